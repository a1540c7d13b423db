// A yarn as an OpenCASCADE solid. Internal to the module selvage_occt.
#pragma once

#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TopoDS_Shape.hxx>
#include <vector>

#include "core/diagnostics.h"
#include "yarn/body.h"

namespace selvage::solid::occt {

// Two places nearer than this share of the yarn's thickness are one place.
inline constexpr double relative_tolerance = 1e-7;

struct YarnShape {
  TopoDS_Shape
      shape;  // a solid; an open shell when the yarn has ends `none` or an end that does not meet its body
  bool closed = false;           // every edge has its two faces
  std::vector<Message> defects;  // why an end does not meet its body
};

// The topology is stated, not found by sewing: body and end face share the edges whose curve is the body's
// own end curve (patch: its four quarters). Curves in parameter space are straight lines, exact for every
// face but a planar one, where they are the control points in the plane. Nothing is moved to make a thing
// fit: an end face further from the body's end curve than relative_tolerance of the thickness keeps edges of
// its own, so that the shell is open.
//
// All lengths are multiplied by `scale`. OpenCASCADE takes lengths under 1e-7 for zero, whatever the unit, so
// a check asks for a scale that brings the yarn's thickness near 1 (unit_scale). Exceptions:
// Standard_Failure, for what OpenCASCADE refuses (a knot of too high multiplicity, ...).
YarnShape build_shape(const yarn::Body& body, double scale);

gp_Pnt point(const Vec3& p, double scale);
// Of its faces, to 1e-9.
double area_of(const TopoDS_Shape& shape);
// The same numbers as OpenCASCADE's, all lengths multiplied by `scale`. Exceptions: Standard_Failure.
Handle(Geom_BSplineCurve) spatial_curve(const nurbs::Curve& curve, double scale);
Handle(Geom_BSplineSurface) spatial_surface(const nurbs::Surface& surface, double scale);

// A power of two, so that scaling costs no bit, that brings the thickness of the yarn into [0.5, 2).
double unit_scale(const yarn::Body& body);

// The square root of the first section's area, file units; for a body without one, a tenth of its box's
// diagonal.
double thickness(const yarn::Body& body);

}  // namespace selvage::solid::occt
