#include "fem/hexahedron.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

namespace selvage::fem {
namespace {

// A corner and the ends of its edges, right-handed.
using Corner = std::array<std::size_t, 4>;
constexpr std::array<Corner, 8> hexahedron_corners = {{{0, 1, 3, 4},
                                                       {1, 2, 0, 5},
                                                       {2, 3, 1, 6},
                                                       {3, 0, 2, 7},
                                                       {4, 7, 5, 0},
                                                       {5, 4, 6, 1},
                                                       {6, 5, 7, 2},
                                                       {7, 6, 4, 3}}};
constexpr std::array<Corner, 6> wedge_corners = {
    {{0, 1, 2, 4}, {1, 2, 0, 5}, {2, 0, 1, 6}, {4, 6, 5, 0}, {5, 4, 6, 1}, {6, 5, 4, 2}}};

// Derivatives of the place by the three natural coordinates.
using Columns = std::array<Vec3, 3>;

// At a point of [-1, 1]^3.
Columns hexahedron_columns(const EightNodes& p, const Vec3& at) {
  constexpr std::array<std::array<int, 3>, 8> signs = {
      {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};
  Columns columns = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  for (std::size_t n = 0; n < 8; ++n) {
    Vec3 factor;
    for (int k = 0; k < 3; ++k) factor[k] = (1 + signs[n][static_cast<std::size_t>(k)] * at[k]) / 2;
    for (int k = 0; k < 3; ++k)
      columns[static_cast<std::size_t>(k)] +=
          p[n] * (signs[n][static_cast<std::size_t>(k)] / 2.0 * factor[(k + 1) % 3] * factor[(k + 2) % 3]);
  }
  return columns;
}

// At (r, s) of the triangle and t of [-1, 1].
Columns wedge_columns(const EightNodes& p, const Vec3& at) {
  const double low = (1 - at.z()) / 2, high = (1 + at.z()) / 2, first = 1 - at.x() - at.y();
  const auto between = [&](std::size_t n) -> Vec3 { return low * p[n] + high * p[n + 4]; };
  const auto up = [&](std::size_t n) -> Vec3 { return (p[n + 4] - p[n]) / 2; };
  return {between(1) - between(0), between(2) - between(0), first * up(0) + at.x() * up(1) + at.y() * up(2)};
}

double determinant(const Columns& c) {
  return c[0].cross(c[1]).dot(c[2]);
}

double scaled(const Columns& c) {
  const double lengths = c[0].norm() * c[1].norm() * c[2].norm();
  return lengths > 0 ? determinant(c) / lengths : 0;
}

const double gauss = 1 / std::sqrt(3.0);

std::vector<Vec3> gauss_points(bool is_wedge) {
  std::vector<Vec3> points;
  for (const double z : {-gauss, gauss}) {
    if (is_wedge)
      for (const Vec2& at : {Vec2(1. / 6, 1. / 6), Vec2(2. / 3, 1. / 6), Vec2(1. / 6, 2. / 3)})
        points.emplace_back(at.x(), at.y(), z);
    else
      for (const double y : {-gauss, gauss})
        for (const double x : {-gauss, gauss}) points.emplace_back(x, y, z);
  }
  return points;
}

// Between two sides along an edge, degrees.
double angle_about(const Vec3& edge, const Vec3& a, const Vec3& b) {
  const Vec3 first = edge.cross(a), second = edge.cross(b);
  return std::atan2(first.cross(second).norm(), first.dot(second)) * 180 / std::numbers::pi;
}

}  // namespace

ElementShape shape_of_hexahedron(const EightNodes& nodes, bool is_wedge) {
  static const std::array<std::vector<Vec3>, 2> points = {gauss_points(false), gauss_points(true)};
  const auto corners = is_wedge ? std::span<const Corner>(wedge_corners) : hexahedron_corners;
  ElementShape shape{.min_dihedral = 180, .max_dihedral = 0, .aspect = 0, .scaled_jacobian = 1};
  const double whole = is_wedge ? 2 * gauss : 1;  // of the regular one
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;
  for (const Corner& corner : corners) {
    Columns edges;
    for (std::size_t k = 0; k < 3; ++k) {
      edges[k] = nodes[corner[k + 1]] - nodes[corner[0]];
      shortest = std::min(shortest, edges[k].norm());
      longest = std::max(longest, edges[k].norm());
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle = angle_about(edges[k], edges[(k + 1) % 3], edges[(k + 2) % 3]);
      shape.min_dihedral = std::min(shape.min_dihedral, angle);
      shape.max_dihedral = std::max(shape.max_dihedral, angle);
    }
    shape.scaled_jacobian = std::min(shape.scaled_jacobian, scaled(edges) * whole);
  }
  for (const Vec3& at : points[is_wedge ? 1 : 0])
    shape.scaled_jacobian =
        std::min(shape.scaled_jacobian,
                 scaled(is_wedge ? wedge_columns(nodes, at) : hexahedron_columns(nodes, at)) * whole);
  shape.aspect = longest / shortest;
  return shape;
}

double volume_of_hexahedron(const EightNodes& nodes) {
  static const std::vector<Vec3> points = gauss_points(false);
  double volume = 0;
  for (const Vec3& at : points) volume += determinant(hexahedron_columns(nodes, at));
  return volume;
}

}  // namespace selvage::fem
