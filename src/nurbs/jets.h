// A curve that is looked at in many places.
#pragma once

#include <vector>

#include "nurbs/spline.h"

namespace selvage::nurbs {

// evaluate_jet() of one curve again and again: of a polynomial curve up to degree 3 each span is kept as its
// Taylor polynomial about its start, which gives the same jets but for rounding (none at the ends of the
// curve).
class Jets {
 public:
  explicit Jets(Curve curve);

  [[nodiscard]] const Curve& curve() const { return curve_; }
  [[nodiscard]] CurveJet at(double t) const;

 private:
  struct Piece {
    Vec3 position, d1, d2, d3;
  };
  Curve curve_;
  std::vector<double> starts_;  // of the pieces
  std::vector<Piece> pieces_;   // none: looked at by evaluate_jet()
};

}  // namespace selvage::nurbs
