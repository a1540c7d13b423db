// Edges of other programs' files that are not where one would look for them: beyond the seam of their
// surface, off the curves that the file has in its parameters, or without ends.
#include <gtest/gtest.h>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <GProp_GProps.hxx>
#include <Geom2d_Line.hxx>
#include <GeomAPI_PointsToBSpline.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Line.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <fstream>
#include <gp_Ax3.hxx>
#include <gp_Lin.hxx>
#include <gp_Pln.hxx>
#include <numbers>
#include <sstream>

#include "cad/measure.h"
#include "cad/region.h"
#include "formats/registry.h"
#include "nurbs/basis.h"
#include "unit/cad/surfaces.h"
#include "unit/core/scratch_folder.h"

namespace selvage {
namespace {

using std::numbers::pi;

std::string occt_text(const TopoDS_Shape& shape) {
  STEPControl_Controller::Init();
  Interface_Static::SetIVal("write.surfacecurve.mode", 0);
  STEPControl_Writer writer;
  EXPECT_EQ(writer.Transfer(shape, STEPControl_AsIs), IFSelect_RetDone);
  const test::ScratchFolder folder;
  EXPECT_EQ(writer.Write((folder / "a.stp").c_str()), IFSelect_RetDone);
  std::ifstream file(folder / "a.stp");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::optional<cad::Model> read_text(const std::string& text, std::vector<std::string>* said = nullptr) {
  Diagnostics diagnostics;
  std::optional<cad::Model> model =
      formats::step::descriptor().read_model(Source::from_memory(text, "a.stp"), diagnostics);
  for (const Message& message : diagnostics.messages()) {
    EXPECT_NE(message.severity, Severity::error) << to_string(message);
    if (said != nullptr) said->push_back(message.text);
  }
  return model;
}

// A boundary in parameters may run over the seam of a closed surface: the face that is written is the one
// across the seam, where OpenCASCADE takes a B-spline surface to end.
TEST(StepEdges, ABoundaryAcrossTheSeam) {
  const double radius = 2, height = 3, share = 0.3;
  for (const double start : {0.1, 0.85, -0.2}) {  // in turns
    cad::Part part;
    cad::Face& face = part.faces.emplace_back();
    face.surface = test::cylinder(radius, height);
    const double first = face.surface.first_u(), turn = face.surface.last_u() - first;
    const double from = first + start * turn, to = from + share * turn;
    const double low = std::lerp(face.surface.first_v(), face.surface.last_v(), 0.2),
                 high = std::lerp(face.surface.first_v(), face.surface.last_v(), 0.7);
    face.loops = {test::rectangle(from, to, low, high)};
    Result<OutputFile> output = OutputFile::in_memory();
    ASSERT_TRUE(output.ok());
    formats::SurfaceOptions options;
    options.has_others = true;
    auto writer = formats::step::descriptor().open_bodies(*output, options);
    ASSERT_TRUE(writer.ok());
    const Status added = (*writer)->add_part(part);
    ASSERT_TRUE(added.ok()) << added.error().text;
    ASSERT_TRUE((*writer)->finish().ok());
    std::istringstream text(*output->contents());
    STEPControl_Reader reader;
    ASSERT_EQ(reader.ReadStream("a.stp", text), IFSelect_RetDone);
    reader.TransferRoots();
    const TopoDS_Shape shape = reader.OneShape();
    EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(shape, properties, 1e-10);
    // The parameters of the quarters of rational circles are not quite angles: the edges' places are the
    // surface's own.
    const auto angle_at = [&](double u) {
      double inside = u - turn * std::floor((u - first) / turn);
      const Vec3 p = nurbs::evaluate(face.surface, inside, face.surface.first_v());
      return std::atan2(p.y(), p.x());
    };
    double angle = angle_at(to) - angle_at(from);
    angle -= 2 * pi * std::floor(angle / (2 * pi));
    EXPECT_NEAR(properties.Mass(), radius * angle * 0.5 * height, 1e-8) << start;
    const double middle = angle_at(from) + 0.5 * angle;
    const gp_Pnt centre = properties.CentreOfMass();
    EXPECT_NEAR(std::atan2(centre.Y(), centre.X()), std::remainder(middle, 2 * pi), 1e-6) << start;
  }
}

// A sleeve whose upper rim waves by 0.01. Within the file's uncertainty, which is larger, OpenCASCADE takes a
// straight line in the parameters for it.
TEST(StepEdges, CurvesInParametersThatAreOff) {
  BRep_Builder builder;
  const Handle(Geom_CylindricalSurface) surface = new Geom_CylindricalSurface(gp_Ax3(), 1);
  TColgp_Array1OfPnt points(1, 33);
  for (int i = 1; i <= 33; ++i) {
    const double a = pi * (i - 1) / 32;
    points.SetValue(i, gp_Pnt(std::cos(a), std::sin(a), 1 + 0.01 * std::sin(2 * a)));
  }
  const Handle(Geom_BSplineCurve) wave = GeomAPI_PointsToBSpline(points, 3, 3, GeomAbs_C2, 1e-6).Curve();
  TopoDS_Face face;
  builder.MakeFace(face, surface, 1e-7);
  TopoDS_Wire wire;
  builder.MakeWire(wire);
  std::array<TopoDS_Vertex, 4> corners;
  const std::array<gp_Pnt, 4> at = {gp_Pnt(1, 0, 0), gp_Pnt(-1, 0, 0), gp_Pnt(-1, 0, 1), gp_Pnt(1, 0, 1)};
  for (std::size_t i = 0; i < 4; ++i) builder.MakeVertex(corners[i], at[i], 0.02);
  const auto add = [&](const Handle(Geom_Curve) & curve, const gp_Pnt2d& place, const gp_Dir2d& along,
                       const std::array<double, 2>& range, std::size_t from, std::size_t to, bool backward) {
    TopoDS_Edge edge;
    builder.MakeEdge(edge, curve, 0.02);
    builder.UpdateEdge(edge, new Geom2d_Line(place, along), face, 0.02);
    builder.Range(edge, range[0], range[1]);
    builder.Add(edge, corners[from].Oriented(TopAbs_FORWARD));
    builder.Add(edge, corners[to].Oriented(TopAbs_REVERSED));
    builder.Add(wire, backward ? edge.Reversed() : TopoDS_Shape(edge));
  };
  const Handle(Geom_BSplineCurve) low = Handle(Geom_BSplineCurve)::DownCast(wave->Copy());
  for (int i = 1; i <= low->NbPoles(); ++i) low->SetPole(i, gp_Pnt(low->Pole(i).X(), low->Pole(i).Y(), 0));
  // Their parameters are angles, nearly: as many as the points have, from 0 to 1.
  const double last = wave->LastParameter();
  const gp_Dir2d round(1, 0), up(0, 1);
  Handle(Geom_BSplineCurve) top = wave;
  for (const Handle(Geom_BSplineCurve) & curve : {low, top}) {
    TColStd_Array1OfReal knots = curve->Knots();
    for (int i = knots.Lower(); i <= knots.Upper(); ++i) knots.SetValue(i, knots.Value(i) * pi / last);
    curve->SetKnots(knots);
  }
  add(low, {0, 0}, round, {0, pi}, 0, 1, false);
  add(new Geom_Line(at[1], gp_Dir(0, 0, 1)), {pi, 0}, up, {0, 1}, 1, 2, false);
  add(top, {0, 1}, round, {0, pi}, 3, 2, true);
  add(new Geom_Line(at[0], gp_Dir(0, 0, 1)), {0, 0}, up, {0, 1}, 0, 3, true);
  wire.Closed(true);
  builder.Add(face, wire);
  std::string text = occt_text(face);
  const std::size_t uncertainty = text.find("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(");
  ASSERT_NE(uncertainty, std::string::npos);
  const std::size_t value = text.find("MEASURE(", uncertainty + 20) + 8;
  text.replace(value, text.find(')', value) - value, "5.E-02");
  const std::optional<cad::Model> model = read_text(text);
  ASSERT_TRUE(model && model->face_count() == 1);
  const cad::Face& found = model->parts[0].faces[0];
  const cad::Region region(found);
  ASSERT_TRUE(region.is_known());
  // Which points of the cylinder are the face's: those below the wave.
  std::size_t seen = 0;
  for (int i = 1; i < 40; ++i)
    for (const double off : {-0.008, -0.002, 0.002, 0.008}) {
      const double u = std::lerp(found.surface.first_u(), found.surface.last_u(), i / 40.0);
      const Vec3 side = nurbs::evaluate(found.surface, u, found.surface.first_v());
      const double angle = std::atan2(side.y(), side.x());
      if (angle < 0.02 || angle > pi - 0.02) continue;
      const double height = 1 + 0.01 * std::sin(2 * angle) + off;
      const Vec3 bottom = side, top_end = nurbs::evaluate(found.surface, u, found.surface.last_v());
      const double share = (height - bottom.z()) / (top_end.z() - bottom.z());
      if (share < 0 || share > 1) continue;
      EXPECT_EQ(region.contains(u, std::lerp(found.surface.first_v(), found.surface.last_v(), share)),
                off < 0)
          << angle << ' ' << off;
      ++seen;
    }
  EXPECT_GT(seen, 100U);
}

// A rational surface without its name is read (a rational curve without one is refused: inspect_test.cpp).
TEST(StepEdges, ASurfaceWithoutItsName) {
  const Handle(Geom_Surface) quarter =
      new Geom_RectangularTrimmedSurface(new Geom_CylindricalSurface(gp_Ax3(), 1), 0.0, pi / 2, 0.0, 2.0);
  std::string text =
      occt_text(BRepBuilderAPI_MakeFace(GeomConvert::SurfaceToBSplineSurface(quarter), 1e-7).Face());
  const std::size_t surface = text.find("RATIONAL_B_SPLINE_SURFACE"), name = text.find("ITEM('')", surface);
  ASSERT_NE(name, std::string::npos);
  text.erase(name + 5, 2);
  std::vector<std::string> said;
  const std::optional<cad::Model> model = read_text(text, &said);
  ASSERT_TRUE(model && model->face_count() == 1);
  EXPECT_NEAR(cad::measures_of(model->parts[0]).area.value_or(0), pi, 1e-9);
  EXPECT_EQ(std::ranges::count_if(
                said, [](const std::string& words) { return words.ends_with("not even an empty one"); }),
            1);
}

TEST(StepEdges, LinesWithoutEndsAreToldAndLeftOut) {
  TopoDS_Compound both;
  BRep_Builder().MakeCompound(both);
  BRep_Builder().Add(both, BRepBuilderAPI_MakeEdge(gp_Lin(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), 0, 2).Edge());
  BRep_Builder().Add(both, BRepBuilderAPI_MakeEdge(gp_Lin(gp_Pnt(0, 1, 0), gp_Dir(1, 0, 0)), 0, 3).Edge());
  std::string text = occt_text(both);
  // The second one as the line that it is a part of.
  const std::size_t trimmed = text.rfind("TRIMMED_CURVE('',#");
  ASSERT_NE(trimmed, std::string::npos);
  const std::size_t id = text.rfind('#', trimmed), line = text.find('#', trimmed);
  const std::string part = text.substr(id, text.find(' ', id) - id),
                    whole = text.substr(line, text.find(',', line) - line);
  const std::size_t set = text.find(part + ")");
  ASSERT_NE(set, std::string::npos);
  text.replace(set, part.size(), whole);
  std::vector<std::string> said;
  const std::optional<cad::Model> model = read_text(text, &said);
  ASSERT_TRUE(model.has_value());
  ASSERT_EQ(model->curves.size(), 1U);
  EXPECT_LE((model->curves[0].curve.points.back() - Vec3(2, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(std::ranges::count(said, "a line without ends is left out"), 1);
}

}  // namespace
}  // namespace selvage
