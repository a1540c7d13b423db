#include "yarn/grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/index.h"
#include "nurbs/basis.h"
#include "nurbs/interpolate.h"
#include "yarn/rigid_fit.h"

namespace selvage::yarn {

namespace {

Message problem(std::string text) {
  return error(Kind::malformed, std::move(text));
}

// What every given knot vector has to obey.
Status check_knots(const std::vector<double>& knots, int count, int degree, std::string_view which) {
  if (static_cast<int>(knots.size()) != count + degree + 1)
    return problem(fmt::format("{} knots {}: {} control points of degree {} need {}", knots.size(), which,
                               count, degree, count + degree + 1));
  for (std::size_t i = 1; i < knots.size(); ++i)
    if (!(knots[i] >= knots[i - 1]))
      return problem(fmt::format("knots {} decrease: {} after {}", which, knots[i], knots[i - 1]));
  for (int end = 0; end < 2; ++end) {
    const std::size_t base = end == 0 ? 0 : at(count);
    if (knots[base] != knots[base + at(degree)])
      return problem(fmt::format("the {} {} knots {} have to be equal (a clamped B-spline)",
                                 end == 0 ? "first" : "last", degree + 1, which));
  }
  for (int i = 1; i < count; ++i)
    if (knots[at(i)] == knots[at(i + degree)] && knots[at(i)] > knots.front() && knots[at(i)] < knots.back())
      return problem(
          fmt::format("the knot {} {} is repeated more than {} times", knots[at(i)], which, degree));
  if (!(knots[at(count)] > knots[at(degree)])) return problem(fmt::format("all knots {} are equal", which));
  return {};
}

// A column of the net as a clamped curve along the yarn.
Result<nurbs::Curve> along_column(const std::vector<Vec3>& points, const std::vector<double>& weights,
                                  const GridNet& net, int degree) {
  if (net.closed_along && net.knots_along.empty())
    return nurbs::closed_uniform(points, weights, degree, [](int i) { return i; });
  if (net.closed_along && points.front() != points.back())
    return problem("a closed grid with its own knots has to end with its first section");
  return nurbs::Curve{
      degree, net.knots_along.empty() ? nurbs::clamped_integer_knots(net.sections, degree) : net.knots_along,
      points, weights};
}

// Row `number` of the net in clamped form.
Result<nurbs::Curve> round_row(const GridNet& net, std::size_t number, int degree) {
  const std::size_t n = at(net.per_section);
  const auto of_row = [&](const auto& all) {
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(number * n);
    return std::vector(first, first + net.per_section);
  };
  const std::vector<Vec3> points = of_row(net.points);
  const std::vector<double> weights = net.weights.empty() ? std::vector<double>() : of_row(net.weights);
  if (!net.open_round) {
    nurbs::Curve row = nurbs::closed_uniform(points, weights, degree,
                                             [step = 1.0 / net.per_section](int i) { return i * step; });
    // i / n has no rounding left in it that the standard form 1/n, 2/n, .., 1 has not.
    for (double& knot : row.knots) knot = std::round(knot * net.per_section) / net.per_section;
    return row;
  }
  if (points.front() != points.back() || (!weights.empty() && weights.front() != weights.back()))
    return problem(
        fmt::format("section {} is not closed: with `open round` its last control point has to be its first",
                    number + 1));
  nurbs::Curve row{degree, net.knots_round, points, weights};
  if (row.knots.empty()) {
    row.knots = nurbs::clamped_integer_knots(net.per_section, degree);
    for (double& knot : row.knots) knot /= net.per_section - degree;
  }
  return row;
}

Status check_counts(const GridNet& net, int degree_round, int degree_along) {
  const int distinct = net.open_round ? net.per_section - 1 : net.per_section;
  if (net.sections < 2) return problem("a grid needs at least two sections");
  if (net.closed_along && net.sections < 3) return problem("a closed grid needs at least three sections");
  if (distinct < 3) return problem("a section needs at least three different control points");
  if (degree_round < 1 || degree_round > nurbs::max_degree || degree_round > distinct)
    return problem(
        fmt::format("degree {} round does not go with {} control points", degree_round, net.per_section));
  const int most = net.closed_along ? net.sections : net.sections - 1;
  if (degree_along < 1 || degree_along > nurbs::max_degree || degree_along > most)
    return problem(fmt::format("degree {} along does not go with {} sections", degree_along, net.sections));
  if (!net.knots_round.empty() && !net.open_round)
    return problem("`knots round` go with `open round`: they belong to the clamped form of the section");
  return {};
}

}  // namespace

std::optional<std::array<double, 4>> find_quarters(const nurbs::Curve& outline) {
  const std::vector<double> breaks = nurbs::breakpoints(outline.knots, outline.degree);
  const std::size_t spans = breaks.size() - 1;
  if (spans < 4) return std::nullopt;
  // Turning and length up to each knot, by chords of the finely sampled outline.
  constexpr int samples = 8;
  std::vector<double> turning(breaks.size(), 0.0), length(breaks.size(), 0.0);
  Vec3 previous = Vec3::Zero(), last_step = Vec3::Zero();
  double angle = 0.0, run = 0.0;
  for (std::size_t k = 0; k < spans; ++k) {
    for (int i = k == 0 ? 0 : 1; i <= samples; ++i) {
      const Vec3 p = nurbs::evaluate(outline, breaks[k] + (breaks[k + 1] - breaks[k]) * i / samples);
      if (k == 0 && i == 0) {
        previous = p;
        continue;
      }
      const Vec3 step = p - previous;
      if (step.norm() > 0.0 && last_step.norm() > 0.0)
        angle += std::atan2(step.cross(last_step).norm(), step.dot(last_step));
      run += step.norm();
      if (step.norm() > 0.0) last_step = step;
      previous = p;
    }
    turning[k + 1] = angle;
    length[k + 1] = run;
  }
  std::array<double, 4> quarters{breaks[0], 0, 0, 0};
  std::size_t from = 1;
  for (std::size_t q = 1; q < 4; ++q) {
    std::size_t best = from;
    double best_cost = std::numeric_limits<double>::infinity();
    for (std::size_t k = from; k <= spans - (4 - q); ++k) {
      // Along a straight edge the turning stands still: its middle is the quarter.
      const double target = static_cast<double>(q) / 4.0;
      const double cost = std::abs(turning[k] / angle - target) + 0.05 * std::abs(length[k] / run - target);
      if (cost < best_cost - 1e-12) {
        best_cost = cost;
        best = k;
      }
    }
    quarters[q] = breaks[best];
    from = best + 1;
  }
  return quarters;
}

nurbs::Curve section_centres(const nurbs::Surface& surface) {
  // The mean of a curve over its parameter weighs each control point by the knots that it spans.
  std::vector<double> shares(at(surface.count_u));
  const double range = surface.last_u() - surface.first_u();
  for (std::size_t i = 0; i < shares.size(); ++i)
    shares[i] = (surface.knots_u[i + at(surface.degree_u) + 1] - surface.knots_u[i]) /
                ((surface.degree_u + 1) * range);
  nurbs::Curve centres;
  centres.degree = surface.degree_v;
  centres.knots = surface.knots_v;
  for (int j = 0; j < surface.count_v; ++j) {
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i < surface.count_u; ++i) centre += shares[at(i)] * surface.point(i, j);
    centres.points.push_back(centre);
  }
  return centres;
}

std::array<double, 4> quarters_of(const nurbs::Surface& surface) {
  if (const auto quarters = find_quarters(nurbs::boundary_row(surface, false))) return *quarters;
  // With fewer than four spans there is no place for a patch's corners at knots; sub_curve makes the knots it
  // needs.
  const double first = surface.first_u(), length = surface.last_u() - first;
  return {first, first + 0.25 * length, first + 0.5 * length, first + 0.75 * length};
}

namespace {

Status set_corners(Body& body, const GridNet& net) {
  if (!net.corners) return {};
  const std::array<double, 4>& corners = body.quarters = *net.corners;
  const double first = body.surface.first_u(), last = body.surface.last_u();
  if (first == corners[0] && first < corners[1] && corners[1] < corners[2] && corners[2] < corners[3] &&
      corners[3] < last)
    return {};
  return problem(
      fmt::format("the corners {}, {}, {}, {} have to begin with the first knot round, {}, and to increase "
                  "below the last, {}",
                  corners[0], corners[1], corners[2], corners[3], first, last));
}

}  // namespace

Status fill_from_grid(Body& body, const GridNet& net) {
  const int degree_round = net.degree_round.value_or(net.open_round ? std::min(2, net.per_section - 1) : 2);
  const int degree_along =
      net.degree_along.value_or(std::min(3, net.closed_along ? net.sections : net.sections - 1));
  Status counts = check_counts(net, degree_round, degree_along);
  if (!counts) return counts;

  // Round: each row in clamped form, and its centre.
  std::vector<nurbs::Curve> rows;
  std::vector<Vec3> centres;
  const std::size_t distinct = at(net.open_round ? net.per_section - 1 : net.per_section);
  for (std::size_t s = 0; s < at(net.sections); ++s) {
    Result<nurbs::Curve> row = round_row(net, s, degree_round);
    if (!row) return row.error();
    rows.push_back(std::move(*row));
    centres.push_back(mean_of(std::span(net.points).subspan(s * at(net.per_section), distinct)));
  }
  const std::vector<double>& knots_round = rows.front().knots;
  const std::size_t count_round = rows.front().points.size();
  if (Status s = check_knots(knots_round, static_cast<int>(count_round), degree_round, "round"); !s) return s;
  // Along: every column, and the centres as one more.
  if (!net.knots_along.empty())
    if (Status s = check_knots(net.knots_along, net.sections, degree_along, "along"); !s) return s;
  std::vector<nurbs::Curve> columns;
  for (std::size_t c = 0; c < count_round; ++c) {
    std::vector<Vec3> points;
    std::vector<double> weights;
    for (const nurbs::Curve& row : rows) {
      points.push_back(row.points[c]);
      if (row.is_rational()) weights.push_back(row.weights[c]);
    }
    Result<nurbs::Curve> column = along_column(points, weights, net, degree_along);
    if (!column) return column.error();
    columns.push_back(std::move(*column));
  }
  Result<nurbs::Curve> axis = along_column(centres, {}, net, degree_along);
  if (!axis) return axis.error();
  body.surface = nurbs::of_columns(degree_round, knots_round, columns);
  body.axis = std::move(*axis);
  body.closed_along = net.closed_along;
  body.quarters = quarters_of(body.surface);
  return set_corners(body, net);
}

}  // namespace selvage::yarn
