// Centre lines of segments and circular arcs, exact: one rational quadratic B-spline (Piegl and Tiller, The
// NURBS Book, 7.3), built piece by piece, each at unit speed where it meets the next.
#pragma once

#include "core/vec.h"
#include "nurbs/spline.h"

namespace selvage::yarn {

class ArcsAndSegments {
 public:
  explicit ArcsAndSegments(const Vec3& start);
  // A segment of no length is left out.
  void segment(const Vec3& to);
  // The arc that touches the lines from the present point to `corner` and from there to `to`; half_angle:
  // half its turning, below 90 degrees. Precondition: the path so far ends in the direction of `corner`.
  void arc(const Vec3& corner, const Vec3& to, double half_angle);
  // The parameter reached so far, before finish() brings the whole to [0, 1].
  [[nodiscard]] double now() const { return curve_.knots.back(); }
  [[nodiscard]] const Vec3& end() const { return curve_.points.back(); }
  // Precondition: something was added.
  nurbs::Curve finish();

 private:
  void piece(const Vec3& middle, double weight, const Vec3& to, double duration);
  nurbs::Curve curve_;
};

}  // namespace selvage::yarn
