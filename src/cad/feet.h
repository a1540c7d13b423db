// Where points and curves in space are in the parameters of a surface: the feet of their perpendiculars.
#pragma once

#include <array>
#include <map>
#include <optional>

#include "cad/distance.h"
#include "cad/model.h"

namespace selvage::cad {

class Feet {
 public:
  // The surface outlives it.
  explicit Feet(const nurbs::Surface& surface);

  [[nodiscard]] const nurbs::Surface& surface() const { return surface_; }
  [[nodiscard]] const std::array<double, 2>& periods() const { return periods_; }
  // By Newton's method from the foot before, and in its turn round the surface; where that goes astray, or
  // there is none, looked for.
  [[nodiscard]] Vec2 of(const Vec3& p, const std::optional<Vec2>& before);
  // At a pole what is open is as it is beside it.
  [[nodiscard]] Vec2 of_end(const Vec3& p, const Vec2& beside);
  // What of a step in space is one in the parameters; nothing at a pole.
  [[nodiscard]] std::optional<Vec2> direction(const Vec2& at, const Vec3& step) const;
  // Of any turn round the surface.
  [[nodiscard]] nurbs::SurfaceJet jet(const Vec2& at) const;

 private:
  [[nodiscard]] std::optional<Vec2> step_towards(const Vec3& p, const Vec2& at) const;
  [[nodiscard]] double inside(double value, std::size_t d) const;
  [[nodiscard]] Vec2 within(Vec2 at) const;

  const nurbs::Surface& surface_;
  std::array<double, 2> periods_;
  std::array<double, 2> least_{};  // shorter derivatives are those beside a pole
  std::optional<SurfaceSet> set_;
};

// The feet of a curve's points, each near the one before, from the middle to both ends: at an end it may meet
// a pole, which has every parameter.
class CurveFeet {
 public:
  // Both outlive it.
  CurveFeet(Feet& feet, const nurbs::Curve& curve);

  Vec2 at(double t);  // parameter of the curve; remembered
  // Along the curve, by its parameter; nothing at a pole.
  std::optional<Vec2> derivative(double t);
  [[nodiscard]] const Vec2& first() const { return feet_.begin()->second; }
  [[nodiscard]] const Vec2& last() const { return std::prev(feet_.end())->second; }

 private:
  Feet& surface_;
  const nurbs::Curve& curve_;
  std::map<double, Vec2> feet_;
};

// The curve in the parameters, with the curve's own parameter: piecewise cubic, its points on the surface
// within `tolerance` (model units), or as far as the curve is off the surface, of the feet, at three places
// between every two nodes; on a parallelogram exact. Nothing where that takes too many nodes, or the curve is
// so far off that it is the one that holds (flat_holds).
std::optional<nurbs::Curve> flat_along(Feet& feet, const nurbs::Curve& curve, double tolerance);

// Gives edges of a face's loops (and of those round a whole parallelogram) that have no curve in the
// parameters one. A loop of which they would leave the surface's range, or leave gaps that are no poles,
// stays as it is.
void give_flats(Face& face, double tolerance);

// Edges that go from the end of a curve in the parameters to the start of the next one, where both are one
// pole (within `tolerance`, model units) and the file has left that out. Of loops in which every edge has a
// curve in the parameters.
void give_poles(Loop& loop, const nurbs::Surface& surface, double tolerance);

}  // namespace selvage::cad
