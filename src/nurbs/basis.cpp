#include "nurbs/basis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

void basis(const std::vector<double>& knots, int degree, int span, double t, BasisRow& values) {
  BasisRow left, right;  // only the first degree + 1 are used
  values[0] = 1.0;
  const auto knot = [&](int i) { return knots[static_cast<std::size_t>(i)]; };
  for (int j = 1; j <= degree; ++j) {
    const auto uj = static_cast<std::size_t>(j);
    left[uj] = t - knot(span + 1 - j);
    right[uj] = knot(span + j) - t;
    double saved = 0.0;
    for (int r = 0; r < j; ++r) {
      const auto ur = static_cast<std::size_t>(r);
      const double part = values[ur] / (right[ur + 1] + left[uj - ur]);
      values[ur] = saved + right[ur + 1] * part;
      saved = left[uj - ur] * part;
    }
    values[uj] = saved;
  }
}

namespace {

// Derivative of the degree-p basis from the values of the degree-(p-1) basis on the same span:
// N'_{i,p} = p (N_{i,p-1} / (u_{i+p} - u_i) - N_{i+1,p-1} / (u_{i+p+1} - u_{i+1})).
void raise_derivative(const std::vector<double>& knots, int degree, int span, const BasisRow& lower,
                      BasisRow& out) {
  const auto knot = [&](int i) { return knots[static_cast<std::size_t>(i)]; };
  for (int j = 0; j <= degree; ++j) {
    const int i = span - degree + j;  // the control point
    double value = 0.0;
    if (j > 0) value += lower[static_cast<std::size_t>(j - 1)] / (knot(i + degree) - knot(i));
    if (j < degree) value -= lower[static_cast<std::size_t>(j)] / (knot(i + degree + 1) - knot(i + 1));
    out[static_cast<std::size_t>(j)] = degree * value;
  }
}

}  // namespace

void basis_derivatives(const std::vector<double>& knots, int degree, int span, double t,
                       std::array<BasisRow, 3>& rows) {
  for (std::size_t k = 1; k < 3; ++k) std::fill_n(rows[k].begin(), degree + 1, 0.0);
  BasisRow lower;
  if (degree >= 2) {
    BasisRow lowest;
    basis(knots, degree - 2, span, t, lowest);
    BasisRow slope;
    raise_derivative(knots, degree - 1, span, lowest, slope);
    raise_derivative(knots, degree, span, slope, rows[2]);
  }
  if (degree >= 1) {
    basis(knots, degree - 1, span, t, lower);
    raise_derivative(knots, degree, span, lower, rows[1]);
  }
  basis(knots, degree, span, t, rows[0]);
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
