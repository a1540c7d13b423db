#include "formats/msh/topology.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "cell_problem/complete_cell.h"

namespace selvage::formats::msh {
namespace {

using Edge = std::array<std::size_t, 2>;  // lower node first

Edge edge_of(std::size_t a, std::size_t b) {
  return {std::min(a, b), std::max(a, b)};
}

std::size_t corners_of(const std::array<std::size_t, 4>& side) {
  return side[3] == side[2] ? 3 : 4;
}

// The region that each side of an interface faces, by its element and its number there.
std::map<std::array<std::size_t, 2>, std::size_t> facing_regions(const fem::Mesh& mesh) {
  std::map<std::array<std::size_t, 2>, std::size_t> facing;
  for (const fem::Interface& interface : mesh.interfaces)
    for (const fem::FacingSides& sides : interface.sides) {
      facing[{sides.first.element, sides.first.side}] = interface.second;
      facing[{sides.second.element, sides.second.side}] = interface.first;
    }
  return facing;
}

// A pore space has its surfaces already.
std::vector<Surface> patches_of(const fem::Mesh& mesh) {
  std::vector<Surface> surfaces;
  for (const fem::Patch& patch : mesh.patches) {
    Surface surface;
    surface.patch = surfaces.size();
    for (const fem::Patch::Side& side : patch.sides)
      surface.sides.push_back(fem::side_nodes(mesh, side.element, side.side));
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

std::vector<Surface> surfaces_of(const fem::Mesh& mesh) {
  if (!mesh.patches.empty()) return patches_of(mesh);
  const auto facing = facing_regions(mesh);
  std::map<std::tuple<int, std::size_t, std::size_t, std::size_t>, Surface> found;
  for (const fem::OuterSide& side : fem::outer_sides(mesh)) {
    if (side.behind < side.region) continue;  // the other one has it
    const auto other = facing.find({side.element, side.side});
    const std::size_t faces = other == facing.end() ? fem::OuterSide::outside : other->second;
    Surface& surface = found[{side.face, side.region, side.behind, faces}];
    surface.region = side.region;
    surface.behind = side.behind;
    surface.facing = faces;
    surface.face = side.face;
    surface.sides.push_back(side.nodes);
  }
  std::vector<Surface> surfaces;
  surfaces.reserve(found.size());
  for (auto& [key, surface] : found) surfaces.push_back(std::move(surface));
  return surfaces;
}

// The edges of the mesh where two surfaces or more meet, with these.
using Seams = std::map<Edge, std::vector<std::size_t>>;

Seams seams_of(const std::vector<Surface>& surfaces) {
  std::vector<std::pair<Edge, std::size_t>> uses;
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    for (const auto& side : surfaces[s].sides)
      for (std::size_t k = 0, n = corners_of(side); k < n; ++k)
        uses.emplace_back(edge_of(side[k], side[(k + 1) % n]), s);
  std::sort(uses.begin(), uses.end());
  uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
  Seams seams;
  for (std::size_t i = 0; i < uses.size();) {
    std::size_t j = i;
    while (j < uses.size() && uses[j].first == uses[i].first) ++j;
    if (j - i > 1)
      for (std::size_t k = i; k < j; ++k) seams[uses[i].first].push_back(uses[k].second);
    i = j;
  }
  return seams;
}

// Curves are chains of seams between the same surfaces. They end where others meet them; a closed one at its
// node with the smallest coordinates, which is the same node of its copies.
class Tracer {
 public:
  Tracer(const fem::Mesh& mesh, const Seams& seams) : mesh_(mesh), seams_(seams) {
    for (const auto& [edge, surfaces] : seams)
      for (const std::size_t node : edge) at_node_[node].push_back(edge);
    for (const auto& [node, edges] : at_node_)
      if (edges.size() != 2 || seams.at(edges[0]) != seams.at(edges[1])) add_point(node);
  }

  void trace(Topology& topology) {
    for (const std::size_t node : std::vector<std::size_t>(topology_.points))
      for (const Edge& edge : at_node_.at(node))
        if (!done_.contains(edge)) follow(node, edge);
    for (const auto& [edge, surfaces] : seams_)
      if (!done_.contains(edge)) follow_ring(edge);
    topology.points = std::move(topology_.points);
    topology.curves = std::move(topology_.curves);
    for (std::size_t c = 0; c < topology.curves.size(); ++c) {
      const Edge first = edge_of(topology.curves[c].edges[0][0], topology.curves[c].edges[0][1]);
      for (const std::size_t s : seams_.at(first)) topology.surfaces[s].curves.push_back(c);
    }
  }

 private:
  void add_point(std::size_t node) {
    point_[node] = topology_.points.size();
    topology_.points.push_back(node);
  }

  [[nodiscard]] std::vector<Edge> chain(std::size_t node, Edge edge) const {
    std::vector<Edge> walked;
    while (true) {
      const std::size_t next = edge[0] == node ? edge[1] : edge[0];
      walked.push_back({node, next});
      if (point_.contains(next)) return walked;
      const std::vector<Edge>& both = at_node_.at(next);
      edge = both[0] == edge ? both[1] : both[0];
      node = next;
      if (node == walked.front()[0]) return walked;
    }
  }

  void follow(std::size_t node, const Edge& edge) {
    Curve curve;
    curve.edges = chain(node, edge);
    for (const Edge& step : curve.edges) done_.insert(edge_of(step[0], step[1]));
    curve.first = point_.at(node);
    curve.last = point_.at(curve.edges.back()[1]);
    topology_.curves.push_back(std::move(curve));
  }

  void follow_ring(const Edge& edge) {
    const std::vector<Edge> ring = chain(edge[0], edge);
    const auto least = std::min_element(ring.begin(), ring.end(), [&](const Edge& a, const Edge& b) {
      const Vec3 &p = mesh_.nodes[a[0]], &q = mesh_.nodes[b[0]];
      return std::tuple(p.x(), p.y(), p.z()) < std::tuple(q.x(), q.y(), q.z());
    });
    add_point((*least)[0]);
    follow((*least)[0], edge_of((*least)[0], (*least)[1]));
  }

  const fem::Mesh& mesh_;
  const Seams& seams_;
  std::map<std::size_t, std::vector<Edge>> at_node_;
  std::map<std::size_t, std::size_t> point_;  // by node
  std::set<Edge> done_;
  Topology topology_;  // points and curves
};

// Where every node of an entity has its image, back along all edges of the cell on whose high side the whole
// entity is, which `along` tells. Empty: it is on no high side.
std::vector<std::size_t> images(const std::vector<std::size_t>& nodes,
                                const std::array<std::vector<std::size_t>, 3>& opposite,
                                std::array<bool, 3>& along) {
  std::vector<std::size_t> result = nodes;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto has_image = [&](std::size_t node) { return opposite[a][node] != fem::no_node; };
    if (!std::all_of(result.begin(), result.end(), has_image)) continue;
    for (std::size_t& node : result) node = opposite[a][node];
    along[a] = true;
  }
  return result == nodes ? std::vector<std::size_t>() : result;
}

// Entities by the sorted nodes of each of their parts (a point, an edge, a side).
using Parts = std::map<std::vector<std::size_t>, std::size_t>;

std::vector<std::size_t> sorted(std::vector<std::size_t> nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

std::vector<std::vector<std::size_t>> parts_of(const Topology& topology, int dimension, std::size_t entity) {
  std::vector<std::vector<std::size_t>> parts;
  if (dimension == 0) return {{topology.points[entity]}};
  if (dimension == 1)
    for (const auto& edge : topology.curves[entity].edges) parts.push_back({edge[0], edge[1]});
  else
    for (const auto& side : topology.surfaces[entity].sides)
      parts.emplace_back(side.begin(), side.begin() + static_cast<std::ptrdiff_t>(corners_of(side)));
  return parts;
}

}  // namespace

Topology topology_of(const fem::Mesh& mesh) {
  Topology topology;
  topology.surfaces = surfaces_of(mesh);
  const Seams seams = seams_of(topology.surfaces);
  Tracer(mesh, seams).trace(topology);
  return topology;
}

std::vector<Copy> copies_in(const Topology& topology,
                            const std::array<std::vector<std::size_t>, 3>& opposite) {
  std::vector<Copy> copies;
  const std::array<std::size_t, 3> counts = {topology.points.size(), topology.curves.size(),
                                             topology.surfaces.size()};
  for (int dimension = 0; dimension < 3; ++dimension) {
    const std::size_t count = counts[static_cast<std::size_t>(dimension)];
    Parts owners;
    for (std::size_t entity = 0; entity < count; ++entity)
      for (auto& part : parts_of(topology, dimension, entity)) owners[sorted(std::move(part))] = entity;
    for (std::size_t entity = 0; entity < count; ++entity) {
      const auto parts = parts_of(topology, dimension, entity);
      std::vector<std::size_t> all;
      for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
      Copy copy{dimension, entity, 0, {}};
      const std::vector<std::size_t> moved = images(all, opposite, copy.along);
      if (moved.empty()) continue;
      std::set<std::size_t> originals;
      for (std::size_t p = 0, at = 0; p < parts.size(); at += parts[p].size(), ++p) {
        const auto begin = moved.begin() + static_cast<std::ptrdiff_t>(at);
        const auto owner = owners.find(sorted({begin, begin + static_cast<std::ptrdiff_t>(parts[p].size())}));
        originals.insert(owner == owners.end() ? count : owner->second);
      }
      if (originals.size() != 1 || *originals.begin() == count) continue;
      copy.original = *originals.begin();
      if (parts_of(topology, dimension, copy.original).size() == parts.size()) copies.push_back(copy);
    }
  }
  return copies;
}

}  // namespace selvage::formats::msh
