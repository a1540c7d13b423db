#include "knit/mend_system.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace selvage::fabric::mending {

std::vector<Eigen::Matrix3d> Linear::diagonal_inverses() const {
  std::vector<Eigen::Matrix3d> blocks(static_cast<std::size_t>(stiffness_.rows() / 3),
                                      Eigen::Matrix3d::Zero());
  for (Eigen::Index row = 0; row < stiffness_.rows(); ++row)
    for (Matrix::InnerIterator entry(stiffness_, row); entry; ++entry)
      if (entry.col() / 3 == row / 3)
        blocks[static_cast<std::size_t>(row / 3)](row % 3, entry.col() % 3) += entry.value();
  for (const std::size_t row : rows_)
    for (const Pull& pull : residuals_[row].pulls)
      blocks[static_cast<std::size_t>(pull.index)] +=
          residuals_[row].weight * pull.along * pull.along.transpose();
  for (Eigen::Matrix3d& block : blocks) block = block.inverse().eval();
  return blocks;
}

Eigen::MatrixXd Linear::matrix() const {
  Eigen::MatrixXd sum = stiffness_;
  for (const std::size_t row : rows_) {
    const std::vector<Pull>& pulls = residuals_[row].pulls;  // by increasing class
    for (std::size_t b = 0; b < pulls.size(); ++b) {
      const Eigen::RowVector3d right = residuals_[row].weight * pulls[b].along.transpose();
      for (std::size_t a = b; a < pulls.size(); ++a)
        sum.block<3, 3>(3 * Eigen::Index{pulls[a].index}, 3 * Eigen::Index{pulls[b].index}) +=
            pulls[a].along * right;
    }
  }
  return sum;
}

void solve(const Linear& linear, const Vector& right, Vector& x) {
  // Gradients that find no end in few steps cost more than a system of some hundred unknowns does at once.
  constexpr Eigen::Index most_dense = 200, most_dense_after_all = 600;
  constexpr int most_steps = 300, most_steps_before = 50;
  const auto directly = [&] { x = linear.matrix().selfadjointView<Eigen::Lower>().llt().solve(right); };
  if (right.size() <= most_dense) return directly();
  const bool is_small = right.size() <= most_dense_after_all;
  const int most = is_small ? most_steps_before : most_steps;
  constexpr double enough = 1e-3;  // of the right side; the next step takes up the rest
  const std::vector<Eigen::Matrix3d> inverses = linear.diagonal_inverses();
  const auto precondition = [&](const Vector& r) {
    Vector z(r.size());
    for (std::size_t i = 0; i < inverses.size(); ++i)
      z.segment<3>(3 * static_cast<Eigen::Index>(i)) =
          inverses[i] * r.segment<3>(3 * static_cast<Eigen::Index>(i));
    return z;
  };
  Vector r = right - linear.times(x), z = precondition(r), direction = z;
  double product = r.dot(z);
  const double goal = enough * right.norm();
  for (int i = 0; i < most && r.norm() > goal; ++i) {
    const Vector image = linear.times(direction);
    const double along = product / direction.dot(image);
    x += along * direction;
    r -= along * image;
    z = precondition(r);
    const double next = r.dot(z);
    direction = z + next / product * direction;
    product = next;
  }
  if (is_small && r.norm() > goal) directly();
}

}  // namespace selvage::fabric::mending
