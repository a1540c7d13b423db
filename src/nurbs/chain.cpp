#include "nurbs/chain.h"

#include <algorithm>
#include <cmath>

#include "nurbs/basis.h"
#include "nurbs/restrict.h"
#include "nurbs/turn.h"

namespace selvage::nurbs {

namespace {

// One span of the curve with nothing else of it: cheap to restrict.
Curve window(const Curve& curve, int span) {
  const auto first = static_cast<std::ptrdiff_t>(span) - curve.degree,
             order = std::ptrdiff_t{curve.degree} + 1;
  Curve part;
  part.degree = curve.degree;
  part.knots.assign(curve.knots.begin() + first, curve.knots.begin() + first + 2 * order);
  part.points.assign(curve.points.begin() + first, curve.points.begin() + first + order);
  if (curve.is_rational())
    part.weights.assign(curve.weights.begin() + first, curve.weights.begin() + first + order);
  return part;
}

// Of a Bezier piece, one degree at a time.
std::vector<Vec4> elevated(std::vector<Vec4> points, int degree) {
  while (static_cast<int>(points.size()) <= degree) {
    const auto n = static_cast<double>(points.size());
    std::vector<Vec4> higher(points.size() + 1);
    higher.front() = points.front();
    higher.back() = points.back();
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double share = static_cast<double>(i) / n;
      higher[i] = share * points[i - 1] + (1 - share) * points[i];
    }
    points = std::move(higher);
  }
  return points;
}

Curve clamped_form(const Curve& curve) {
  return is_clamped(curve.knots, curve.degree)
             ? curve
             : restricted(curve, curve.first_parameter(), curve.last_parameter());
}

void make_rational(Curve& curve) {
  if (!curve.is_rational()) curve.weights.assign(curve.points.size(), 1.0);
}

}  // namespace

Curve in_pieces(const Curve& curve, const std::vector<double>& breaks, int degree) {
  Curve out;
  out.degree = degree;
  out.knots.assign(1, breaks.front());
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    const int span = find_span(curve.knots, curve.degree, static_cast<int>(curve.points.size()),
                               (breaks[k] + breaks[k + 1]) / 2);
    const Curve piece = restricted(window(curve, span), breaks[k], breaks[k + 1]);
    std::vector<Vec4> points;
    for (std::size_t i = 0; i < piece.points.size(); ++i) points.push_back(homogeneous(piece, i));
    points = elevated(std::move(points), degree);
    for (std::size_t i = k == 0 ? 0 : 1; i < points.size(); ++i) {
      const bool plain = !curve.is_rational();
      out.points.push_back(plain ? Vec3(points[i].head<3>()) : Vec3(points[i].head<3>() / points[i].w()));
      if (!plain) out.weights.push_back(points[i].w());
    }
    out.knots.insert(out.knots.end(), static_cast<std::size_t>(degree), breaks[k]);
  }
  out.knots.insert(out.knots.end(), static_cast<std::size_t>(degree) + 1, breaks.back());
  // The ends are its own, to the bit.
  if (is_clamped(curve.knots, curve.degree) && breaks.front() == curve.first_parameter())
    out.points.front() = curve.points.front();
  if (is_clamped(curve.knots, curve.degree) && breaks.back() == curve.last_parameter())
    out.points.back() = curve.points.back();
  return out;
}

Curve with_range(const Curve& curve, double from, double to) {
  const double first = curve.first_parameter(), last = curve.last_parameter();
  Curve out = curve;
  for (double& knot : out.knots)
    knot = knot == first ? from : knot == last ? to : from + (knot - first) * ((to - from) / (last - first));
  for (std::size_t i = 1; i < out.knots.size(); ++i) out.knots[i] = std::max(out.knots[i], out.knots[i - 1]);
  return out;
}

double largest_gap(const std::vector<Curve>& curves) {
  double gap = 0;
  for (std::size_t i = 1; i < curves.size(); ++i)
    gap = std::max(gap, (evaluate(curves[i - 1], curves[i - 1].last_parameter()) -
                         evaluate(curves[i], curves[i].first_parameter()))
                            .norm());
  return gap;
}

Curve chained(const std::vector<Curve>& curves) {
  if (curves.size() == 1) return curves.front();
  int degree = 0;
  bool rational = false;
  for (const Curve& curve : curves) {
    degree = std::max(degree, curve.degree);
    rational = rational || curve.is_rational();
  }
  Curve out;
  for (const Curve& given : curves) {
    Curve next = given.degree < degree ? in_pieces(given, breakpoints(given.knots, given.degree), degree)
                                       : clamped_form(given);
    if (rational) make_rational(next);
    if (out.points.empty()) {
      out = std::move(next);
      continue;
    }
    const double start = out.knots.back();
    next = with_range(next, start, start + (next.knots.back() - next.knots.front()));
    if (rational) {  // projectively the same: the weights meet, too
      const double factor = out.weights.back() / next.weights.front();
      for (double& weight : next.weights) weight *= factor;
      out.weights.insert(out.weights.end(), next.weights.begin() + 1, next.weights.end());
    }
    out.points.insert(out.points.end(), next.points.begin() + 1, next.points.end());
    out.knots.pop_back();
    out.knots.insert(out.knots.end(), next.knots.begin() + degree + 1, next.knots.end());
  }
  return out;
}

void make_compatible(Curve& a, Curve& b) {
  a = with_range(clamped_form(a), 0, 1);
  b = with_range(clamped_form(b), 0, 1);
  if (a.is_rational() || b.is_rational()) make_rational(a), make_rational(b);
  constexpr double same = 1e-12;
  if (a.degree == b.degree && a.knots.size() == b.knots.size()) {
    double apart = 0;
    for (std::size_t i = 0; i < a.knots.size(); ++i)
      apart = std::max(apart, std::abs(a.knots[i] - b.knots[i]));
    if (apart <= same) {
      b.knots = a.knots;
      return;
    }
  }
  // Knots that differ by rounding alone are one; b takes a's.
  const std::vector<double> breaks_a = breakpoints(a.knots, a.degree);
  for (double& knot : b.knots) {
    const auto near = std::lower_bound(breaks_a.begin(), breaks_a.end(), knot - same);
    if (near != breaks_a.end() && std::abs(*near - knot) <= same) knot = *near;
  }
  const std::vector<double> breaks_b = breakpoints(b.knots, b.degree);
  std::vector<double> breaks;
  std::set_union(breaks_a.begin(), breaks_a.end(), breaks_b.begin(), breaks_b.end(),
                 std::back_inserter(breaks));
  const int degree = std::max(a.degree, b.degree);
  a = in_pieces(a, breaks, degree);
  b = in_pieces(b, breaks, degree);
}

Surface transposed(const Surface& surface) {
  Surface out;
  out.degree_u = surface.degree_v;
  out.degree_v = surface.degree_u;
  out.count_u = surface.count_v;
  out.count_v = surface.count_u;
  out.knots_u = surface.knots_v;
  out.knots_v = surface.knots_u;
  out.points.reserve(surface.points.size());
  for (int i = 0; i < surface.count_u; ++i)
    for (int j = 0; j < surface.count_v; ++j) {
      out.points.push_back(surface.point(i, j));
      if (surface.is_rational()) out.weights.push_back(surface.weight(i, j));
    }
  return out;
}

}  // namespace selvage::nurbs
