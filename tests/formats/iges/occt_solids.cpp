#include "formats/iges/occt_solids.h"

#include <gtest/gtest.h>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <GeomAPI_Interpolate.hxx>
#include <Geom_BSplineCurve.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <TColgp_HArray1OfPnt.hxx>
#include <gp_Trsf.hxx>

#include <numbers>

#include "core/source.h"
#include "formats/iges/files.h"

namespace selvage::test {

namespace {

using std::numbers::pi;

// What lies between a wavy spline and the line y = 0, x from 0 to 4, and its measures by a polygon of a
// million sides: to 1e-10.
struct UnderSpline {
  TopoDS_Shape face;
  double area = 0, first = 0;     // first moment: of y + 2
  double length = 0, turned = 0;  // of its border; the integral of y + 2 along it
};
UnderSpline under_a_spline() {
  const Handle(TColgp_HArray1OfPnt) points = new TColgp_HArray1OfPnt(1, 7);
  for (int i = 0; i < 7; ++i)
    points->SetValue(i + 1, gp_Pnt(4.0 * i / 6, 1.5 + 0.4 * ((i * 3) % 4) / 3.0, 0));
  GeomAPI_Interpolate interpolate(points, false, 1e-9);
  interpolate.Perform();
  const Handle(Geom_BSplineCurve) spline = interpolate.Curve();
  const gp_Pnt a(0, 0, 0), b(4, 0, 0), c = spline->EndPoint(), d = spline->StartPoint();
  BRepBuilderAPI_MakeWire wire(BRepBuilderAPI_MakeEdge(a, b), BRepBuilderAPI_MakeEdge(b, c),
                               BRepBuilderAPI_MakeEdge(spline), BRepBuilderAPI_MakeEdge(d, a));
  UnderSpline made{.face = BRepBuilderAPI_MakeFace(wire.Wire(), true).Shape()};
  const auto side = [&](const gp_Pnt& from, const gp_Pnt& to) {
    const double length = from.Distance(to);
    made.length += length;
    made.turned += length * (0.5 * (from.Y() + to.Y()) + 2);
  };
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(d, a)}) side(from, to);
  constexpr int sides = 1'000'000;
  const double t0 = spline->FirstParameter(), t1 = spline->LastParameter();
  gp_Pnt before = d;
  for (int k = 1; k <= sides; ++k) {
    const gp_Pnt at = spline->Value(t0 + (t1 - t0) * k / sides);
    side(before, at);
    const double dx = at.X() - before.X(), y = 0.5 * (before.Y() + at.Y());
    made.area += dx * y;
    made.first += dx * (y * y / 2 + 2 * y);
    before = at;
  }
  return made;
}

TopoDS_Shape placed(const TopoDS_Shape& shape) {
  gp_Trsf turn, shift;
  turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 2, 2)), 0.7);
  shift.SetTranslation(gp_Vec(5, -3, 2));
  return BRepBuilderAPI_Transform(shape, shift * turn, true).Shape();
}

}  // namespace

std::vector<OcctSample> occt_solids() {
  std::vector<OcctSample> all;
  all.push_back({"box", BRepPrimAPI_MakeBox(2, 3, 4).Shape(), 6, 6, 24});
  all.push_back({"cylinder", BRepPrimAPI_MakeCylinder(1.5, 4).Shape(), 3, 1, pi * 1.5 * 1.5 * 4});
  all.push_back({"sector", BRepPrimAPI_MakeCylinder(1.5, 4, 1.25).Shape(), 5, 3, 1.25 / 2 * 1.5 * 1.5 * 4});
  all.push_back({"cone", BRepPrimAPI_MakeCone(2, 1, 3).Shape(), 3, 1, pi * 3 / 3 * (4 + 2 + 1)});
  all.push_back({"pointed cone", BRepPrimAPI_MakeCone(2, 0, 3).Shape(), 2, 1, pi * 4});
  all.push_back({"sphere", BRepPrimAPI_MakeSphere(1.5).Shape(), 1, 1, 4.0 / 3 * pi * 1.5 * 1.5 * 1.5});
  all.push_back(
      {"half sphere", BRepPrimAPI_MakeSphere(1.5, 0, pi / 2).Shape(), 2, 1, 2.0 / 3 * pi * 1.5 * 1.5 * 1.5});
  all.push_back({"torus", BRepPrimAPI_MakeTorus(3, 1).Shape(), 1, 1, 2 * pi * pi * 3});
  all.push_back({"placed torus", placed(BRepPrimAPI_MakeTorus(3, 1, 2.0).Shape()), 3, 1, 2.0 * pi * 3});
  const gp_Ax2 across(gp_Pnt(1, 1.5, -1), gp_Dir(0, 0, 1));
  const TopoDS_Shape drilled =
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(2, 3, 4).Shape(), BRepPrimAPI_MakeCylinder(across, 0.5, 6).Shape())
          .Shape();
  all.push_back({"drilled box", placed(drilled), 7, 5, 24 - pi * 0.25 * 4, 4});
  const UnderSpline under = under_a_spline();
  all.push_back({"extruded spline", BRepPrimAPI_MakePrism(under.face, gp_Vec(0, 0, 1.5)).Shape(), 6, 4,
                 1.5 * under.area, 0, 2 * under.area + 1.5 * under.length});
  all.push_back({"revolved spline",
                 BRepPrimAPI_MakeRevol(under.face, gp_Ax1(gp_Pnt(0, -2, 0), gp_Dir(1, 0, 0)), 1.9).Shape(), 6,
                 2, 1.9 * under.first, 0, 2 * under.area + 1.9 * under.turned});
  all.push_back(
      {"placed cylinder", placed(BRepPrimAPI_MakeCylinder(1.5, 4).Shape()), 3, 1, pi * 1.5 * 1.5 * 4});
  return all;
}

std::filesystem::path write_with_occt(const TopoDS_Shape& shape, bool brep) {
  ::Message::DefaultMessenger()->ChangePrinters().Clear();
  IGESControl_Controller::Init();
  IGESControl_Writer writer("MM", brep ? 1 : 0);
  EXPECT_TRUE(writer.AddShape(shape));
  writer.ComputeModel();
  const auto file = scratch() / (brep ? "occt_brep.igs" : "occt_faces.igs");
  EXPECT_TRUE(writer.Write(file.c_str()));
  return file;
}

std::string bytes_of(const std::filesystem::path& file) {
  return std::string(Source::open(file).value().bytes());
}

}  // namespace selvage::test
