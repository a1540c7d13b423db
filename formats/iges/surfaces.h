// Surfaces that have to know what bounds them, and how parameters of the file become those of B-splines.
#pragma once

#include <optional>
#include <vector>

#include "formats/iges/reading.h"
#include "nurbs/analytic.h"

namespace selvage::formats::iges {

// 108, 190 to 198 and what is offset (140) from one of them: by formula, some of them without end.
bool is_analytic(Reading& reading, const DirectoryEntry& entry);
std::optional<nurbs::Analytic> read_analytic(Reading& reading, const DirectoryEntry& entry, Parameters& in);
// What stands by itself: all of a finite one.
std::optional<nurbs::Surface> read_whole(Reading& reading, const DirectoryEntry& entry, Parameters& in);

// A 140: how far from which surface, and on whose side (the end of a normal in its middle). Both have the
// same parameters.
struct OffsetOf {
  Vec3 side = Vec3::Zero();
  double distance = 0;
  int base = 0;
};
std::optional<OffsetOf> read_offset(Parameters& in);

// What is due to a curve in the parameters that the standard gives to the surface at `pointer`, so that it
// is one in those of the B-spline `surface`: these run along arcs otherwise than the angle does.
class FlatMap {
 public:
  FlatMap(Reading& reading, int pointer, const nurbs::Surface& surface);

  // Nothing where it cannot be told. Straight lines along the parameters stay exact; others are interpolated
  // where the map is not the identity.
  [[nodiscard]] std::optional<nurbs::Curve> operator()(const nurbs::Curve& flat) const;

 private:
  struct Axis {
    double scale = 1, shift = 0;
    std::vector<double> angles;  // the arc's knots; empty: no arc

    [[nodiscard]] double operator()(double value) const;
    [[nodiscard]] bool is_identity() const { return angles.empty() && scale == 1 && shift == 0; }
  };
  [[nodiscard]] Vec3 at(const Vec3& p) const { return {u_(p.x()), v_(p.y()), 0}; }

  bool is_known_ = true;
  Axis u_, v_;
};

// Gives the face the surface at `pointer`, its own transformation applied: one by formula as far as the
// face's loops reach, every other one as it is. Nothing after by.fail() or by.give_up().
std::optional<FlatMap> put_surface(Reading& reading, int pointer, cad::Face& face, Parameters& by);

// Files differ in which way a curve in the parameters runs where an edge is used backwards: the curve in
// space decides.
void align_flat(cad::Edge& edge, const nurbs::Surface& surface);

}  // namespace selvage::formats::iges
