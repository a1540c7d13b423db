#include "nurbs/offset.h"

#include <algorithm>

#include "nurbs/divided.h"
#include "nurbs/interpolate.h"

namespace selvage::nurbs {

namespace {

constexpr int most_parts = 64;
constexpr std::size_t most_points = 250'000;

double middle(const std::vector<double>& values, std::size_t i) {
  return 0.5 * (values[i] + values[i + 1]);
}

// The derivative at the first (last) of increasing places, of a function of one variable: second order, of a
// step at which its error and that of rounding are both some 1e-9 of what a span turns by.
template <class At>
Eigen::RowVectorXd end_slope(const std::vector<double>& places, bool last, const At& at) {
  const double end = last ? places.back() : places.front(),
               span = last ? end - places[places.size() - 2] : places[1] - end,
               step = (last ? -1e-4 : 1e-4) * span;
  return (-3 * at(end) + 4 * at(end + step) - at(end + 2 * step)) / (2 * step);
}

std::vector<double> cut(const std::vector<double>& breaks, int parts) {
  return divided(breaks, std::vector<int>(breaks.size() - 1, parts));
}

Curve through(const std::vector<double>& places, const std::function<Vec3(double)>& at) {
  std::vector<Vec3> points;
  points.reserve(places.size());
  for (const double t : places) points.push_back(at(t));
  const auto row = [&](double t) -> Eigen::RowVectorXd { return at(t).transpose(); };
  return interpolate(points, places, end_slope(places, false, row).transpose(),
                     end_slope(places, true, row).transpose());
}

Surface through(const std::vector<double>& us, const std::vector<double>& vs,
                const std::function<Vec3(double, double)>& at) {
  const auto count_u = static_cast<Eigen::Index>(us.size()), count_v = static_cast<Eigen::Index>(vs.size());
  // A row of points along v as one row of numbers.
  const auto along_v = [&](double u) {
    Eigen::RowVectorXd row(3 * count_v);
    for (Eigen::Index j = 0; j < count_v; ++j)
      row.segment<3>(3 * j) = at(u, vs[static_cast<std::size_t>(j)]).transpose();
    return row;
  };
  Eigen::MatrixXd data(count_u, 3 * count_v);
  for (Eigen::Index i = 0; i < count_u; ++i) data.row(i) = along_v(us[static_cast<std::size_t>(i)]);
  const Eigen::MatrixXd rows =
      interpolate_clamped(us, data, end_slope(us, false, along_v), end_slope(us, true, along_v));
  // The same the other way: the slopes at its ends are splines along u, too.
  const auto along_u = [&](double v) {
    Eigen::MatrixXd values(count_u, 3);
    const auto point = [&](double u) -> Eigen::RowVectorXd { return at(u, v).transpose(); };
    for (Eigen::Index i = 0; i < count_u; ++i) values.row(i) = point(us[static_cast<std::size_t>(i)]);
    const Eigen::MatrixXd control =
        interpolate_clamped(us, values, end_slope(us, false, point), end_slope(us, true, point));
    Eigen::RowVectorXd row(control.size());
    for (Eigen::Index i = 0; i < control.rows(); ++i) row.segment<3>(3 * i) = control.row(i);
    return row;
  };
  Eigen::MatrixXd columns(count_v, 3 * rows.rows());
  for (Eigen::Index j = 0; j < count_v; ++j)
    for (Eigen::Index i = 0; i < rows.rows(); ++i) columns.block<1, 3>(j, 3 * i) = rows.block<1, 3>(i, 3 * j);
  const Eigen::MatrixXd net =
      interpolate_clamped(vs, columns, end_slope(vs, false, along_u), end_slope(vs, true, along_u));

  Surface surface;
  surface.degree_u = surface.degree_v = 3;
  surface.count_u = static_cast<int>(rows.rows());
  surface.count_v = static_cast<int>(net.rows());
  surface.knots_u = clamped_knots(us);
  surface.knots_v = clamped_knots(vs);
  for (Eigen::Index j = 0; j < net.rows(); ++j)
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
      surface.points.emplace_back(net.block<1, 3>(j, 3 * i).transpose());
  return surface;
}

}  // namespace

Fitted<Curve> fitted(const std::vector<double>& breaks, const std::function<Vec3(double)>& at,
                     double tolerance) {
  Fitted<Curve> best;
  for (int parts = 4; parts <= most_parts; parts *= 2) {
    const std::vector<double> places = cut(breaks, parts);
    best = {through(places, at), 0};
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      const double t = middle(places, i);
      best.error = std::max(best.error, (evaluate(best.shape, t) - at(t)).norm());
    }
    if (best.error <= tolerance) break;
  }
  return best;
}

Fitted<Surface> fitted(const std::vector<double>& breaks_u, const std::vector<double>& breaks_v,
                       const std::function<Vec3(double, double)>& at, double tolerance) {
  Fitted<Surface> best;
  for (int parts = 4; parts <= most_parts; parts *= 2) {
    const std::vector<double> us = cut(breaks_u, parts), vs = cut(breaks_v, parts);
    if (!best.shape.is_empty() && us.size() * vs.size() > most_points) break;
    best = {through(us, vs, at), 0};
    std::vector<double> between_u, between_v;
    for (std::size_t i = 0; i + 1 < us.size(); ++i) between_u.push_back(middle(us, i));
    for (std::size_t j = 0; j + 1 < vs.size(); ++j) between_v.push_back(middle(vs, j));
    const std::vector<Vec3> made = evaluate_grid(best.shape, between_u, between_v);
    for (std::size_t j = 0; j < between_v.size(); ++j)
      for (std::size_t i = 0; i < between_u.size(); ++i)
        best.error =
            std::max(best.error, (made[j * between_u.size() + i] - at(between_u[i], between_v[j])).norm());
    if (best.error <= tolerance) break;
  }
  return best;
}

Vec3 unit_normal(const Surface& surface, double u, double v) {
  const double middle_u = 0.5 * (surface.first_u() + surface.last_u()),
               middle_v = 0.5 * (surface.first_v() + surface.last_v());
  Vec3 normal = Vec3::Zero();
  for (const double share : {0.0, 1e-6, 1e-4, 1e-2}) {
    const SurfaceJet jet = evaluate_jet(surface, u + share * (middle_u - u), v + share * (middle_v - v));
    normal = jet.du.cross(jet.dv);
    const double length = normal.norm();
    if (length > 1e-9 * jet.du.norm() * jet.dv.norm() && jet.du.norm() > 0 && jet.dv.norm() > 0)
      return normal / length;
  }
  return normal.normalized();
}

Fitted<Surface> offset(const Surface& base, double distance, double tolerance) {
  const auto at = [&](double u, double v) -> Vec3 {
    return evaluate(base, u, v) + distance * unit_normal(base, u, v);
  };
  return fitted(breakpoints(base.knots_u, base.degree_u), breakpoints(base.knots_v, base.degree_v), at,
                tolerance);
}

}  // namespace selvage::nurbs
