#include "formats/cdb/interfaces.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <vector>

#include "core/columns.h"
#include "fem/materials.h"
#include "formats/cdb/deck.h"

namespace selvage::formats::cdb {
namespace {

constexpr std::size_t target_type = 3, contact_type = 4, first_pair = 11;  // numbers of real constants

// Nodes of one side of an interface, increasing.
std::vector<std::size_t> nodes_of(const fem::Mesh& mesh, const fem::Interface& interface,
                                  fem::FacingSides::Side fem::FacingSides::*which) {
  std::vector<std::size_t> nodes;
  for (const fem::FacingSides& facing : interface.sides) {
    const auto& side = (facing.*which).nodes;
    nodes.insert(nodes.end(), side.begin(), side.begin() + (mesh.order == 1 ? 3 : 6));
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

// TB,CZM's bilinear law for interface elements: largest normal traction, opening at which it has parted, the
// same along it, the share of these openings at which softening begins (one for both), weight of the shear.
std::array<double, 6> bilinear(const fem::CohesiveLaw& law) {
  const auto& [normal, shear] = law.stiffness;
  // Nothing breaks: the law bends at an opening of a millimetre.
  if (!law.fracture) return {normal, 2, shear, 2, 0.5, 1};
  const auto& [strength, energy] = *law.fracture;
  const double at_normal = strength.normal * strength.normal / (2 * normal * energy.normal);
  const double at_shear = strength.shear * strength.shear / (2 * shear * energy.shear);
  return {strength.normal,
          2 * energy.normal / strength.normal,
          strength.shear,
          2 * energy.shear / strength.shear,
          std::min(at_normal, at_shear),
          1};
}

}  // namespace

int cohesive_element(const fem::Mesh& mesh) {
  return mesh.order == 1 ? 205 : 204;
}

void write_interface_types(TextBuffer& text, const fem::Mesh& mesh) {
  if (mesh.joining == fem::Joining::cohesive)
    text << "ET," << cohesive_type << ',' << cohesive_element(mesh) << '\n';
  // Always bonded, without what may lie between; a real constant set a pair.
  if (mesh.joining == fem::Joining::surfaces)
    text << "ET," << target_type << ",170\nET," << contact_type << ",174\nKEYOPT," << contact_type
         << ",12,5\nKEYOPT," << contact_type << ",9,1\n";
}

void write_cohesive_elements(TextBuffer& text, const fem::Mesh& mesh) {
  if (mesh.joining != fem::Joining::cohesive) return;
  std::size_t number = mesh.elements.size() + mesh.drivers.size();
  for (const fem::Interface& interface : mesh.interfaces)
    for (const fem::FacingSides& facing : interface.sides) {
      const auto &p = facing.first.nodes, &q = facing.second.nodes;
      std::vector<std::size_t> nodes = {p[0], p[1], p[2], p[2], q[0], q[1], q[2], q[2]};
      if (mesh.order == 2)
        for (const auto* side : {&p, &q})
          nodes.insert(nodes.end(), {(*side)[3], (*side)[4], (*side)[2], (*side)[5]});
      write_element_head(text, {.material = mesh.materials.size() + interface.law + 1,
                                .type = cohesive_type,
                                .nodes = nodes.size(),
                                .number = ++number});
      put_numbers(text, nodes, 10, 8);
    }
}

void write_interface_components(TextBuffer& text, const fem::Mesh& mesh, const fem::DeckNames& names) {
  std::size_t number = mesh.elements.size() + mesh.drivers.size();
  for (std::size_t i = 0; i < mesh.interfaces.size(); ++i) {
    const fem::Interface& interface = mesh.interfaces[i];
    const auto name = [&](std::string_view ending) { return names.of_interface(mesh, i, ending); };
    if (mesh.joining == fem::Joining::cohesive) {
      fem::NamedSet set{name("_Cohesive"), std::vector<std::size_t>(interface.sides.size())};
      std::iota(set.members.begin(), set.members.end(), number);
      number += interface.sides.size();
      write_component(text, set, false);
    }
    write_component(text, {name("_Side"), nodes_of(mesh, interface, &fem::FacingSides::first)}, true);
    write_component(text, {name("_Facing"), nodes_of(mesh, interface, &fem::FacingSides::second)}, true);
  }
}

void write_cohesive_materials(TextBuffer& text, const fem::Mesh& mesh) {
  const std::vector<std::string> names = fem::solver_names(mesh.materials, mesh.laws);
  for (std::size_t i = 0; i < mesh.laws.size(); ++i) {
    const std::size_t number = mesh.materials.size() + i + 1;
    const std::array<double, 6> c = bilinear(mesh.laws[i]);
    text << "! material " << number << ": " << names[number - 1] << ", an interface: "
         << (mesh.laws[i].fracture ? "bilinear, stiffness " : "nothing breaks, stiffness ")
         << c[0] / (c[4] * c[1]) << " across and " << c[2] / (c[4] * c[3]) << " along it, MPa/mm\nTB,CZM,"
         << number << ",1,,BILI\nTBDATA,1";
    for (const double constant : c) text << ',' << constant;
    text << '\n';
  }
}

void write_bonded_contact(TextBuffer& text, const fem::Mesh& mesh, const fem::DeckNames& names) {
  if (mesh.joining != fem::Joining::surfaces) return;
  text << "! bonded contact between NAME_Side and NAME_Facing\n";
  for (std::size_t i = 0; i < mesh.interfaces.size(); ++i) {
    const fem::Interface& interface = mesh.interfaces[i];
    text << "R," << first_pair + i << "\nREAL," << first_pair + i << '\n';
    const auto cover = [&](std::size_t type, std::size_t region, std::string_view ending) {
      text << "CMSEL,S," << names.of(region) << ",ELEM\nCMSEL,S," << names.of_interface(mesh, i, ending)
           << ",NODE\nTYPE," << type << "\nESURF\n";
    };
    cover(target_type, interface.second, "_Facing");
    cover(contact_type, interface.first, "_Side");
  }
  text << "ALLSEL\nTYPE,1\nREAL,1\n";
}

}  // namespace selvage::formats::cdb
