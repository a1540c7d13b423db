// Penalties on moves, to the first order, and the step that is best for them: the inside of mend.cpp.
#pragma once

#include <Eigen/SparseCore>
#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/vec.h"

namespace selvage::fabric::mending {

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;

// What a class contributes to a residual: a vector along which its move counts.
struct Pull {
  int index = 0;  // of the class
  Vec3 along;
};

// One penalty: weight / 2 (lack - sum pulls . moves)^2, where that is lacking; or whatever it is.
struct Residual {
  double weight = 0, lack = 0;
  std::vector<Pull> pulls;
  bool counts_always = false;

  [[nodiscard]] double left(double change) const {
    return counts_always ? lack - change : std::max(lack - change, 0.0);
  }
};

// Stiffness and those penalties that count, to the first order at a state.
class Linear {
 public:
  Linear(const Matrix& stiffness, const std::vector<Residual>& residuals)
      : stiffness_(stiffness), residuals_(residuals) {}

  void count_only(std::vector<std::size_t> rows) { rows_ = std::move(rows); }

  // After a step of x from these moves, with all penalties that lack then.
  [[nodiscard]] double energy(const Vector& moves, const Vector& x) const {
    const Vector after = moves + x;
    double sum = 0.5 * after.dot(stiffness_ * after);
    for (const Residual& residual : residuals_) {
      const double lack = residual.left(change(residual, x));
      sum += 0.5 * residual.weight * lack * lack;
    }
    return sum;
  }
  [[nodiscard]] Vector times(const Vector& x) const {
    Vector image = stiffness_ * x;
    for (const std::size_t row : rows_) {
      const Residual& residual = residuals_[row];
      add(residual, residual.weight * change(residual, x), image);
    }
    return image;
  }
  // What the penalties pull with at x = 0.
  [[nodiscard]] Vector force() const {
    Vector sum = Vector::Zero(stiffness_.rows());
    for (const std::size_t row : rows_)
      add(residuals_[row], residuals_[row].weight * residuals_[row].lack, sum);
    return sum;
  }
  // The blocks of 3 x 3 on the diagonal, inverted.
  [[nodiscard]] std::vector<Eigen::Matrix3d> diagonal_inverses() const;
  // All of it as one matrix, of which the lower half is filled.
  [[nodiscard]] Eigen::MatrixXd matrix() const;
  static double change(const Residual& residual, const Vector& x) {
    double sum = 0;
    for (const Pull& pull : residual.pulls) sum += pull.along.dot(x.segment<3>(3 * Eigen::Index{pull.index}));
    return sum;
  }

 private:
  static void add(const Residual& residual, double factor, Vector& to) {
    for (const Pull& pull : residual.pulls)
      to.segment<3>(3 * Eigen::Index{pull.index}) += factor * pull.along;
  }

  const Matrix& stiffness_;
  const std::vector<Residual>& residuals_;
  std::vector<std::size_t> rows_;
};

// The x at which `linear` pulls with `right`. By Cholesky's method where that is quick; else by conjugate
// gradients from `x` on, as long as these come to an end sooner.
void solve(const Linear& linear, const Vector& right, Vector& x);

}  // namespace selvage::fabric::mending
