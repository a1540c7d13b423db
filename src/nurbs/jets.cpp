#include "nurbs/jets.h"

#include <algorithm>
#include <utility>

namespace selvage::nurbs {

Jets::Jets(Curve curve) : curve_(std::move(curve)) {
  if (curve_.is_rational() || curve_.degree > 3) return;
  starts_ = breakpoints(curve_.knots, curve_.degree);
  for (std::size_t k = 0; k + 1 < starts_.size(); ++k) {
    const double half = 0.5 * (starts_[k + 1] - starts_[k]);
    const CurveJet start = evaluate_jet(curve_, starts_[k]), middle = evaluate_jet(curve_, starts_[k] + half);
    pieces_.push_back({start.position, start.d1, start.d2, (middle.d2 - start.d2) / half});
  }
  starts_.pop_back();
}

CurveJet Jets::at(double t) const {
  // At the ends to the bit.
  if (pieces_.empty() || !(t > curve_.first_parameter() && t < curve_.last_parameter()))
    return evaluate_jet(curve_, t);
  const auto next = std::upper_bound(starts_.begin() + 1, starts_.end(), t);
  const auto k = static_cast<std::size_t>(next - starts_.begin()) - 1;
  const auto& [position, d1, d2, d3] = pieces_[k];
  const double s = t - starts_[k];
  return {position + s * (d1 + (0.5 * s) * (d2 + (s / 3.0) * d3)), d1 + s * (d2 + (0.5 * s) * d3),
          d2 + s * d3};
}

}  // namespace selvage::nurbs
