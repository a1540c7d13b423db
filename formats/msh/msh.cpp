#include "formats/registry.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <vector>

#include "core/text_buffer.h"
#include "fem/faces.h"
#include "formats/msh/cell.h"
#include "formats/msh/element_data.h"
#include "formats/msh/reader.h"

namespace selvage::formats::msh {

std::string quoted(std::string name) {
  std::replace(name.begin(), name.end(), '"', '\'');
  return '"' + name + '"';
}

void write_box(TextBuffer& text, const Box3& box) {
  for (const Vec3& corner : {Vec3(box.min()), Vec3(box.max())})
    for (int k = 0; k < 3; ++k) text << corner[k] << ' ';
}

void write_region_names(TextBuffer& text, const fem::Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.regions.size(); ++i)
    text << "3 " << i + 1 << ' ' << quoted(mesh.regions[i].name) << '\n';
}

void write_volume(TextBuffer& text, std::size_t tag, const Box3& box,
                  const std::vector<std::string>& around) {
  text << tag << ' ';
  write_box(text, box);
  text << "1 " << tag << ' ' << around.size();
  for (const std::string& surface : around) text << ' ' << surface;
  text << '\n';
}

namespace {

// How many of a region's elements are wedges, or are none.
std::size_t count_elements(const fem::Mesh& mesh, const fem::Region& region, bool wedges) {
  std::size_t count = 0;
  for (std::size_t e = region.first_element; e < region.last_element; ++e)
    count += mesh.is_wedge(e) == wedges ? 1 : 0;
  return count;
}

}  // namespace

void write_volume_elements(TextBuffer& text, const fem::Mesh& mesh, std::size_t number) {
  // Tetrahedra of 4 and 10 nodes, hexahedra, wedges. Gmsh's ten-node tetrahedron has the midpoints of the
  // edges 01 12 20 03 23 13: ours with the last two exchanged.
  constexpr int wedge = 6;
  const int type = mesh.shape == fem::Mesh::Shape::hexahedron ? 5 : mesh.order == 1 ? 4 : 11;
  constexpr std::array<std::size_t, 10> node_order = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};
  for (std::size_t i = 0; i < mesh.regions.size(); ++i)
    for (const bool wedges : {false, true}) {
      const fem::Region& region = mesh.regions[i];
      const std::size_t count = count_elements(mesh, region, wedges);
      if (count == 0) continue;
      text << "3 " << i + 1 << ' ' << (wedges ? wedge : type) << ' ' << count << '\n';
      for (std::size_t e = region.first_element; e < region.last_element; ++e) {
        if (mesh.is_wedge(e) != wedges) continue;
        text << number + e + 1;
        const std::vector<std::size_t> nodes = mesh.different_nodes_of(e);
        for (std::size_t k = 0; k < nodes.size(); ++k) text << ' ' << nodes[node_order[k]] + 1;
        text << '\n';
      }
    }
}

namespace {

using Faces = std::vector<fem::ElementSide>;

// A yarn's boundary in the file: entity and physical group `tag`.
struct Skin {
  int tag = 0;
  std::string name;
  std::size_t region = 0;
  const Faces* faces = nullptr;
};

// Surfaces are numbered 1.. over all yarns; volumes are the yarns, 1.. .
std::vector<Skin> skins_of(const fem::Mesh& mesh) {
  std::vector<Skin> skins;
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    const fem::Region& region = mesh.regions[i];
    auto add = [&](const char* part, const Faces& faces) {
      if (!faces.empty())
        skins.push_back({static_cast<int>(skins.size()) + 1, region.name + part, i, &faces});
    };
    add("_side", region.side_faces);
    add("_start", region.start_faces);
    add("_end", region.end_faces);
  }
  return skins;
}

void write_names(TextBuffer& text, const fem::Mesh& mesh, const std::vector<Skin>& skins) {
  text << "$PhysicalNames\n" << skins.size() + mesh.regions.size() << '\n';
  for (const Skin& skin : skins) text << "2 " << skin.tag << ' ' << quoted(skin.name) << '\n';
  write_region_names(text, mesh);
  text << "$EndPhysicalNames\n";
}

void write_entities(TextBuffer& text, const fem::Mesh& mesh, const std::vector<Skin>& skins) {
  text << "$Entities\n0 0 " << skins.size() << ' ' << mesh.regions.size() << '\n';
  for (const Skin& skin : skins) {
    Box3 box;
    for (const auto& face : *skin.faces)
      for (const std::size_t node : face) box.extend(mesh.nodes[node]);
    text << skin.tag << ' ';
    write_box(text, box);
    text << "1 " << skin.tag << " 0\n";
  }
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    const fem::Region& region = mesh.regions[i];
    Box3 box;
    for (std::size_t n = region.first_node; n < region.last_node; ++n) box.extend(mesh.nodes[n]);
    std::vector<std::string> around;
    for (const Skin& skin : skins)
      if (skin.region == i) around.push_back(std::to_string(skin.tag));
    write_volume(text, i + 1, box, around);
  }
  text << "$EndEntities\n";
}

// All nodes of a yarn are said to be in its volume: the triangles of its skin use them from there.
void write_nodes(TextBuffer& text, const fem::Mesh& mesh) {
  text << "$Nodes\n" << mesh.regions.size() << ' ' << mesh.nodes.size() << " 1 " << mesh.nodes.size() << '\n';
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    const fem::Region& region = mesh.regions[i];
    std::vector<std::size_t> nodes(region.last_node - region.first_node);
    std::iota(nodes.begin(), nodes.end(), region.first_node);
    write_node_block(text, mesh, 3, i + 1, nodes);
  }
  text << "$EndNodes\n";
}

// The elements of a skin by Gmsh's type: 2 and 9 are triangles of 3 and 6 nodes, 3 quadrilaterals.
std::map<int, std::vector<std::vector<std::size_t>>> elements_of(const fem::Mesh& mesh, const Skin& skin) {
  std::map<int, std::vector<std::vector<std::size_t>>> by_type;
  if (mesh.shape == fem::Mesh::Shape::hexahedron)
    for (const fem::ElementSide& n : *skin.faces) {
      if (n[2] == n[3])
        by_type[2].push_back({n[0], n[1], n[2]});
      else
        by_type[3].push_back({n[0], n[1], n[2], n[3]});
    }
  else
    for (const fem::SixNodes& n : fem::six_node_faces(mesh, mesh.regions[skin.region], *skin.faces))
      by_type[mesh.order == 1 ? 2 : 9].emplace_back(n.begin(), n.begin() + (mesh.order == 1 ? 3 : 6));
  return by_type;
}

BoundingElements write_elements(TextBuffer& text, const fem::Mesh& mesh, const std::vector<Skin>& skins) {
  BoundingElements bounding;
  std::size_t count = mesh.elements.size(), blocks = 0;
  for (const fem::Region& region : mesh.regions)
    for (const bool wedges : {false, true}) blocks += count_elements(mesh, region, wedges) > 0 ? 1 : 0;
  for (const Skin& skin : skins) {
    count += skin.faces->size();
    blocks += elements_of(mesh, skin).size();
  }
  text << "$Elements\n" << blocks << ' ' << count << " 1 " << count << '\n';
  std::size_t number = 0;
  for (const Skin& skin : skins)
    for (const auto& [type, elements] : elements_of(mesh, skin)) {
      text << "2 " << skin.tag << ' ' << type << ' ' << elements.size() << '\n';
      for (const std::vector<std::size_t>& nodes : elements) {
        text << ++number;
        bounding.add(nodes);
        for (const std::size_t node : nodes) text << ' ' << node + 1;
        text << '\n';
      }
    }
  write_volume_elements(text, mesh, number);
  text << "$EndElements\n";
  return bounding;
}

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output, const MeshFileOptions& /*options*/) {
  if (mesh.cell) return write_cell(mesh, output);
  const std::vector<Skin> skins = skins_of(mesh);
  TextBuffer text(output);
  text << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
  write_names(text, mesh, skins);
  write_entities(text, mesh, skins);
  write_nodes(text, mesh);
  write_fibre_fraction(text, mesh, write_elements(text, mesh, skins));
  std::size_t triangles = 0, faces = 0;
  for (const Skin& skin : skins)
    for (const fem::ElementSide& face : *skin.faces) {
      triangles += face[2] == face[3] ? 1 : 0;
      ++faces;
    }
  const std::size_t wedges = mesh.count_wedges(), others = mesh.elements.size() - wedges;
  const bool is_brick = mesh.shape == fem::Mesh::Shape::hexahedron;
  return finished(text,
                  {{"nodes", mesh.nodes.size()},
                   {is_brick ? "hexahedra" : "tetrahedra", others},
                   {"physical groups", skins.size() + mesh.regions.size()}},
                  {{"triangles", triangles}, {"quadrangles", faces - triangles}, {"wedges", wedges}});
}

bool has_the_first_line(std::string_view head) {
  return head.starts_with("$MeshFormat");
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "msh",
                                  .title = "Gmsh mesh 4.1",
                                  .extensions = {".msh"},
                                  .sniff = has_the_first_line,
                                  .read_mesh = read_mesh,
                                  .write_mesh = write,
                                  .order_of_surfaces = 2,
                                  .order_of_cohesive = 1,
                                  .order_of_pores = 2,
                                  .has_layers = true};
  return self;
}

}  // namespace selvage::formats::msh
