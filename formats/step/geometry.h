// Curves and surfaces of OpenCASCADE and of STEP entities as B-splines. Internal to the module selvage_occt.
#pragma once

#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>
#include <StepGeom_Surface.hxx>
#include <gp_Trsf.hxx>
#include <optional>

#include "cad/distance.h"
#include "nurbs/spline.h"

namespace selvage::formats::step {

// Exceptions of all of these: Standard_Failure.

// Clamped; exact for all but offset curves. The parameters are those of the curve only where it is a line or
// a B-spline.
nurbs::Curve to_spline(const Handle(Geom_Curve) & curve, double first, double last);
// The same in parameter space, z = 0.
nurbs::Curve to_spline(const Handle(Geom2d_Curve) & curve, double first, double last);

// The surface over `range`, clamped, or the whole of a B-spline surface where `range` covers it.
nurbs::Surface to_spline(const Handle(Geom_Surface) & surface, const cad::Range& range);
// Does to_spline give a surface of the same parameters?
bool keeps_parameters(const Handle(Geom_Surface) & surface);

// A B-spline surface with the file's own numbers, its points multiplied by `scale`; nothing for other
// surfaces and for numbers that do not fit together.
std::optional<nurbs::Surface> exact_spline(const Handle(StepGeom_Surface) & surface, double scale);

// Of the surface's parameters; infinite where it has no end.
cad::Range bounds_of(const Handle(Geom_Surface) & surface);

// In place; nothing changes under the identity.
void place(std::vector<Vec3>& points, const gp_Trsf& placement);

Vec3 vector_of(const gp_Pnt& p);
Vec3 vector_of(const gp_Pnt2d& p);

}  // namespace selvage::formats::step
