#include "structured/stations.h"

#include <algorithm>
#include <cmath>

#include "nurbs/divided.h"
#include "surface_mesh/divided_line.h"

namespace selvage::fem {
namespace {

// What is known at a few places along the yarn.
struct Samples {
  std::vector<double> vs, lengths;  // along the centre line from its start
  std::vector<double> wanted;       // length of a part

  // Linear between the samples: one of the lists as a function of another.
  static double between(const std::vector<double>& of, const std::vector<double>& values, double at) {
    const auto above = std::upper_bound(of.begin() + 1, of.end() - 1, at);
    const auto i = static_cast<std::size_t>(above - of.begin());
    const double step = of[i] - of[i - 1];
    const double share = step > 0 ? std::clamp((at - of[i - 1]) / step, 0.0, 1.0) : 0;
    return values[i - 1] + share * (values[i] - values[i - 1]);
  }
};

// By the second derivatives of the lines after the length of the centre line.
void limit(Samples& samples, const std::vector<Vec3>& points, std::size_t lines, const StationRules& rules) {
  const std::size_t count = samples.vs.size();
  const auto slope = [&](std::size_t j, std::size_t k) -> Vec3 {
    const double step = std::max(samples.lengths[j] - samples.lengths[j - 1], 1e-300);
    return (points[j * lines + k] - points[(j - 1) * lines + k]) / step;
  };
  for (std::size_t j = 1; j + 1 < count; ++j) {
    const double step = (samples.lengths[j + 1] - samples.lengths[j - 1]) / 2;
    if (!(step > 0)) continue;
    for (std::size_t k = 0; k < lines; ++k) {
      const Vec3 before = slope(j, k), after = slope(j + 1, k);
      const double bend = (after - before).norm() / step;
      if (!(bend > 0)) continue;
      samples.wanted[j] = std::min({samples.wanted[j], std::sqrt(8 * rules.deviation / bend),
                                    rules.turn * (before + after).norm() / 2 / bend});
    }
  }
}

// Neighbours do not differ much.
void even_out(Samples& samples, double least) {
  constexpr double growth = 0.5;
  std::vector<double>& wanted = samples.wanted;
  for (double& length : wanted) length = std::max(length, least);
  const auto grow = [&](std::size_t from, std::size_t to) {
    wanted[to] =
        std::min(wanted[to], wanted[from] + growth * std::abs(samples.lengths[to] - samples.lengths[from]));
  };
  for (std::size_t j = 1; j < wanted.size(); ++j) grow(j - 1, j);
  for (std::size_t j = wanted.size() - 1; j > 0; --j) grow(j, j - 1);
}

}  // namespace

std::vector<double> stations(const yarn::Body& body, std::span<const double> us, const StationRules& rules) {
  constexpr int parts = 8, least_samples = 64;  // of a span; in all
  constexpr double shortest = 1.0 / 32;         // of the longest: a kink asks for no less
  Samples samples;
  samples.vs = nurbs::divided(body.surface.knots_v, body.surface.degree_v, parts, least_samples);
  samples.lengths.push_back(0);
  for (std::size_t j = 1; j < samples.vs.size(); ++j)
    samples.lengths.push_back(
        samples.lengths.back() +
        (nurbs::evaluate(body.axis, samples.vs[j]) - nurbs::evaluate(body.axis, samples.vs[j - 1])).norm());
  samples.wanted.assign(samples.vs.size(), rules.longest);
  limit(samples, nurbs::evaluate_grid(body.surface, {us.begin(), us.end()}, samples.vs), us.size(), rules);
  even_out(samples, shortest * rules.longest);
  const auto wanted = [&](double along) { return Samples::between(samples.lengths, samples.wanted, along); };
  std::vector<double> result;
  for (const double along : divided_line(samples.lengths.back(), wanted, rules.least))
    result.push_back(Samples::between(samples.lengths, samples.vs, along));
  result.front() = samples.vs.front();
  result.back() = samples.vs.back();
  return result;
}

}  // namespace selvage::fem
