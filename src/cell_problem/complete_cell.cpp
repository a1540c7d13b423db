#include "cell_problem/complete_cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cell_problem/interfaces.h"
#include "cell_problem/periodicity.h"
#include "fem/sides.h"

namespace selvage::fem {
namespace {

// Share of the box's size up to which a node beside a plane is taken for one that was meant to be in it, and
// up to which opposite nodes match.
constexpr double beside = 1e-9, match = 1e-12;

// Faces A..F: number 2 axis + (0 high, 1 low).
constexpr std::size_t face_number(int axis, bool high) {
  return 2 * static_cast<std::size_t>(axis) + (high ? 0 : 1);
}

// On which side of each axis a node is: -1 low, 1 high, 0 between.
using Sides = std::array<int, 3>;

Result<std::vector<Sides>> find_sides(const Mesh& mesh, const Parallelepiped& cell) {
  const Box3& box = cell.box;
  const double size = box.sizes().maxCoeff();
  std::vector<Sides> sides(mesh.nodes.size());
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    for (int axis = 0; axis < 3; ++axis) {
      int& side = sides[n][static_cast<std::size_t>(axis)];
      side = cell.side_of(mesh.nodes[n], axis);
      const double x = cell.axes.own(mesh.nodes[n])[axis], low = box.min()[axis], high = box.max()[axis];
      const double off = std::min(std::abs(x - low), std::abs(x - high));
      if (side == 0 && (off < beside * size || x < low || x > high))
        return error(Kind::internal,
                     fmt::format("a node of the mesh lies {:.1e} mm beside a face of the cell", off))
            .at_point(mesh.nodes[n]);
    }
  return sides;
}

// Puts each node into the set of its face, edge or corner.
void sort_into_sets(UnitCell& cell, const std::vector<Sides>& sides) {
  cell.corners.fill(no_node);
  for (std::size_t n = 0; n < sides.size(); ++n) {
    const Sides& side = sides[n];
    int between = 0, on = 0;  // the axis that it is between, or on, where there is one only
    int count = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (side[static_cast<std::size_t>(axis)] == 0) {
        between = axis;
      } else {
        on = axis;
        ++count;
      }
    const auto is_high = [&](int axis) -> std::size_t {
      return side[static_cast<std::size_t>(axis % 3)] > 0 ? 1 : 0;
    };
    if (count == 1) cell.face_nodes[face_number(on, is_high(on) > 0)].push_back(n);
    if (count == 2)
      cell.edge_nodes[4 * static_cast<std::size_t>(between) + is_high(between + 1) + 2 * is_high(between + 2)]
          .push_back(n);
    if (count == 3) cell.corners[is_high(0) + 2 * is_high(1) + 4 * is_high(2)] = n;
  }
}

// Of each node in the cell's own coordinates.
using Places = std::vector<Vec3>;

Places places_of(const Mesh& mesh, const ObliqueAxes& axes) {
  Places places;
  places.reserve(mesh.nodes.size());
  for (const Vec3& node : mesh.nodes) places.push_back(axes.own(node));
  return places;
}

// Nodes of a face or an edge by their coordinates along it.
void sort_by_place(const Places& places, std::vector<std::size_t>& nodes, int first_axis, int second_axis) {
  std::sort(nodes.begin(), nodes.end(), [&](std::size_t a, std::size_t b) {
    const Vec3 &p = places[a], &q = places[b];
    return std::make_pair(p[first_axis], p[second_axis]) < std::make_pair(q[first_axis], q[second_axis]);
  });
}

Message no_opposite(const Mesh& mesh, std::size_t node, int axis) {
  return error(Kind::geometry,
               fmt::format("a node on one face across {} has no node opposite on the other: these "
                           "faces have different meshes",
                           "xyz"[axis]))
      .at_point(mesh.nodes[node]);
}

// Brings `high` into the order of `low`: the k-th opposite the k-th over `axis`. Both are sorted by place;
// where rounding made their orders differ, each looks for its own.
Status pair_up(const Mesh& mesh, const Places& places, const std::vector<std::size_t>& low,
               std::vector<std::size_t>& high, int axis, double tolerance) {
  const int first = (axis + 1) % 3, second = (axis + 2) % 3;
  auto matches = [&](std::size_t a, std::size_t b) {
    const Vec3 &p = places[a], &q = places[b];
    return std::abs(p[first] - q[first]) <= tolerance && std::abs(p[second] - q[second]) <= tolerance;
  };
  if (low.size() != high.size())
    return error(Kind::geometry, fmt::format("{} nodes on the low face across {} have {} opposite: these "
                                             "faces have different meshes",
                                             low.size(), "xyz"[axis], high.size()));
  std::vector<std::size_t> ordered;
  std::vector<bool> taken(high.size(), false);
  for (std::size_t k = 0; k < low.size(); ++k) {
    const double wanted = places[low[k]][first];
    std::size_t found = high.size();
    if (!taken[k] && matches(low[k], high[k])) {
      found = k;
    } else {
      auto candidate = std::partition_point(
          high.begin(), high.end(), [&](std::size_t n) { return places[n][first] < wanted - tolerance; });
      for (; candidate != high.end() && places[*candidate][first] <= wanted + tolerance; ++candidate) {
        const auto i = static_cast<std::size_t>(candidate - high.begin());
        if (taken[i] || !matches(low[k], *candidate)) continue;
        found = i;
        break;
      }
    }
    if (found == high.size()) return no_opposite(mesh, low[k], axis);
    taken[found] = true;
    ordered.push_back(high[found]);
  }
  high = std::move(ordered);
  return {};
}

Status order_sets(const Mesh& mesh, UnitCell& cell, double size) {
  const Places places = places_of(mesh, cell.axes);
  for (int axis = 0; axis < 3; ++axis) {
    auto &high = cell.face_nodes[face_number(axis, true)], &low = cell.face_nodes[face_number(axis, false)];
    for (auto* face : {&low, &high}) sort_by_place(places, *face, (axis + 1) % 3, (axis + 2) % 3);
    for (std::size_t k = 0; k < 4; ++k)
      sort_by_place(places, cell.edge_nodes[4 * static_cast<std::size_t>(axis) + k], axis, (axis + 1) % 3);
    if (!cell.periodic[static_cast<std::size_t>(axis)]) continue;
    if (Status paired = pair_up(mesh, places, low, high, axis, match * size); !paired) return paired;
  }
  for (int axis = 0; axis < 3; ++axis)  // edges along it
    for (int bit = 0; bit < 2; ++bit) {
      const int across = (axis + 1 + bit) % 3;
      if (!cell.periodic[static_cast<std::size_t>(across)]) continue;
      for (std::size_t k = 0; k < 4; ++k) {
        if ((k >> bit & 1U) == 0) continue;
        auto* edges = &cell.edge_nodes[4 * static_cast<std::size_t>(axis)];
        if (Status paired =
                pair_up(mesh, places, edges[k & ~(std::size_t{1} << bit)], edges[k], across, match * size);
            !paired)
          return paired;
      }
    }
  for (std::size_t corner = 0; corner < 8; ++corner)
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (cell.periodic[axis] &&
          (cell.corners[corner] == no_node) != (cell.corners[corner ^ (std::size_t{1} << axis)] == no_node))
        return error(Kind::geometry, "opposite corners of the cell do not both have a node");
  return {};
}

void find_face_sides(const Mesh& mesh, UnitCell& cell, const std::vector<Sides>& sides) {
  const auto corners = element_sides(mesh.shape);
  for (const auto& element : mesh.elements)
    for (const auto& side : corners)
      for (int axis = 0; axis < 3; ++axis) {
        const int at = sides[element[side[0]]][static_cast<std::size_t>(axis)];
        if (at == 0 || !std::all_of(side.begin(), side.end(), [&](std::size_t k) {
              return sides[element[k]][static_cast<std::size_t>(axis)] == at;
            }))
          continue;
        cell.face_sides[face_number(axis, at > 0)].push_back(
            {element[side[0]], element[side[1]], element[side[2]], element[side[3]]});
      }
}

// The node opposite each node on a high side, over all periodic axes together: the lowest of its like.
std::vector<std::size_t> find_lowest(const Mesh& mesh, const UnitCell& cell) {
  std::vector<std::size_t> lowest(mesh.nodes.size());
  for (std::size_t n = 0; n < lowest.size(); ++n) lowest[n] = n;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!cell.periodic[axis]) continue;
    const auto &high = cell.face_nodes[2 * axis], &low = cell.face_nodes[2 * axis + 1];
    for (std::size_t k = 0; k < high.size(); ++k) lowest[high[k]] = low[k];
  }
  for (std::size_t edge = 0; edge < 12; ++edge) {
    std::size_t master = edge % 4;
    for (std::size_t bit = 0; bit < 2; ++bit)
      if (cell.periodic[(edge / 4 + 1 + bit) % 3]) master &= ~(std::size_t{1} << bit);
    const auto& from = cell.edge_nodes[edge / 4 * 4 + master];
    for (std::size_t k = 0; k < from.size(); ++k) lowest[cell.edge_nodes[edge][k]] = from[k];
  }
  for (std::size_t corner = 0; corner < 8; ++corner) {
    std::size_t master = corner;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (cell.periodic[axis]) master &= ~(std::size_t{1} << axis);
    if (cell.corners[corner] != no_node) lowest[cell.corners[corner]] = cell.corners[master];
  }
  return lowest;
}

// Sides of a high face into the order of those opposite: over this axis alone, for where a cell is one
// element thick, two sides may have nodes that are alike over the others.
Status pair_sides(const Mesh& mesh, UnitCell& cell) {
  using Side = std::array<std::size_t, 4>;
  const auto opposite = opposite_nodes(cell, mesh.nodes.size());
  auto key = [&](Side side, std::size_t axis) {
    for (std::size_t& node : side)
      if (opposite[axis][node] != no_node) node = opposite[axis][node];
    std::sort(side.begin(), side.end());
    return side;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!cell.periodic[axis]) continue;
    auto &high = cell.face_sides[2 * axis], &low = cell.face_sides[2 * axis + 1];
    std::vector<std::pair<Side, std::size_t>> of_low, of_high;
    auto list = [&](const std::vector<Side>& from, auto& to) {
      for (std::size_t k = 0; k < from.size(); ++k) to.emplace_back(key(from[k], axis), k);
      for (auto& [side, number] : to)  // a triangle's doubled corner may be any
        if (side[2] == side[3] || side[0] == side[1] || side[1] == side[2]) {
          std::size_t* last = std::unique(side.data(), side.data() + 4);
          std::fill(last, side.data() + 4, side[2]);
        }
      std::sort(to.begin(), to.end());
    };
    list(low, of_low);
    list(high, of_high);
    std::vector<Side> ordered(low.size());
    for (std::size_t k = 0; k < std::max(low.size(), high.size()); ++k) {
      if (k >= low.size() || k >= high.size() || of_low[k].first != of_high[k].first)
        return no_opposite(mesh, k < low.size() ? low[of_low[k].second][0] : high[of_high[k].second][0],
                           static_cast<int>(axis));
      ordered[of_low[k].second] = high[of_high[k].second];
    }
    high = std::move(ordered);
  }
  return {};
}

}  // namespace

std::array<std::vector<std::size_t>, 3> opposite_nodes(const UnitCell& cell, std::size_t nodes) {
  std::array<std::vector<std::size_t>, 3> opposite;
  for (std::size_t a = 0; a < 3; ++a) {
    opposite[a].assign(nodes, no_node);
    if (!cell.periodic[a]) continue;
    const auto pair = [&](const std::vector<std::size_t>& high, const std::vector<std::size_t>& low) {
      for (std::size_t k = 0; k < std::min(high.size(), low.size()); ++k) opposite[a][high[k]] = low[k];
    };
    pair(cell.face_nodes[2 * a], cell.face_nodes[2 * a + 1]);
    for (std::size_t edge = 0; edge < 12; ++edge) {
      if (edge / 4 == a) continue;
      const std::size_t bit = (edge / 4 + 1) % 3 == a ? 1 : 2;
      if ((edge % 4 & bit) != 0) pair(cell.edge_nodes[edge], cell.edge_nodes[edge - bit]);
    }
    const std::size_t bit = std::size_t{1} << a;
    for (std::size_t corner = 0; corner < 8; ++corner)
      if ((corner & bit) != 0 && cell.corners[corner] < nodes && cell.corners[corner - bit] < nodes)
        opposite[a][cell.corners[corner]] = cell.corners[corner - bit];
    for (std::size_t corner = 0; corner < 8; ++corner)
      if ((corner & bit) != 0) pair(cell.more_corners[corner], cell.more_corners[corner - bit]);
  }
  return opposite;
}

Status complete_cell(Mesh& mesh, const Parallelepiped& shape, std::array<bool, 3> periodic) {
  const Result<std::vector<Sides>> sides = find_sides(mesh, shape);
  if (!sides) return sides.error();
  UnitCell cell;
  cell.low = shape.box.min();
  cell.high = shape.box.max();
  cell.axes = shape.axes;
  cell.periodic = periodic;
  sort_into_sets(cell, *sides);
  if (Status ordered = order_sets(mesh, cell, shape.box.sizes().maxCoeff()); !ordered) return ordered;
  find_face_sides(mesh, cell, *sides);
  std::vector<std::size_t> lowest = find_lowest(mesh, cell);
  if (Status paired = pair_sides(mesh, cell); !paired) return paired;
  mesh.cell = std::move(cell);
  if (mesh.joining != Joining::bonded) double_nodes(mesh, lowest);
  return mesh.patches.empty() ? add_conditions(mesh, lowest) : Status();
}

}  // namespace selvage::fem
