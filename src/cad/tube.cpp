#include "cad/tube.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cad/natural_border.h"
#include "cad/sampled_curve.h"
#include "nurbs/turn.h"
#include "yarn/grid.h"

namespace selvage::cad {

namespace {

struct Line {
  double length = 0, area = 0;  // of the polygon; the area that it encloses
};

// A row (or column) of the control net.
Line line_of(const nurbs::Surface& surface, bool row, int index) {
  const int count = row ? surface.count_u : surface.count_v;
  const auto at = [&](int k) -> const Vec3& {
    return row ? surface.point(k, index) : surface.point(index, k);
  };
  Line line;
  Vec3 area = Vec3::Zero();
  for (int k = 1; k < count; ++k) {
    line.length += (at(k) - at(k - 1)).norm();
    area += 0.5 * (at(k - 1) - at(0)).cross(at(k) - at(0));
  }
  line.area = area.norm();
  return line;
}

bool is_continuous(const std::vector<double>& knots, int degree) {
  const auto p = static_cast<std::size_t>(degree);
  for (std::size_t i = 1; i + p + 1 < knots.size(); ++i)
    if (knots[i] == knots[i + p] && knots[i] > knots.front() && knots[i] < knots.back()) return false;
  return true;
}

bool has_equal_ends(const nurbs::Surface& surface, bool in_u, double tolerance) {
  const int count = in_u ? surface.count_v : surface.count_u;
  const int last = (in_u ? surface.count_u : surface.count_v) - 1;
  if (last < 3) return false;
  for (int k = 0; k < count; ++k) {
    const std::size_t a = in_u ? surface.index(0, k) : surface.index(k, 0);
    const std::size_t b = in_u ? surface.index(last, k) : surface.index(k, last);
    if ((surface.points[a] - surface.points[b]).norm() > tolerance) return false;
    if (surface.is_rational() &&
        std::abs(surface.weights[a] - surface.weights[b]) > 1e-9 * std::abs(surface.weights[a]))
      return false;
  }
  return true;
}

double largest_coordinate(const nurbs::Surface& surface) {
  double largest = 0;
  for (const Vec3& p : surface.points) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  return largest;
}

// The thinner end of a tube whose section is a row (or column); 0 where one encloses nothing.
double end_size(const nurbs::Surface& surface, bool row) {
  const Line first = line_of(surface, row, 0);
  const Line last = line_of(surface, row, (row ? surface.count_v : surface.count_u) - 1);
  const auto encloses = [](const Line& line) { return line.area > 1e-6 * line.length * line.length; };
  return encloses(first) && encloses(last) ? std::min(first.length, last.length) / std::numbers::pi : 0;
}

}  // namespace

std::optional<TubeKind> tube_kind(const Face& face, double resolution) {
  const nurbs::Surface& surface = face.surface;
  if (!is_continuous(surface.knots_u, surface.degree_u) || !is_continuous(surface.knots_v, surface.degree_v))
    return std::nullopt;
  // Almost every surface that is no tube is told by its first corners.
  const double rows = end_size(surface, true), columns = end_size(surface, false);
  const double largest = largest_coordinate(surface);
  const auto tolerance_for = [&](double size) { return closeness(size, largest, resolution); };
  const bool closed_u = rows > 0 && has_equal_ends(surface, true, tolerance_for(rows));
  const bool closed_v = columns > 0 && has_equal_ends(surface, false, tolerance_for(columns));
  if (!closed_u && !closed_v) return std::nullopt;
  TubeKind kind;
  kind.is_ring = closed_u && closed_v;
  kind.round_is_v = kind.is_ring ? columns < 0.5 * rows : closed_v;
  kind.size = kind.round_is_v ? columns : rows;
  kind.tolerance = tolerance_for(kind.size);
  return has_natural_border(face, kind.tolerance) ? std::optional(kind) : std::nullopt;
}

yarn::Body body_of(const nurbs::Surface& given, const TubeKind& kind) {
  yarn::Body body;
  nurbs::Surface& surface = body.surface;
  surface = kind.round_is_v ? nurbs::transposed(given) : given;
  const auto copy = [&](std::size_t from, std::size_t to) {
    surface.points[to] = surface.points[from];
    if (surface.is_rational()) surface.weights[to] = surface.weights[from];
  };
  for (int j = 0; j < surface.count_v; ++j) copy(surface.index(0, j), surface.index(surface.count_u - 1, j));
  if (kind.is_ring)
    for (int i = 0; i < surface.count_u; ++i)
      copy(surface.index(i, 0), surface.index(i, surface.count_v - 1));
  body.closed_along = kind.is_ring;
  body.axis = yarn::section_centres(surface);
  body.quarters = yarn::quarters_of(surface);
  return body;
}

}  // namespace selvage::cad
