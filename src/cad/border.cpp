#include "cad/border.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cad/edges.h"
#include "cad/sampled_curve.h"

namespace selvage::cad {

namespace {

constexpr int fewest_points = 8, points_a_span = 4, most_points = 2000;
constexpr int newton_steps = 30;

}  // namespace

Border::Border(nurbs::Curve curve, int side)
    : curve_(std::move(curve)),
      side_(side),
      first_(curve_.first_parameter()),
      last_(curve_.last_parameter()) {
  const std::vector<double> spans = nurbs::breakpoints(curve_.knots, curve_.degree);
  const auto count = static_cast<int>(std::max<std::size_t>(spans.size(), 2)) - 1;
  const int each =
      std::max({1, (fewest_points + count - 1) / count, std::min(points_a_span, most_points / count)});
  for (std::size_t i = 0; i + 1 < spans.size(); ++i)
    for (int k = 0; k < each; ++k)
      parameters_.push_back(std::lerp(spans[i], spans[i + 1], static_cast<double>(k) / each));
  parameters_.push_back(last_);
  for (const double t : parameters_) {
    points_.push_back(nurbs::evaluate(curve_, t));
    box_.extend(points_.back());
    if (points_.size() < 2) continue;
    const double step = (points_.back() - points_[points_.size() - 2]).norm();
    length_ += step;
    step_ = std::max(step_, step);
  }
  box_ = Box3(box_.min().array() - step_, box_.max().array() + step_);
}

double Border::distance(const Vec3& p, double hint, double enough, double most) const {
  if (box_.exteriorDistance(p) > most) return std::numeric_limits<double>::infinity();
  double best = std::numeric_limits<double>::infinity();
  for (const double share : {hint, 1 - hint}) {
    best = std::min(best, (nurbs::evaluate(curve_, std::lerp(first_, last_, share)) - p).norm());
    if (best <= enough) return best;
  }
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const double squared = (points_[i] - p).squaredNorm();
    if (squared < least) {
      least = squared;
      nearest = i;
    }
  }
  best = std::min(best, std::sqrt(least));
  // No point of the border is farther from its nearest sample than that one's step.
  return best <= enough || std::sqrt(least) - step_ > most ? best : std::min(best, refined(p, nearest));
}

double Border::refined(const Vec3& p, std::size_t nearest) const {
  const double low = parameters_[nearest == 0 ? 0 : nearest - 1];
  const double high = parameters_[std::min(nearest + 1, parameters_.size() - 1)];
  double t = parameters_[nearest], best = (points_[nearest] - p).norm();
  for (int step = 0; step < newton_steps; ++step) {
    const nurbs::CurveJet jet = nurbs::evaluate_jet(curve_, t);
    const Vec3 gap = p - jet.position;
    best = std::min(best, gap.norm());
    // Newton's method on the derivative of the squared distance; Gauss's form where that is no minimum.
    const double bend = jet.d1.squaredNorm() - gap.dot(jet.d2);
    const double slope = bend > 0 ? bend : jet.d1.squaredNorm();
    if (!(slope > 0)) break;
    const double next = std::clamp(t + gap.dot(jet.d1) / slope, low, high);
    if (std::abs(next - t) <= 1e-15 * (high - low)) break;
    t = next;
  }
  return best;
}

std::vector<Border> borders_of(const Face& face) {
  std::vector<Border> borders;
  if (face.loops.empty()) {
    for (nurbs::Curve& side : sides_of(face.surface))
      borders.emplace_back(std::move(side), static_cast<int>(borders.size()));
    return borders;
  }
  for (const Edge& edge : edges_of(face))
    if (!edge.curve.points.empty()) borders.emplace_back(edge.curve);
  return borders;
}

}  // namespace selvage::cad
