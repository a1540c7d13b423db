#include "cell_problem/interfaces.h"

#include <algorithm>
#include <array>
#include <compare>
#include <map>
#include <utility>

#include "cell_problem/complete_cell.h"
#include "core/groups.h"
#include "fem/faces.h"
#include "fem/sides.h"

namespace selvage::fem {
namespace {

// A node as one region has it.
struct OfRegion {
  std::size_t node = 0, region = 0;
  auto operator<=>(const OfRegion&) const = default;
};

using Corners = std::array<std::size_t, 3>;

Corners sorted_corners(const ElementSide& side) {
  Corners corners = {side[0], side[1], side[2]};
  std::sort(corners.begin(), corners.end());
  return corners;
}

std::size_t side_nodes(const Mesh& mesh) {
  return mesh.order == 1 ? 3 : 6;
}

// Corners of an element's side, as they are given, and the midpoints of 01 12 20.
SixNodes nodes_of_side(const Mesh& mesh, std::size_t e, const ElementSide& corners) {
  const auto& element = mesh.elements[e];
  SixNodes nodes = {corners[0], corners[1], corners[2], 0, 0, 0};
  if (mesh.order == 1) return nodes;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t m = 0; m < edge_ends.size(); ++m) {
      const std::size_t a = element[edge_ends[m][0]], b = element[edge_ends[m][1]];
      const std::size_t from = nodes[k], to = nodes[(k + 1) % 3];
      if ((a == from && b == to) || (a == to && b == from)) nodes[3 + k] = element[4 + m];
    }
  return nodes;
}

class Doubling {
 public:
  Doubling(Mesh& mesh, std::vector<std::size_t>& lowest)
      : mesh_(mesh), lowest_(lowest), sides_(outer_sides(mesh)) {}

  void run() {
    find_copies();
    find_interfaces();
    const std::vector<std::array<std::size_t, 2>> ties = find_ties();
    renumber();
    tie(ties);
    renew_faces();
    renew_edges();
    renew_corners();
  }

 private:
  void find_copies();
  void find_interfaces();
  [[nodiscard]] std::vector<std::array<std::size_t, 2>> find_ties();
  void renumber();
  void tie(const std::vector<std::array<std::size_t, 2>>& ties);
  void renew_faces();
  void renew_edges();
  void renew_corners();

  // The number of a node in a region.
  [[nodiscard]] std::size_t number(std::size_t node, std::size_t region) const {
    if (more_at_[node].empty()) return node;
    const auto found = copy_.find({node, region});
    return found == copy_.end() ? node : found->second;
  }
  // All nodes at the place of an old one, by their regions.
  [[nodiscard]] std::vector<std::size_t> at_place_of(std::size_t node) const {
    std::vector<std::size_t> nodes = more_at_[node];
    nodes.insert(nodes.begin(), node);
    return nodes;
  }
  [[nodiscard]] std::vector<std::vector<std::size_t>> alike(const std::vector<std::size_t>& olds) const;

  Mesh& mesh_;
  std::vector<std::size_t>& lowest_;
  std::vector<OuterSide> sides_;
  std::map<OfRegion, std::size_t> copy_;           // those that are not the old node
  std::vector<std::vector<std::size_t>> more_at_;  // at the place of each old node, by their regions
};

// Every region that has a node of an interface gets its own.
void Doubling::find_copies() {
  std::vector<bool> meets(mesh_.nodes.size(), false);
  for (const OuterSide& side : sides_) {
    if (side.behind == OuterSide::outside) continue;
    const SixNodes nodes = nodes_of_side(mesh_, side.element, side.nodes);
    for (std::size_t k = 0; k < side_nodes(mesh_); ++k) meets[nodes[k]] = true;
  }
  std::vector<OfRegion> all;
  for (std::size_t r = 0; r < mesh_.regions.size(); ++r)
    for (std::size_t e = mesh_.regions[r].first_element; e < mesh_.regions[r].last_element; ++e)
      for (const std::size_t node : mesh_.nodes_of(e))
        if (meets[node]) all.push_back({node, r});
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  more_at_.resize(mesh_.nodes.size());
  std::size_t next = mesh_.nodes.size();
  for (std::size_t k = 1; k < all.size(); ++k) {
    if (all[k].node != all[k - 1].node) continue;
    copy_.emplace(all[k], next);
    more_at_[all[k].node].push_back(next++);
  }
}

// With the numbers that nodes get.
void Doubling::find_interfaces() {
  std::map<Corners, const OuterSide*> seen;
  std::map<std::array<std::size_t, 2>, std::vector<FacingSides>> found;
  for (const OuterSide& side : sides_) {
    if (side.behind == OuterSide::outside) continue;
    const auto [at, is_new] = seen.emplace(sorted_corners(side.nodes), &side);
    if (is_new) continue;
    const OuterSide& first = at->second->region < side.region ? *at->second : side;
    const OuterSide& second = &first == &side ? *at->second : side;
    FacingSides facing{{first.element, first.side, {}}, {second.element, second.side, {}}};
    const SixNodes nodes = nodes_of_side(mesh_, first.element, first.nodes);
    for (std::size_t k = 0; k < side_nodes(mesh_); ++k) {
      facing.first.nodes[k] = number(nodes[k], first.region);
      facing.second.nodes[k] = number(nodes[k], second.region);
    }
    found[{first.region, second.region}].push_back(facing);
  }
  mesh_.interfaces.clear();
  for (auto& [regions, sides] : found)
    mesh_.interfaces.push_back(
        {.first = regions[0], .second = regions[1], .law = 0, .sides = std::move(sides)});
}

// Nodes that move alike but for what the drivers make: those of sides of the faces that are opposite. The
// cell's sides get their new numbers.
std::vector<std::array<std::size_t, 2>> Doubling::find_ties() {
  std::map<Corners, const OuterSide*> of_corners;
  for (const OuterSide& side : sides_)
    if (side.behind == OuterSide::outside) of_corners.emplace(sorted_corners(side.nodes), &side);
  UnitCell& cell = *mesh_.cell;
  std::vector<std::array<std::size_t, 2>> ties;
  const auto six = [&](const ElementSide& corners, std::size_t& region) {
    const OuterSide& side = *of_corners.at(sorted_corners(corners));
    region = side.region;
    return nodes_of_side(mesh_, side.element, corners);
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto &high = cell.face_sides[2 * axis], &low = cell.face_sides[2 * axis + 1];
    for (std::size_t k = 0; k < high.size() && cell.periodic[axis]; ++k) {
      std::size_t up = 0, down = 0;
      const SixNodes above = six(high[k], up), below = six(low[k], down);
      for (std::size_t i = 0; i < side_nodes(mesh_); ++i)
        for (std::size_t j = 0; j < side_nodes(mesh_); ++j)
          if (lowest_[above[i]] == lowest_[below[j]])
            ties.push_back({number(above[i], up), number(below[j], down)});
    }
  }
  for (auto& face : cell.face_sides)
    for (auto& side : face) {
      const std::size_t region = of_corners.at(sorted_corners(side))->region;
      for (std::size_t& node : side) node = number(node, region);
    }
  return ties;
}

void Doubling::renumber() {
  std::vector<Vec3> more(copy_.size());
  for (const auto& [old, made] : copy_) more[made - mesh_.nodes.size()] = mesh_.nodes[old.node];
  mesh_.nodes.insert(mesh_.nodes.end(), more.begin(), more.end());
  const auto count = static_cast<std::size_t>(mesh_.nodes_per_element());
  for (std::size_t r = 0; r < mesh_.regions.size(); ++r) {
    Region& region = mesh_.regions[r];
    for (std::size_t e = region.first_element; e < region.last_element; ++e)
      for (std::size_t k = 0; k < count; ++k) mesh_.elements[e][k] = number(mesh_.elements[e][k], r);
    for (ElementSide& face : region.side_faces)
      for (std::size_t& node : face) node = number(node, r);
  }
}

// Of those that move alike all depend on the one that is on the fewest high sides.
void Doubling::tie(const std::vector<std::array<std::size_t, 2>>& ties) {
  Groups groups(mesh_.nodes.size());
  for (const auto& [a, b] : ties) groups.join(a, b);
  const Parallelepiped cell = mesh_.cell->shape();
  const auto high_sides = [&](std::size_t node) {
    int count = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (mesh_.cell->periodic[static_cast<std::size_t>(axis)] && cell.side_of(mesh_.nodes[node], axis) > 0)
        ++count;
    return count;
  };
  std::vector<std::size_t> of_group(mesh_.nodes.size(), no_node);
  for (std::size_t n = 0; n < mesh_.nodes.size(); ++n)
    if (std::size_t& best = of_group[groups.of(n)]; best == no_node || high_sides(n) < high_sides(best))
      best = n;
  lowest_.resize(mesh_.nodes.size());
  for (std::size_t n = 0; n < mesh_.nodes.size(); ++n) lowest_[n] = of_group[groups.of(n)];
}

// Of old nodes opposite each other, the first on no high side: the nodes there that move alike, one at the
// place of each.
std::vector<std::vector<std::size_t>> Doubling::alike(const std::vector<std::size_t>& olds) const {
  std::vector<std::vector<std::size_t>> rows, left;
  left.reserve(olds.size());
  for (const std::size_t old : olds) left.push_back(at_place_of(old));
  for (const std::size_t master : left.front()) {
    std::vector<std::size_t> row = {master};
    for (std::size_t k = 1; k < olds.size() && row.size() == k; ++k) {
      const auto other = std::find_if(left[k].begin(), left[k].end(),
                                      [&](std::size_t node) { return lowest_[node] == lowest_[master]; });
      if (other == left[k].end()) continue;
      row.push_back(*other);
      left[k].erase(other);
    }
    if (row.size() == olds.size()) rows.push_back(std::move(row));
  }
  return rows;
}

void Doubling::renew_faces() {
  UnitCell& cell = *mesh_.cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::array<std::vector<std::size_t>, 2> old = {cell.face_nodes[2 * axis + 1],
                                                         cell.face_nodes[2 * axis]};  // low, high
    auto &high = cell.face_nodes[2 * axis], &low = cell.face_nodes[2 * axis + 1];
    high.clear();
    low.clear();
    if (cell.periodic[axis]) {
      for (std::size_t k = 0; k < old[0].size(); ++k)
        for (const auto& row : alike({old[0][k], old[1][k]})) {
          low.push_back(row[0]);
          high.push_back(row[1]);
        }
      continue;
    }
    for (const std::size_t node : old[0])
      for (const auto& row : alike({node})) low.push_back(row[0]);
    for (const std::size_t node : old[1])
      for (const auto& row : alike({node})) high.push_back(row[0]);
  }
}

// The numbers below `count` that differ from `from` in bits of `free` alone, `from` first.
std::vector<std::size_t> family(std::size_t from, std::size_t free, std::size_t count) {
  std::vector<std::size_t> members;
  for (std::size_t k = 0; k < count; ++k)
    if ((k & ~free) == from) members.push_back(k);
  return members;
}

void Doubling::renew_edges() {
  UnitCell& cell = *mesh_.cell;
  const auto old = cell.edge_nodes;
  for (auto& nodes : cell.edge_nodes) nodes.clear();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::size_t free = 0;  // edges that differ in these bits are opposite each other
    for (std::size_t bit = 0; bit < 2; ++bit)
      if (cell.periodic[(axis + 1 + bit) % 3]) free |= std::size_t{1} << bit;
    for (std::size_t from = 0; from < 4; ++from) {
      if ((from & free) != 0) continue;
      const std::vector<std::size_t> edges = family(from, free, 4);
      for (std::size_t k = 0; k < old[4 * axis + from].size(); ++k) {
        std::vector<std::size_t> opposite;
        for (const std::size_t edge : edges) opposite.push_back(old[4 * axis + edge][k]);
        for (const auto& row : alike(opposite))
          for (std::size_t i = 0; i < edges.size(); ++i)
            cell.edge_nodes[4 * axis + edges[i]].push_back(row[i]);
      }
    }
  }
}

void Doubling::renew_corners() {
  UnitCell& cell = *mesh_.cell;
  std::size_t free = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (cell.periodic[axis]) free |= std::size_t{1} << axis;
  for (std::size_t from = 0; from < 8; ++from) {
    if ((from & free) != 0) continue;
    const std::vector<std::size_t> corners = family(from, free, 8);
    std::vector<std::size_t> opposite;
    for (const std::size_t corner : corners) opposite.push_back(cell.corners[corner]);
    const auto rows = alike(opposite);
    if (rows.empty())
      for (std::size_t i = 1; i < corners.size(); ++i) cell.corners[corners[i]] = no_node;
    for (std::size_t k = 0; k < rows.size(); ++k)
      for (std::size_t i = 0; i < corners.size(); ++i) {
        if (k == 0)
          cell.corners[corners[i]] = rows[k][i];
        else
          cell.more_corners[corners[i]].push_back(rows[k][i]);
      }
  }
}

}  // namespace

void double_nodes(Mesh& mesh, std::vector<std::size_t>& lowest) {
  Doubling(mesh, lowest).run();
}

}  // namespace selvage::fem
