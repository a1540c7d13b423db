// Where regions of a cell meet that share no nodes: cohesive elements, or surfaces that are tied.
#include <algorithm>

#include "fem/materials.h"
#include "formats/inp/deck.h"

namespace selvage::formats::inp {
namespace {

void write_side(TextBuffer& text, const std::string& name, const fem::Interface& interface,
                fem::FacingSides::Side fem::FacingSides::*which) {
  text << "*SURFACE, NAME=" << name << ", TYPE=ELEMENT\n";
  for (const fem::FacingSides& facing : interface.sides)
    text << (facing.*which).element + 1 << ", S" << (facing.*which).side + 1 << '\n';
}

// Of each interface the first region's nodes that are tied there. Each node is tied once, to the last of the
// regions that it meets; one that an equation eliminates follows from the node that it depends on.
std::vector<std::vector<std::size_t>> tied_nodes(const fem::Mesh& mesh) {
  std::vector<bool> is_done(mesh.nodes.size(), false);
  for (const std::size_t node : dependent_nodes(mesh)) is_done[node] = true;
  std::vector<std::size_t> order(mesh.interfaces.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return mesh.interfaces[a].second > mesh.interfaces[b].second;
  });
  std::vector<std::vector<std::size_t>> tied(mesh.interfaces.size());
  for (const std::size_t i : order) {
    for (const fem::FacingSides& facing : mesh.interfaces[i].sides)
      for (std::size_t k = 0; k < (mesh.order == 1 ? 3U : 6U); ++k) {
        const std::size_t node = facing.first.nodes[k];
        if (!is_done[node]) tied[i].push_back(node);
        is_done[node] = true;
      }
    std::sort(tied[i].begin(), tied[i].end());
  }
  return tied;
}

}  // namespace

void write_cohesive_elements(TextBuffer& text, const Deck& deck) {
  const fem::Mesh& mesh = deck.mesh;
  if (mesh.joining != fem::Joining::cohesive) return;
  std::size_t number = mesh.elements.size();
  for (std::size_t i = 0; i < mesh.interfaces.size(); ++i) {
    text << "*ELEMENT, TYPE=COH3D6, ELSET=" << deck.names.of_interface(mesh, i, "_Cohesive") << '\n';
    for (const fem::FacingSides& facing : mesh.interfaces[i].sides) {
      text << ++number;
      for (const auto* side : {&facing.first, &facing.second})
        for (std::size_t k = 0; k < 3; ++k) text << ", " << side->nodes[k] + 1;
      text << '\n';
    }
  }
}

void write_interface_surfaces(TextBuffer& text, const Deck& deck) {
  const fem::Mesh& mesh = deck.mesh;
  if (mesh.joining != fem::Joining::surfaces) return;
  const std::vector<std::vector<std::size_t>> tied = tied_nodes(mesh);
  for (std::size_t i = 0; i < mesh.interfaces.size(); ++i) {
    const auto name = [&](std::string_view ending) { return deck.names.of_interface(mesh, i, ending); };
    write_side(text, name("_Side"), mesh.interfaces[i], &fem::FacingSides::first);
    write_side(text, name("_Facing"), mesh.interfaces[i], &fem::FacingSides::second);
    if (tied[i].empty()) continue;
    text << "*NSET, NSET=" << name("_Tied") << '\n';
    write_set(text, tied[i]);
    text << "*SURFACE, NAME=" << name("_Tied") << ", TYPE=NODE\n" << name("_Tied") << ",\n";
  }
}

void write_ties(TextBuffer& text, const Deck& deck) {
  const fem::Mesh& mesh = deck.mesh;
  if (mesh.joining != fem::Joining::surfaces) return;
  const double tolerance = 1e-6 * (mesh.cell->high - mesh.cell->low).maxCoeff();
  text << "** Nodes of _Side are tied to _Facing but for those that equations eliminate. For contact "
          "instead: a "
          "*CONTACT PAIR of _Side and _Facing.\n";
  const std::vector<std::vector<std::size_t>> tied = tied_nodes(mesh);
  for (std::size_t i = 0; i < mesh.interfaces.size(); ++i) {
    if (tied[i].empty()) continue;
    const std::string slave = deck.names.of_interface(mesh, i, "_Tied");
    text << "*TIE, NAME=" << slave << ", ADJUST=NO, POSITION TOLERANCE=" << real(tolerance) << '\n'
         << slave << ", " << deck.names.of_interface(mesh, i, "_Facing") << '\n';
  }
}

void write_cohesive_materials(TextBuffer& text, const Deck& deck) {
  const fem::Mesh& mesh = deck.mesh;
  const std::vector<std::string> names = fem::solver_names(mesh.materials, mesh.laws);
  const auto three = [&](const fabric::Interface::Pair& pair) {
    text << real(pair.normal) << ", " << real(pair.shear) << ", " << real(pair.shear) << '\n';
  };
  for (std::size_t i = 0; i < mesh.laws.size(); ++i) {
    const fem::CohesiveLaw& law = mesh.laws[i];
    text << "** Tractions: MPa, openings: mm\n*MATERIAL, NAME=" << names[mesh.materials.size() + i]
         << "\n*ELASTIC, TYPE=TRACTION\n";
    three(law.stiffness);
    if (!law.fracture) continue;
    text << "*DAMAGE INITIATION, CRITERION=QUADS\n";
    three(law.fracture->strength);
    text << "*DAMAGE EVOLUTION, TYPE=ENERGY, MIXED MODE BEHAVIOR=POWER LAW, POWER=1\n";
    three(law.fracture->energy);
  }
  for (std::size_t i = 0; i < mesh.interfaces.size() && !mesh.laws.empty(); ++i)
    text << "*COHESIVE SECTION, ELSET=" << deck.names.of_interface(mesh, i, "_Cohesive")
         << ", MATERIAL=" << names[mesh.materials.size() + mesh.interfaces[i].law]
         << ", RESPONSE=TRACTION SEPARATION, THICKNESS=SPECIFIED\n1\n";
}

}  // namespace selvage::formats::inp
