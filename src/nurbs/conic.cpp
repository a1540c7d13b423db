#include "nurbs/conic.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::nurbs {

namespace {

using std::numbers::pi;

constexpr double whole_turn_slack = 1e-9;

bool is_whole_turn(double from, double to) {
  return std::abs(to - from - 2 * pi) <= whole_turn_slack;
}

// Exact at the multiples of a quarter.
Vec2 direction(double angle) {
  const double quarters = angle / (pi / 2), nearest = std::round(quarters);
  if (std::abs(quarters - nearest) < 1e-15 * std::max(1.0, std::abs(quarters))) {
    const int k = ((static_cast<int>(std::fmod(nearest, 4.0)) % 4) + 4) % 4;
    return Vec2(k == 0 ? 1 : k == 2 ? -1 : 0, k == 1 ? 1 : k == 3 ? -1 : 0);
  }
  return {std::cos(angle), std::sin(angle)};
}

struct Conic {
  double a, b, c, d, e, f;

  [[nodiscard]] double value(const Vec2& p) const {
    return a * p.x() * p.x() + b * p.x() * p.y() + c * p.y() * p.y() + d * p.x() + e * p.y() + f;
  }
  [[nodiscard]] Vec2 gradient(const Vec2& p) const {
    return {2 * a * p.x() + b * p.y() + d, b * p.x() + 2 * c * p.y() + e};
  }
  // To first order.
  [[nodiscard]] double distance(const Vec2& p) const {
    const double slope = gradient(p).norm();
    return slope > 0 ? std::abs(value(p)) / slope : std::abs(value(p));
  }
};

Vec3 lifted(const Vec2& p, double z) {
  return {p.x(), p.y(), z};
}

ConicKind kind_of(const Conic& conic) {
  const double square = conic.b * conic.b, product = 4 * conic.a * conic.c;
  const double scale = square + std::abs(product) + 1e-3 * (conic.a * conic.a + conic.c * conic.c);
  if (std::abs(square - product) <= 1e-9 * scale) return ConicKind::parabola;
  return square < product ? ConicKind::ellipse : ConicKind::hyperbola;
}

ConicArc parabola(const Conic& conic, double z, const Vec2& from, const Vec2& to) {
  // Where the tangents at both ends meet.
  const Vec2 g = conic.gradient(from), h = conic.gradient(to);
  Eigen::Matrix2d tangents;
  tangents << g.x(), g.y(), h.x(), h.y();
  if (!(std::abs(tangents.determinant()) > 1e-12 * g.norm() * h.norm()))
    return {std::nullopt, "the parabola's ends coincide, or it is none"};
  const Vec2 tip = tangents.inverse() * Vec2(g.dot(from), h.dot(to));
  return {parabolic_arc(lifted(from, z), lifted(tip, z), lifted(to, z)), ""};
}

ConicArc central(const Conic& conic, ConicKind kind, double z, const Vec2& from, const Vec2& to) {
  Eigen::Matrix2d form;
  form << conic.a, conic.b / 2, conic.b / 2, conic.c;
  const Vec2 center = form.inverse() * Vec2(-conic.d / 2, -conic.e / 2);
  const double rest = -conic.value(center);  // lambda_x x^2 + lambda_y y^2 = rest about the centre
  Eigen::Matrix2d axes = Eigen::Matrix2d::Identity();
  Vec2 lambda(conic.a, conic.c);
  if (conic.b != 0) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(form);
    axes = solver.eigenvectors();
    lambda = solver.eigenvalues();
  }
  Vec2 squares(rest / lambda.x(), rest / lambda.y());
  if (kind == ConicKind::hyperbola && squares.x() < 0) {
    std::swap(squares.x(), squares.y());
    axes.col(0).swap(axes.col(1));
  }
  if (!std::isfinite(squares.x()) || !std::isfinite(squares.y()) || !(squares.x() > 0) ||
      !(kind == ConicKind::ellipse ? squares.y() > 0 : squares.y() < 0))
    return {std::nullopt, "the coefficients are those of no real curve"};
  if (axes.determinant() < 0) axes.col(1) = -axes.col(1);
  const Vec2 half(std::sqrt(squares.x()), std::sqrt(std::abs(squares.y())));
  const Vec3 x = lifted(half.x() * axes.col(0), 0), y = lifted(half.y() * axes.col(1), 0);
  const auto local = [&](const Vec2& p) -> Vec2 {
    return (axes.transpose() * (p - center)).cwiseQuotient(half);
  };
  const Vec2 a = local(from), b = local(to);
  if (kind == ConicKind::ellipse) {
    const double first = std::atan2(a.y(), a.x());
    double last = std::atan2(b.y(), b.x());
    if (from == to) last = first + 2 * pi;
    while (last <= first) last += 2 * pi;
    return {elliptic_arc(lifted(center, z), x, y, first, last), ""};
  }
  if ((a.x() > 0) != (b.x() > 0)) return {std::nullopt, "its ends are on two branches of the hyperbola"};
  if (from == to) return {std::nullopt, "its ends coincide"};
  return {
      hyperbolic_arc(lifted(center, z), a.x() > 0 ? x : Vec3(-x), y, std::asinh(a.y()), std::asinh(b.y())),
      ""};
}

}  // namespace

std::vector<double> arc_breaks(double from, double to) {
  const int pieces = std::max(1, static_cast<int>(std::ceil((to - from) / (pi / 2) - 1e-9)));
  std::vector<double> breaks(static_cast<std::size_t>(pieces) + 1);
  for (int i = 0; i <= pieces; ++i)
    breaks[static_cast<std::size_t>(i)] = i == pieces ? to : from + (to - from) * i / pieces;
  return breaks;
}

double parameter_at_angle(const std::vector<double>& breaks, double angle) {
  const auto above = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, angle);
  const double low = *(above - 1), high = *above, middle = (low + high) / 2, half = (high - low) / 2;
  return middle + half * std::tan((angle - middle) / 2) / std::tan(half / 2);
}

Curve elliptic_arc(const Vec3& center, const Vec3& x, const Vec3& y, double from, double to) {
  const std::vector<double> breaks = arc_breaks(from, to);
  Curve curve;
  curve.degree = 2;
  curve.knots = {breaks.front()};
  const auto at = [&](double angle, double stretch) -> Vec3 {
    const Vec2 d = stretch * direction(angle);
    return center + d.x() * x + d.y() * y;
  };
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double half = (breaks[i + 1] - breaks[i]) / 2;
    curve.knots.insert(curve.knots.end(), 2, breaks[i]);
    curve.points.push_back(at(breaks[i], 1));
    curve.weights.push_back(1);
    curve.points.push_back(at(breaks[i] + half, 1 / std::cos(half)));
    curve.weights.push_back(std::cos(half));
  }
  curve.knots.insert(curve.knots.end(), 3, breaks.back());
  curve.points.push_back(is_whole_turn(from, to) ? curve.points.front() : at(breaks.back(), 1));
  curve.weights.push_back(1);
  return curve;
}

Curve arc_by_angle(const Vec3& center, const Vec3& x, const Vec3& y, double from, double to) {
  const int pieces = std::max(1, static_cast<int>(std::ceil((to - from) / (pi / 32) - 1e-9)));
  Curve curve;
  curve.degree = 5;
  const double h = (to - from) / pieces;
  curve.knots = {from};
  const auto angle_at = [&](int i) { return i == pieces ? to : from + h * i; };
  for (int i = 0; i < pieces; ++i) {
    const double a = angle_at(i), b = angle_at(i + 1);
    const Vec2 p = direction(a), q = direction(b);
    const Vec3 start = p.x() * x + p.y() * y, end = q.x() * x + q.y() * y;
    const Vec3 start_slope = p.x() * y - p.y() * x, end_slope = q.x() * y - q.y() * x;
    // The second derivatives are -start and -end.
    const double s = (b - a) / 5, t = (b - a) * (b - a) / 20;
    curve.knots.insert(curve.knots.end(), 5, a);
    curve.points.push_back(center + start);
    curve.points.push_back(center + start + s * start_slope);
    curve.points.push_back(center + start + 2 * s * start_slope - t * start);
    curve.points.push_back(center + end - 2 * s * end_slope - t * end);
    curve.points.push_back(center + end - s * end_slope);
    if (i + 1 == pieces)
      curve.points.push_back(is_whole_turn(from, to) ? curve.points.front() : Vec3(center + end));
  }
  curve.knots.insert(curve.knots.end(), 6, to);
  return curve;
}

Curve hyperbolic_arc(const Vec3& center, const Vec3& x, const Vec3& y, double from, double to) {
  const double middle = (from + to) / 2, weight = std::cosh((to - from) / 2);
  Curve curve;
  curve.degree = 2;
  curve.knots = {0, 0, 0, 1, 1, 1};
  curve.points = {center + std::cosh(from) * x + std::sinh(from) * y,
                  center + (std::cosh(middle) * x + std::sinh(middle) * y) / weight,
                  center + std::cosh(to) * x + std::sinh(to) * y};
  curve.weights = {1, weight, 1};
  return curve;
}

Curve parabolic_arc(const Vec3& from, const Vec3& tip, const Vec3& to) {
  return {.degree = 2, .knots = {0, 0, 0, 1, 1, 1}, .points = {from, tip, to}, .weights = {}};
}

ConicArc conic_arc(const std::array<double, 6>& k, double z, const Vec2& from, const Vec2& to,
                   ConicKind kind) {
  const double largest = std::max({std::abs(k[0]), std::abs(k[1]), std::abs(k[2])});
  if (!(largest > 0) || !std::isfinite(largest))
    return {std::nullopt, "its quadratic coefficients are all zero"};
  const Conic conic{k[0] / largest, k[1] / largest, k[2] / largest,
                    k[3] / largest, k[4] / largest, k[5] / largest};
  const double size = std::max({from.norm(), to.norm(), (from - to).norm()});
  for (const Vec2& end : {from, to})
    if (!(conic.distance(end) <= 1e-4 * size)) return {std::nullopt, "an end is not on the curve"};
  const ConicKind own = kind_of(conic);
  // Coefficients of a parabola are rounded: what the file says counts where they do not contradict it.
  if (kind == ConicKind::unknown || kind != ConicKind::parabola) kind = own;
  ConicArc arc =
      kind == ConicKind::parabola ? parabola(conic, z, from, to) : central(conic, kind, z, from, to);
  if (!arc.curve) return arc;
  const bool whole = arc.curve->points.front() == arc.curve->points.back();
  arc.curve->points.front() = lifted(from, z);
  arc.curve->points.back() = whole ? arc.curve->points.front() : lifted(to, z);
  return arc;
}

}  // namespace selvage::nurbs
