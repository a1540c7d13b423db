// Solids that OpenCASCADE makes and writes, in its faces mode and its B-rep mode: what we read of them, and
// what it reads again of what we write then.
#include <gtest/gtest.h>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <gp_Trsf.hxx>

#include <cmath>
#include <fstream>
#include <numbers>

#include "formats/iges/files.h"
#include "formats/iges/occt_reader.h"
#include "formats/iges/reading.h"
#include "formats/registry.h"
#include "nurbs/measure.h"

namespace selvage::test {

namespace {

using std::numbers::pi;

struct Sample {
  std::string name;
  TopoDS_Shape shape;
  int faces = 0;
  int untrimmed = 0;  // of them, by us
  double volume = 0;  // by formula
  int only_brep = 0;  // untrimmed in the B-rep mode only: there planes have no border of their own
};

TopoDS_Shape placed(const TopoDS_Shape& shape) {
  gp_Trsf turn, shift;
  turn.SetRotation(gp_Ax1(gp_Pnt(1, 2, 3), gp_Dir(1, 2, 2)), 0.7);
  shift.SetTranslation(gp_Vec(5, -3, 2));
  return BRepBuilderAPI_Transform(shape, shift * turn, true).Shape();
}

std::vector<Sample> samples() {
  std::vector<Sample> all;
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

double area_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, 1e-10);
  return properties.Mass();
}

std::string bytes_of(const std::filesystem::path& file) {
  return std::string(Source::open(file).value().bytes());
}

std::filesystem::path write_again(const cad::Model& model) {
  const auto path = scratch() / "again.igs";
  auto opened = OutputFile::create(path);
  OutputFile& file = opened.value();
  auto made = formats::iges::descriptor().open_bodies(file, surfaces(model.units));
  formats::BodyWriter* const writer = made.value().get();
  for (cad::Part part : model.parts) {
    part.group = "";
    const Status status = writer->add_part(part);
    EXPECT_TRUE(status.ok()) << to_string(status.error());
  }
  EXPECT_TRUE(writer->finish().ok());
  EXPECT_TRUE(file.commit().ok());
  return path;
}

class Foreign : public testing::TestWithParam<bool> {};

TEST_P(Foreign, SolidsOfOpenCascade) {
  for (const Sample& sample : samples()) {
    SCOPED_TRACE(sample.name);
    const auto file = write_with_occt(sample.shape, GetParam());
    const IgesReading reading = read_iges(bytes_of(file));
    ASSERT_TRUE(reading.model) << reading.text();
    EXPECT_EQ(reading.text(), "");
    EXPECT_TRUE(reading.model->unknown.empty());
    ASSERT_EQ(static_cast<int>(reading.model->face_count()), sample.faces);
    int untrimmed = 0;
    double flux = 0;
    for (const cad::Part& part : reading.model->parts) {
      if (GetParam()) {
        EXPECT_EQ(part.kind, cad::Part::Kind::solid);
      }
      for (const cad::Face& face : part.faces) {
        if (!face.loops.empty()) continue;
        ++untrimmed;
        flux += (face.reversed ? -1 : 1) * nurbs::volume_flux(face.surface, Vec3::Zero());
      }
    }
    EXPECT_EQ(untrimmed, GetParam() ? sample.untrimmed : sample.untrimmed - sample.only_brep);
    if (untrimmed == sample.faces && GetParam()) {
      EXPECT_NEAR(flux, sample.volume, 1e-6 * sample.volume);
    }
    // There again.
    const OcctReading again = read_with_occt(write_again(*reading.model), 1e-5);
    EXPECT_EQ(again.load_fails, 0);
    EXPECT_EQ(again.faces, sample.faces);
    EXPECT_NEAR(again.area, area_of(sample.shape), 1e-6 * again.area);
    double volume = 0;
    for (const OcctSolid& solid : again.solids) volume += solid.volume;
    EXPECT_NEAR(volume, sample.volume, 1e-6 * sample.volume);
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, Foreign, testing::Bool(),
                         [](const auto& mode) { return std::string(mode.param ? "Brep" : "Faces"); });

}  // namespace

}  // namespace selvage::test
