#include "cad/bernstein.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "cad/distance.h"
#include "nurbs/basis.h"

namespace selvage::cad {

namespace {

using Matrix = Eigen::MatrixXd;

constexpr int highest = 24;  // degree: beyond it the change of basis costs too many digits

// From the values at `nodes` in [0, 1] to the Bernstein coefficients of the polynomial through them.
struct Conversion {
  std::vector<double> nodes;
  Matrix to_coefficients;
};

Conversion make_conversion(int degree) {
  Conversion conversion;
  const int n = degree + 1;
  Matrix values(n, n);
  for (int k = 0; k < n; ++k) {
    // Inner points: a knot at the end of a range belongs to the next piece.
    const double x = 0.5 - 0.5 * std::cos(std::numbers::pi * (2 * k + 1) / (2 * n));
    conversion.nodes.push_back(x);
    for (int i = 0; i < n; ++i) {
      double value = 1;
      for (int j = 0; j < i; ++j) value *= x * (degree - j) / (j + 1);
      values(k, i) = value * std::pow(1 - x, degree - i);
    }
  }
  conversion.to_coefficients = values.fullPivLu().inverse();
  return conversion;
}

const Conversion& conversion(int degree) {
  static const std::vector<Conversion> all = [] {
    std::vector<Conversion> made;
    for (int degree_of = 0; degree_of <= highest; ++degree_of) made.push_back(make_conversion(degree_of));
    return made;
  }();
  return all[static_cast<std::size_t>(degree)];
}

std::vector<double> sites(const std::vector<double>& nodes, double from, double to) {
  std::vector<double> out;
  out.reserve(nodes.size());
  for (const double x : nodes) out.push_back(from + x * (to - from));
  return out;
}

// Values of basis functions at several parameters of one knot span.
struct Rows {
  int first = 0;
  std::vector<nurbs::BasisRow> values;
};

Rows rows_of(const std::vector<double>& knots, int degree, int count, double from, double to,
             const std::vector<double>& nodes) {
  Rows rows;
  const int span = nurbs::find_span(knots, degree, count, 0.5 * (from + to));
  rows.first = span - degree;
  rows.values.resize(nodes.size());
  const std::vector<double> all = sites(nodes, from, to);
  for (std::size_t k = 0; k < all.size(); ++k) nurbs::basis(knots, degree, span, all[k], rows.values[k]);
  return rows;
}

// x w, y w, z w and w of the surface at the nodes, the first direction in the rows.
using Values = std::array<Matrix, 4>;

Values values_of(const nurbs::Surface& surface, const Range& range, const std::vector<double>& nodes_u,
                 const std::vector<double>& nodes_v) {
  const Rows us = rows_of(surface.knots_u, surface.degree_u, surface.count_u, range.u0, range.u1, nodes_u);
  const Rows vs = rows_of(surface.knots_v, surface.degree_v, surface.count_v, range.v0, range.v1, nodes_v);
  const auto rows = static_cast<Eigen::Index>(nodes_u.size()),
             columns = static_cast<Eigen::Index>(nodes_v.size());
  Values values;
  values.fill(Matrix::Zero(rows, columns));
  const auto degree_u = static_cast<std::size_t>(surface.degree_u);
  const auto degree_v = static_cast<std::size_t>(surface.degree_v);
  for (std::size_t l = 0; l < nodes_v.size(); ++l) {
    for (std::size_t i = 0; i <= degree_u; ++i) {
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      for (std::size_t j = 0; j <= degree_v; ++j) {
        const int column = us.first + static_cast<int>(i), row = vs.first + static_cast<int>(j);
        const double weight = surface.weight(column, row);
        const double share = vs.values[l][j] * weight;
        sum.head<3>() += share * surface.point(column, row);
        sum[3] += share;
      }
      for (std::size_t k = 0; k < nodes_u.size(); ++k)
        for (std::size_t d = 0; d < 4; ++d)
          values[d](static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) +=
              us.values[k][i] * sum[static_cast<Eigen::Index>(d)];
    }
  }
  return values;
}

Matrix coefficients(const Matrix& values, const Conversion& rows, const Conversion& columns) {
  return rows.to_coefficients * values * columns.to_coefficients.transpose();
}

// Of the columns: twice the middle one of three neighbours less the others.
double largest_bend(const Matrix& net) {
  const Eigen::Index inner = net.rows() - 2;
  if (inner <= 0) return 0;
  return (net.topRows(inner) - 2 * net.middleRows(1, inner) + net.bottomRows(inner)).cwiseAbs().maxCoeff();
}

}  // namespace

bool BilinearMap::make_rectangle(double near) {
  auto& u = of[0];
  auto& v = of[1];
  for (const bool swaps : {false, true}) {
    double& main_u = swaps ? u[2] : u[1];
    double& side_u = swaps ? u[1] : u[2];
    double& main_v = swaps ? v[1] : v[2];
    double& side_v = swaps ? v[2] : v[1];
    if (main_u == 0 || main_v == 0) continue;
    if (std::abs(side_u) > near * std::abs(main_u) || std::abs(u[3]) > near * std::abs(main_u)) continue;
    if (std::abs(side_v) > near * std::abs(main_v) || std::abs(v[3]) > near * std::abs(main_v)) continue;
    // The middle line of the image stays where it is.
    u[0] += side_u / 2;
    v[0] += side_v / 2;
    main_u += u[3] / 2;
    main_v += v[3] / 2;
    side_u = side_v = u[3] = v[3] = 0;
    return true;
  }
  return false;
}

bool BilinearMap::is_swapped() const {
  return of[0][1] == 0;
}

std::array<double, 2> BilinearMap::line(bool of_u) const {
  const std::array<double, 4>& c = of[of_u ? 0 : 1];
  return {c[0], c[1] != 0 ? c[1] : c[2]};
}

Range BilinearMap::rectangle(double s0, double s1, double t0, double t1) const {
  const auto [u, slope_u] = line(true);
  const auto [v, slope_v] = line(false);
  if (is_swapped()) return {u + slope_u * t0, u + slope_u * t1, v + slope_v * s0, v + slope_v * s1};
  return {u + slope_u * s0, u + slope_u * s1, v + slope_v * t0, v + slope_v * t1};
}

Box3 piece_bounds(const nurbs::Surface& surface, const Range& range) {
  const Conversion& u = conversion(std::min(surface.degree_u, highest));
  const Conversion& v = conversion(std::min(surface.degree_v, highest));
  const Values values = values_of(surface, range, u.nodes, v.nodes);
  std::array<Matrix, 4> net;
  for (std::size_t d = 0; d < 4; ++d) net[d] = coefficients(values[d], u, v);
  Box3 box;
  if (!(net[3].minCoeff() > 0)) return box;
  for (Eigen::Index i = 0; i < net[3].size(); ++i) {
    const double w = surface.is_rational() ? net[3].data()[i] : 1.0;
    box.extend(Vec3(net[0].data()[i] / w, net[1].data()[i] / w, net[2].data()[i] / w));
  }
  return box;
}

PieceDifference piece_difference(const nurbs::Surface& a, const Range& range_a, const nurbs::Surface& b,
                                 const Range& range_b, bool swapped) {
  constexpr double unknown = std::numeric_limits<double>::infinity();
  const bool rational = a.is_rational() || b.is_rational();
  const int b_s = swapped ? b.degree_v : b.degree_u, b_t = swapped ? b.degree_u : b.degree_v;
  const int degree_s = rational ? a.degree_u + b_s : std::max(a.degree_u, b_s);
  const int degree_t = rational ? a.degree_v + b_t : std::max(a.degree_v, b_t);
  if (degree_s > highest || degree_t > highest) return {unknown, 0, 0};
  const Conversion& s = conversion(degree_s);
  const Conversion& t = conversion(degree_t);
  const Values va = values_of(a, range_a, s.nodes, t.nodes);
  Values vb = swapped ? values_of(b, range_b, t.nodes, s.nodes) : values_of(b, range_b, s.nodes, t.nodes);
  if (swapped)
    for (Matrix& m : vb) m.transposeInPlace();
  // a - b = (A w_b - B w_a) / (w_a w_b): the numerator's coefficients over the least of the denominator's.
  PieceDifference out;
  double squared = 0;
  std::array<Matrix, 3> numerator;
  for (std::size_t d = 0; d < 3; ++d) {
    const Matrix difference =
        rational ? Matrix(va[d].cwiseProduct(vb[3]) - vb[d].cwiseProduct(va[3])) : Matrix(va[d] - vb[d]);
    numerator[d] = coefficients(difference, s, t);
  }
  for (Eigen::Index i = 0; i < numerator[0].size(); ++i) {
    double sum = 0;
    for (const Matrix& part : numerator) sum += part.data()[i] * part.data()[i];
    squared = std::max(squared, sum);
  }
  for (const Matrix& part : numerator) {
    out.bend_s = std::max(out.bend_s, largest_bend(part));
    out.bend_t = std::max(out.bend_t, largest_bend(part.transpose()));
  }
  out.bound = std::sqrt(squared);
  if (!rational) return out;
  const double least = coefficients(va[3].cwiseProduct(vb[3]), s, t).minCoeff();
  out.bound = least > 0 ? out.bound / least : unknown;
  return out;
}

ImplicitBounds implicit_bounds(const nurbs::Surface& surface, const Range& range, const Implicit& function) {
  constexpr ImplicitBounds unknown = {std::numeric_limits<double>::infinity(), 0};
  const int order = function.degree(), slope_order = 2 * (order - 1);
  const int most = std::max(order, slope_order);
  if (most * std::max(surface.degree_u, surface.degree_v) > highest) return unknown;
  // The least (or largest) ratio of coefficients of two polynomials, the second one positive, bounds the
  // ratio of their values.
  const auto ratios = [&](int power, const auto& of_point) -> std::optional<std::array<double, 2>> {
    const Conversion& u = conversion(power * surface.degree_u);
    const Conversion& v = conversion(power * surface.degree_v);
    const Values values = values_of(surface, range, u.nodes, v.nodes);
    Matrix numerator(values[3].rows(), values[3].cols()), weights = numerator;
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      const double w = values[3].data()[i];
      weights.data()[i] = std::pow(w, power);
      const Vec3 p = Vec3(values[0].data()[i], values[1].data()[i], values[2].data()[i]) / w;
      numerator.data()[i] = of_point(p) * weights.data()[i];
    }
    const Matrix above = coefficients(numerator, u, v), below = coefficients(weights, u, v);
    if (!(below.minCoeff() > 0)) return std::nullopt;
    const Eigen::ArrayXXd ratio = above.array() / below.array();
    return std::array<double, 2>{ratio.minCoeff(), ratio.maxCoeff()};
  };
  const auto value = ratios(order, [&](const Vec3& p) { return function.value(p); });
  const auto slope = ratios(slope_order, [&](const Vec3& p) { return function.gradient(p).squaredNorm(); });
  if (!value || !slope) return unknown;
  return {std::max(std::abs((*value)[0]), std::abs((*value)[1])), std::sqrt(std::max(0.0, (*slope)[0]))};
}

}  // namespace selvage::cad
