// OpenCASCADE's faces and curves as those of a cad::Model. Internal to the module selvage_occt.
#pragma once

#include <StepShape_FaceSurface.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <unordered_map>

#include "cad/model.h"

namespace selvage::formats::step {

// The edges that the faces of a part share have one number each.
using EdgeIds = std::unordered_map<const TopoDS_TShape*, int>;

// Surface, side, boundary and area, placed; name, colour and origin are the caller's. `entity`, where it is
// not null, is the face in the file: of a B-spline surface its own numbers are taken, times `scale`, since
// OpenCASCADE makes closed ones periodic. A boundary that runs along the surface's natural border all round
// is none. Exceptions: Standard_Failure.
cad::Face to_face(const TopoDS_Face& face, const Handle(StepShape_FaceSurface) & entity, double scale,
                  EdgeIds& ids);

// By OpenCASCADE's own integration, span by span.
double area_of(const TopoDS_Shape& face);

// All lengths times `factor`.
void stretch(nurbs::Curve& curve, double factor);
void stretch(cad::Face& face, double factor);

// Without points where the edge has no curve in space.
nurbs::Curve to_curve(const TopoDS_Edge& edge);

}  // namespace selvage::formats::step
