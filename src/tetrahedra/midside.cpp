#include "tetrahedra/midside.h"

#include <algorithm>
#include <cmath>

#include "core/bounds.h"
#include "fem/sides.h"
#include "surface_mesh/curved_edges.h"
#include "tetrahedra/block.h"

namespace selvage::fem {
namespace {

class CellEdges {
 public:
  CellEdges(const Mesh& mesh, const Block& block)
      : mesh_(mesh),
        block_(block),
        places_(block.skin.nodes.places),
        scale_(millimetres_per(block.units)),
        cell_(Box3(block.cell.box.min() * scale_, block.cell.box.max() * scale_), block.cell.axes),
        snug_(1e-9 * cell_.box.diagonal().norm()) {}

  // The edges of the yarns' surfaces, with their middles.
  [[nodiscard]] std::vector<CurvedEdge> curved() const;
  // Of the edges in faces that face each other over a periodic axis, those of the high one take the middle of
  // their opposite.
  [[nodiscard]] std::vector<TiedEdges> tie(std::vector<CurvedEdge>& edges) const;

 private:
  // The axis of the face of the box that both nodes are on; none: -1.
  [[nodiscard]] int face_axis(std::size_t a, std::size_t b) const;
  [[nodiscard]] bool is_on(std::size_t node, int axis, bool high) const {
    const double plane = high ? cell_.box.max()[axis] : cell_.box.min()[axis];
    return std::abs(cell_.axes.own(mesh_.nodes[node])[axis] - plane) <= snug_;
  }
  // In a face of the box, or (all on one yarn's surface) at the yarn's own end.
  [[nodiscard]] bool is_flat(const std::array<std::size_t, 3>& triangle) const;
  [[nodiscard]] std::optional<Vec3> middle(std::size_t a, std::size_t b) const;
  void tie_over(int axis, std::vector<CurvedEdge>& edges, std::vector<TiedEdges>& tied) const;

  const Mesh& mesh_;
  const Block& block_;
  const std::vector<SurfacePlace>& places_;
  double scale_;         // mm per file unit
  Parallelepiped cell_;  // mm
  double snug_;
};

int CellEdges::face_axis(std::size_t a, std::size_t b) const {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true})
      if (is_on(a, axis, high) && is_on(b, axis, high)) return axis;
  return -1;
}

std::optional<Vec3> CellEdges::middle(std::size_t a, std::size_t b) const {
  if (std::max(a, b) >= places_.size()) return std::nullopt;
  const SurfacePlace &from = places_[a], &to = places_[b];
  if (from.body == no_body || from.body != to.body) return std::nullopt;
  const yarn::Body& body = block_.bodies[from.body];
  const SurfaceEnd start{from.parameters, mesh_.nodes[a] / scale_},
      end{to.parameters, mesh_.nodes[b] / scale_};
  const int axis = face_axis(a, b);
  if (axis < 0) return middle_on_surface(body, start, end) * scale_;
  const std::optional<Vec3> result = middle_in_plane(body, start, end, cell_.axes.normal(axis));
  if (!result) return std::nullopt;
  return cell_.with(*result * scale_, axis,
                    is_on(a, axis, true) ? cell_.box.max()[axis] : cell_.box.min()[axis]);
}

bool CellEdges::is_flat(const std::array<std::size_t, 3>& t) const {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true})
      if (is_on(t[0], axis, high) && is_on(t[1], axis, high) && is_on(t[2], axis, high)) return true;
  // The yarn's own end: all three on the rim.
  const SurfacePlace& first = places_[t[0]];
  const yarn::Body& body = block_.bodies[first.body];
  if (body.closed_along) return false;
  for (const double end : {body.surface.first_v(), body.surface.last_v()}) {
    const double snug = 1e-9 * (body.surface.last_v() - body.surface.first_v());
    if (std::all_of(t.begin(), t.end(),
                    [&](std::size_t node) { return std::abs(places_[node].parameters.y() - end) <= snug; }))
      return true;
  }
  return false;
}

std::vector<CurvedEdge> CellEdges::curved() const {
  std::vector<std::uint64_t> keys;
  for (const OuterSide& side : outer_sides(mesh_)) {
    const std::array<std::size_t, 3> t = {side.nodes[0], side.nodes[1], side.nodes[2]};
    // Between a yarn and the rest, all of it on one yarn's surface.
    const std::size_t last = *std::max_element(t.begin(), t.end());
    if (last >= places_.size()) continue;
    const std::size_t body = places_[t[0]].body;
    if (body == no_body || places_[t[1]].body != body || places_[t[2]].body != body || is_flat(t)) continue;
    for (std::size_t k = 0; k < 3; ++k) keys.push_back(edge_key(t[k], t[(k + 1) % 3]));
  }
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  std::vector<CurvedEdge> result;
  for (const std::uint64_t key : keys) {
    const std::size_t a = key >> 32U, b = key & 0xffffffffU;
    const auto at = middle(a, b);
    if (!at) continue;
    const auto region = std::ranges::find(block_.of_regions, places_[a].body);
    const bool is_free = face_axis(a, b) < 0 && region != block_.of_regions.end();
    result.push_back(
        {key, *at,
         is_free ? static_cast<std::size_t>(region - block_.of_regions.begin()) : CurvedEdge::none});
  }
  const CellTriangles& surface = block_.skin.surface;
  for (const CellTriangles::Cap& cap : surface.caps)
    for (const Triangle& t : std::span(surface.triangles).subspan(cap.first, cap.count))
      for (std::size_t k = 0; k < 3 && !cap.shape.is_flat(); ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3];
        const Vec3 chord = (mesh_.nodes[a] + mesh_.nodes[b]) / (2 * scale_);
        result.push_back({edge_key(a, b), cap.shape.lift(cap.shape.project(chord)) * scale_});
      }
  sort_edges(result);  // a rim's middle is its side's, which stands first
  return result;
}

void CellEdges::tie_over(int axis, std::vector<CurvedEdge>& edges, std::vector<TiedEdges>& tied) const {
  const int across = (axis + 1) % 3, up = (axis + 2) % 3;
  struct Place {
    double across, up;
    std::size_t node;
    bool operator<(const Place& other) const {
      return across != other.across ? across < other.across : up < other.up;
    }
  };
  const double match = 1e-3 * snug_;  // rounding
  const auto own = [&](std::size_t node) { return cell_.axes.own(mesh_.nodes[node]); };
  // The nodes at the ends of curved edges in the low face.
  std::vector<Place> low;
  const auto is_in = [&](const CurvedEdge& edge, bool high) {
    return is_on(edge.key >> 32U, axis, high) && is_on(edge.key & 0xffffffffU, axis, high);
  };
  for (const CurvedEdge& edge : edges)
    if (is_in(edge, false))
      for (const std::size_t node : {edge.key >> 32U, edge.key & 0xffffffffU})
        low.push_back({own(node)[across], own(node)[up], node});
  std::sort(low.begin(), low.end());
  const auto opposite = [&](std::size_t node) -> std::optional<std::size_t> {
    const Vec3 wanted = own(node);
    auto at = std::lower_bound(low.begin(), low.end(), Place{wanted[across] - match, -infinity, 0});
    for (; at != low.end() && at->across <= wanted[across] + match; ++at)
      if (std::abs(at->up - wanted[up]) <= match) return at->node;
    return std::nullopt;
  };
  std::vector<std::uint64_t> paired;
  for (CurvedEdge& edge : edges) {
    if (!is_in(edge, true)) continue;
    const auto a = opposite(edge.key >> 32U), b = opposite(edge.key & 0xffffffffU);
    if (!a || !b) continue;
    const std::uint64_t key = edge_key(*a, *b);
    const auto other = std::lower_bound(edges.begin(), edges.end(), key,
                                        [](const CurvedEdge& e, std::uint64_t k) { return e.key < k; });
    if (other == edges.end() || other->key != key) continue;
    edge.middle = cell_.with(other->middle, axis, cell_.box.max()[axis]);
    tied.push_back({edge.key, key});
    paired.insert(paired.end(), {edge.key, key});
  }
  // One that has no curved opposite stays on its chord, as its opposite does.
  std::sort(paired.begin(), paired.end());
  std::erase_if(edges, [&](const CurvedEdge& edge) {
    return (is_in(edge, false) || is_in(edge, true)) &&
           !std::binary_search(paired.begin(), paired.end(), edge.key);
  });
}

std::vector<TiedEdges> CellEdges::tie(std::vector<CurvedEdge>& edges) const {
  std::vector<TiedEdges> tied;
  for (int axis = 0; axis < 3; ++axis)
    if (block_.periodic[static_cast<std::size_t>(axis)]) tie_over(axis, edges, tied);
  return tied;
}

}  // namespace

MidsideNodes add_midside_nodes(Mesh& mesh, const Block& block) {
  const CellEdges cell(mesh, block);
  std::vector<CurvedEdge> edges = cell.curved();
  const std::vector<TiedEdges> tied = cell.tie(edges);
  const double scale = millimetres_per(block.units);
  std::vector<double> volumes(mesh.regions.size(), 0);
  for (std::size_t r = 0; r < volumes.size(); ++r)
    if (block.of_regions[r] != CellTriangles::matrix)
      volumes[r] = scale * scale * scale * block.skin.volumes[block.of_regions[r]];
  return add_midside_nodes(mesh, edges, tied, volumes);
}

}  // namespace selvage::fem
