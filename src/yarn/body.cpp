#include "yarn/body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/bounds.h"
#include "nurbs/samples.h"
#include "nurbs/turn.h"
#include "yarn/ends.h"

namespace selvage::yarn {

std::string_view name_of(Role role) {
  constexpr std::array<std::string_view, all_roles.size()> names = {"warp",    "weft",  "wale",   "course",
                                                                    "braider", "axial", "binder", "other"};
  return names[static_cast<std::size_t>(role)];
}

std::string_view name_of(EndStyle style) {
  constexpr std::array<std::string_view, 4> names = {"patch", "fan", "planar", "none"};
  return names[static_cast<std::size_t>(style)];
}

nurbs::Curve end_curve(const Body& body, bool last) {
  return nurbs::boundary_row(body.surface, last);
}

std::array<nurbs::Curve, 4> end_quarters(const Body& body, bool last) {
  const nurbs::Curve whole = end_curve(body, last);
  const std::array<double, 4>& q = body.quarters;
  return {nurbs::sub_curve(whole, q[0], q[1]), nurbs::sub_curve(whole, q[1], q[2]),
          nurbs::sub_curve(whole, q[2], q[3]), nurbs::sub_curve(whole, q[3], whole.last_parameter())};
}

namespace {

// The largest distance between corresponding points of two curves, each over its own domain.
double largest_distance(const nurbs::Curve& a, const nurbs::Curve& b) {
  const std::size_t steps = 4 * std::max(a.points.size(), b.points.size());
  double largest = 0.0;
  for (std::size_t k = 0; k <= steps; ++k) {
    const double s = static_cast<double>(k) / static_cast<double>(steps);
    const auto at = [&](const nurbs::Curve& c) {
      return nurbs::evaluate(c, c.first_parameter() + s * (c.last_parameter() - c.first_parameter()));
    };
    largest = std::max(largest, (at(a) - at(b)).norm());
  }
  return largest;
}

}  // namespace

double end_gap(const Body& body, bool last) {
  const EndFace& end = last ? body.end : body.start;
  if (end.style == EndStyle::fan)
    return largest_distance(nurbs::boundary_row(end.surface, false), end_curve(body, last));
  if (end.style == EndStyle::patch) {
    const std::array<nurbs::Curve, 4> sides = nurbs::boundary_round(end.surface),
                                      quarters = end_quarters(body, last);
    double gap = 0.0;
    for (std::size_t k = 0; k < 4; ++k) gap = std::max(gap, largest_distance(sides[k], quarters[k]));
    return gap;
  }
  return end.style == EndStyle::planar ? flatness(end_curve(body, last), end.origin, end.normal) : 0.0;
}

double widest_section(const Body& body) {
  double widest = 0.0;
  for (int j = 0; j < body.surface.count_v; ++j) {
    Box3 box;
    for (int i = 0; i < body.surface.count_u; ++i) box.extend(body.surface.point(i, j));
    widest = std::max(widest, box.diagonal().norm());
  }
  return widest;
}

double narrowest_section(const Body& body) {
  constexpr int sections = 17, directions = 36, round = 64;
  const nurbs::Surface& surface = body.surface;
  std::vector<double> us, vs;
  for (int i = 0; i < round; ++i)
    us.push_back(surface.first_u() + (surface.last_u() - surface.first_u()) * i / round);
  for (int j = 0; j < sections; ++j)
    vs.push_back(surface.first_v() + (surface.last_v() - surface.first_v()) * j / (sections - 1));
  const nurbs::Samples samples(surface, us, vs);
  std::vector<double> extents;
  for (std::size_t j = 0; j < sections; ++j) {
    const std::span<const Vec3> row = samples.row(j);
    // The section's own normal, from the area that it encloses; of an eight, which may enclose none, from the
    // largest part of it.
    Vec3 normal = Vec3::Zero(), largest_part = Vec3::Zero();
    for (std::size_t i = 0; i + 2 < row.size(); ++i) {
      const Vec3 part = (row[i + 1] - row[0]).cross(row[i + 2] - row[0]);
      normal += part;
      if (part.squaredNorm() > largest_part.squaredNorm()) largest_part = part;
    }
    if (normal.norm() < 1e-6 * largest_part.norm()) normal = largest_part;
    if (!(normal.norm() > 0.0)) continue;  // a point, or a line
    const Vec3 x = normal.unitOrthogonal(), y = normal.normalized().cross(x);
    double extent = std::numeric_limits<double>::infinity();
    for (int k = 0; k < directions; ++k) {
      const double angle = std::numbers::pi * k / directions;
      const Vec3 direction = std::cos(angle) * x + std::sin(angle) * y;
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const Vec3& point : row) {
        low = std::min(low, direction.dot(point));
        high = std::max(high, direction.dot(point));
      }
      extent = std::min(extent, high - low);
    }
    extents.push_back(extent);
  }
  const double largest = extents.empty() ? 0.0 : *std::max_element(extents.begin(), extents.end());
  if (const double widest = widest_section(body); !(largest > 1e-9 * widest)) return widest;
  double result = largest;
  for (const double extent : extents)
    if (extent >= largest / 10) result = std::min(result, extent);
  return result;
}

double narrowest_section(std::span<const Body> bodies) {
  double thinnest = std::numeric_limits<double>::infinity();
  for (const Body& body : bodies) thinnest = std::min(thinnest, narrowest_section(body));
  return thinnest;
}

Box3 bounds(const Body& body) {
  return bounds_of(body.surface.points);
}

std::vector<std::size_t> first_of_shape(std::span<const Body> bodies) {
  std::vector<std::size_t> first(bodies.size());
  std::unordered_map<std::uint64_t, std::size_t> known;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    first[i] = bodies[i].shape == 0 ? i : known.try_emplace(bodies[i].shape, i).first->second;
  return first;
}

}  // namespace selvage::yarn
