#include "formats/msh/cell.h"

#include <algorithm>
#include <map>

#include "cell_problem/complete_cell.h"
#include "fem/faces.h"
#include "formats/msh/element_data.h"
#include "formats/msh/topology.h"

namespace selvage::formats::msh {
namespace {

// Tags of entities are indices + 1 in their dimension; those of physical groups too: of surfaces the faces A
// to F first, then one group for each pair of regions (and for what ends nowhere); of volumes the regions.
class CellFile {
 public:
  CellFile(const fem::Mesh& mesh, TextBuffer& text)
      : mesh_(mesh),
        text_(text),
        topology_(topology_of(mesh)),
        opposite_(fem::opposite_nodes(*mesh.cell, mesh.nodes.size())),
        copies_(copies_in(topology_, opposite_)) {
    if (mesh.order == 2) find_midside_nodes();
    name_groups();
    place_nodes();
  }

  void write() {
    text_ << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    write_names();
    write_entities();
    write_nodes();
    write_elements();
    write_periodic();
    write_fibre_fraction(text_, mesh_, bounding_);
  }

  [[nodiscard]] EntityCounts counts() const {
    std::size_t sides = 0, quadrangles = 0;
    for (const Surface& surface : topology_.surfaces) {
      sides += surface.sides.size();
      quadrangles += count_sides(surface, 4);
    }
    EntityCounts counts = {
        {"nodes", mesh_.nodes.size()},
        {mesh_.shape == fem::Mesh::Shape::hexahedron ? "quadrangles" : "triangles", sides},
        {mesh_.shape == fem::Mesh::Shape::hexahedron ? "hexahedra" : "tetrahedra", mesh_.elements.size()},
        {"physical groups", groups_.size() + mesh_.regions.size() + layers() + 2},
        {"periodic entities", copies_.size()}};
    if (layers() > 0) counts["wedges"] = mesh_.cohesive_elements();
    if (const std::size_t wedges = mesh_.layers.wedges.size(); wedges > 0) {
      counts["triangles"] = sides - quadrangles;
      counts["quadrangles"] = quadrangles;
      counts["wedges"] = wedges;
    }
    return counts;
  }

 private:
  [[nodiscard]] static std::size_t corners_of(const std::array<std::size_t, 4>& side) {
    return side[3] == side[2] ? 3 : 4;
  }
  [[nodiscard]] static std::size_t count_sides(const Surface& surface, std::size_t corners) {
    return static_cast<std::size_t>(std::ranges::count_if(
        surface.sides, [corners](const auto& side) { return corners_of(side) == corners; }));
  }

  // Volumes of cohesive elements: numbered behind those of the regions.
  [[nodiscard]] std::size_t layers() const {
    return mesh_.joining == fem::Joining::cohesive ? mesh_.interfaces.size() : 0;
  }
  [[nodiscard]] std::string layer_name(std::size_t i) const {
    const fem::Interface& layer = mesh_.interfaces[i];
    const fem::Region& second = mesh_.regions[layer.second];
    return mesh_.regions[layer.first].name +
           (second.kind == fem::Region::Kind::matrix ? "" : "_" + second.name) + "_cohesive";
  }

  void find_midside_nodes() {
    for (const auto& element : mesh_.elements)
      for (std::size_t k = 0; k < fem::edge_ends.size(); ++k) {
        const auto [low, high] = std::minmax(element[fem::edge_ends[k][0]], element[fem::edge_ends[k][1]]);
        middle_[{low, high}] = element[4 + k];
      }
  }
  [[nodiscard]] std::size_t middle(std::size_t a, std::size_t b) const {
    return middle_.at({std::min(a, b), std::max(a, b)});
  }

  [[nodiscard]] std::string group_name(const Surface& surface) const {
    if (!mesh_.patches.empty()) return mesh_.patches[surface.patch].name;
    if (surface.face >= 0) return std::string("Face") + static_cast<char>('A' + surface.face);
    const std::string& name = mesh_.regions[surface.region].name;
    const std::size_t beyond = std::min(surface.behind, surface.facing);  // one of them is outside
    if (beyond == fem::OuterSide::outside) return name + "_side";
    const fem::Region& behind = mesh_.regions[beyond];
    return behind.kind == fem::Region::Kind::matrix ? name + "_side" : name + "_" + behind.name;
  }

  void name_groups() {
    for (const Surface& surface : topology_.surfaces) {
      std::string name = group_name(surface);
      const auto at = std::find(groups_.begin(), groups_.end(), name);
      group_of_.push_back(static_cast<std::size_t>(at - groups_.begin()) + 1);
      if (at == groups_.end()) groups_.push_back(std::move(name));
    }
  }

  // The nodes of one side or edge in Gmsh's order.
  [[nodiscard]] std::vector<std::size_t> nodes_of(const std::array<std::size_t, 4>& side) const {
    const std::size_t corners = corners_of(side);
    std::vector<std::size_t> nodes(side.begin(), side.begin() + static_cast<std::ptrdiff_t>(corners));
    if (mesh_.order == 2)
      for (std::size_t k = 0; k < corners; ++k) nodes.push_back(middle(side[k], side[(k + 1) % corners]));
    return nodes;
  }
  [[nodiscard]] std::vector<std::size_t> nodes_of(const std::array<std::size_t, 2>& edge) const {
    std::vector<std::size_t> nodes(edge.begin(), edge.end());
    if (mesh_.order == 2) nodes.push_back(middle(edge[0], edge[1]));
    return nodes;
  }

  // Each node is in the entity of the least dimension that has it.
  void place_nodes() {
    constexpr std::size_t free = static_cast<std::size_t>(-1);
    std::vector<std::size_t> owner(mesh_.nodes.size(), free);
    const std::array<std::size_t, 4> counts = {topology_.points.size(), topology_.curves.size(),
                                               topology_.surfaces.size(), mesh_.regions.size()};
    for (std::size_t d = 0; d < 4; ++d) members_[d].resize(counts[d]);
    const auto take = [&](std::size_t dimension, std::size_t entity, std::size_t node) {
      if (owner[node] != free) return;
      owner[node] = entity;
      members_[dimension][entity].push_back(node);
    };
    for (std::size_t i = 0; i < counts[0]; ++i) take(0, i, topology_.points[i]);
    for (std::size_t i = 0; i < counts[1]; ++i)
      for (const auto& edge : topology_.curves[i].edges)
        for (const std::size_t node : nodes_of(edge)) take(1, i, node);
    for (std::size_t i = 0; i < counts[2]; ++i)
      for (const auto& side : topology_.surfaces[i].sides)
        for (const std::size_t node : nodes_of(side)) take(2, i, node);
    for (std::size_t i = 0; i < counts[3]; ++i)
      for (std::size_t e = mesh_.regions[i].first_element; e < mesh_.regions[i].last_element; ++e)
        for (const std::size_t node : mesh_.nodes_of(e)) take(3, i, node);
    for (const auto& wedge : mesh_.layers.wedges)
      for (const std::size_t node : wedge) take(3, 0, node);
  }

  void write_names() {
    text_ << "$PhysicalNames\n"
          << groups_.size() + mesh_.regions.size() + layers() + 2 << "\n0 1 \"points\"\n1 1 \"curves\"\n";
    for (std::size_t g = 0; g < groups_.size(); ++g)
      text_ << "2 " << g + 1 << ' ' << quoted(groups_[g]) << '\n';
    write_region_names(text_, mesh_);
    for (std::size_t i = 0; i < layers(); ++i)
      text_ << "3 " << mesh_.regions.size() + i + 1 << ' ' << quoted(layer_name(i)) << '\n';
    text_ << "$EndPhysicalNames\n";
  }

  void write_entities() {
    text_ << "$Entities\n"
          << topology_.points.size() << ' ' << topology_.curves.size() << ' ' << topology_.surfaces.size()
          << ' ' << mesh_.regions.size() + layers() << '\n';
    for (std::size_t i = 0; i < topology_.points.size(); ++i) {
      const Vec3& p = mesh_.nodes[topology_.points[i]];
      text_ << i + 1 << ' ' << p.x() << ' ' << p.y() << ' ' << p.z() << " 1 1\n";
    }
    for (std::size_t i = 0; i < topology_.curves.size(); ++i) {
      const Curve& curve = topology_.curves[i];
      text_ << i + 1 << ' ';
      write_box(text_, box_of(curve.edges));
      text_ << "1 1 2 " << curve.first + 1 << " -" << curve.last + 1 << '\n';
    }
    for (std::size_t i = 0; i < topology_.surfaces.size(); ++i) write_surface(i);
    for (std::size_t i = 0; i < mesh_.regions.size(); ++i)
      write_volume(text_, i + 1, box_of_volume(i), around_volume(i));
    for (std::size_t i = 0; i < layers(); ++i)
      write_volume(text_, mesh_.regions.size() + i + 1, box_of_layer(mesh_.interfaces[i]), {});
    text_ << "$EndEntities\n";
  }

  [[nodiscard]] Box3 box_of(const auto& lists_of_nodes) const {
    Box3 box;
    for (const auto& nodes : lists_of_nodes)
      for (const std::size_t node : nodes) box.extend(mesh_.nodes[node]);
    return box;
  }

  void write_surface(std::size_t i) {
    const Surface& surface = topology_.surfaces[i];
    text_ << i + 1 << ' ';
    write_box(text_, box_of(surface.sides));
    text_ << "1 " << group_of_[i] << ' ' << surface.curves.size();
    for (const std::size_t curve : surface.curves) text_ << ' ' << curve + 1;
    text_ << '\n';
  }

  [[nodiscard]] Box3 box_of_layer(const fem::Interface& layer) const {
    Box3 box;
    for (const fem::FacingSides& facing : layer.sides)
      for (std::size_t k = 0; k < 3; ++k) box.extend(mesh_.nodes[facing.first.nodes[k]]);
    return box;
  }

  [[nodiscard]] Box3 box_of_volume(std::size_t i) const {
    Box3 box;
    for (std::size_t e = mesh_.regions[i].first_element; e < mesh_.regions[i].last_element; ++e)
      for (const std::size_t node : mesh_.nodes_of(e)) box.extend(mesh_.nodes[node]);
    for (const auto& wedge : mesh_.layers.wedges)  // of the only region
      for (const std::size_t node : wedge) box.extend(mesh_.nodes[node]);
    return box;
  }

  [[nodiscard]] std::vector<std::string> around_volume(std::size_t i) const {
    std::vector<std::string> around;
    for (std::size_t s = 0; s < topology_.surfaces.size(); ++s) {
      if (topology_.surfaces[s].region == i)
        around.push_back(std::to_string(s + 1));
      else if (topology_.surfaces[s].behind == i)
        around.push_back("-" + std::to_string(s + 1));
    }
    return around;
  }

  void write_nodes() {
    std::size_t blocks = 0;
    for (const auto& entities : members_) blocks += entities.size();
    text_ << "$Nodes\n" << blocks << ' ' << mesh_.nodes.size() << " 1 " << mesh_.nodes.size() << '\n';
    for (std::size_t d = 0; d < members_.size(); ++d)
      for (std::size_t i = 0; i < members_[d].size(); ++i)
        write_node_block(text_, mesh_, d, i + 1, members_[d][i]);
    text_ << "$EndNodes\n";
  }

  void open_block(std::size_t dimension, std::size_t entity, int type, std::size_t count) {
    text_ << dimension << ' ' << entity + 1 << ' ' << type << ' ' << count << '\n';
  }
  void write_element(const std::vector<std::size_t>& nodes) {
    text_ << ++number_;
    bounding_.add(nodes);
    for (const std::size_t node : nodes) text_ << ' ' << node + 1;
    text_ << '\n';
  }

  // Gmsh's types: 15 point, 1 and 8 lines, 2 and 9 triangles, 3 quadrangle.
  void write_elements() {
    const bool is_straight = mesh_.order == 1;
    const std::size_t wedges = mesh_.layers.wedges.size();
    std::size_t count = topology_.points.size() + mesh_.elements.size() + mesh_.cohesive_elements() + wedges;
    std::size_t blocks = topology_.points.size() + topology_.curves.size() + mesh_.regions.size() + layers() +
                         (wedges > 0 ? 1 : 0);
    for (const Curve& curve : topology_.curves) count += curve.edges.size();
    for (const Surface& surface : topology_.surfaces) {
      count += surface.sides.size();
      for (const std::size_t corners : {3U, 4U}) blocks += count_sides(surface, corners) > 0 ? 1 : 0;
    }
    text_ << "$Elements\n" << blocks << ' ' << count << " 1 " << count << '\n';
    for (std::size_t i = 0; i < topology_.points.size(); ++i) {
      open_block(0, i, 15, 1);
      write_element({topology_.points[i]});
    }
    for (std::size_t i = 0; i < topology_.curves.size(); ++i) {
      open_block(1, i, is_straight ? 1 : 8, topology_.curves[i].edges.size());
      for (const auto& edge : topology_.curves[i].edges) write_element(nodes_of(edge));
    }
    for (std::size_t i = 0; i < topology_.surfaces.size(); ++i) {
      const Surface& surface = topology_.surfaces[i];
      for (const std::size_t corners : {3U, 4U}) {
        const std::size_t sides = count_sides(surface, corners);
        if (sides == 0) continue;
        open_block(2, i, corners == 4 ? 3 : is_straight ? 2 : 9, sides);
        for (const auto& side : surface.sides)
          if (corners_of(side) == corners) write_element(nodes_of(side));
      }
    }
    write_volume_elements(text_, mesh_, number_);
    number_ += mesh_.elements.size();
    if (wedges > 0) open_block(3, 0, 6, wedges);
    for (const auto& wedge : mesh_.layers.wedges) write_element({wedge.begin(), wedge.end()});
    write_layers();
    text_ << "$EndElements\n";
  }

  // Prisms of six nodes.
  void write_layers() {
    for (std::size_t i = 0; i < layers(); ++i) {
      open_block(3, mesh_.regions.size() + i, 6, mesh_.interfaces[i].sides.size());
      for (const fem::FacingSides& facing : mesh_.interfaces[i].sides) {
        text_ << ++number_;
        for (const auto* side : {&facing.first.nodes, &facing.second.nodes})
          for (std::size_t k = 0; k < 3; ++k) text_ << ' ' << (*side)[k] + 1;
        text_ << '\n';
      }
    }
  }

  // All nodes of an entity, its borders too, each once.
  [[nodiscard]] std::vector<std::size_t> all_nodes(int dimension, std::size_t entity) const {
    std::vector<std::size_t> nodes;
    const auto add = [&](const std::vector<std::size_t>& more) {
      nodes.insert(nodes.end(), more.begin(), more.end());
    };
    if (dimension == 0) nodes.push_back(topology_.points[entity]);
    if (dimension == 1)
      for (const auto& edge : topology_.curves[entity].edges) add(nodes_of(edge));
    if (dimension == 2)
      for (const auto& side : topology_.surfaces[entity].sides) add(nodes_of(side));
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
  }

  void write_periodic() {
    if (copies_.empty()) return;
    text_ << "$Periodic\n" << copies_.size() << '\n';
    for (const Copy& copy : copies_) {
      Vec3 shift = Vec3::Zero();
      for (std::size_t k = 0; k < 3; ++k)
        if (copy.along[k]) shift += mesh_.cell->shape().edge(static_cast<int>(k));
      text_ << copy.dimension << ' ' << copy.entity + 1 << ' ' << copy.original + 1 << "\n16";
      for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) {
          const double last = row < 3 ? shift[row] : 1;
          text_ << ' ' << (column == 3 ? last : row == column ? 1.0 : 0.0);
        }
      const std::vector<std::size_t> nodes = all_nodes(copy.dimension, copy.entity);
      text_ << '\n' << nodes.size() << '\n';
      for (const std::size_t node : nodes) {
        std::size_t image = node;
        for (std::size_t k = 0; k < 3; ++k)
          if (copy.along[k]) image = opposite_[k][image];
        text_ << node + 1 << ' ' << image + 1 << '\n';
      }
    }
    text_ << "$EndPeriodic\n";
  }

  const fem::Mesh& mesh_;
  TextBuffer& text_;
  Topology topology_;
  std::array<std::vector<std::size_t>, 3> opposite_;
  std::vector<Copy> copies_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> middle_;  // midside nodes by the edge's ends
  std::vector<std::string> groups_;                                    // of surfaces
  std::vector<std::size_t> group_of_;                                  // from 1, of each surface
  std::array<std::vector<std::vector<std::size_t>>, 4> members_;       // nodes, by dimension and entity
  BoundingElements bounding_;
  std::size_t number_ = 0;  // of the last element
};

}  // namespace

Result<WriteFacts> write_cell(const fem::Mesh& mesh, OutputFile& output) {
  TextBuffer text(output);
  CellFile file(mesh, text);
  file.write();
  return finished(text, file.counts());
}

}  // namespace selvage::formats::msh
