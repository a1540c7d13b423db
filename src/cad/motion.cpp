#include "cad/motion.h"

#include <Eigen/SVD>
#include <cmath>
#include <numbers>

namespace selvage::cad {

namespace {

Vec3 mean_of(const std::vector<Vec3>& points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

}  // namespace

std::optional<Motion> motion_between(const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                                     double near) {
  if (from.empty() || from.size() != to.size()) return std::nullopt;
  const Vec3 a = mean_of(from), b = mean_of(to);
  const auto fits = [&](const Eigen::Matrix3d& turn) {
    for (std::size_t k = 0; k < from.size(); ++k)
      if ((turn * (from[k] - a) - (to[k] - b)).squaredNorm() > near * near) return false;
    return true;
  };
  Motion motion;
  motion.shift = b - a;
  if (fits(Eigen::Matrix3d::Identity())) return motion;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < from.size(); ++k) covariance += (to[k] - b) * (from[k] - a).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Vec3::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) signs[2] = -1;
  const Eigen::Matrix3d turn = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  if (!fits(turn)) return std::nullopt;
  const Eigen::AngleAxisd rotation(turn);
  motion.angle = rotation.angle() * 180 / std::numbers::pi;
  motion.axis = rotation.axis();
  return motion;
}

}  // namespace selvage::cad
