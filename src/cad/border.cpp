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
  std::vector<double> squared(points_.size());
  std::transform(points_.begin(), points_.end(), squared.begin(),
                 [&](const Vec3& q) { return (q - p).squaredNorm(); });
  best = std::min(best, std::sqrt(*std::min_element(squared.begin(), squared.end())));
  // From every place that is nearer than those beside it: a closed border begins and ends at one place, and
  // the nearest one may lie on either side of it. No point is farther from its nearest sample than one step.
  for (std::size_t i = 0; i < squared.size() && best > enough; ++i) {
    const bool is_least =
        (i == 0 || squared[i] <= squared[i - 1]) && (i + 1 == squared.size() || squared[i] <= squared[i + 1]);
    if (is_least && std::sqrt(squared[i]) - step_ <= std::min(best, most))
      best = std::min(best, refined(p, i));
  }
  return best;
}

double Border::refined(const Vec3& p, std::size_t nearest) const {
  double low = parameters_[nearest == 0 ? 0 : nearest - 1];
  double high = parameters_[std::min(nearest + 1, parameters_.size() - 1)];
  const double width = high - low;
  double t = parameters_[nearest], best = (points_[nearest] - p).norm();
  for (int step = 0; step < newton_steps; ++step) {
    const nurbs::CurveJet jet = nurbs::evaluate_jet(curve_, t);
    const Vec3 gap = p - jet.position;
    best = std::min(best, gap.norm());
    // Newton's method on the derivative of the squared distance; Gauss's form where that is no minimum. What
    // leaves the part in which the derivative changes its sign halves it.
    const double pull = gap.dot(jet.d1), bend = jet.d1.squaredNorm() - gap.dot(jet.d2);
    const double slope = bend > 0 ? bend : jet.d1.squaredNorm();
    if (!(slope > 0) || pull == 0) break;
    (pull > 0 ? low : high) = t;
    double next = t + pull / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - t) <= 1e-15 * width) break;
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
