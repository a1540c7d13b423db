#include "formats/cdb/pores.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "core/columns.h"
#include "fem/faces.h"
#include "fem/names.h"
#include "fem/sections.h"
#include "fem/sides.h"
#include "formats/cdb/deck.h"

namespace selvage::formats::cdb {
namespace {

// All nodes of a patch, increasing; midside nodes too.
std::vector<std::size_t> nodes_of(const fem::Mesh& mesh, const fem::Patch& patch) {
  std::vector<std::size_t> nodes;
  for (const fem::Patch::Side& side : patch.sides) {
    const fem::ElementSide& corners = fem::element_sides(mesh, side.element)[side.side];
    const auto& element = mesh.elements[side.element];
    const auto is_corner = [&](std::size_t k) { return std::ranges::find(corners, k) != corners.end(); };
    for (std::size_t k = 0; k < 4; ++k)
      if (is_corner(k)) nodes.push_back(element[k]);
    if (mesh.order == 2)
      for (std::size_t k = 0; k < fem::edge_ends.size(); ++k)
        if (is_corner(fem::edge_ends[k][0]) && is_corner(fem::edge_ends[k][1]))
          nodes.push_back(element[4 + k]);
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void write_elements(TextBuffer& text, const fem::Mesh& mesh) {
  open_block(text, "EBLOCK,19,SOLID,", mesh.elements.size(), "(19i10)");
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const std::span<const std::size_t> nodes = mesh.nodes_of(e);
    write_element_head(text, {.material = 1, .nodes = nodes.size(), .number = e + 1});
    put_numbers(text, nodes, 10, 8);
  }
  text << "        -1\n";
}

}  // namespace

Result<WriteFacts> write_pores(const fem::Mesh& mesh, OutputFile& output) {
  std::vector<std::string> own;
  for (const fem::Patch& patch : mesh.patches) own.push_back(patch.name);
  const std::vector<std::string> names =
      fem::unique_names(own, {.longest = 32, .taken = {"ALL", "STAT", "DEFA", "PORES"}});
  TextBuffer text(output);
  text << "/COM,ANSYS mesh archive by Selvage: the space between yarns, mm. Read it with CDREAD,DB\n";
  for (std::size_t k = 0; k < own.size(); ++k)
    if (names[k] != own[k]) text << "! " << names[k] << " is yarn '" << own[k] << "'\n";
  text << "/PREP7\nET,1,200\nKEYOPT,1,1," << (mesh.order == 1 ? 8 : 9) << '\n';
  write_node_block(text, mesh.nodes);
  write_elements(text, mesh);
  fem::NamedSet all{"PORES", std::vector<std::size_t>(mesh.elements.size())};
  std::iota(all.members.begin(), all.members.end(), std::size_t{0});
  write_component(text, all, false);
  for (std::size_t k = 0; k < mesh.patches.size(); ++k)
    write_component(text, {names[k], nodes_of(mesh, mesh.patches[k])}, true);
  text << "FINISH\n";
  return finished(text, {{"nodes", mesh.nodes.size()},
                         {"MESH200", mesh.elements.size()},
                         {"components", mesh.patches.size() + 1}});
}

}  // namespace selvage::formats::cdb
