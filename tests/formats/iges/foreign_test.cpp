// Solids that OpenCASCADE makes and writes, in its faces mode and its B-rep mode: what we read of them, and
// what it reads again of what we write then.
#include <gtest/gtest.h>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>

#include "formats/iges/files.h"
#include "formats/iges/occt_reader.h"
#include "formats/iges/occt_solids.h"
#include "formats/iges/reading.h"
#include "formats/registry.h"
#include "nurbs/measure.h"

namespace selvage::test {

namespace {

double area_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, 1e-10);
  return properties.Mass();
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
  for (const OcctSample& sample : occt_solids()) {
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
    EXPECT_NEAR(again.area, sample.area > 0 ? sample.area : area_of(sample.shape), 1e-6 * again.area);
    double volume = 0;
    for (const OcctSolid& solid : again.solids) volume += solid.volume;
    EXPECT_NEAR(volume, sample.volume, 1e-6 * sample.volume);
  }
}

INSTANTIATE_TEST_SUITE_P(Modes, Foreign, testing::Bool(),
                         [](const auto& mode) { return std::string(mode.param ? "Brep" : "Faces"); });

}  // namespace

}  // namespace selvage::test
