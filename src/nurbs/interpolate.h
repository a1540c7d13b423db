// Cubic B-splines through data points (inverse interpolation): methods.md, 1, after the paper on plain weft
// knitting
// ../shared/references 001 (uniform, chord and centripetal parameters, knots at the data points). All solves
// are tridiagonal, O(n).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "core/vec.h"
#include "nurbs/spline.h"

namespace selvage::nurbs {

enum class Parameterization { uniform, chord, centripetal };

// Parameters 0 .. 1 of the data points, one each. `closed`: the first point follows the last, and one value
// more (1) is given for it. Precondition: neighbouring points differ; at least two points (three when
// closed).
std::vector<double> parameters(const std::vector<Vec3>& points, Parameterization how, bool closed = false);

// Derivative vectors at the data's ends: of the parabola through the nearest three points (of the chord when
// there are two only). With a direction given (any length but zero) that vector's length in that direction.
Vec3 end_derivative(const std::vector<Vec3>& points, const std::vector<double>& parameters, bool last,
                    const std::optional<Vec3>& direction = std::nullopt);

// The clamped cubic through data at strictly increasing parameters, with given derivatives at both ends.
// `data`: one row a data point (n >= 2), any number of columns; returns n + 2 rows of control values over the
// knots clamped_knots(parameters).
Eigen::MatrixXd interpolate_clamped(const std::vector<double>& parameters, const Eigen::MatrixXd& data,
                                    const Eigen::RowVectorXd& first_derivative,
                                    const Eigen::RowVectorXd& last_derivative);

// The periodic cubic through n >= 3 data rows; parameters has n + 1 values, the last one for the return to
// row 0. Returned in clamped form: n + 3 rows over clamped_knots(parameters), the last row equal to the first
// to the bit.
Eigen::MatrixXd interpolate_periodic(const std::vector<double>& parameters, const Eigen::MatrixXd& data);

// Each parameter once, the first and last four times.
std::vector<double> clamped_knots(const std::vector<double>& parameters);

// The curve forms of the above.
Curve interpolate(const std::vector<Vec3>& points, const std::vector<double>& parameters,
                  const Vec3& first_derivative, const Vec3& last_derivative);
Curve interpolate_closed(const std::vector<Vec3>& points, const std::vector<double>& parameters);

// 0, 1, 2, .., the first and last as often as a clamped curve of so many control points has them.
std::vector<double> clamped_integer_knots(int count, int degree);

// A closed polygon as a clamped closed B-spline over knot(0) .. knot(points.size()), which are evenly spaced
// and go on beyond them: degree 2 begins in the middle of the edge from the last point to the first, degree 3
// beside the first point, and so on. Weights: none, or one a point.
Curve closed_uniform(const std::vector<Vec3>& points, const std::vector<double>& weights, int degree,
                     const std::function<double(int)>& knot);

}  // namespace selvage::nurbs
