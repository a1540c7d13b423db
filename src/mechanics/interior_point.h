// Minimum of a smooth function of many variables under smooth inequalities, by a primal-dual interior-point
// method with slacks: starts need not be feasible, second derivatives are exact. Source: J. Nocedal, S. J.
// Wright, Numerical Optimization, 2nd edition, Springer 2006, chapter 19 (step to the boundary, l1 merit
// function, inertia by a multiple of the identity).
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "mechanics/dual.h"

namespace selvage::mechanics {

// A linear combination of at most six unknowns.
struct Form {
  static constexpr std::size_t max_terms = 6;
  std::array<int, max_terms> index{};
  std::array<double, max_terms> weight{};
  int count = 0;
  double constant = 0;

  void add(int unknown, double by) {
    for (int i = 0; i < count; ++i)
      if (index[static_cast<std::size_t>(i)] == unknown) {
        weight[static_cast<std::size_t>(i)] += by;
        return;
      }
    index[static_cast<std::size_t>(count)] = unknown;
    weight[static_cast<std::size_t>(count)] = by;
    ++count;
  }
  [[nodiscard]] double at(const Eigen::VectorXd& x) const {
    double sum = constant;
    for (int i = 0; i < count; ++i)
      sum += weight[static_cast<std::size_t>(i)] * x[index[static_cast<std::size_t>(i)]];
    return sum;
  }
};

template <std::size_t N>
std::array<Dual<N>, N> duals_of(const std::array<Form, N>& forms, const Eigen::VectorXd& x) {
  std::array<Dual<N>, N> made;
  for (std::size_t i = 0; i < N; ++i) made[i] = Dual<N>::variable(i, forms[i].at(x));
  return made;
}

// A symmetric sparse matrix to which blocks are added again and again at the same places.
class SymmetricSum {
 public:
  explicit SymmetricSum(Eigen::Index size) : size_(size), columns_(static_cast<std::size_t>(size)) {}
  void clear();  // all entries to 0, places kept
  // Adds values[a * count + b], b <= a, at (unknowns[a], unknowns[b]); unknowns increase.
  void add(const int* unknowns, std::size_t count, const double* values);
  // The lower triangle, every diagonal entry present.
  [[nodiscard]] const Eigen::SparseMatrix<double>& lower();
  // Have places been added since the last call?
  [[nodiscard]] bool has_new_places() { return std::exchange(is_new_, false); }

 private:
  using Entry = std::pair<int, double>;  // row, value
  static void merge(std::vector<Entry>& column);

  Eigen::Index size_;
  Eigen::SparseMatrix<double> matrix_;
  std::vector<std::vector<Entry>> columns_;  // entries that have no place in the matrix yet
  bool has_places_ = false, has_more_ = false, is_new_ = false;
};

// Adds factor * (second derivatives of a function of forms) + outer * (outer product of its gradient).
template <std::size_t N>
void add_second(SymmetricSum& sum, const std::array<Form, N>& forms, const Dual<N>& term, double factor,
                double outer) {
  constexpr std::size_t most = Form::max_terms * N;
  std::array<int, most> unknowns;
  std::size_t count = 0;
  for (const Form& form : forms)
    for (std::size_t k = 0; k < static_cast<std::size_t>(form.count); ++k) {
      std::size_t at = 0;
      while (at < count && unknowns[at] < form.index[k]) ++at;
      if (at < count && unknowns[at] == form.index[k]) continue;
      std::copy_backward(unknowns.begin() + at, unknowns.begin() + count, unknowns.begin() + count + 1);
      unknowns[at] = form.index[k];
      ++count;
    }
  std::array<std::array<double, most>, N> weights, products;
  for (std::size_t i = 0; i < N; ++i) {
    std::fill_n(weights[i].begin(), count, 0.0);
    std::fill_n(products[i].begin(), count, 0.0);
    for (std::size_t k = 0; k < static_cast<std::size_t>(forms[i].count); ++k)
      weights[i][static_cast<std::size_t>(
          std::find(unknowns.begin(), unknowns.begin() + count, forms[i].index[k]) - unknowns.begin())] +=
          forms[i].weight[k];
  }
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) {
      const double value = factor * term.second_at(i, j) + outer * term.first[i] * term.first[j];
      for (std::size_t b = 0; b < count; ++b) products[i][b] += value * weights[j][b];
    }
  std::array<double, most * most> block;
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = 0; b <= a; ++b) {
      double value = 0.0;
      for (std::size_t i = 0; i < N; ++i) value += weights[i][a] * products[i][b];
      block[a * count + b] = value;
    }
  sum.add(unknowns.data(), count, block.data());
}
// Adds factor * (gradient of a function of forms).
template <std::size_t N>
void add_first(Eigen::VectorXd& gradient, const std::array<Form, N>& forms, const Dual<N>& term,
               double factor) {
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t a = 0; a < static_cast<std::size_t>(forms[i].count); ++a)
      gradient[forms[i].index[a]] += factor * term.first[i] * forms[i].weight[a];
}

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
  explicit Derivatives(Eigen::Index num_unknowns) : second(num_unknowns) {}
  Eigen::VectorXd gradient;
  SparseRows gradients;  // of the inequalities
  SymmetricSum second;
};

class BarrierProblem {
 public:
  virtual ~BarrierProblem() = default;
  [[nodiscard]] virtual Eigen::Index num_unknowns() const = 0;
  // The function, and all inequalities (allowed: >= 0). The function is infinite where it is not defined.
  virtual double evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& inequalities) const = 0;
  // Fills gradient and gradients of `made`; adds to `second` the second derivatives of the function and, of
  // each inequality k, -multipliers[k] * its own + weights[k] * the outer product of its gradient.
  virtual void differentiate(const Eigen::VectorXd& x, const Eigen::VectorXd& multipliers,
                             const Eigen::VectorXd& weights, Derivatives& made) const = 0;
  // One linear equality, equality() . x = 0; empty: none.
  [[nodiscard]] virtual Eigen::VectorXd equality() const { return {}; }
};

template <std::size_t N>
void add_row(SparseRows& rows, const std::array<Form, N>& forms, const Dual<N>& term) {
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t a = 0; a < static_cast<std::size_t>(forms[i].count); ++a)
      rows.add(forms[i].index[a], term.first[i] * forms[i].weight[a]);
  rows.end_row();
}

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
  explicit BarrierWorkspace(Eigen::Index num_unknowns);
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
