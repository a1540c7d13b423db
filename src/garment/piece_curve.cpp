#include "garment/piece_curve.h"

#include <fmt/format.h>

#include "nurbs/edit.h"
#include "nurbs/interpolate.h"

namespace selvage::fabric {

namespace {

constexpr int cubic = 3;

std::vector<double> uniform_knots(std::size_t count) {
  std::vector<double> knots = nurbs::clamped_integer_knots(static_cast<int>(count), cubic);
  const double last = knots.back();
  for (double& knot : knots) knot /= last;
  return knots;
}

std::vector<Vec3> in_space(const std::vector<Vec2>& points) {
  std::vector<Vec3> out;
  out.reserve(points.size());
  for (const Vec2& p : points) out.emplace_back(p.x(), p.y(), 0.0);
  return out;
}

// Weights at the data points themselves: homogeneous coordinates are interpolated.
Result<nurbs::Curve> weighted(const std::vector<Vec3>& points, const std::vector<double>& weights,
                              const std::vector<double>& parameters) {
  const auto count = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd data(count, 4);
  std::vector<Vec3> as_points;  // the weights, for the parabola through them
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    data.row(i) = nurbs::homogeneous(points[k], weights[k]).transpose();
    as_points.emplace_back(weights[k], 0.0, 0.0);
  }
  const auto derivative = [&](bool last) {
    const Vec3& p = last ? points.back() : points.front();
    const double w = last ? weights.back() : weights.front();
    const Vec3 of_points = nurbs::end_derivative(points, parameters, last);
    const double of_weights = nurbs::end_derivative(as_points, parameters, last).x();
    Eigen::RowVectorXd row(4);
    row << (of_weights * p + w * of_points).transpose(), of_weights;
    return row;
  };
  const Eigen::MatrixXd rows =
      nurbs::interpolate_clamped(parameters, data, derivative(false), derivative(true));
  nurbs::Curve curve;
  curve.knots = nurbs::clamped_knots(parameters);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const double weight = rows(i, 3);
    if (!(weight > 0.0))
      return error(Kind::geometry,
                   fmt::format("its weights differ so much from row to row that one between them becomes "
                               "{:.3g}: bring them nearer to each other",
                               weight));
    curve.weights.push_back(weight);
    curve.points.emplace_back(rows(i, 0) / weight, rows(i, 1) / weight, 0.0);
  }
  curve.points.front() = points.front();
  curve.points.back() = points.back();
  return curve;
}

}  // namespace

Result<nurbs::Curve> spline_of(const PieceCurve& source, const std::vector<Vec2>& points) {
  nurbs::Curve curve;
  curve.degree = cubic;
  if (source.shape == PieceCurve::Shape::control) {
    curve.points = in_space(points);
    curve.weights = source.weights;
    curve.knots = source.knots.empty() ? uniform_knots(points.size()) : source.knots;
    return curve;
  }
  const std::vector<Vec3> through = in_space(points);
  const std::vector<double> parameters =
      nurbs::parameters(through, source.method.value_or(nurbs::Parameterization::chord));
  if (!source.weights.empty()) return weighted(through, source.weights, parameters);
  return nurbs::interpolate(through, parameters, nurbs::end_derivative(through, parameters, false),
                            nurbs::end_derivative(through, parameters, true));
}

Result<nurbs::Curve> edited(const nurbs::Curve& curve, const Edit& edit, double length) {
  const int joints = nurbs::joint_count(curve, false);
  if (joints < 3)
    return error(Kind::geometry, fmt::format("'{}' is one cubic without a joint between its ends: as a "
                                             "`spline` it has one in every row",
                                             edit.yarn));
  if (edit.joint < 2 || edit.joint >= joints)
    return error(
        Kind::geometry,
        fmt::format("joint {} of '{}' {}: its inner joints are 2 to {}", edit.joint, edit.yarn,
                    edit.joint == 1 || edit.joint == joints ? "is an end, where the outline would open"
                                                            : "does not exist",
                    joints - 1));
  switch (edit.form) {
    case Edit::Form::point:
      return nurbs::move_joint_by_control(curve, false, edit.joint, edit.target);
    case Edit::Form::weight:
      return nurbs::move_joint_by_weight(curve, false, edit.joint, edit.target);
    case Edit::Form::length:
      return nurbs::move_joint_to_length(curve, false, edit.joint, length, edit.direction);
  }
  return curve;
}

}  // namespace selvage::fabric
