// Minimum of a smooth function of many variables under smooth inequalities, by a primal-dual interior-point
// method with slacks: starts need not be feasible, second derivatives are exact. Source: J. Nocedal, S. J.
// Wright, Numerical Optimization, 2nd edition, Springer 2006, chapter 19 (step to the boundary, l1 merit
// function, inertia by a multiple of the identity).
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <memory>
#include <vector>

namespace selvage::mechanics {

// Rows of a sparse matrix; a column may come more than once in a row, and counts as the sum.
class SparseRows {
 public:
  void clear() {
    starts_.assign(1, 0);
    columns_.clear();
    values_.clear();
  }
  void add(int column, double value) {
    columns_.push_back(column);
    values_.push_back(value);
  }
  void end_row() { starts_.push_back(columns_.size()); }
  // rows * x; sum over k of by[k] * row k.
  [[nodiscard]] Eigen::VectorXd times(const Eigen::VectorXd& x) const;
  [[nodiscard]] Eigen::VectorXd combined(const Eigen::VectorXd& by, Eigen::Index num_columns) const;

 private:
  std::vector<std::size_t> starts_{0};
  std::vector<int> columns_;
  std::vector<double> values_;
};

struct Derivatives {
  Eigen::VectorXd gradient;
  SparseRows gradients;                // of the inequalities
  Eigen::SparseMatrix<double> second;  // lower triangle, with the places of BarrierProblem::places
};

class BarrierProblem {
 public:
  virtual ~BarrierProblem() = default;
  [[nodiscard]] virtual Eigen::Index num_unknowns() const = 0;
  // The function, and all inequalities (allowed: >= 0). The function is infinite where it is not defined.
  virtual double evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& inequalities) const = 0;
  // Lower triangle, all 0: every place that second derivatives may have, the diagonal included.
  [[nodiscard]] virtual Eigen::SparseMatrix<double> places() const = 0;
  // Fills gradient and gradients of `made`; adds to `second` the second derivatives of the function and, of
  // each inequality k, -multipliers[k] * its own + weights[k] * the outer product of its gradient.
  virtual void differentiate(const Eigen::VectorXd& x, const Eigen::VectorXd& multipliers,
                             const Eigen::VectorXd& weights, Derivatives& made) const = 0;
  // One linear equality, equality() . x = 0; empty: none.
  [[nodiscard]] virtual Eigen::VectorXd equality() const { return {}; }
};

struct BarrierOptions {
  double tolerance = 1e-10;  // of the gradient, the inequalities and the complementarity
  double first_barrier = 2e-3;
  double longest_step = 0.5;  // of any unknown
  int max_steps = 200;
};

struct Minimum {
  Eigen::VectorXd x, slacks, multipliers;
  double equality_multiplier = 0;
  double energy = 0;
  double residual = 0;   // largest of the gradient of the Lagrangian, and of slack times multiplier
  double violation = 0;  // largest violation of an inequality
  int steps = 0;
  bool is_converged = false;
};

// Places of the matrix of a step and the order of its factorization: kept from one minimization to the next
// one of the same problem.
class BarrierWorkspace {
 public:
  BarrierWorkspace();
  ~BarrierWorkspace();
  struct State;
  [[nodiscard]] State& state() { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

// From `start` (x; slacks and multipliers where they have the size of the inequalities, else set anew).
Minimum minimize(const BarrierProblem& problem, Minimum start, const BarrierOptions& options,
                 BarrierWorkspace& workspace);

}  // namespace selvage::mechanics
