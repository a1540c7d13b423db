#include "cell/sampling.h"

#include <algorithm>
#include <cmath>

#include "nurbs/divided.h"
#include "nurbs/samples.h"

namespace selvage::cell {
namespace {

// Chords stay within this share of the tolerance, round the section and along it.
constexpr double chord_share = 0.125;
// Sides are at most this share of the box's smallest size, and of the section's where it is larger.
constexpr double side_share = 0.25;
constexpr int fewest = 2, most = 4096;  // pieces of a span

// Does any part of the rows first..last of control points reach into the box?
bool may_enter(const nurbs::Surface& surface, int first, int last, const Box3& box) {
  Box3 hull;
  for (int j = first; j <= last; ++j)
    for (int i = 0; i < surface.count_u; ++i) hull.extend(surface.point(i, j));
  return box.intersects(hull);
}

}  // namespace

Sampling::Sampling(const yarn::Body& body, const Box3& box, double tolerance) : is_ring_(body.closed_along) {
  for (int face = 0; face < face_count; ++face) planes_[static_cast<std::size_t>(face)] = plane_of(box, face);
  choose_parameters(body, box, tolerance);
  points_ = nurbs::evaluate_grid(body.surface, us_, vs_);
  if (!is_ring_) find_end_faces(box, tolerance);
}

void Sampling::choose_parameters(const yarn::Body& body, const Box3& box, double tolerance) {
  const nurbs::Surface& surface = body.surface;
  const std::vector<double> ends_u = nurbs::breakpoints(surface.knots_u, surface.degree_u);
  const std::vector<double> ends_v = nurbs::breakpoints(surface.knots_v, surface.degree_v);
  const nurbs::Samples middles(surface, nurbs::divided(surface.knots_u, surface.degree_u, 2),
                               nurbs::divided(surface.knots_v, surface.degree_v, 2));
  const double wanted = chord_share * tolerance;
  const double longest = side_share * std::min(box.sizes().minCoeff(), yarn::widest_section(body));
  using Span = std::array<Vec3, 3>;
  const auto pieces = [&](bool along_v, std::size_t k) {
    const double rise = middles.largest<3>(along_v, 2 * k,
                                           [](const Span&p) { return (p[1] - (p[0] + p[2]) / 2).norm(); }),
                 length =
                     middles.largest<3>(along_v, 2 * k, [](const Span&p) { return (p[2] - p[0]).norm(); });
    return nurbs::whole_parts(std::max(length / longest, std::sqrt(rise / wanted)), fewest, most);
  };
  us_ = nurbs::divided(ends_u, [&](std::size_t k) { return pieces(false, k); });
  us_.pop_back();
  vs_ = nurbs::divided(ends_v, [&](std::size_t k) {
    // The last control row of a span is that of the last knot at its start.
    const auto knot = std::upper_bound(surface.knots_v.begin(), surface.knots_v.end(), ends_v[k]);
    const int last = std::clamp(static_cast<int>(knot - surface.knots_v.begin()) - 1, surface.degree_v,
                                surface.count_v - 1);
    return may_enter(surface, last - surface.degree_v, last, box) ? pieces(true, k) : 1;
  });
  if (is_ring_) vs_.pop_back();
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
