#include "fabric/helix.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::fabric {

namespace {

constexpr double share_of_tolerance = 0.1, bound = 5.0 / 384.0;
constexpr double longest_step = std::numbers::pi / 6.0;  // radians

double steps_of(const Helix& helix, double tolerance) {
  const double step =
      std::min(longest_step, std::pow(share_of_tolerance * tolerance / (bound * helix.radius), 0.25));
  return std::ceil(2.0 * std::numbers::pi * helix.turns / step);
}

}  // namespace

std::uint64_t helix_rows(const Helix& helix, double tolerance) {
  return static_cast<std::uint64_t>(std::min(steps_of(helix, tolerance), 1e18)) + 1;
}

Yarn drawn_helix(const Yarn& yarn, double tolerance) {
  const Helix& helix = std::get<Helix>(yarn.shape);
  const double turn = (helix.is_left ? -2.0 : 2.0) * std::numbers::pi * helix.turns;
  const double rise = helix.pitch * helix.turns, start = helix.start / 180.0 * std::numbers::pi;
  const auto steps = static_cast<int>(steps_of(helix, tolerance));
  Path path;
  path.form = yarn::PathForm::uniform;
  path.place = helix.place;
  path.lines.assign(static_cast<std::size_t>(steps) + 1, helix.place.line);
  const auto derivative = [&](double t) {  // by t over [0, 1]
    const double angle = start + turn * t;
    return Vec3(-helix.radius * turn * std::sin(angle), helix.radius * turn * std::cos(angle), rise);
  };
  for (int i = 0; i <= steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    const double angle = start + turn * share;
    path.points.emplace_back(helix.radius * std::cos(angle), helix.radius * std::sin(angle), rise * share);
  }
  Yarn drawn = yarn;
  if (!drawn.tangent_start) drawn.tangent_start = yarn::EndTangent(derivative(0.0), true);
  if (!drawn.tangent_end) drawn.tangent_end = yarn::EndTangent(derivative(1.0), true);
  drawn.shape = std::move(path);
  return drawn;
}

}  // namespace selvage::fabric
