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

// Shares of the waves from which a search begins.
constexpr std::array<double, 3> warp_shares = {0.5, 0.8, 0.2};

double mean_area(const WovenCloth& cloth) {
  double sum = 0.0;
  for (const auto* yarns : {&cloth.warps, &cloth.wefts})
    for (const WovenYarn& yarn : *yarns) sum += yarn.fibre_area / static_cast<double>(2 * yarns->size());
  return sum;
}

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
Minimum settle(WovenProblem& problem, Minimum at, double tolerance, int max_rounds,
               BarrierWorkspace& workspace) {
  BarrierOptions options;
  options.tolerance = tolerance;
  int steps = at.steps;
  for (int round = 0; round < max_rounds; ++round) {
    if (!problem.update(at, tolerance) && round > 0) break;
    at = minimize(problem, std::move(at), options, workspace);
    steps += at.steps;
    if (!at.is_converged) break;
  }
  at.steps = steps;
  return at;
}

}  // namespace

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

Result<WovenEquilibrium> find_equilibrium(const WovenCloth& cloth, const WovenOptions& options) {
  // Rough minima from all starts; those that are no copies of each other are polished, and the one of least
  // energy is taken: of equal ones (1e-6) that of the first start.
  constexpr double rough = 1e-3, fine = 1e-5, promising = 0.01, copy = 0.05, tie = 1e-6, max_violation = 1e-6;
  constexpr int rough_rounds = 2, max_rounds = 30;
  // In drafts of more kinds of crossings the systems share their waves from place to place, whatever the
  // start.
  constexpr int most_classes_of_starts = 32;
  Partition classes = classes_of(cloth, options.max_classes);
  if (!classes.is_exact)
    return error(Kind::limit,
                 fmt::format("the crossings of its repeat of {} x {} are of more than {} classes",
                             cloth.columns(), cloth.rows(), options.max_classes));
  const double scale = std::sqrt(mean_area(cloth));
  const WovenCloth ratios = scaled(cloth, 1.0 / scale);
  const auto problem = std::make_shared<WovenProblem>(ratios, std::move(classes));
  BarrierWorkspace workspace;
  struct Candidate {
    Minimum minimum;
    std::vector<char> active;
  };
  std::vector<Candidate> candidates;
  int steps = 0;
  for (const double share : warp_shares) {
    Minimum start;
    start.x = problem->start(cloth.warp_share.value_or(share));
    problem->set_active({});
    Minimum found = settle(*problem, std::move(start), rough, rough_rounds, workspace);
    steps += found.steps;
    const bool is_copy = std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
      return (other.minimum.x - found.x).cwiseAbs().maxCoeff() < copy;
    });
    if (!is_copy) candidates.push_back({std::move(found), problem->active()});
    if (cloth.warp_share || problem->classes().count() > most_classes_of_starts) break;
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.minimum.energy < b.minimum.energy;
  });
  std::optional<Minimum> best;
  double residual = std::numeric_limits<double>::infinity(), overlap = 0.0;
  for (Candidate& candidate : candidates) {
    if (best && candidate.minimum.energy > best->energy * (1.0 + promising)) break;
    problem->set_active(std::move(candidate.active));
    candidate.minimum.steps = 0;
    Minimum found = settle(*problem, std::move(candidate.minimum), fine, max_rounds, workspace);
    found = settle(*problem, std::move(found), options.tolerance, max_rounds, workspace);
    steps += found.steps;
    // Rounds that never came to rest leave an inequality violated: no equilibrium, whatever the residual.
    const double violation = problem->worst(found.x);
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
  return WovenEquilibrium(problem, std::move(*best), scale);
}

}  // namespace selvage::mechanics
