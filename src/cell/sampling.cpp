#include "cell/sampling.h"

#include <algorithm>
#include <cmath>

namespace selvage::cell {
namespace {

// Chords stay within this share of the tolerance, round the section and along it.
constexpr double chord_share = 0.125;
// Sides are at most this share of the box's smallest size, and of the section's where it is larger.
constexpr double side_share = 0.25;
constexpr double fewest = 2, most = 4096;  // pieces of a span

// The span's ends and middles.
std::vector<double> with_middles(const std::vector<double>& ends) {
  std::vector<double> all{ends.front()};
  for (std::size_t i = 1; i < ends.size(); ++i) {
    all.push_back((ends[i - 1] + ends[i]) / 2);
    all.push_back(ends[i]);
  }
  return all;
}

// Of a span of this length whose chord is this far from it.
int pieces_for(double length, double rise, double longest, double wanted) {
  return static_cast<int>(
      std::clamp(std::ceil(std::max(length / longest, std::sqrt(rise / wanted))), fewest, most));
}

void divide(std::vector<double>& values, double from, double to, int pieces) {
  for (int k = 0; k < pieces; ++k) values.push_back(from + (to - from) * k / pieces);
}

// Does any part of the rows first..last of control points reach into the box?
bool may_enter(const nurbs::Surface& surface, int first, int last, const Box3& box) {
  Box3 hull;
  for (int j = first; j <= last; ++j)
    for (int i = 0; i < surface.count_u; ++i) hull.extend(surface.point(i, j));
  return box.intersects(hull);
}

}  // namespace

Sampling::Sampling(const yarn::Body& body, const Box3& box, double tolerance) : is_ring_(body.closed_along) {
  period_u_ = body.surface.last_u() - body.surface.first_u();
  period_v_ = is_ring_ ? body.surface.last_v() - body.surface.first_v() : 0;
  for (int face = 0; face < face_count; ++face) planes_[static_cast<std::size_t>(face)] = plane_of(box, face);
  choose_parameters(body, box, tolerance);
  points_ = nurbs::evaluate_grid(body.surface, us_, vs_);
  if (!is_ring_) find_end_faces(box, tolerance);
}

void Sampling::choose_parameters(const yarn::Body& body, const Box3& box, double tolerance) {
  const nurbs::Surface& surface = body.surface;
  const std::vector<double> ends_u = nurbs::breakpoints(surface.knots_u, surface.degree_u);
  const std::vector<double> ends_v = nurbs::breakpoints(surface.knots_v, surface.degree_v);
  const std::vector<double> all_u = with_middles(ends_u), all_v = with_middles(ends_v);
  const std::vector<Vec3> points = nurbs::evaluate_grid(surface, all_u, all_v);
  const auto at = [&](std::size_t i, std::size_t j) -> const Vec3& { return points[j * all_u.size() + i]; };
  const double wanted = chord_share * tolerance;
  const double longest = side_share * std::min(box.sizes().minCoeff(), yarn::widest_section(body));
  for (std::size_t i = 0; i + 1 < ends_u.size(); ++i) {
    double rise = 0, length = 0;
    for (std::size_t j = 0; j < all_v.size(); ++j) {
      rise = std::max(rise, (at(2 * i + 1, j) - (at(2 * i, j) + at(2 * i + 2, j)) / 2).norm());
      length = std::max(length, (at(2 * i + 2, j) - at(2 * i, j)).norm());
    }
    divide(us_, ends_u[i], ends_u[i + 1], pieces_for(length, rise, longest, wanted));
  }
  for (std::size_t j = 0; j + 1 < ends_v.size(); ++j) {
    // The last control row of a span is that of the last knot at its start.
    const auto knot = std::upper_bound(surface.knots_v.begin(), surface.knots_v.end(), ends_v[j]);
    const int last = std::clamp(static_cast<int>(knot - surface.knots_v.begin()) - 1, surface.degree_v,
                                surface.count_v - 1);
    double rise = 0, length = 0;
    for (std::size_t i = 0; i < all_u.size(); ++i) {
      rise = std::max(rise, (at(i, 2 * j + 1) - (at(i, 2 * j) + at(i, 2 * j + 2)) / 2).norm());
      length = std::max(length, (at(i, 2 * j + 2) - at(i, 2 * j)).norm());
    }
    const bool near = may_enter(surface, last - surface.degree_v, last, box);
    divide(vs_, ends_v[j], ends_v[j + 1], near ? pieces_for(length, rise, longest, wanted) : 1);
  }
  if (!is_ring_) vs_.push_back(ends_v.back());
}

void Sampling::find_end_faces(const Box3& box, double tolerance) {
  const std::size_t rows = vs_.size(), columns = us_.size();
  const auto lies_in = [&](std::size_t row, int face) {
    for (std::size_t i = 0; i < columns; ++i)
      if (std::abs(points_[row * columns + i][axis_of(face)] - plane_of(box, face)) > tolerance) return false;
    return true;
  };
  for (std::size_t end = 0; end < 2; ++end) {
    std::size_t row = end == 0 ? 0 : rows - 1;
    for (int face = 0; face < face_count && end_faces_[end] < 0; ++face)
      if (lies_in(row, face)) end_faces_[end] = face;
    if (end_faces_[end] < 0) continue;
    // The rows next to it too, while they lie there.
    std::size_t count = 1;
    while (count + 1 < rows && lies_in(end == 0 ? count : rows - 1 - count, end_faces_[end])) ++count;
    level_rows_[end] = end == 0 ? std::array<std::size_t, 2>{0, count} : std::array{rows - count, rows};
  }
}

Vec2 Sampling::unwrapped(Vec2 parameters, const Vec2& near) const {
  parameters.x() += period_u_ * std::round((near.x() - parameters.x()) / period_u_);
  if (is_ring_) parameters.y() += period_v_ * std::round((near.y() - parameters.y()) / period_v_);
  return parameters;
}

std::array<Sampling::Vertex, 3> Sampling::triangle(std::size_t index) const {
  const std::size_t columns = us_.size(), cell = index / 2, i = cell % columns, j = cell / columns;
  const std::size_t next_i = (i + 1) % columns, next_j = (j + 1) % vs_.size();
  const auto a = static_cast<Vertex>(j * columns + i), b = static_cast<Vertex>(j * columns + next_i),
             c = static_cast<Vertex>(next_j * columns + next_i),
             d = static_cast<Vertex>(next_j * columns + i);
  if (index % 2 == 0) return {a, b, c};
  return {a, c, d};
}

int Sampling::own_border(Vertex a, Vertex b) const {
  const std::size_t row = a / us_.size();
  if (is_ring_ || row != b / us_.size()) return 0;
  if (row == 0) return Arc::own_start;
  return row + 1 == vs_.size() ? Arc::own_end : 0;
}

}  // namespace selvage::cell
