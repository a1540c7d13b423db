#include "yarn/rigid_fit.h"

#include <Eigen/SVD>

namespace selvage::yarn {

Vec3 mean_of(std::span<const Vec3> points) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

Eigen::Matrix3d best_rotation(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  const Vec3 a = mean_of(from), b = mean_of(to);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < from.size(); ++k) covariance += (to[k] - b) * (from[k] - a).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Vec3::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) signs[2] = -1;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace selvage::yarn
