#include "solid/occt/faults.h"

#include <fmt/format.h>

#include <BRepAdaptor_Curve.hxx>
#include <BRepCheck.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepCheck_ListIteratorOfListOfStatus.hxx>
#include <BRepCheck_ListOfStatus.hxx>
#include <BRepCheck_Result.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <cctype>
#include <set>
#include <sstream>

namespace selvage::solid::occt {

namespace {

std::string_view words_for(BRepCheck_Status status, const TopoDS_Shape& part) {
  const bool is_alone = part.ShapeType() != TopAbs_SHELL && part.ShapeType() != TopAbs_SOLID;
  switch (status) {
    case BRepCheck_InvalidPointOnCurve:
    case BRepCheck_InvalidPointOnCurveOnSurface:
    case BRepCheck_InvalidPointOnSurface:
      return "a vertex lies off its curve or surface";
    case BRepCheck_InvalidCurveOnSurface:
    case BRepCheck_InvalidCurveOnClosedSurface:
    case BRepCheck_InvalidSameParameterFlag:
      return "an edge lies off its face";
    case BRepCheck_SelfIntersectingWire:
    case BRepCheck_IntersectingWires:
      return "the outline of a face crosses itself";
    case BRepCheck_InvalidDegeneratedFlag:
      return "an edge has no length";
    case BRepCheck_BadOrientation:
    case BRepCheck_BadOrientationOfSubshape:
    case BRepCheck_UnorientableShape:
      return is_alone ? "the outline does not run round the face"
                      : "a face is turned inside out against its neighbour";
    case BRepCheck_NotClosed:
    case BRepCheck_FreeEdge:
      return "the shell is not closed";
    default:
      return "the shape is not valid";
  }
}

std::string_view remedy_for(BRepCheck_Status status) {
  switch (status) {
    case BRepCheck_SelfIntersectingWire:
    case BRepCheck_IntersectingWires:
      return "look for a section that crosses itself at this end";
    case BRepCheck_BadOrientation:
    case BRepCheck_BadOrientationOfSubshape:
    case BRepCheck_UnorientableShape:
      return "let the sections of the grid run round all in one direction";
    default:
      return "build the ends anew from the body, or check the control points there";
  }
}

// OpenCASCADE's own name for it.
std::string name_of(BRepCheck_Status status) {
  std::ostringstream name;
  BRepCheck::Print(status, name);
  std::string text = name.str();
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.pop_back();
  return text;
}

}  // namespace

gp_Pnt place_of(const TopoDS_Shape& shape) {
  if (shape.ShapeType() == TopAbs_VERTEX) return BRep_Tool::Pnt(TopoDS::Vertex(shape));
  if (shape.ShapeType() == TopAbs_EDGE) {
    const TopoDS_Edge& edge = TopoDS::Edge(shape);
    if (!BRep_Tool::Degenerated(edge)) {
      const BRepAdaptor_Curve curve(edge);
      return curve.Value(0.5 * (curve.FirstParameter() + curve.LastParameter()));
    }
  }
  TopTools_IndexedMapOfShape vertices;
  TopExp::MapShapes(shape, TopAbs_VERTEX, vertices);
  return vertices.IsEmpty() ? gp_Pnt() : BRep_Tool::Pnt(TopoDS::Vertex(vertices(1)));
}

std::vector<Fault> faults_of(const TopoDS_Shape& shape) {
  std::vector<Fault> faults;
  const BRepCheck_Analyzer analyzer(shape);
  if (analyzer.IsValid()) return faults;
  std::set<BRepCheck_Status> known;
  const auto add = [&](const BRepCheck_ListOfStatus& statuses, const TopoDS_Shape& part) {
    for (BRepCheck_ListIteratorOfListOfStatus it(statuses); it.More(); it.Next())
      if (it.Value() != BRepCheck_NoError && known.insert(it.Value()).second)
        faults.push_back(
            {words_for(it.Value(), part), remedy_for(it.Value()), name_of(it.Value()), place_of(part)});
  };
  TopTools_IndexedMapOfShape parts;
  TopExp::MapShapes(shape, parts);
  for (int i = 1; i <= parts.Extent(); ++i) {
    const Handle(BRepCheck_Result)& result = analyzer.Result(parts(i));
    if (result.IsNull()) continue;
    add(result->Status(), parts(i));
    for (result->InitContextIterator(); result->MoreShapeInContext(); result->NextShapeInContext())
      add(result->StatusOnShape(), parts(i));
  }
  if (faults.empty())
    faults.push_back(
        {words_for(BRepCheck_NoError, shape), remedy_for(BRepCheck_NoError), {}, place_of(shape)});
  return faults;
}

std::string to_string(const Fault& fault) {
  return fault.name.empty() ? std::string(fault.words) : fmt::format("{} ({})", fault.words, fault.name);
}

}  // namespace selvage::solid::occt
