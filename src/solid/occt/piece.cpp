#include "solid/occt/piece.h"

#include <fmt/format.h>

#include <BRepCheck_Analyzer.hxx>
#include <BRep_Builder.hxx>
#include <Geom_Line.hxx>
#include <Geom_Plane.hxx>
#include <Precision.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <cmath>

#include "solid/occt/guard.h"
#include "solid/occt/shape.h"

namespace selvage::solid::occt {

namespace {

Handle(Geom_Curve) spatial(const fabric::PieceEdge& edge, double scale) {
  if (!edge.is_line()) return spatial_curve(edge.curve, scale);
  const gp_Pnt first = point(edge.curve.points.front(), scale);
  return new Geom_Line(first, gp_Dir(gp_Vec(first, point(edge.curve.points.back(), scale))));
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
  verdict.area = area_of(shape) / (scale * scale);
  if (!verdict.valid)
    verdict.defects.push_back(error(
        Kind::geometry, fmt::format("piece '{}': OpenCASCADE finds no valid face in its outline", piece.name),
        {.place = piece.place}));
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
