// Nodes, elements, and what is told by their numbers.
#include "fem/materials.h"
#include "formats/inp/deck.h"

namespace selvage::formats::inp {

namespace {

void write_node(TextBuffer& text, std::size_t number, const Vec3& p) {
  text << number << ", " << real(p.x()) << ", " << real(p.y()) << ", " << real(p.z()) << '\n';
}

// One block, for meshio knows no second one: drivers and rigid parts, whose nodes are no part of AllNodes,
// stand at its end.
void write_nodes(TextBuffer& text, const Deck& deck) {
  const fem::Mesh& mesh = deck.mesh;
  const bool has_more = !mesh.drivers.empty() || deck.forming != nullptr;
  text << (has_more ? "*NODE\n" : "*NODE, NSET=AllNodes\n");
  for (std::size_t n = 0; n < mesh.numbered(); ++n) write_node(text, n + 1, mesh.place(n));
  if (deck.forming != nullptr) write_rigid_nodes(text, mesh, *deck.forming);
  if (has_more) text << "*NSET, NSET=AllNodes, GENERATE\n1, " << mesh.nodes.size() << ", 1\n";
  if (mesh.drivers.empty()) return;
  for (std::size_t k = 0; k < mesh.drivers.size(); ++k)
    text << "*NSET, NSET=" << mesh.drivers[k].name << '\n' << mesh.number_of_driver(k) + 1 << '\n';
  text << "*NSET, NSET=Drivers, GENERATE\n" << mesh.nodes.size() + 1 << ", " << mesh.numbered() << ", 1\n";
}

// Of one region, those that are wedges or those that are not.
void write_elements(TextBuffer& text, const Deck& deck, std::size_t i, bool wedges) {
  const fem::Mesh& mesh = deck.mesh;
  const fem::Region& region = mesh.regions[i];
  bool is_first = true;
  for (std::size_t e = region.first_element; e < region.last_element; ++e) {
    if (mesh.is_wedge(e) != wedges) continue;
    if (is_first)
      text << "*ELEMENT, TYPE=" << (wedges ? deck.wedge : deck.element) << ", ELSET=" << deck.names.of(i)
           << '\n';
    is_first = false;
    text << e + 1;
    for (const std::size_t node : mesh.different_nodes_of(e)) text << ", " << node + 1;
    text << '\n';
  }
}

void write_elements(TextBuffer& text, const Deck& deck) {
  for (std::size_t i = 0; i < deck.mesh.regions.size(); ++i)
    for (const bool wedges : {false, true}) write_elements(text, deck, i, wedges);
}

// One name a line: sixteen may be too long for Abaqus's 256 columns, and meshio takes the first of a line.
void write_element_sets(TextBuffer& text, const Deck& deck) {
  text << "*ELSET, ELSET=All\n";
  for (std::size_t i = 0; i < deck.mesh.regions.size(); ++i) text << deck.names.of(i) << '\n';
  for (const fem::Section& section : deck.sections) {
    if (section.name == deck.names.of(section.region)) continue;
    text << "*ELSET, ELSET=" << section.name << '\n';
    write_set(text, section.elements);
  }
}

void write_node_sets(TextBuffer& text, const std::vector<fem::NamedSet>& sets) {
  for (const fem::NamedSet& set : sets) {
    text << "*NSET, NSET=" << set.name << '\n';
    write_set(text, set.members);
  }
}

void write_vectors(TextBuffer& text, const Vec3& along, const Vec3& across) {
  for (const double value : {along.x(), along.y(), along.z(), across.x(), across.y()})
    text << real(value) << ", ";
  text << real(across.z()) << '\n';
}

// Local axes 1 along the yarn, 2 across it, element by element. The distribution's name must not look like a
// Fortran real (CalculiX takes D1 for a number).
void write_directions(TextBuffer& text, const Deck& deck) {
  const fem::Mesh& mesh = deck.mesh;
  text << "** 1: along the yarn, 2: across it\n*DISTRIBUTION, NAME=YARNDIST1, LOCATION=ELEMENT, "
          "TABLE=YARNTABLE\n, ";
  write_vectors(text, Vec3::UnitX(), Vec3::UnitY());
  for (const fem::Section& section : deck.sections) {
    if (!is_oriented(mesh, section)) continue;
    for (const std::size_t e : section.elements) {
      text << e + 1 << ", ";
      write_vectors(text, mesh.along[e], mesh.across[e]);
    }
  }
}

Result<WriteFacts> write_mesh_file(const fem::Mesh& mesh, OutputFile& output,
                                   const MeshFileOptions& options) {
  const Result<Deck> deck = plan_deck(mesh, options);
  if (!deck) return deck.error();
  TextBuffer text(output);
  text << "** Mesh by Selvage: the deck that stands beside it includes it.\n";
  write_names(text, *deck);
  write_mesh_part(text, *deck);
  return finished(text, counts_of_mesh(*deck));
}

}  // namespace

void write_set(TextBuffer& text, const std::vector<std::size_t>& members) {
  for (std::size_t i = 0; i < members.size(); ++i)
    text << members[i] + 1 << (i % 16 == 15 || i + 1 == members.size() ? "\n" : ", ");
}

bool is_oriented(const fem::Mesh& mesh, const fem::Section& section) {
  return mesh.regions[section.region].kind == fem::Region::Kind::yarn ||
         !fem::is_isotropic(mesh.materials[section.material], mesh.physics);
}

void write_mesh_part(TextBuffer& text, const Deck& deck) {
  write_nodes(text, deck);
  write_elements(text, deck);
  write_cohesive_elements(text, deck);
  write_element_sets(text, deck);
  write_node_sets(text, deck.node_sets);
  if (!deck.mesh.equations.empty()) write_node_sets(text, {{"Dependent", dependent_nodes(deck.mesh)}});
  write_contact_surfaces(text, deck);
  write_interface_surfaces(text, deck);
  if (deck.forming != nullptr) write_rigid_parts(text, deck.mesh, *deck.forming);
  write_directions(text, deck);
}

EntityCounts counts_of_mesh(const Deck& deck) {
  const fem::Mesh& mesh = deck.mesh;
  const std::size_t wedges = mesh.count_wedges();
  EntityCounts counts = {{"nodes", mesh.nodes.size()},
                         {std::string(deck.element), mesh.elements.size() - wedges},
                         {"element sets", mesh.regions.size() + 1},
                         {"node sets", deck.node_sets.size() + 1 + mesh.drivers.size()}};
  if (wedges > 0) counts[std::string(deck.wedge)] = wedges;
  if (mesh.joining == fem::Joining::cohesive) counts["COH3D6"] = mesh.cohesive_elements();
  return counts;
}

const Descriptor& mesh_descriptor() {
  static const Descriptor self = {.name = "inp",
                                  .title = "mesh that an Abaqus and CalculiX input deck includes",
                                  .extensions = {".inp"},
                                  .write_mesh = write_mesh_file,
                                  .is_companion = true};
  return self;
}

}  // namespace selvage::formats::inp
