// Arcs of cut yarns as B-splines: the edges of CAD faces. Internal to this folder.
#pragma once

#include <optional>
#include <vector>

#include "cell/cut.h"
#include "nurbs/spline.h"

namespace selvage::cell {

// A curve in space and the same in the parameters of the yarn's surface (z = 0), over one parameter: where
// the surface has flat(t), space(t) is within the tolerance of it, and in the face of the box to rounding.
struct EdgeCurves {
  nurbs::Curve space, flat;
};

// An arc by a parameter that runs along it: through the surface the length of its polygon, along an end of
// the surface the change of u. On an arc that is a border by itself it may go on past length().
class ArcPath {
 public:
  // All outlive this.
  ArcPath(const yarn::Body& body, const Box3& box, const Arc& arc, bool closed);

  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] bool is_closed() const { return closed_; }
  // Of the kept point `index` (Arc::parameters).
  [[nodiscard]] double along_of(std::size_t index) const;
  [[nodiscard]] Vec2 at(double along) const;
  [[nodiscard]] Vec3 position(double along) const;
  // Where u (axis 0) or v (axis 1) is `value`, between two places on whose sides of it they are.
  [[nodiscard]] double crossing(int axis, double value, double from, double to) const;

  // Along an end the surface's own row; else cubics through places of the arc, with its own tangents there:
  // an error of the fourth order, made less than `tolerance` (file units) by halving. from < to.
  [[nodiscard]] EdgeCurves curves(double from, double to, double tolerance) const;

 private:
  struct Place {
    Vec2 parameters;
    Vec3 at;
  };
  struct Way {  // the unit tangent, and the change of the parameters along it
    Vec3 space = Vec3::Zero();
    Vec2 flat = Vec2::Zero();
  };
  struct Span {
    double from = 0, to = 0;  // along
    double length = 0;        // of the curve
    Place first, last;
    Way out, in;  // at the first and the last place, from inside of the span
  };
  [[nodiscard]] Place place(double along) const;
  [[nodiscard]] Way way(const Place& here, const Vec2& beside, const Vec3& chord) const;
  [[nodiscard]] Span span(double from, double to) const;
  [[nodiscard]] bool is_near(const Span& span, double tolerance) const;
  void divide(double from, double to, double tolerance, int depth, std::vector<Span>& spans) const;
  [[nodiscard]] std::vector<double> breaks(double from, double to) const;
  [[nodiscard]] EdgeCurves row(double from, double to) const;

  const yarn::Body* body_;
  const Arc* arc_;
  std::optional<ArcCurve> curve_;  // through the surface
  int axis_ = -1;                  // of the face; -1: none
  bool closed_ = false;
  double length_ = 0;
  Vec2 gain_ = Vec2::Zero();  // of the parameters in one round
};

// The line of constant u from v0 to v1 (< v1), exactly.
EdgeCurves line_of_constant_u(const nurbs::Surface& surface, double u, double v0, double v1);

}  // namespace selvage::cell
