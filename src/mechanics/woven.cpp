#include "mechanics/woven.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/wrapped.h"

namespace selvage::mechanics {

namespace {

using Eigen::VectorXd;

// Shares of the waves from which a search begins.
constexpr std::array<double, 3> warp_shares = {0.5, 0.8, 0.2};

// Tolerance before the last one; of inequalities; rounds of those that take part.
constexpr double fine = 1e-5, max_violation = 1e-6;
constexpr int max_rounds = 30;

WovenCloth scaled(WovenCloth cloth, double by) {
  for (auto* yarns : {&cloth.warps, &cloth.wefts})
    for (WovenYarn& yarn : *yarns) yarn.fibre_area *= by * by;
  for (auto* gaps : {&cloth.warp_gaps, &cloth.weft_gaps})
    for (double& gap : *gaps) gap *= by;
  cloth.clearance *= by;
  if (cloth.thickness) *cloth.thickness *= by;
  return cloth;
}

// Minima of the inequalities that take part, until all others hold, too.
Minimum settle(WovenProblem& problem, Minimum at, double tolerance, int most_rounds,
               BarrierWorkspace& workspace) {
  BarrierOptions options;
  options.tolerance = tolerance;
  int steps = at.steps;
  for (int round = 0; round < most_rounds; ++round) {
    if (!problem.update(at, tolerance) && round > 0) break;
    at = minimize(problem, std::move(at), options, workspace);
    steps += at.steps;
    if (!at.is_converged) break;
  }
  at.steps = steps;
  return at;
}

// Rough minima from all starts; those that are no copies of each other are polished, and the one of least
// energy is taken: of equal ones (1e-6) that of the first start.
Result<Minimum> least_minimum(WovenProblem& problem, const std::vector<VectorXd>& starts, double tolerance) {
  constexpr double rough = 1e-3, promising = 0.01, copy = 0.05, tie = 1e-6;
  constexpr int rough_rounds = 2;
  BarrierWorkspace workspace;
  struct Candidate {
    Minimum minimum;
    std::vector<char> active;
  };
  std::vector<Candidate> candidates;
  int steps = 0;
  for (const VectorXd& x : starts) {
    Minimum start;
    start.x = x;
    problem.set_active({});
    Minimum found = settle(problem, std::move(start), rough, rough_rounds, workspace);
    steps += found.steps;
    // Of copies the lower one, whatever the order of the starts.
    const auto copied = std::find_if(candidates.begin(), candidates.end(), [&](const Candidate& other) {
      return (other.minimum.x - found.x).cwiseAbs().maxCoeff() < copy;
    });
    if (copied == candidates.end())
      candidates.push_back({std::move(found), problem.active()});
    else if (found.energy < copied->minimum.energy)
      *copied = {std::move(found), problem.active()};
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.minimum.energy < b.minimum.energy;
  });
  std::optional<Minimum> best;
  double residual = std::numeric_limits<double>::infinity(), overlap = 0.0;
  for (Candidate& candidate : candidates) {
    if (best && candidate.minimum.energy > best->energy * (1.0 + promising)) break;
    problem.set_active(std::move(candidate.active));
    candidate.minimum.steps = 0;
    Minimum found = settle(problem, std::move(candidate.minimum), fine, max_rounds, workspace);
    found = settle(problem, std::move(found), tolerance, max_rounds, workspace);
    steps += found.steps;
    // Rounds that never came to rest leave an inequality violated: no equilibrium, whatever the residual.
    const double violation = problem.worst(found.x);
    if (found.residual < residual) {
      residual = found.residual;
      overlap = violation;
    }
    if (found.is_converged && violation <= max_violation &&
        (!best || found.energy < best->energy * (1.0 - tie)))
      best = std::move(found);
  }
  if (!best)
    return error(
        Kind::geometry,
        fmt::format("no equilibrium without overlap was found (residual {:.1e}, overlap {:.2g} of a yarn)",
                    residual, overlap));
  best->steps = steps;
  return std::move(*best);
}

}  // namespace

double mean_area(const WovenCloth& cloth) {
  double sum = 0.0;
  for (const auto* yarns : {&cloth.warps, &cloth.wefts})
    for (const WovenYarn& yarn : *yarns) sum += yarn.fibre_area / static_cast<double>(2 * yarns->size());
  return sum;
}

double WovenEquilibrium::control_height(WovenSystem system, int yarn, int knot) const {
  return scale_ * minimum_.x[problem_->height(system, yarn, knot)];
}

WovenEquilibrium::Size WovenEquilibrium::size(WovenSystem system, int yarn, double crossings) const {
  const double halves = 2.0 * crossings, whole = std::floor(halves), t = halves - whole;
  const double step = t * t * (3.0 - 2.0 * t);
  const auto at = [&](int half) { return problem_->width_at(system, yarn, static_cast<int>(whole) + half); };
  const int from = at(0), to = at(1);
  const auto between = [&](int which) {
    return 2.0 * scale_ * ((1.0 - step) * minimum_.x[from + which] + step * minimum_.x[to + which]);
  };
  return {between(0), between(1)};
}

Result<WovenEquilibrium> WovenEquilibrium::next(const WovenCloth& cloth, double flattened) const {
  const auto problem = std::make_shared<WovenProblem>(cloth, problem_->classes());
  const VectorXd start = problem->flattened(minimum_.x, flattened);
  if (cloth.thickness && problem_->cloth().thickness) {
    // The same inequalities: most of those that press will press on.
    Minimum near = minimum_;
    near.x = start;
    problem->set_active(problem_->active());
    BarrierWorkspace workspace;
    near = settle(*problem, std::move(near), fine, max_rounds, workspace);
    near = settle(*problem, std::move(near), tolerance_, max_rounds, workspace);
    if (near.is_converged && problem->worst(near.x) <= max_violation)
      return WovenEquilibrium(problem, std::move(near), scale_, tolerance_);
  }
  Result<Minimum> found = least_minimum(*problem, {start}, tolerance_);
  if (!found) return found.error();
  found->steps += minimum_.steps;
  return WovenEquilibrium(problem, std::move(*found), scale_, tolerance_);
}

// In steps that become smaller where there is no equilibrium.
WovenEquilibrium WovenEquilibrium::pressed(double thickness) const {
  constexpr double first_step = 0.9, last_step = 0.998;
  WovenEquilibrium at = *this;
  double by = first_step, reached = this->thickness();
  while (reached > thickness && by < last_step) {
    const double less = std::max(thickness, by * reached);
    WovenCloth cloth = problem_->cloth();
    cloth.thickness = less / scale_;
    Result<WovenEquilibrium> found = at.next(cloth, less / reached);
    if (!found) {
      by = std::sqrt(by);
      continue;
    }
    reached = less;
    at = std::move(*found);
  }
  return at;
}

Result<WovenEquilibrium> WovenEquilibrium::pressed_with(double pressure) const {
  constexpr double first_step = 4.0, last_step = 1.02;
  WovenEquilibrium at = *this;
  double by = first_step, reached = this->pressure();
  while (reached < pressure) {
    const double more = std::min(pressure, by * reached);
    WovenCloth cloth = problem_->cloth();
    cloth.pressure = more;
    Result<WovenEquilibrium> found = at.next(cloth, 1.0);
    if (!found) {
      by = std::sqrt(by);
      if (by < last_step) return found.error();
      continue;
    }
    reached = more;
    at = std::move(*found);
  }
  return at;
}

Result<WovenEquilibrium> find_equilibrium(const WovenCloth& cloth, const WovenOptions& options) {
  // In drafts of more kinds of crossings the systems share their waves from place to place, whatever the
  // start.
  constexpr int most_classes_of_starts = 32;
  const Partition classes = classes_of(cloth, options.max_classes);
  if (!classes.is_exact)
    return error(Kind::limit,
                 fmt::format("the crossings of its repeat of {} x {} are of more than {} classes",
                             cloth.columns(), cloth.rows(), options.max_classes));
  const double scale = std::sqrt(mean_area(cloth));
  WovenCloth ratios = scaled(cloth, 1.0 / scale);
  ratios.thickness.reset();
  if (ratios.pressure) ratios.pressure = std::min(*ratios.pressure, ratios.constants.pressure);
  const auto problem = std::make_shared<WovenProblem>(ratios, classes);
  std::vector<VectorXd> starts;
  for (const double share : warp_shares) {
    starts.push_back(problem->start(cloth.warp_share.value_or(share)));
    if (cloth.warp_share || classes.count() > most_classes_of_starts) break;
  }
  Result<Minimum> found = least_minimum(*problem, starts, options.tolerance);
  if (!found) return found.error();
  WovenEquilibrium at(problem, std::move(*found), scale, options.tolerance);
  if (cloth.pressure > ratios.pressure) {
    Result<WovenEquilibrium> pressed = at.pressed_with(*cloth.pressure);
    if (!pressed) return pressed.error();
    at = std::move(*pressed);
  }
  return cloth.thickness ? at.pressed(*cloth.thickness) : at;
}

}  // namespace selvage::mechanics
