// Minima that are known in closed form or published.
#include "mechanics/interior_point.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "mechanics/dual.h"

namespace selvage::mechanics {
namespace {

using Eigen::VectorXd;

// Of two unknowns; the function and the inequalities as functions of duals.
using Function = std::function<Dual<2>(const std::array<Dual<2>, 2>&)>;

class SmallProblem final : public BarrierProblem {
 public:
  SmallProblem(Function function, std::vector<Function> inequalities, VectorXd equality = {})
      : function_(std::move(function)),
        inequalities_(std::move(inequalities)),
        equality_(std::move(equality)) {}
  [[nodiscard]] Eigen::Index num_unknowns() const override { return 2; }
  [[nodiscard]] Eigen::SparseMatrix<double> places() const override {
    return Eigen::Matrix2d::Ones().sparseView() * 0.0;
  }
  double evaluate(const VectorXd& x, VectorXd& inequalities) const override {
    inequalities.resize(static_cast<Eigen::Index>(inequalities_.size()));
    const auto at = duals(x);
    for (std::size_t k = 0; k < inequalities_.size(); ++k)
      inequalities[static_cast<Eigen::Index>(k)] = inequalities_[k](at).value;
    return function_(at).value;
  }
  void differentiate(const VectorXd& x, const VectorXd& multipliers, const VectorXd& weights,
                     Derivatives& made) const override {
    const auto at = duals(x);
    const auto add = [&](const Dual<2>& term, double factor, double outer) {
      for (int row = 0; row < 2; ++row)
        for (int column = 0; column <= row; ++column) {
          const auto i = static_cast<std::size_t>(row), j = static_cast<std::size_t>(column);
          made.second.coeffRef(row, column) +=
              factor * term.second_at(i, j) + outer * term.first[i] * term.first[j];
        }
    };
    const Dual<2> function = function_(at);
    made.gradient = Eigen::Vector2d(function.first[0], function.first[1]);
    add(function, 1.0, 0.0);
    for (std::size_t k = 0; k < inequalities_.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const Dual<2> value = inequalities_[k](at);
      for (int i = 0; i < 2; ++i) made.gradients.add(i, value.first[static_cast<std::size_t>(i)]);
      made.gradients.end_row();
      add(value, -multipliers[row], weights[row]);
    }
  }
  [[nodiscard]] VectorXd equality() const override { return equality_; }

 private:
  static std::array<Dual<2>, 2> duals(const VectorXd& x) {
    return {Dual<2>::variable(0, x[0]), Dual<2>::variable(1, x[1])};
  }
  Function function_;
  std::vector<Function> inequalities_;
  VectorXd equality_;
};

Minimum solve(const SmallProblem& problem, double x, double y) {
  BarrierWorkspace workspace;
  Minimum start;
  start.x = Eigen::Vector2d(x, y);
  return minimize(problem, std::move(start), {}, workspace);
}

TEST(InteriorPoint, NearestPointOfAHalfPlane) {
  // x^2 + y^2 with x + y >= 1: (1/2, 1/2), multiplier 1. The start is not allowed.
  const SmallProblem problem([](const auto& v) { return square(v[0]) + square(v[1]); },
                             {[](const auto& v) { return v[0] + v[1] - 1.0; }});
  const Minimum found = solve(problem, -3.0, 0.2);
  ASSERT_TRUE(found.is_converged);
  EXPECT_NEAR(found.x[0], 0.5, 1e-9);
  EXPECT_NEAR(found.x[1], 0.5, 1e-9);
  EXPECT_NEAR(found.multipliers[0], 1.0, 1e-8);
}

TEST(InteriorPoint, RosenbrockInADisk) {
  // (1 - x)^2 + 100 (y - x^2)^2 with x^2 + y^2 <= 1: 0.0456748 at (0.786415, 0.617698), as published with
  // many solvers' manuals; the gradient is a multiple of the disk's there.
  const SmallProblem problem(
      [](const auto& v) { return square(v[0] * -1.0 + 1.0) + 100.0 * square(v[1] - square(v[0])); },
      {[](const auto& v) { return (square(v[0]) + square(v[1])) * -1.0 + 1.0; }});
  const Minimum found = solve(problem, -0.5, 0.5);
  ASSERT_TRUE(found.is_converged);
  EXPECT_NEAR(found.x[0], 0.786415, 1e-6);
  EXPECT_NEAR(found.x[1], 0.617698, 1e-6);
  EXPECT_NEAR(found.energy, 0.0456748, 1e-7);
}

TEST(InteriorPoint, WithoutInequalitiesItIsNewton) {
  const SmallProblem problem([](const auto& v) { return square(v[0] - 2.0) + 3.0 * square(v[1] + v[0]); },
                             {});
  const Minimum found = solve(problem, 0.1, 0.1);
  ASSERT_TRUE(found.is_converged);
  EXPECT_NEAR(found.x[0], 2.0, 1e-9);
  EXPECT_NEAR(found.x[1], -2.0, 1e-9);
}

TEST(InteriorPoint, HoldsAnEquality) {
  // x^2 + 2 y^2 on x = 2 y, y >= 1: (2, 1).
  const SmallProblem problem([](const auto& v) { return square(v[0]) + 2.0 * square(v[1]); },
                             {[](const auto& v) { return v[1] - 1.0; }}, Eigen::Vector2d(1.0, -2.0));
  const Minimum found = solve(problem, 0.3, -1.0);
  ASSERT_TRUE(found.is_converged);
  EXPECT_NEAR(found.x[0], 2.0, 1e-8);
  EXPECT_NEAR(found.x[1], 1.0, 1e-8);
}

TEST(InteriorPoint, SaysWhereNothingIsAllowed) {
  // x >= 1 and x <= -1.
  const SmallProblem problem(
      [](const auto& v) { return square(v[0]) + square(v[1]); },
      {[](const auto& v) { return v[0] - 1.0; }, [](const auto& v) { return v[0] * -1.0 - 1.0; }});
  const Minimum found = solve(problem, 0.0, 0.0);
  EXPECT_FALSE(found.is_converged);
  EXPECT_GE(found.violation, 0.99);
}

}  // namespace
}  // namespace selvage::mechanics
