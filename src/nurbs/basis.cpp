#include "nurbs/basis.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace selvage::nurbs {

int find_span(const std::vector<double>& knots, int degree, int count, double t) {
  const auto first = knots.begin() + degree;
  const auto last = knots.begin() + count;
  if (t >= *last) {  // the last span that is not empty
    const auto found = std::lower_bound(first, last, *last);
    return static_cast<int>(found - knots.begin()) - 1;
  }
  const auto found = std::upper_bound(first, last, t);
  if (found == first) return degree;
  return static_cast<int>(found - knots.begin()) - 1;
}

namespace {

// Degree is an int, or a number that the compiler knows: most splines are quadratic or cubic.
template <int degree>
using Known = std::integral_constant<int, degree>;

// The basis of degree j on a span, whose first knot is *knot, in place of that of degree j - 1.
template <class Degree>
inline void raise_to(Degree j, const double* knot, double t, double* values) {
  double saved = 0.0;
  for (int r = 0; r < j; ++r) {
    const double left = t - knot[r + 1 - j], right = knot[r + 1] - t;
    const double part = values[r] / (right + left);
    values[r] = saved + right * part;
    saved = left * part;
  }
  values[j] = saved;
}

// Derivative of the degree-p basis from the values of the degree-(p-1) basis on the same span:
// N'_{i,p} = p (N_{i,p-1} / (u_{i+p} - u_i) - N_{i+1,p-1} / (u_{i+p+1} - u_{i+1})).
template <class Degree>
inline void raise_derivative_to(Degree degree, const double* knot, const double* lower, double* out) {
  double before = 0.0;
  for (int j = 0; j < degree; ++j) {
    const double after = lower[j] / (knot[j + 1] - knot[j + 1 - degree]);
    out[j] = degree * (before - after);
    before = after;
  }
  out[degree] = degree * before;
}

// With the derivatives of degree 2 and more from the basis of two degrees less.
template <class Before, class Last>
inline void differentiate(Before before, Last degree, const double* knot, double t,
                          std::array<BasisRow, 3>& rows) {
  raise_derivative_to(before, knot, rows[0].data(), rows[1].data());
  raise_derivative_to(degree, knot, rows[1].data(), rows[2].data());
  raise_to(before, knot, t, rows[0].data());
  raise_derivative_to(degree, knot, rows[0].data(), rows[1].data());
  raise_to(degree, knot, t, rows[0].data());
}

}  // namespace

void basis(const std::vector<double>& knots, int degree, int span, double t, BasisRow& values) {
  const double* const knot = knots.data() + span;
  values[0] = 1.0;
  if (degree <= 3) {
    if (degree > 0) raise_to(Known<1>(), knot, t, values.data());
    if (degree > 1) raise_to(Known<2>(), knot, t, values.data());
    if (degree > 2) raise_to(Known<3>(), knot, t, values.data());
    return;
  }
  for (int j = 1; j <= degree; ++j) raise_to(j, knot, t, values.data());
}

void basis_slopes(const std::vector<double>& knots, int degree, int span, double t, BasisRow& values,
                  BasisRow& slopes) {
  const double* const knot = knots.data() + span;
  basis(knots, std::max(degree - 1, 0), span, t, values);
  slopes[0] = 0.0;
  if (degree == 0) return;
  raise_derivative_to(degree, knot, values.data(), slopes.data());
  raise_to(degree, knot, t, values.data());
}

void basis_derivatives(const std::vector<double>& knots, int degree, int span, double t,
                       std::array<BasisRow, 3>& rows) {
  const double* const knot = knots.data() + span;
  if (degree >= 2) {
    basis(knots, degree - 2, span, t, rows[0]);
    if (degree == 3) return differentiate(Known<2>(), Known<3>(), knot, t, rows);
    if (degree == 2) return differentiate(Known<1>(), Known<2>(), knot, t, rows);
    return differentiate(degree - 1, degree, knot, t, rows);
  }
  std::fill_n(rows[1].begin(), degree + 1, 0.0);
  std::fill_n(rows[2].begin(), degree + 1, 0.0);
  basis(knots, 0, span, t, rows[0]);
  if (degree == 0) return;
  raise_derivative_to(Known<1>(), knot, rows[0].data(), rows[1].data());
  raise_to(Known<1>(), knot, t, rows[0].data());
}

void polar_form(const std::vector<double>& knots, int degree, int span, const double* arguments,
                BasisRow& factors) {
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  std::array<BasisRow, max_degree + 1> points;
  for (int i = 0; i <= degree; ++i)
    std::fill_n(points[at(i)].begin(), degree + 1, 0.0), points[at(i)][at(i)] = 1.0;
  for (int r = 1; r <= degree; ++r) {
    const double t = arguments[r - 1];
    for (int i = degree; i >= r; --i) {
      const double low = knots[at(span - degree + i)], high = knots[at(span + 1 + i - r)];
      const double share = (t - low) / (high - low);  // high > low: the span lies between them
      for (int c = i - r; c <= i; ++c)
        points[at(i)][at(c)] = (1.0 - share) * points[at(i - 1)][at(c)] + share * points[at(i)][at(c)];
    }
  }
  std::copy_n(points[at(degree)].begin(), degree + 1, factors.begin());
}

std::vector<double> greville(const std::vector<double>& knots, int degree, int count) {
  std::vector<double> sites(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    double sum = 0.0;
    for (int k = 1; k <= degree; ++k) sum += knots[static_cast<std::size_t>(i) + static_cast<std::size_t>(k)];
    sites[static_cast<std::size_t>(i)] = sum / degree;
  }
  return sites;
}

namespace {

GaussRule make_rule(int n) {
  GaussRule rule;
  for (int i = 0; i < n; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
    double slope = 1.0;
    for (int step = 0; step < 100; ++step) {  // Newton on the Legendre polynomial
      double p0 = 1.0, p1 = x;
      for (int k = 2; k <= n; ++k) {
        const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
        p0 = p1;
        p1 = p2;
      }
      slope = n * (x * p1 - p0) / (x * x - 1.0);
      const double move = p1 / slope;
      x -= move;
      if (std::abs(move) < 1e-16) break;
    }
    rule.nodes.push_back(x);
    rule.weights.push_back(2.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace

const GaussRule& gauss_rule(int n) {
  static const std::vector<GaussRule> rules = [] {
    std::vector<GaussRule> all;
    for (int i = 1; i <= 10; ++i) all.push_back(i == 1 ? GaussRule{{0.0}, {2.0}} : make_rule(i));
    return all;
  }();
  return rules[static_cast<std::size_t>(std::clamp(n, 1, 10) - 1)];
}

}  // namespace selvage::nurbs
