// Surfaces whose distances are known, and the same surfaces in other forms.
#pragma once

#include "cad/model.h"
#include "nurbs/spline.h"

namespace selvage::test {

// A cylinder about z, exactly round (rational quadratics), from z = 0 to `height`; u runs round from +x.
nurbs::Surface cylinder(double radius, double height, double x = 0, double y = 0);

// A wavy bicubic tube along x of 18 x 16 control points, clamped, closed round.
nurbs::Surface wavy_tube(double y = 0);

// A wavy sheet over [0, 1]^2, bicubic, 7 x 6 control points; not closed.
nurbs::Surface sheet();

nurbs::Surface swapped(const nurbs::Surface& surface);
nurbs::Surface backward_v(const nurbs::Surface& surface);
// With every knot moved by an affine map of u.
nurbs::Surface stretched(const nurbs::Surface& surface, double scale, double shift);
// Knots inserted along v; the same shape.
nurbs::Surface refined_v(const nurbs::Surface& surface, const std::vector<double>& knots);
// The part between two parameters of v.
nurbs::Surface cut_v(const nurbs::Surface& surface, double v0, double v1);
// A surface closed in u, begun at the parameter u = at instead.
nurbs::Surface reseamed(const nurbs::Surface& surface, double at);

nurbs::Curve straight(const Vec3& from, const Vec3& to);
// Round a rectangle of the parameters, which is given in these alone: to the left, or `turned`.
cad::Loop rectangle(double u0, double u1, double v0, double v1, bool turned = false);
cad::Face face_of(const nurbs::Surface& surface, std::vector<cad::Loop> loops);
cad::Part part_of(const std::string& name, const std::vector<nurbs::Surface>& surfaces);

}  // namespace selvage::test
