#include "contact/least_shift.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>

namespace selvage::contact {

namespace {

// The shortest t that meets `count` demands exactly; nothing: they are dependent, or one of them pulls.
std::optional<Vec3> exact_shift(const std::array<const ShiftDemand*, 3>& active, int count) {
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 3, 3> rows(count, 3);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> right(count);
  for (int k = 0; k < count; ++k) {
    rows.row(k) = active[static_cast<std::size_t>(k)]->normal.transpose();
    right[k] = active[static_cast<std::size_t>(k)]->distance;
  }
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> gram = rows * rows.transpose();
  if (!(gram.determinant() > 1e-9)) return std::nullopt;
  const Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1> force = gram.inverse() * right;
  if (force.minCoeff() < 0.0) return std::nullopt;
  return rows.transpose() * force;
}

}  // namespace

std::optional<Vec3> least_shift(const std::vector<ShiftDemand>& demands) {
  if (demands.empty()) return Vec3(Vec3::Zero());
  double largest = 0.0;
  for (const ShiftDemand& demand : demands) largest = std::max(largest, demand.distance);
  const auto meets_all = [&](const Vec3& t) {
    return std::all_of(demands.begin(), demands.end(),
                       [&](const ShiftDemand& d) { return d.normal.dot(t) >= d.distance - 1e-10 * largest; });
  };
  std::optional<Vec3> best;
  const auto consider = [&](const std::array<const ShiftDemand*, 3>& active, int count) {
    const std::optional<Vec3> t = exact_shift(active, count);
    if (t && (!best || t->squaredNorm() < best->squaredNorm()) && meets_all(*t)) best = t;
  };
  const std::size_t n = demands.size();
  for (std::size_t i = 0; i < n; ++i) consider({&demands[i], nullptr, nullptr}, 1);
  for (std::size_t i = 0; i < n && !best; ++i)
    for (std::size_t j = i + 1; j < n; ++j) consider({&demands[i], &demands[j], nullptr}, 2);
  for (std::size_t i = 0; i < n && !best; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k) consider({&demands[i], &demands[j], &demands[k]}, 3);
  return best;
}

}  // namespace selvage::contact
