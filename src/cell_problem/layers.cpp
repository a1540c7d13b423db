#include "cell_problem/layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "cell_problem/complete_cell.h"
#include "fem/quality.h"
#include "fem/sides.h"

namespace selvage::fem {
namespace {

constexpr double growth = 1.2;
constexpr double default_share = 0.4;                        // of the mean edge of the wall round a node
constexpr double least_volume = 1.0 / 3, least_angle = 0.5;  // shares that a tetrahedron keeps
constexpr double most_growth = 1.5;                          // of the thickness along an edge
constexpr double shorter = 0.75;                             // where a tetrahedron would lose more
constexpr double least_slope = 0.5;  // cosine up to which a corner's layers keep their thickness

using Triangle = std::array<std::size_t, 3>;
using Edge = std::array<std::size_t, 2>;

class Layering {
 public:
  Layering(Mesh& mesh, const LayerOptions& options)
      : mesh_(mesh),
        options_(options),
        cell_(mesh.cell->shape()),
        opposite_(opposite_nodes(*mesh.cell, mesh.nodes.size())),
        lowest_(mesh.nodes.size()),
        direction_(mesh.nodes.size(), Vec3::Zero()),
        thickness_(mesh.nodes.size(), 0.0) {
    for (std::size_t node = 0; node < lowest_.size(); ++node) {
      std::size_t low = node;
      for (const auto& axis : opposite_)
        if (axis[low] != no_node) low = axis[low];
      lowest_[node] = low;
    }
    for (const Patch& patch : mesh.patches)
      if (patch.kind == Patch::Kind::wall)
        for (const Patch::Side& side : patch.sides) {
          const ElementSide nodes = side_nodes(mesh, side.element, side.side);
          walls_.push_back({nodes[0], nodes[1], nodes[2]});
          under_.push_back(side.element);
        }
  }

  Status run() {
    if (Status found = find_directions(); !found) return found;
    choose_thickness();
    shorten();
    move_nodes();
    add_nodes();
    add_wedges();
    renew_patches();
    return {};
  }

 private:
  [[nodiscard]] Vec3 inner_normal(const Triangle& t) const {
    return (mesh_.nodes[t[2]] - mesh_.nodes[t[0]]).cross(mesh_.nodes[t[1]] - mesh_.nodes[t[0]]);
  }

  // What is left of a direction for a node that stays in the faces in which it stands.
  [[nodiscard]] Vec3 within_faces(std::size_t node, const Vec3& direction) const {
    std::vector<int> axes;
    for (int axis = 0; axis < 3; ++axis)
      if (cell_.side_of(mesh_.nodes[node], axis) != 0) axes.push_back(axis);
    if (axes.empty()) return direction;
    if (axes.size() > 2) return Vec3::Zero();
    if (axes.size() == 2) {
      const Vec3 way = cell_.axes.unit(3 - axes[0] - axes[1]);
      return way * way.dot(direction);
    }
    const Vec3 normal = cell_.axes.normal(axes[0]);
    return direction - normal * normal.dot(direction);
  }

  // Inwards, so long that the walls at a node are left behind by 1, where that takes no more than 2.
  Status find_directions() {
    std::vector<Vec3> sum(mesh_.nodes.size(), Vec3::Zero());
    for (const Triangle& t : walls_)
      for (const std::size_t node : t) sum[lowest_[node]] += inner_normal(t);
    std::vector<double> slope(mesh_.nodes.size(), 1.0);
    for (const Triangle& t : walls_) {
      const Vec3 normal = inner_normal(t).normalized();
      for (const std::size_t node : t) {
        const Vec3 way = within_faces(node, sum[lowest_[node]].normalized());
        constexpr double least = 1e-2;  // of the way that is left
        if (!(way.norm() > least) || !sum[lowest_[node]].allFinite())
          return error(
              Kind::geometry,
              "a wall runs along an edge of the cell, or a face, or is folded: layers have no way to "
              "go there; another cell, or leave out --layers",
              {.at = mesh_.nodes[node]});
        direction_[node] = way.normalized();
        slope[lowest_[node]] = std::min(slope[lowest_[node]], normal.dot(direction_[node]));
      }
    }
    for (std::size_t node = 0; node < direction_.size(); ++node) {
      for (const auto& axis : opposite_)
        if (axis[node] != no_node && direction_[node].isZero() != direction_[axis[node]].isZero())
          return error(Kind::geometry,
                       "a wall touches a face of the cell from one side only: layers cannot repeat there; "
                       "another cell, or leave out --layers",
                       {.at = mesh_.nodes[node]});
      direction_[node] /= std::max(slope[lowest_[node]], least_slope);
    }
    return {};
  }

  // As asked, of all nodes that are one over the periodic faces the same.
  void choose_thickness() {
    std::vector<double> edges(mesh_.nodes.size(), 0.0), count(mesh_.nodes.size(), 0.0);
    for (const Triangle& t : walls_)
      for (std::size_t k = 0; k < 3; ++k)
        for (const std::size_t node : {t[k], t[(k + 1) % 3]}) {
          edges[lowest_[node]] += (mesh_.nodes[t[k]] - mesh_.nodes[t[(k + 1) % 3]]).norm();
          count[lowest_[node]] += 1;
        }
    for (const Triangle& t : walls_)
      for (const std::size_t node : t) {
        const std::size_t low = lowest_[node];
        thickness_[node] = thickness_[low] =
            options_.thickness > 0 ? options_.thickness : default_share * edges[low] / count[low];
      }
    asked_ = thickness_;
  }

  [[nodiscard]] Vec3 moved(std::size_t node) const {
    return mesh_.nodes[node] + thickness_[lowest_[node]] * direction_[node];
  }

  [[nodiscard]] std::array<Vec3, 4> moved_corners(std::size_t element) const {
    std::array<Vec3, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) corners[k] = moved(mesh_.elements[element][k]);
    return corners;
  }

  [[nodiscard]] static double six_volumes_of(const std::array<Vec3, 4>& p) {
    return (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]);
  }

  // Is a column of wedges sound, at all of its corners?
  [[nodiscard]] bool stands(const Triangle& t) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = t[k], b = t[(k + 2) % 3], c = t[(k + 1) % 3];
      const Vec3 rise = moved(a) - mesh_.nodes[a];
      const Vec3 low = (mesh_.nodes[b] - mesh_.nodes[a]).cross(mesh_.nodes[c] - mesh_.nodes[a]);
      const Vec3 high = (moved(b) - moved(a)).cross(moved(c) - moved(a));
      constexpr double least = 0.05;  // of a right prism
      if (low.dot(rise) <= least * low.norm() * rise.norm() ||
          high.dot(rise) <= least * high.norm() * rise.norm())
        return false;
    }
    return true;
  }

  // Until every tetrahedron and every column is as it should be.
  void shorten() {
    struct Kept {
      std::size_t element;
      double six_volumes, angle;
    };
    std::vector<Kept> beside;
    for (std::size_t e = 0; e < mesh_.elements.size(); ++e) {
      if (std::none_of(mesh_.elements[e].begin(), mesh_.elements[e].begin() + 4,
                       [&](std::size_t node) { return thickness_[lowest_[node]] > 0; }))
        continue;
      std::array<Vec3, 4> corners;
      for (std::size_t k = 0; k < 4; ++k) corners[k] = mesh_.nodes[mesh_.elements[e][k]];
      beside.push_back({e, six_volumes_of(corners), shape_of(corners).min_dihedral});
    }
    constexpr int most_rounds = 100;  // 0.75^100: nothing is left to shorten
    for (int round = 0; round < most_rounds; ++round) {
      std::vector<bool> is_short(mesh_.nodes.size(), false);
      bool any = false;
      const auto mark = [&](std::size_t node) { is_short[lowest_[node]] = any = true; };
      for (const Kept& kept : beside) {
        const std::array<Vec3, 4> corners = moved_corners(kept.element);
        if (six_volumes_of(corners) >= least_volume * kept.six_volumes &&
            shape_of(corners).min_dihedral >= least_angle * kept.angle)
          continue;
        for (std::size_t k = 0; k < 4; ++k) mark(mesh_.elements[kept.element][k]);
      }
      for (const Triangle& t : walls_)
        if (!stands(t)) std::for_each(t.begin(), t.end(), mark);
      if (!any) return;
      for (std::size_t node = 0; node < is_short.size(); ++node)
        if (is_short[node]) thickness_[node] *= shorter;
      grade();
    }
  }

  // No steps from one node of a wall to the next.
  void grade() {
    for (bool changed = true; changed;) {
      changed = false;
      for (const Triangle& t : walls_)
        for (std::size_t k = 0; k < 3; ++k) {
          double &a = thickness_[lowest_[t[k]]], &b = thickness_[lowest_[t[(k + 1) % 3]]];
          constexpr double slack = 1 + 1e-9;
          if (a > slack * most_growth * b || b > slack * most_growth * a) {
            (a > b ? a : b) = most_growth * std::min(a, b);
            changed = true;
          }
        }
    }
  }

  void move_nodes() {
    before_ = mesh_.nodes;
    std::size_t thinned = 0, all = 0;
    double sum = 0, sum_asked = 0;
    for (std::size_t node = 0; node < thickness_.size(); ++node) {
      if (direction_[node].isZero()) continue;
      thickness_[node] = thickness_[lowest_[node]];
      mesh_.nodes[node] = moved(node);
      ++all;
      sum += thickness_[node];
      sum_asked += asked_[lowest_[node]];
      thinned += thickness_[node] < 0.5 * asked_[lowest_[node]] ? 1 : 0;
    }
    const auto number = static_cast<double>(std::max<std::size_t>(all, 1));
    mesh_.layers = {.count = options_.count,
                    .wedges = {},
                    .under = {},
                    .asked = sum_asked / number,
                    .thickness = sum / number,
                    .thinned = static_cast<double>(thinned) / number};
  }

  // Those of each level from the wall on; the last one is the node that has moved.
  void add_nodes() {
    const auto levels = static_cast<std::size_t>(options_.count);
    first_new_.assign(before_.size(), no_node);
    for (std::size_t node = 0; node < before_.size(); ++node) {
      if (direction_[node].isZero()) continue;
      first_new_[node] = mesh_.nodes.size();
      const Vec3 rise = mesh_.nodes[node] - before_[node];
      for (std::size_t level = 0; level < levels; ++level)
        mesh_.nodes.push_back(before_[node] + (std::pow(growth, static_cast<double>(level)) - 1) /
                                                  (std::pow(growth, static_cast<double>(levels)) - 1) * rise);
    }
    for (auto& list : mesh_.cell->face_nodes) append_new(list);
    for (std::size_t edge = 0; edge < mesh_.cell->edge_nodes.size(); ++edge) {
      auto& list = mesh_.cell->edge_nodes[edge];
      append_new(list);
      const int axis = static_cast<int>(edge / 4);
      std::stable_sort(list.begin(), list.end(), [&](std::size_t a, std::size_t b) {
        return cell_.axes.own(mesh_.nodes[a])[axis] < cell_.axes.own(mesh_.nodes[b])[axis];
      });
    }
  }

  void append_new(std::vector<std::size_t>& list) const {
    const std::size_t count = list.size();
    for (std::size_t k = 0; k < count; ++k)
      if (first_new_[list[k]] != no_node)
        for (int level = 0; level < options_.count; ++level)
          list.push_back(first_new_[list[k]] + static_cast<std::size_t>(level));
  }

  [[nodiscard]] std::size_t at_level(std::size_t node, int level) const {
    return level == options_.count ? node : first_new_[node] + static_cast<std::size_t>(level);
  }

  void add_wedges() {
    for (const Triangle& t : walls_)
      for (int level = 0; level < options_.count; ++level)
        mesh_.layers.wedges.push_back({at_level(t[0], level), at_level(t[2], level), at_level(t[1], level),
                                       at_level(t[0], level + 1), at_level(t[2], level + 1),
                                       at_level(t[1], level + 1)});
    mesh_.layers.under = under_;
  }

  // Of a wall's triangle, and the side of its wedges over an edge of it.
  struct Border {
    std::size_t wall = 0, side = 0;
  };

  // The edges at which walls end, on the cell's faces.
  [[nodiscard]] std::map<Edge, Border> borders() const {
    std::map<Edge, Border> found;
    for (std::size_t w = 0; w < walls_.size(); ++w)
      for (std::size_t k = 0; k < 3; ++k) {
        // A wedge goes round the other way: 0 2 1 of the wall's nodes.
        constexpr std::array<std::size_t, 3> sides = {4, 3, 2};
        const auto [low, high] = std::minmax(walls_[w][k], walls_[w][(k + 1) % 3]);
        const auto [at, is_new] = found.try_emplace({low, high}, Border{w, sides[k]});
        if (!is_new) found.erase(at);
      }
    return found;
  }

  [[nodiscard]] bool is_on(const Edge& edge, int axis, int side) const {
    return std::all_of(edge.begin(), edge.end(),
                       [&](std::size_t node) { return cell_.side_of(before_[node], axis) == side; });
  }

  void renew_patches() {
    const auto levels = static_cast<std::size_t>(options_.count);
    const std::size_t first = mesh_.elements.size();
    std::size_t wall = 0;
    for (Patch& patch : mesh_.patches)
      if (patch.kind == Patch::Kind::wall)
        for (Patch::Side& side : patch.sides) side = {first + levels * wall++, 0};
    const std::map<Edge, Border> all = borders();
    for (Patch& patch : mesh_.patches) {
      if (patch.kind == Patch::Kind::wall) continue;
      const bool is_periodic = patch.kind == Patch::Kind::periodic;
      const bool is_high = patch.name.ends_with("_high") || patch.name.starts_with("outlet_");
      const int axis = (is_periodic ? patch.name.front() : patch.name.back()) - 'x';
      if (is_periodic && is_high) continue;  // with the low one
      for (const auto& [edge, border] : all) {
        if (!is_on(edge, axis, is_periodic ? 1 : is_high ? 1 : -1)) continue;
        Border low = border;
        if (is_periodic) {
          const auto& across = opposite_[static_cast<std::size_t>(axis)];
          const auto [a, b] = std::minmax(across[edge[0]], across[edge[1]]);
          low = all.at({a, b});
        }
        for (std::size_t level = 0; level < levels; ++level) {
          patch.sides.push_back({first + levels * low.wall + level, low.side});
          if (is_periodic)
            mesh_.patches[patch.opposite].sides.push_back(
                {first + levels * border.wall + level, border.side});
        }
      }
    }
  }

  Mesh& mesh_;
  const LayerOptions& options_;
  Parallelepiped cell_;
  std::array<std::vector<std::size_t>, 3> opposite_;
  std::vector<std::size_t> lowest_;  // of each node the one that stands for all that are opposite each other
  std::vector<Triangle> walls_;      // seen from outside of the tetrahedra
  std::vector<std::size_t> under_;   // these
  std::vector<Vec3> direction_;      // zero of nodes that stay
  std::vector<double> thickness_, asked_;  // by lowest_
  std::vector<Vec3> before_;
  std::vector<std::size_t> first_new_;  // of each node that has moved the first of its levels
};

}  // namespace

Status add_layers(Mesh& mesh, const LayerOptions& options) {
  return Layering(mesh, options).run();
}

}  // namespace selvage::fem
