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
Minimum settle(WovenProblem& problem, Minimum at, double tolerance) {
  constexpr int max_rounds = 30;
  BarrierOptions options;
  options.tolerance = tolerance;
  int steps = at.steps;
  for (int round = 0; round < max_rounds; ++round) {
    if (!problem.update(at, tolerance) && round > 0) break;
    at = minimize(problem, std::move(at), options);
    steps += at.steps;
    if (!at.is_converged) break;
  }
  at.steps = steps;
  return at;
}

}  // namespace

double WovenEquilibrium::control_height(WovenSystem system, int yarn, int knot) const {
  const bool is_warp = system == WovenSystem::warp;
  return scale_ * minimum_.x[problem_->height(system, is_warp ? 0 : yarn, is_warp ? yarn : 0, knot)];
}

WovenEquilibrium::Size WovenEquilibrium::size(WovenSystem system, int yarn, double crossings) const {
  const bool is_warp = system == WovenSystem::warp;
  const double halves = 2.0 * crossings, whole = std::floor(halves), t = halves - whole;
  const double step = t * t * (3.0 - 2.0 * t);
  const auto at = [&](int half) {
    return problem_->width_at(system, is_warp ? 0 : yarn, is_warp ? yarn : 0, static_cast<int>(whole) + half);
  };
  const int from = at(0), to = at(1);
  const auto between = [&](int which) {
    return 2.0 * scale_ * ((1.0 - step) * minimum_.x[from + which] + step * minimum_.x[to + which]);
  };
  return {between(0), between(1)};
}

Result<WovenEquilibrium> find_equilibrium(const WovenCloth& cloth, const WovenOptions& options) {
  constexpr double rough = 1e-3;
  const double scale = std::sqrt(mean_area(cloth));
  const WovenCloth ratios = scaled(cloth, 1.0 / scale);
  const auto problem_of = [&] { return std::make_shared<WovenProblem>(ratios, options.max_classes); };
  struct Candidate {
    std::shared_ptr<WovenProblem> problem;
    Minimum minimum;
  };
  std::optional<Candidate> best;
  double least_residual = std::numeric_limits<double>::infinity(), violation = 0.0;
  int steps = 0;
  for (const double share : warp_shares) {
    Candidate candidate{problem_of(), {}};
    candidate.minimum.x = candidate.problem->start(cloth.warp_share.value_or(share));
    candidate.minimum = settle(*candidate.problem, std::move(candidate.minimum), rough);
    steps += candidate.minimum.steps;
    if (candidate.minimum.violation + candidate.minimum.residual < least_residual) {
      least_residual = candidate.minimum.violation + candidate.minimum.residual;
      violation = candidate.minimum.violation;
    }
    if (candidate.minimum.is_converged && (!best || candidate.minimum.energy < best->minimum.energy * (1.0 - 1e-6)))
      best = std::move(candidate);
    if (cloth.warp_share) break;
  }
  if (best) {
    best->minimum.steps = steps;
    Candidate polished{best->problem, settle(*best->problem, best->minimum, options.tolerance)};
    if (polished.minimum.is_converged)
      return WovenEquilibrium(polished.problem, std::move(polished.minimum), scale);
    least_residual = polished.minimum.residual;
    violation = polished.minimum.violation;
  }
  return error(Kind::geometry, fmt::format("no equilibrium was found (residual {:.2g}, overlap {:.2g} of a yarn)",
                                           least_residual, violation));
}

}  // namespace selvage::mechanics
