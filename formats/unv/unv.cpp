#include "formats/registry.h"

#include <algorithm>

#include "core/columns.h"
#include "fem/sections.h"

namespace selvage::formats::unv {
namespace {

constexpr std::string_view mark = "    -1\n";
constexpr std::size_t width = 10;

void open_dataset(TextBuffer& text, std::size_t number) {
  text << mark;
  put_right(text, number, 6);
  text << '\n';
}

// Dataset 2411: number, two coordinate systems, colour; then the coordinates, 3D25.16.
void write_nodes(TextBuffer& text, const fem::Mesh& mesh) {
  open_dataset(text, 2411);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    put_right(text, {n + 1, 1, 1, 11}, width);
    text << '\n';
    // The exponent has two digits here unless it needs three.
    for (int k = 0; k < 3; ++k) {
      std::string number = scientific_text(mesh.nodes[n][k], 16, 'D');
      if (const std::size_t cut = number.find('D') + 2; number[cut] == '0') number.erase(cut, 1);
      put_right(text, number, 25);
    }
    text << '\n';
  }
  text << mark;
}

// Dataset 2412: 111 and 118 are tetrahedra of 4 and 10 nodes, 115 the brick of 8, 112 the wedge of 6. Ten
// nodes go round the base, corners and middles in turn, then up the three edges, then the tip.
void write_elements(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections) {
  const bool is_brick = mesh.shape == fem::Mesh::Shape::hexahedron;
  const std::size_t descriptor = is_brick ? 115 : mesh.order == 1 ? 111 : 118;
  constexpr std::array<std::size_t, 10> plain = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9},
                                        round = {0, 4, 1, 5, 2, 6, 7, 8, 9, 3};
  const auto& order = mesh.nodes_per_element() == 10 ? round : plain;
  const std::vector<std::size_t> materials = fem::element_materials(mesh, sections);
  open_dataset(text, 2412);
  for (std::size_t i = 0; i < mesh.regions.size(); ++i)
    for (std::size_t e = mesh.regions[i].first_element; e < mesh.regions[i].last_element; ++e) {
      const std::vector<std::size_t> own = mesh.different_nodes_of(e);
      const std::size_t type = mesh.is_wedge(e) ? 112 : descriptor;
      put_right(text, {e + 1, type, i + 1, materials[e] + 1, 7, own.size()}, width);
      text << '\n';
      std::vector<std::size_t> nodes;
      for (std::size_t k = 0; k < own.size(); ++k) nodes.push_back(own[order[k]]);
      put_numbers(text, nodes, width, 8);
    }
  text << mark;
}

// Of dataset 2467; the entity type is 7 for nodes, 8 for elements.
void write_group(TextBuffer& text, std::size_t number, const fem::NamedSet& set, std::size_t type) {
  put_right(text, {number, 0, 0, 0, 0, 0, 0, set.members.size()}, width);
  text << '\n' << set.name << '\n';
  for (std::size_t k = 0; k < set.members.size(); ++k) {
    put_right(text, {type, set.members[k] + 1, 0, 0}, width);
    if (k % 2 == 1 || k + 1 == set.members.size()) text << '\n';
  }
}

std::size_t write_groups(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections,
                         const fem::DeckNames& names) {
  open_dataset(text, 2467);
  std::size_t number = 0;
  for (const fem::NamedSet& set : fem::element_sets(mesh, sections, names))
    write_group(text, ++number, set, 8);
  for (const fem::NamedSet& set : fem::node_sets(mesh, names)) write_group(text, ++number, set, 7);
  text << mark;
  return number;
}

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output, const MeshFileOptions& /*options*/) {
  const fem::DeckNames names(mesh, {.longest = 24});  // Code_Aster's groups
  const Result<std::vector<fem::Section>> sections = fem::sections(mesh, names);
  if (!sections) return sections.error();
  TextBuffer text(output);
  write_nodes(text, mesh);
  write_elements(text, mesh, *sections);
  const std::size_t groups = write_groups(text, mesh, *sections, names);
  return finished(text,
                  {{"nodes", mesh.nodes.size()}, {"elements", mesh.elements.size()}, {"groups", groups}});
}

bool begins_with_a_dataset(std::string_view head) {
  return head.starts_with("    -1\n") || head.starts_with("    -1\r\n");
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "unv",
                                  .title = "I-DEAS universal file (Salome, Code_Aster)",
                                  .extensions = {".unv"},
                                  .sniff = begins_with_a_dataset,
                                  .write_mesh = write};
  return self;
}

}  // namespace selvage::formats::unv
