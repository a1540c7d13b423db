#include "yarn/path.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "nurbs/basis.h"
#include "nurbs/smooth.h"
#include "yarn/arcs.h"

namespace selvage::yarn {

namespace {

Message at_row(std::size_t row, std::string text) {
  return error(Kind::geometry, std::move(text)).placed({static_cast<int>(row) + 1, 0});
}

nurbs::Curve clamped_uniform(const std::vector<Vec3>& points) {
  nurbs::Curve curve;
  curve.points = points;
  const int count = static_cast<int>(points.size());
  curve.degree = std::min(3, count - 1);
  curve.knots = nurbs::clamped_integer_knots(count, curve.degree);
  for (double& knot : curve.knots) knot /= count - curve.degree;
  return curve;
}

// The periodic uniform cubic, cut open where the first control point has its influence's middle.
nurbs::Curve periodic_uniform(const std::vector<Vec3>& points) {
  const auto n = static_cast<double>(points.size());
  return nurbs::closed_uniform(points, {}, 3, [n](int i) { return i / n; });
}

CentreLine through_points(const PathRows& rows, nurbs::Parameterization how) {
  CentreLine line;
  line.parameters = nurbs::parameters(rows.points, how, rows.closed);
  if (rows.closed) {
    line.curve = nurbs::interpolate_closed(rows.points, line.parameters);
    line.parameters.pop_back();
  } else {
    const auto at_end = [&](bool last, const std::optional<EndTangent>& tangent) {
      if (tangent && tangent->is_derivative) return tangent->vector;
      return nurbs::end_derivative(rows.points, line.parameters, last,
                                   tangent ? std::optional(tangent->vector) : std::nullopt);
    };
    const Vec3 first = at_end(false, rows.tangent_start), last = at_end(true, rows.tangent_end);
    line.curve = nurbs::interpolate(rows.points, line.parameters, first, last);
  }
  return line;
}

// Over [0, 1], whatever the knots as given.
CentreLine with_knots(const PathRows& rows) {
  CentreLine line;
  line.curve = {3, rows.knots, rows.points, {}};
  const double first = rows.knots.front(), length = rows.knots.back() - first;
  for (double& knot : line.curve.knots) knot = (knot - first) / length;
  line.parameters = nurbs::greville(line.curve.knots, 3, static_cast<int>(rows.points.size()));
  if (rows.closed) line.curve.points.back() = line.curve.points.front();
  return line;
}

CentreLine from_control(const PathRows& rows) {
  if (!rows.knots.empty()) return with_knots(rows);
  CentreLine line;
  const std::size_t n = rows.points.size();
  line.curve = rows.closed ? periodic_uniform(rows.points) : clamped_uniform(rows.points);
  if (!rows.closed)
    line.parameters = nurbs::greville(line.curve.knots, line.curve.degree, static_cast<int>(n));
  for (std::size_t i = 0; rows.closed && i < n; ++i)
    line.parameters.push_back(static_cast<double>(i) / static_cast<double>(n));
  return line;
}

// Where the curve is nearest to a point between two parameters: Newton's method on the distance's derivative,
// kept inside by halving.
double nearest_between(const nurbs::Curve& curve, const Vec3& point, double low, double high) {
  const auto slope = [&](double t, double* change) {
    const nurbs::CurveJet jet = nurbs::evaluate_jet(curve, t);
    if (change != nullptr) *change = jet.d1.squaredNorm() + (jet.position - point).dot(jet.d2);
    return (jet.position - point).dot(jet.d1);
  };
  if (slope(low, nullptr) >= 0.0) return low;
  if (slope(high, nullptr) <= 0.0) return high;
  double t = 0.5 * (low + high);
  for (int i = 0; i < 60 && high - low > 1e-15; ++i) {
    double change = 0.0;
    const double here = slope(t, &change);
    (here < 0.0 ? low : high) = t;
    const double next = change > 0.0 ? t - here / change : low;
    const double previous = t;
    t = next > low && next < high ? next : 0.5 * (low + high);
    if (t == previous) break;
  }
  return t;
}

CentreLine from_loop(const PathRows& rows) {
  const std::vector<Vec3>& p = rows.points;
  const std::size_t n = p.size();
  PathRows as_control = rows;
  as_control.points = loop_control_points(p, rows.closed);
  CentreLine line = from_control(as_control);
  const std::size_t controls = as_control.points.size();
  // Two a row, but for the ends of an open path.
  const auto first_control = [&](std::size_t i) { return rows.closed || i == 0 ? 2 * i : 2 * i - 1; };
  // Between the control points of a row and those of its neighbours the curve passes by the row.
  std::vector<double> parameters;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = first_control(i), next = i + 1 < n ? first_control(i + 1) : controls;
    const double before = first > 0 ? line.parameters[first - 1] : 0.0,
                 after = next < controls ? line.parameters[next] : 1.0;
    const double low = 0.5 * (before + line.parameters[first]),
                 high = 0.5 * (line.parameters[next - 1] + after);
    const bool is_end = !rows.closed && (i == 0 || i + 1 == n);
    parameters.push_back(is_end ? line.parameters[first] : nearest_between(line.curve, p[i], low, high));
    line.largest_miss =
        std::max(line.largest_miss, (nurbs::evaluate(line.curve, parameters.back()) - p[i]).norm());
  }
  line.parameters = parameters;
  return line;
}

CentreLine from_smooth(const PathRows& rows) {
  std::optional<nurbs::Smoothed> smoothed = nurbs::smooth(rows.points, rows.error, rows.closed);
  if (!smoothed) return through_points(rows, nurbs::Parameterization::chord);
  CentreLine line;
  line.curve = std::move(smoothed->curve);
  line.parameters = std::move(smoothed->parameters);
  line.largest_miss = smoothed->farthest;
  return line;
}

Result<CentreLine> from_polyline(const PathRows& rows) {
  const std::vector<Vec3>& p = rows.points;
  const std::size_t n = p.size();
  struct Corner {
    double half_angle = 0, cut = 0;  // cut: from the corner to where its arc touches
  };
  std::vector<Corner> corners(n);
  const auto next = [&](std::size_t i) { return (i + 1) % n; };
  const auto before = [&](std::size_t i) { return (i + n - 1) % n; };
  for (std::size_t i = 0; i < n; ++i) {
    if (!rows.closed && (i == 0 || i + 1 == n)) continue;
    const Vec3 in = p[i] - p[before(i)], out = p[next(i)] - p[i];
    const double turning = std::atan2(in.cross(out).norm(), in.dot(out));
    if (turning < 1e-9) continue;
    if (turning > 150.0 / 180.0 * std::numbers::pi)
      return at_row(
          i, fmt::format("the polyline turns back by {:.0f} degrees at point {}: no arc rounds more than 150",
                         turning * 180.0 / std::numbers::pi, i + 1));
    corners[i].half_angle = 0.5 * turning;
    corners[i].cut = 1.05 * rows.half_sizes[i] * std::tan(0.5 * turning);
  }
  for (std::size_t i = 0; i + (rows.closed ? 0 : 1) < n; ++i) {
    const double room = (p[next(i)] - p[i]).norm(), wanted = corners[i].cut + corners[next(i)].cut;
    if (wanted > room * (1.0 + 1e-12))
      return at_row(
          i, fmt::format(
                 "the segment from point {} to point {} is {:.4g} long, but the arcs that round its corners "
                 "(1.05 times half the section) need {:.4g}",
                 i + 1, next(i) + 1, room, wanted));
  }
  const auto toward = [&](std::size_t from, std::size_t to, double distance) -> Vec3 {
    return p[from] + (p[to] - p[from]).normalized() * distance;
  };
  CentreLine line;
  line.parameters.assign(n, 0.0);
  // A closed one begins in the middle of its last segment's straight part, where nothing bends.
  const std::size_t last = n - 1;
  const Vec3 start =
      rows.closed ? Vec3(0.5 * (toward(last, 0, corners[last].cut) + toward(0, last, corners[0].cut))) : p[0];
  ArcsAndSegments path(start);
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_end = !rows.closed && (i == 0 || i == last);
    if (is_end || corners[i].cut == 0.0) {
      if (i > 0 || rows.closed) path.segment(p[i]);
      line.parameters[i] = path.now();
      continue;
    }
    const Vec3 touch = toward(i, before(i), corners[i].cut);
    if ((touch - p[before(i)]).norm() > corners[before(i)].cut * (1.0 + 1e-12)) path.segment(touch);
    const double entered = path.now();
    path.arc(p[i], toward(i, next(i), corners[i].cut), corners[i].half_angle);
    line.parameters[i] = 0.5 * (entered + path.now());
  }
  if (rows.closed) path.segment(start);
  const double total = path.now();
  line.curve = path.finish();
  for (double& t : line.parameters) t /= total;
  if (rows.closed) line.curve.points.back() = line.curve.points.front();
  return line;
}

Result<CentreLine> line_of(const PathRows& rows) {
  switch (rows.form) {
    case PathForm::uniform:
      return through_points(rows, nurbs::Parameterization::uniform);
    case PathForm::chord:
      return through_points(rows, nurbs::Parameterization::chord);
    case PathForm::centripetal:
      return through_points(rows, nurbs::Parameterization::centripetal);
    case PathForm::control:
      return from_control(rows);
    case PathForm::loop:
      return from_loop(rows);
    case PathForm::smooth:
      return from_smooth(rows);
    case PathForm::polyline:
      break;
  }
  return from_polyline(rows);
}

}  // namespace

std::vector<Vec3> loop_control_points(const std::vector<Vec3>& rows, bool closed) {
  const std::size_t n = rows.size();
  std::vector<Vec3> control;
  for (std::size_t i = 0; i < n; ++i) {
    if (!closed && (i == 0 || i + 1 == n)) {
      control.push_back(rows[i]);
      continue;
    }
    const Vec3& before = rows[(i + n - 1) % n];
    const Vec3& after = rows[(i + 1) % n];
    const Vec3 d = (after - before).normalized();
    control.emplace_back(rows[i] - d * ((rows[i] - before).norm() / 4.0));
    control.emplace_back(rows[i] + d * ((after - rows[i]).norm() / 4.0));
  }
  return control;
}

Result<CentreLine> make_centre_line(const PathRows& rows) {
  const std::size_t n = rows.points.size();
  if (n < 2) return at_row(0, "a path needs at least two points");
  if (rows.closed && n < 3) return at_row(0, "a closed path needs at least three points");
  for (std::size_t i = 0; rows.knots.empty() && i + (rows.closed ? 0 : 1) < n; ++i)
    if (rows.points[i] == rows.points[(i + 1) % n])
      return at_row((i + 1) % n,
                    fmt::format("points {} and {} of the path are equal", i + 1, (i + 1) % n + 1));
  Result<CentreLine> line = line_of(rows);
  if (line) line->closed = rows.closed;
  return line;
}

}  // namespace selvage::yarn
