// Parts of a cad::Model as OpenCASCADE's shapes. Internal to the module selvage_occt.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Shape.hxx>
#include <optional>
#include <string>
#include <vector>

#include "cad/model.h"

namespace selvage::formats::step {

struct PartShape {
  // A solid; a shell or several in a compound where the faces leave gaps or are not said to be joined.
  TopoDS_Shape shape;
  bool closed = false;
  std::vector<TopoDS_Shape> faces;  // as they stand in `shape`, in the part's order; null: not there
};

// Faces share an edge where the part says so by its id; where they do not, edges that lie on each other
// within `tolerance` (the part's unit) become one. An untrimmed face has its surface's natural border.
// Surfaces keep every number. A solid of which every edge has both its curves, and an id that two uses have,
// is built as it is stated where OpenCASCADE finds that valid, rectangles whose parameters are lengths as
// planes. Exceptions: Standard_Failure.
PartShape build_part(const cad::Part& part, double tolerance);

// Why this is not what the part says, with a remedy; nothing where it is. A solid stays one, every face is
// there with as many boundaries and the area as it had, and OpenCASCADE's check (BRepCheck_Analyzer) finds
// nothing. Exceptions: Standard_Failure.
std::optional<std::string> flaw_of(const PartShape& built, const cad::Part& part);

// What OpenCASCADE made of the file that the part is from (cad::Part::kernel), in the part's unit; nothing
// where there is none, where it does not have the part's faces, or where its check finds it invalid.
// Exceptions: Standard_Failure.
std::optional<PartShape> kept_part(const cad::Part& part);

TopoDS_Edge build_edge(const nurbs::Curve& curve);

}  // namespace selvage::formats::step
