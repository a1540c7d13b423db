#include "mechanics/interior_point.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace selvage::mechanics {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd SparseRows::times(const VectorXd& x) const {
  VectorXd made(static_cast<Index>(starts_.size() - 1));
  for (std::size_t row = 0; row + 1 < starts_.size(); ++row) {
    double sum = 0.0;
    for (std::size_t k = starts_[row]; k < starts_[row + 1]; ++k) sum += values_[k] * x[columns_[k]];
    made[static_cast<Index>(row)] = sum;
  }
  return made;
}

VectorXd SparseRows::combined(const VectorXd& by, Index num_columns) const {
  VectorXd made = VectorXd::Zero(num_columns);
  for (std::size_t row = 0; row + 1 < starts_.size(); ++row)
    for (std::size_t k = starts_[row]; k < starts_[row + 1]; ++k)
      made[columns_[k]] += by[static_cast<Index>(row)] * values_[k];
  return made;
}

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// The last unknown may be joined with all others: it stays the last one.
struct AllButLast {
  using PermutationType = Eigen::AMDOrdering<int>::PermutationType;
  void operator()(const Eigen::SparseMatrix<double>& symmetric, PermutationType& order) const {
    const Index count = symmetric.cols() - 1;
    const Eigen::SparseMatrix<double> others = symmetric.topLeftCorner(count, count);
    PermutationType of_others;
    Eigen::AMDOrdering<int>()(others, of_others);
    order.resize(count + 1);
    order.indices().head(count) = of_others.indices();
    order.indices()[count] = static_cast<int>(count);
  }
};

// The linear system of a step: positive definite by what is added to its diagonal.
class StepSolver {
 public:
  void analyze(const Eigen::SparseMatrix<double>& places) { solver_.analyzePattern(places); }
  void forget_shift() { last_shift_ = 0.0; }
  // False: no multiple of the identity makes it definite.
  bool factorize(const Eigen::SparseMatrix<double>& matrix) {
    constexpr double smallest_shift = 1e-8;
    double shift = 0.0;
    for (int attempt = 0; attempt < max_attempts; ++attempt) {
      solver_.setShift(shift);
      solver_.factorize(matrix);
      if (solver_.info() == Eigen::Success) {
        last_shift_ = shift;
        return true;
      }
      if (shift == 0.0)
        shift = std::max(smallest_shift, last_shift_ / 4.0);
      else
        shift *= 6.0;
    }
    return false;
  }
  [[nodiscard]] VectorXd solve(const VectorXd& right) const { return solver_.solve(right); }

 private:
  static constexpr int max_attempts = 40;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, AllButLast> solver_;
  double last_shift_ = 0;
};

// The largest part of a step, up to 1, that keeps 0.5 % of each value.
double to_boundary(const VectorXd& values, const VectorXd& step) {
  constexpr double kept = 0.995;
  double part = 1.0;
  for (Index k = 0; k < values.size(); ++k)
    if (step[k] < 0.0) part = std::min(part, -kept * values[k] / step[k]);
  return part;
}

}  // namespace

struct BarrierWorkspace::State {
  Derivatives made;
  StepSolver solver;

  // Places that are the same as before keep the order of the factorization.
  void take(Eigen::SparseMatrix<double> places) {
    solver.forget_shift();
    const auto is_same = [](const int* a, const int* b, Index count) { return std::equal(a, a + count, b); };
    const Eigen::SparseMatrix<double>& old = made.second;
    if (old.rows() == places.rows() && old.nonZeros() == places.nonZeros() &&
        is_same(old.outerIndexPtr(), places.outerIndexPtr(), old.cols()) &&
        is_same(old.innerIndexPtr(), places.innerIndexPtr(), old.nonZeros()))
      return;
    made.second.swap(places);
    solver.analyze(made.second);
  }
};

BarrierWorkspace::BarrierWorkspace() : state_(std::make_unique<State>()) {}
BarrierWorkspace::~BarrierWorkspace() = default;

namespace {

class Solver {
 public:
  Solver(const BarrierProblem& problem, Minimum start, const BarrierOptions& options,
         BarrierWorkspace::State& workspace)
      : problem_(problem),
        options_(options),
        at_(std::move(start)),
        equality_(problem.equality()),
        solver_(workspace.solver),
        made_(workspace.made) {}

  Minimum run() {
    begin();
    for (at_.steps = 0;; ++at_.steps) {
      differentiate();
      measure();
      if (at_.residual <= options_.tolerance && at_.violation <= options_.tolerance) {
        at_.is_converged = true;
        break;
      }
      if (at_.steps >= options_.max_steps || !step()) break;
    }
    return std::move(at_);
  }

 private:
  void begin() {
    at_.is_converged = false;
    at_.energy = problem_.evaluate(at_.x, inequalities_);
    const Index count = inequalities_.size();
    if (at_.slacks.size() == count && at_.multipliers.size() == count && count > 0) {
      // From a former minimum: what has touched keeps its multiplier, what has not its slack.
      barrier_ = std::clamp(at_.slacks.dot(at_.multipliers) / static_cast<double>(count), next_barrier,
                            options_.first_barrier);
      for (Index k = 0; k < count; ++k)
        if (at_.slacks[k] > at_.multipliers[k])
          at_.multipliers[k] = barrier_ / at_.slacks[k];
        else
          at_.slacks[k] = barrier_ / at_.multipliers[k];
    } else {
      barrier_ = options_.first_barrier;
      at_.slacks = inequalities_.cwiseMax(0.1);
      at_.multipliers = barrier_ * at_.slacks.cwiseInverse();
    }
    if (count == 0) barrier_ = last_barrier;
  }

  void differentiate() {
    // Multipliers are kept near what the barrier says of them.
    constexpr double nearness = 1e8;
    for (Index k = 0; k < at_.slacks.size(); ++k) {
      const double central = barrier_ / at_.slacks[k];
      at_.multipliers[k] = std::clamp(at_.multipliers[k], central / nearness, central * nearness);
    }
    weights_ = at_.multipliers.cwiseQuotient(at_.slacks);
    made_.second.coeffs().setZero();
    made_.gradients.clear();
    problem_.differentiate(at_.x, at_.multipliers, weights_, made_);
  }

  [[nodiscard]] double equality_gap(const VectorXd& x) const {
    return equality_.size() > 0 ? equality_.dot(x) : 0.0;
  }

  void measure() {
    missing_ = inequalities_ - at_.slacks;
    lagrangian_ = made_.gradient - made_.gradients.combined(at_.multipliers, at_.x.size());
    if (equality_.size() > 0) lagrangian_ -= at_.equality_multiplier * equality_;
    const auto largest = [](const VectorXd& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0.0; };
    // Scaled by the multipliers, as large ones carry their rounding.
    scale_ = std::max(1.0, at_.multipliers.size() > 0 ? at_.multipliers.mean() : 1.0);
    at_.violation = std::max(inequalities_.size() > 0 ? std::max(0.0, -inequalities_.minCoeff()) : 0.0,
                             std::abs(equality_gap(at_.x)));
    const VectorXd products = at_.slacks.cwiseProduct(at_.multipliers);
    at_.residual = std::max({largest(lagrangian_), largest(products)}) / scale_;
    const double error =
        std::max({largest(lagrangian_) / scale_, largest((products.array() - barrier_).matrix()) / scale_,
                  largest(missing_), std::abs(equality_gap(at_.x))});
    constexpr double closeness = 10.0;
    while (barrier_ > last_barrier && error <= closeness * barrier_) {
      barrier_ = std::max(last_barrier, std::min(0.2 * barrier_, std::pow(barrier_, 1.3)));
    }
  }

  // What a line search decreases; the gap of slacks weighs `penalty_`.
  [[nodiscard]] double merit(double energy, const VectorXd& inequalities, const VectorXd& slacks,
                             const VectorXd& x) const {
    return energy - barrier_ * slacks.array().log().sum() +
           penalty_ * ((inequalities - slacks).cwiseAbs().sum() + std::abs(equality_gap(x)));
  }

  bool step() {
    constexpr double sufficient = 1e-4;
    constexpr int max_halvings = 30;
    if (!solver_.factorize(made_.second)) return false;
    const VectorXd central = barrier_ * at_.slacks.cwiseInverse() - weights_.cwiseProduct(missing_);
    VectorXd right = made_.gradients.combined(central, at_.x.size()) - made_.gradient;
    if (equality_.size() > 0) right += at_.equality_multiplier * equality_;
    VectorXd dx = solver_.solve(right);
    if (equality_.size() > 0) {
      const VectorXd along = solver_.solve(equality_);
      const double change = -(equality_gap(at_.x) + equality_.dot(dx)) / equality_.dot(along);
      dx += change * along;
      at_.equality_multiplier += change;
    }
    const VectorXd rise = made_.gradients.times(dx);
    const VectorXd ds = rise + missing_;
    const VectorXd dm = central - weights_.cwiseProduct(rise) - at_.multipliers;
    double part = std::min(to_boundary(at_.slacks, ds),
                           options_.longest_step / std::max(options_.longest_step, dx.cwiseAbs().maxCoeff()));
    const double gap = missing_.cwiseAbs().sum() + std::abs(equality_gap(at_.x));
    const double slope = made_.gradient.dot(dx) - barrier_ * ds.cwiseQuotient(at_.slacks).sum();
    if (gap > 0.0) penalty_ = std::max(penalty_, 1.2 * std::max(0.0, slope) / gap + 1e-3);
    if (at_.multipliers.size() > 0)
      penalty_ = std::max(penalty_, 1.1 * std::min(1e6, (at_.multipliers + dm).cwiseAbs().maxCoeff()));
    const double before = merit(at_.energy, inequalities_, at_.slacks, at_.x);
    const double descent = slope - penalty_ * gap;
    VectorXd x, slacks, inequalities;
    double energy = infinity;
    for (int halving = 0;; ++halving, part *= 0.5) {
      x = at_.x + part * dx;
      slacks = at_.slacks + part * ds;
      energy = problem_.evaluate(x, inequalities);
      if (energy < infinity) {
        // Where an inequality has more than its slack, the slack takes it.
        for (Index k = 0; k < slacks.size(); ++k) slacks[k] = std::max(slacks[k], inequalities[k]);
        const double after = merit(energy, inequalities, slacks, x);
        const double rounding = 1e-13 * (std::abs(before) + 1.0);
        if (after <= before + sufficient * part * std::min(descent, 0.0) + rounding) break;
      }
      if (halving >= max_halvings) return false;
    }
    at_.x = std::move(x);
    at_.slacks = std::move(slacks);
    at_.energy = energy;
    inequalities_ = std::move(inequalities);
    at_.multipliers += to_boundary(at_.multipliers, dm) * dm;
    return true;
  }

  static constexpr double last_barrier = 1e-11, next_barrier = 1e-8;
  const BarrierProblem& problem_;
  const BarrierOptions& options_;
  Minimum at_;
  VectorXd equality_;
  StepSolver& solver_;
  Derivatives& made_;
  VectorXd inequalities_, weights_, missing_, lagrangian_;
  double barrier_ = 0, penalty_ = 1, scale_ = 1;
};

}  // namespace

Minimum minimize(const BarrierProblem& problem, Minimum start, const BarrierOptions& options,
                 BarrierWorkspace& workspace) {
  workspace.state().take(problem.places());
  return Solver(problem, std::move(start), options, workspace.state()).run();
}

}  // namespace selvage::mechanics
