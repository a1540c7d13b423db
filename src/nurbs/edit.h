// Moving one joint of a B-spline curve: methods.md, 4, after ../shared/references 003 (Wang and Lin 2006),
// with the values of the basis functions at any knots instead of the 1 4 1 of uniform ones.
//
// The joints of a curve are its breakpoints, counted from 1: the first and the last are its ends. A joint is
// sum R_i v_i over the basis functions that do not vanish there: three at a simple knot of a cubic, one (the
// end point) at a clamped end. A closed curve (clamped form, first point equal to the last to the bit) is
// edited as the periodic cubic that it is, and stays as smooth at its seam as it was: the seam is joint 1,
// and a control point of the periodic form that is near it is held by up to two points at each end of the
// clamped form.
//
// In every function: points and weights that are not named as changed keep their bits, and knots all do.
// Errors (geometry): no such joint; an inner joint that stands on its control point (an arc's end, where a
// move would make a corner); a closed curve that is no cubic of at least three spans with simple knots.
#pragma once

#include "core/diagnostics.h"
#include "core/vec.h"
#include "nurbs/spline.h"

namespace selvage::nurbs {

// Joints of the curve; on a closed one the seam counts once.
int joint_count(const Curve& curve, bool closed);

// Brings the joint to the target by one control point, the one with the largest share in it: the middle
// one of three on uniform knots. The joint meets the target to 1e-14 of the coordinates' size; a cubic
// changes in the four segments of that control point (fewer next to an end).
Result<Curve> move_joint_by_control(const Curve& curve, bool closed, int joint, const Vec3& target);

// What a weight of the outer two control points may become, in units of the middle one's, and its inverse: a
// weight beyond has no more shape to give, and costs the systems that read it their accuracy.
inline constexpr double largest_weight_ratio = 1000.0;

// Brings the joint to the target by weights. One weight, when the target is on the line through the joint
// and that control point (four segments change); otherwise those of the outer two (six segments). Positions
// are compared to 1e-9 of the control triangle's size. Errors (geometry), each with the nearest point that
// can be reached: the target lies off the triangle's plane, outside the triangle, or needs a weight beyond
// largest_weight_ratio; other than three basis functions at the joint.
Result<Curve> move_joint_by_weight(const Curve& curve, bool closed, int joint, const Vec3& target);

// The point nearest to the target where move_joint_by_weight can bring the joint. As one outer weight runs
// through its range with the other fixed, the joint runs along a straight line through that control point:
// the two ranges enclose a plane quadrilateral, convex for it is the common part of two wedges. The nearest
// point is the foot of the perpendicular on its plane or, when that is outside, the nearest one of its edges.
Result<Vec3> nearest_by_weight(const Curve& curve, bool closed, int joint, const Vec3& target);

// Moves the joint along `direction` (any length but zero), by the control point of move_joint_by_control,
// until the curve has that arc length (to 1e-12 of it), and no farther than needed. The length is a convex
// function of the displacement, since every derivative C'(t) is an affine one. Errors (geometry): the curve
// gets no shorter than L that way, which is named; a length of more than a million times the present one.
Result<Curve> move_joint_to_length(const Curve& curve, bool closed, int joint, double length,
                                   const Vec3& direction);

}  // namespace selvage::nurbs
