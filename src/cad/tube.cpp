#include "cad/tube.h"

#include <algorithm>

#include "nurbs/interpolate.h"

namespace selvage::cad {

namespace {

constexpr double equal_points = 1e-9;  // of the surface's size

bool is_clamped(const std::vector<double>& knots, int degree) {
  const auto order = static_cast<std::size_t>(degree) + 1;
  return knots.front() == knots[order - 1] && knots.back() == knots[knots.size() - order];
}

nurbs::Surface clamped_in_u(const nurbs::Surface& surface) {
  nurbs::Surface out = surface;
  out.points.clear();
  out.weights.clear();
  for (int j = 0; j < surface.count_v; ++j) {
    nurbs::Curve row;
    row.degree = surface.degree_u;
    row.knots = surface.knots_u;
    for (int i = 0; i < surface.count_u; ++i) {
      row.points.push_back(surface.point(i, j));
      if (surface.is_rational()) row.weights.push_back(surface.weight(i, j));
    }
    const nurbs::Curve fixed = nurbs::clamped(row);
    out.count_u = static_cast<int>(fixed.points.size());
    out.knots_u = fixed.knots;
    out.points.insert(out.points.end(), fixed.points.begin(), fixed.points.end());
    out.weights.insert(out.weights.end(), fixed.weights.begin(), fixed.weights.end());
  }
  return out;
}

bool columns_meet(const nurbs::Surface& surface, double tolerance) {
  const int last = surface.count_u - 1;
  for (int j = 0; j < surface.count_v; ++j) {
    const double weight = surface.weight(0, j), other = surface.weight(last, j);
    if ((surface.point(0, j) - surface.point(last, j)).norm() > tolerance ||
        std::abs(weight - other) > equal_points * std::abs(weight))
      return false;
  }
  return true;
}

bool rows_meet(const nurbs::Surface& surface, double tolerance) {
  const int last = surface.count_v - 1;
  for (int i = 0; i < surface.count_u; ++i) {
    const double weight = surface.weight(i, 0), other = surface.weight(i, last);
    if ((surface.point(i, 0) - surface.point(i, last)).norm() > tolerance ||
        std::abs(weight - other) > equal_points * std::abs(weight))
      return false;
  }
  return true;
}

void close_round(nurbs::Surface& surface) {
  const int last = surface.count_u - 1;
  for (int j = 0; j < surface.count_v; ++j) {
    surface.point(last, j) = surface.point(0, j);
    if (surface.is_rational()) surface.weights[surface.index(last, j)] = surface.weight(0, j);
  }
}

void close_along(nurbs::Surface& surface) {
  const int last = surface.count_v - 1;
  for (int i = 0; i < surface.count_u; ++i) {
    surface.point(i, last) = surface.point(i, 0);
    if (surface.is_rational()) surface.weights[surface.index(i, last)] = surface.weight(i, 0);
  }
}

// Closed or not, a row or column whose points are all one is a pole.
bool is_pole(const nurbs::Surface& surface, int row, double tolerance) {
  for (int i = 1; i < surface.count_u; ++i)
    if ((surface.point(i, row) - surface.point(0, row)).norm() > tolerance) return false;
  return true;
}

double mean_row_length(const nurbs::Surface& surface) {
  double sum = 0;
  for (int j = 0; j < surface.count_v; ++j)
    for (int i = 1; i < surface.count_u; ++i) sum += (surface.point(i, j) - surface.point(i - 1, j)).norm();
  return sum / surface.count_v;
}

}  // namespace

double extent(const std::vector<Vec3>& points) {
  Box3 box;
  for (const Vec3& p : points) box.extend(p);
  return points.empty() ? 0.0 : box.sizes().maxCoeff();
}

nurbs::Surface transposed(const nurbs::Surface& surface) {
  nurbs::Surface out;
  out.degree_u = surface.degree_v;
  out.degree_v = surface.degree_u;
  out.count_u = surface.count_v;
  out.count_v = surface.count_u;
  out.knots_u = surface.knots_v;
  out.knots_v = surface.knots_u;
  out.points.reserve(surface.points.size());
  out.weights.reserve(surface.weights.size());
  for (int i = 0; i < surface.count_u; ++i)
    for (int j = 0; j < surface.count_v; ++j) {
      out.points.push_back(surface.point(i, j));
      if (surface.is_rational()) out.weights.push_back(surface.weight(i, j));
    }
  return out;
}

nurbs::Surface reversed_u(const nurbs::Surface& surface) {
  nurbs::Surface out = surface;
  const double sum = surface.knots_u.front() + surface.knots_u.back();
  std::transform(surface.knots_u.rbegin(), surface.knots_u.rend(), out.knots_u.begin(),
                 [sum](double knot) { return sum - knot; });
  for (int j = 0; j < surface.count_v; ++j)
    for (int i = 0; i < surface.count_u; ++i) {
      out.point(i, j) = surface.point(surface.count_u - 1 - i, j);
      if (surface.is_rational()) out.weights[out.index(i, j)] = surface.weight(surface.count_u - 1 - i, j);
    }
  return out;
}

nurbs::Surface reversed_v(const nurbs::Surface& surface) {
  return transposed(reversed_u(transposed(surface)));
}

nurbs::Surface clamped(const nurbs::Surface& surface) {
  nurbs::Surface out = surface;
  if (!is_clamped(out.knots_u, out.degree_u)) out = clamped_in_u(out);
  if (!is_clamped(out.knots_v, out.degree_v)) out = transposed(clamped_in_u(transposed(out)));
  return out;
}

std::optional<Tube> as_tube(const nurbs::Surface& surface) {
  Tube tube;
  tube.surface = clamped(surface);
  const double tolerance = equal_points * extent(tube.surface.points);
  bool round = columns_meet(tube.surface, tolerance), along = rows_meet(tube.surface, tolerance);
  if (!round && !along) return std::nullopt;
  // A ring is longer along than round.
  const bool is_turned =
      !round || (along && mean_row_length(tube.surface) > mean_row_length(transposed(tube.surface)));
  if (is_turned) {
    tube.surface = transposed(tube.surface);
    std::swap(round, along);
  }
  if (is_pole(tube.surface, 0, tolerance) || is_pole(tube.surface, tube.surface.count_v - 1, tolerance))
    return std::nullopt;
  close_round(tube.surface);
  tube.closed_along = along;
  if (along) close_along(tube.surface);
  return tube;
}

std::optional<nurbs::Surface> as_fan(const nurbs::Surface& surface) {
  nurbs::Surface fan = clamped(surface);
  const double tolerance = equal_points * extent(fan.points);
  if (!columns_meet(fan, tolerance)) fan = transposed(fan);
  if (!columns_meet(fan, tolerance)) return std::nullopt;
  const bool first = is_pole(fan, 0, tolerance), last = is_pole(fan, fan.count_v - 1, tolerance);
  if (first == last) return std::nullopt;
  if (first) fan = reversed_v(fan);
  close_round(fan);
  return fan;
}

}  // namespace selvage::cad
