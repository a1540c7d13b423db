#include "solid/occt/piece.h"

#include <fmt/format.h>

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>

#include "solid/occt/guard.h"

namespace selvage::solid::occt {

namespace {

constexpr double area_precision = 1e-9;  // relative

gp_Pnt point(const Vec3& p, double scale) {
  return {scale * p.x(), scale * p.y(), scale * p.z()};
}

Handle(Geom_Curve) spatial(const fabric::PieceEdge& edge, double scale) {
  const std::vector<Vec3>& points = edge.curve.points;
  const gp_Pnt first = point(points.front(), scale);
  if (edge.is_line()) return new Geom_Line(first, gp_Dir(gp_Vec(first, point(points.back(), scale))));
  TColgp_Array1OfPnt poles(1, 4);
  for (int i = 0; i < 4; ++i) poles.SetValue(i + 1, point(points[static_cast<std::size_t>(i)], scale));
  TColStd_Array1OfReal knots(1, 2);
  knots.SetValue(1, 0.0);
  knots.SetValue(2, 1.0);
  TColStd_Array1OfInteger multiplicities(1, 2);
  multiplicities.Init(4);
  return new Geom_BSplineCurve(poles, knots, multiplicities, 3);
}

double length_of(const fabric::PieceEdge& edge, double scale) {
  return point(edge.curve.points.front(), scale).Distance(point(edge.curve.points.back(), scale));
}

// A power of two that brings the piece's extent into [0.5, 2).
double unit_scale(const fabric::PieceShape& piece) {
  return std::exp2(-std::round(std::log2(piece.box.diagonal().norm())));
}

}  // namespace

TopoDS_Shape build_piece(const fabric::PieceShape& piece, double scale) {
  BRep_Builder builder;
  const std::size_t count = piece.edges.size();
  std::vector<TopoDS_Vertex> corners(count);
  for (std::size_t i = 0; i < count; ++i)
    builder.MakeVertex(corners[i], point(piece.edges[i].curve.points.front(), scale), Precision::Confusion());
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  for (std::size_t i = 0; i < count; ++i) {
    const fabric::PieceEdge& source = piece.edges[i];
    TopoDS_Edge edge;
    builder.MakeEdge(edge, spatial(source, scale), Precision::Confusion());
    builder.Add(edge, corners[i].Oriented(TopAbs_FORWARD));
    builder.Add(edge, corners[(i + 1) % count].Oriented(TopAbs_REVERSED));
    builder.Range(edge, 0.0, source.is_line() ? length_of(source, scale) : 1.0);
    builder.Add(wire, edge);
  }
  wire.Closed(true);
  TopoDS_Face face;
  builder.MakeFace(face, new Geom_Plane(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), Precision::Confusion());
  builder.Add(face, wire);
  TopoDS_Shell shell;
  builder.MakeShell(shell);
  builder.Add(shell, face);
  return shell;
}

FaceCheck check_piece(const fabric::PieceShape& piece) {
  FaceCheck verdict;
  const double scale = unit_scale(piece);
  const TopoDS_Shape shape = build_piece(piece, scale);
  verdict.valid = BRepCheck_Analyzer(shape).IsValid();
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, area_precision);
  verdict.area = properties.Mass() / (scale * scale);
  if (!verdict.valid) {
    Message message =
        error(Kind::geometry,
              fmt::format("piece '{}': OpenCASCADE finds no valid face in its outline", piece.name));
    message.place = piece.place;
    verdict.defects.push_back(std::move(message));
  }
  return verdict;
}

Result<std::vector<FaceCheck>> check_pieces(std::span<const fabric::PieceShape> pieces) {
  return guarded("the garment pieces", [&]() -> Result<std::vector<FaceCheck>> {
    std::vector<FaceCheck> verdicts;
    for (const fabric::PieceShape& piece : pieces) verdicts.push_back(check_piece(piece));
    return verdicts;
  });
}

}  // namespace selvage::solid::occt
