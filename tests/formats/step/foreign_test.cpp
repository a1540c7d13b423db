// Files that other programs wrote: OpenCASCADE's STEP and IGES (faces and solids), gmsh's STEP, FreeCAD's
// STEP and IGES. Counts and volumes are compared with what OpenCASCADE itself says of the shapes, and with
// the yarns that they were made of.
#include <gtest/gtest.h>
#include <unistd.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Controller.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gp_Ax2.hxx>
#include <numbers>
#include <sstream>

#include "built.h"
#include "cad/judge.h"
#include "fabric/from_cad.h"
#include "formats/registry.h"
#include "formats/step/face_flux.h"
#include "nurbs/measure.h"
#include "places.h"

namespace selvage {
namespace {

namespace fs = std::filesystem;
using formats::Descriptor;

class Folder {
 public:
  Folder() {
    std::string pattern = (fs::temp_directory_path() / "selvage-foreign-XXXXXX").string();
    EXPECT_NE(::mkdtemp(pattern.data()), nullptr);
    path_ = pattern;
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

std::vector<yarn::Body> bodies_of(const Source& source, std::optional<yarn::EndStyle> ends = {},
                                  bool as_published = false) {
  Diagnostics diagnostics;
  const auto fabric = formats::txt::descriptor().read_fabric(source, diagnostics);
  for (const Message& message : diagnostics.messages())
    EXPECT_NE(message.severity, Severity::error) << to_string(message);
  fabric::BuildOptions options;
  options.ends = ends;
  options.as_published = as_published;
  return fabric ? test::built(*fabric, options) : std::vector<yarn::Body>{};
}

std::vector<yarn::Body> sample(const std::string& name, const std::string& tolerance) {
  Result<Source> source = Source::open(fs::path(places::samples()) / (name + ".txt"));
  EXPECT_TRUE(source.ok()) << name;
  if (!source) return {};
  // A coarse tolerance makes small files; what is compared is the tube that is written.
  std::string text(source->bytes());
  if (const std::size_t given = text.find("\ntolerance"); given != std::string::npos)
    text.erase(given + 1, text.find('\n', given + 1) - given);
  text.insert(text.find('\n') + 1, "tolerance " + tolerance + "\n");
  return bodies_of(Source::from_memory(text, name + ".txt"));
}

void write_step(const std::vector<yarn::Body>& bodies, const std::string& path) {
  Result<OutputFile> output = OutputFile::create(path);
  ASSERT_TRUE(output.ok());
  auto writer = formats::step::descriptor().open_bodies(*output, {});
  ASSERT_TRUE(writer.ok());
  for (const yarn::Body& body : bodies) ASSERT_TRUE((*writer)->add(body).ok());
  ASSERT_TRUE((*writer)->finish().ok());
  ASSERT_TRUE(output->commit().ok());
}

// What OpenCASCADE says of a shape, in millimetres.
struct Facts {
  int faces = 0;
  std::vector<double> volumes;  // of its solids
};

Facts facts_of(const TopoDS_Shape& shape) {
  Facts facts;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) ++facts.faces;
  for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next()) {
    // About a point of the solid: far from it, what flows in and out would cancel.
    const gp_Pnt centre =
        BRep_Tool::Pnt(TopoDS::Vertex(TopExp_Explorer(it.Current(), TopAbs_VERTEX).Current()));
    GProp_GProps properties(centre);
    BRepGProp::VolumePropertiesGK(it.Current(), properties, 1e-12, false, true);
    double volume = 0.0;
    for (TopExp_Explorer face(it.Current(), TopAbs_FACE); face.More(); face.Next()) {
      const std::optional<double> flux = tests::flux_through(TopoDS::Face(face.Current()), centre);
      volume += flux.value_or(0.0);
      if (flux) continue;
      volume = properties.Mass();  // with trimmed planes: its quadrature, span by span
      break;
    }
    facts.volumes.push_back(volume);
  }
  return facts;
}

TopoDS_Shape occt_read(const std::string& path) {
  ::Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Controller::Init();
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(path.c_str()), IFSelect_RetDone);
  reader.TransferRoots();
  return reader.OneShape();
}

void occt_write_step(const TopoDS_Shape& shape, const std::string& path, const char* unit = "MM") {
  Interface_Static::SetCVal("write.step.unit", unit);
  Interface_Static::SetIVal("write.surfacecurve.mode", 1);
  STEPControl_Writer writer;
  ASSERT_EQ(writer.Transfer(shape, STEPControl_AsIs), IFSelect_RetDone);
  ASSERT_EQ(writer.Write(path.c_str()), IFSelect_RetDone);
}

void occt_write_iges(const TopoDS_Shape& shape, const std::string& path, bool brep) {
  IGESControl_Controller::Init();
  IGESControl_Writer writer("MM", brep ? 1 : 0);
  ASSERT_TRUE(writer.AddShape(shape));
  writer.ComputeModel();
  ASSERT_TRUE(writer.Write(path.c_str()));
}

struct Reading {
  std::optional<cad::Model> model;
  std::vector<yarn::Body> yarns;
};

Reading read(const Descriptor& format, const std::string& path) {
  SCOPED_TRACE(path);
  Reading reading;
  Result<Source> source = Source::open(path);
  EXPECT_TRUE(source.ok());
  if (!source) return reading;
  Diagnostics diagnostics;
  reading.model = format.read_model(*source, diagnostics);
  for (const Message& message : diagnostics.messages())
    EXPECT_NE(message.severity, Severity::error) << to_string(message);
  if (reading.model) reading.yarns = test::built(fabric::fabric_of(*reading.model, diagnostics));
  return reading;
}

int solids_in(const cad::Model& model) {
  int count = 0;
  for (const cad::Part& part : model.parts) count += part.kind == cad::Part::Kind::solid ? 1 : 0;
  return count;
}

// The largest relative deviation of volumes, in the same order.
double deviation(std::vector<double> a, std::vector<double> b) {
  EXPECT_EQ(a.size(), b.size());
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  double worst = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::max(worst, std::abs(a[i] / b[i] - 1.0));
  return worst;
}

std::vector<double> volumes_of(const std::vector<yarn::Body>& bodies) {
  std::vector<double> volumes;
  for (const yarn::Body& body : bodies) volumes.push_back(body.volume);
  return volumes;
}

// gmsh opens our STEP file with its OpenCASCADE kernel and writes its own.
TEST(ForeignGmsh, StepOfGmsh) {
  for (const char* name : {"plain4_grid", "ring", "filaments7"}) {
    SCOPED_TRACE(name);
    const Folder folder;
    const std::vector<yarn::Body> bodies = sample(name, "1e-2");
    write_step(bodies, folder / "own.stp");
    std::ofstream(folder / "write.geo")
        << "SetFactory(\"OpenCASCADE\");\nMerge \"own.stp\";\nSave \"gmsh.step\";\n";
    const std::string command =
        "cd '" + (folder / "") + "' && '" + places::gmsh() + "' write.geo -parse_and_exit > gmsh.log 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0);
    const Facts facts = facts_of(occt_read(folder / "gmsh.step"));
    ASSERT_EQ(facts.volumes.size(), bodies.size());
    const Reading reading = read(formats::step::descriptor(), folder / "gmsh.step");
    ASSERT_TRUE(reading.model.has_value());
    EXPECT_EQ(static_cast<int>(reading.model->face_count()), facts.faces);
    EXPECT_EQ(solids_in(*reading.model), static_cast<int>(bodies.size()));
    EXPECT_LT(deviation(volumes_of(reading.yarns), facts.volumes), 1e-6);
    EXPECT_LT(deviation(volumes_of(reading.yarns), volumes_of(bodies)), 1e-6);
  }
}

// As high degrees as OpenCASCADE has are evaluated as it does, and found to be right.
TEST(ForeignDegrees, UpToTwentyFive) {
  for (const int degree : {20, 21, 25}) {
    TColgp_Array2OfPnt poles(1, degree + 1, 1, 2);
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; j < 2; ++j) poles(i + 1, j + 1) = gp_Pnt(i, 10.0 * j, std::sin(1.0 * i + j));
    const Handle(Geom_BezierSurface) bezier = new Geom_BezierSurface(poles);
    const TopoDS_Shape face = BRepBuilderAPI_MakeFace(GeomConvert::SurfaceToBSplineSurface(bezier), 1e-7);
    const Folder folder;
    occt_write_step(face, folder / "high.step");
    occt_write_iges(face, folder / "high.igs", false);
    for (const auto& [format, file] : {std::pair(formats::step::descriptor(), "high.step"),
                                       std::pair(formats::iges::descriptor(), "high.igs")}) {
      const Reading reading = read(format, folder / file);
      ASSERT_TRUE(reading.model.has_value());
      ASSERT_EQ(reading.model->face_count(), 1U);
      const nurbs::Surface& surface = reading.model->parts.front().faces.front().surface;
      EXPECT_EQ(surface.degree_u, degree) << file;
      for (const double u : {0.0, 0.1, 0.5, 0.77, 1.0}) {
        const gp_Pnt there = bezier->Value(u, 0.3);
        const Vec3 here = nurbs::evaluate(surface, u, 0.3);
        EXPECT_NEAR(here.x(), degree * u, 1e-12) << file;  // Bernstein polynomials reproduce lines
        EXPECT_LT((here - Vec3(there.X(), there.Y(), there.Z())).norm(), 1e-8)
            << file;  // it uses powers of u
      }
      Findings findings;
      EXPECT_EQ(cad::judge(*reading.model, findings).borders, 4U);
    }
  }
}

// A face that is made anew with another area than the one that was read is not written.
TEST(ForeignAreas, AreFoundAgain) {
  const std::string path = places::tests() + "/fixtures/freecad/planar.step";
  const Reading reading = read(formats::step::descriptor(), path);
  ASSERT_TRUE(reading.model.has_value());
  cad::Part part = reading.model->parts.front();
  part.kernel.reset();  // it would be written as it was read
  double sum = 0;
  for (const cad::Part& one : reading.model->parts)
    for (const cad::Face& face : one.faces) sum += face.area.value_or(0);
  GProp_GProps whole;
  BRepGProp::SurfaceProperties(occt_read(path), whole, 1e-6);  // its adaptive quadrature
  EXPECT_NEAR(sum, whole.Mass(), 0.01 * whole.Mass());
  for (const double factor : {1.0, 2.0}) {
    Result<OutputFile> output = OutputFile::in_memory();
    ASSERT_TRUE(output.ok());
    auto writer = formats::step::descriptor().open_bodies(*output, {});
    ASSERT_TRUE(writer.ok());
    *part.faces.front().area *= factor;
    const Status added = (*writer)->add_part(part);
    EXPECT_EQ(added.ok(), factor == 1.0);
    const std::string said = added.ok() ? "" : added.error().text;
    EXPECT_EQ(said.find("has an area of") != std::string::npos, factor == 2.0) << said;
  }
}

// Solids of other programs keep their planes and cylinders, and their volume to the last digits, in any unit
// and place; where what was read is gone, they are made of their faces.
TEST(ForeignSolids, KeepTheirSurfaces) {
  const gp_Ax2 place(gp_Pnt(10, -3, 7), gp_Dir(1, 2, 2));
  const double volume = std::numbers::pi * 1.5 * 1.5 * 4;
  const Folder folder;
  const auto times = [](const std::string& text, const std::string& word) {
    std::size_t count = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
    return count;
  };
  for (const char* const unit : {"MM", "INCH"}) {
    SCOPED_TRACE(unit);
    STEPControl_Controller::Init();
    occt_write_step(BRepPrimAPI_MakeCylinder(place, 1.5, 4).Shape(), folder / "rod.step", unit);
    const Reading reading = read(formats::step::descriptor(), folder / "rod.step");
    ASSERT_TRUE(reading.model && reading.model->parts.size() == 1);
    for (const bool is_kept : {true, false}) {
      cad::Part part = reading.model->parts.front();
      if (!is_kept) part.kernel.reset();
      Result<OutputFile> output = OutputFile::create(folder / "again.step");
      ASSERT_TRUE(output.ok());
      formats::SurfaceOptions options;
      options.units = reading.model->units;
      options.has_others = true;
      auto writer = formats::step::descriptor().open_bodies(*output, options);
      ASSERT_TRUE(writer.ok());
      ASSERT_TRUE((*writer)->add_part(part).ok());
      ASSERT_TRUE((*writer)->finish().ok());
      ASSERT_TRUE(output->commit().ok());
      const Result<Source> again = Source::open(folder / "again.step");
      const std::string text(again->bytes());
      EXPECT_EQ(times(text, "CYLINDRICAL_SURFACE("), is_kept ? 1U : 0U);
      if (is_kept) {
        EXPECT_EQ(times(text, "= PLANE("), 2U);
      }
      GProp_GProps properties;
      BRepGProp::VolumeProperties(occt_read(folder / "again.step"), properties, 1e-12);
      EXPECT_NEAR(properties.Mass(), volume, (is_kept ? 1e-11 : 1e-5) * volume);
    }
  }
}

// What FreeCAD wrote once; tests/fixtures/freecad/PROVENANCE.md.
class FreeCad : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const fs::path folder = fs::path(places::tests()) / "fixtures/freecad";
    const std::string name = GetParam();
    Result<Source> source = Source::open(
        name == "plain4_grid" ? fs::path(places::samples()) / "plain4_grid.txt" : folder / (name + ".txt"));
    ASSERT_TRUE(source.ok());
    // The knit that FreeCAD was given is the published one.
    bodies_ = bodies_of(*source, name == "planar" ? yarn::EndStyle::planar : yarn::EndStyle::patch, true);
    // NAME SOLIDS FACES, as FreeCAD counts them.
    std::ifstream lines(folder / "expected.txt");
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string word;
      if (!(words >> word) || word != name) continue;
      words >> solids_ >> faces_;
    }
    ASSERT_GT(solids_, 0);
    path_ = (folder / name).string();
  }

  void compare(const Descriptor& format, const std::string& path, bool solids) {
    const Reading reading = read(format, path);
    ASSERT_TRUE(reading.model.has_value());
    EXPECT_EQ(static_cast<int>(reading.model->face_count()), faces_);
    EXPECT_EQ(solids_in(*reading.model), solids ? solids_ : 0);
    ASSERT_EQ(static_cast<int>(reading.yarns.size()), solids_);
    // FreeCAD was given tubes of before, which stood within the tolerance of the same yarns; a grid is what
    // it is.
    double allowed = 1e-6;
    for (const yarn::Body& body : bodies_)
      allowed = std::max(allowed, 2.0 * 4.0 * body.tube_error / yarn::narrowest_section(body));
    EXPECT_LT(deviation(volumes_of(reading.yarns), volumes_of(bodies_)), allowed);
    // Of FreeCAD's own volumes some are off by 4e-3: it takes OpenCASCADE's coarsest quadrature.
    const double from_occt =
        deviation(volumes_of(reading.yarns), facts_of(occt_read(path_ + ".step")).volumes);
    EXPECT_LT(from_occt, 1e-6);
    std::printf("%-12s %-20s yarns %d faces %d off OCCT %.1e off own %.1e\n", GetParam(),
                fs::path(path).filename().c_str(), solids_, faces_, from_occt,
                deviation(volumes_of(reading.yarns), volumes_of(bodies_)));
  }

  std::vector<yarn::Body> bodies_;
  int solids_ = 0, faces_ = 0;
  std::string path_;
};

TEST_P(FreeCad, Step) {
  compare(formats::step::descriptor(), path_ + ".step", true);
}
TEST_P(FreeCad, Iges) {
  compare(formats::iges::descriptor(), path_ + ".iges", false);
}

INSTANTIATE_TEST_SUITE_P(Fixtures, FreeCad, ::testing::Values("plain4_grid", "ring", "jersey", "planar"),
                         [](const auto& test) { return std::string(test.param); });

struct Sample {
  const char* name;
  const char* tolerance;
};

class Foreign : public ::testing::TestWithParam<Sample> {
 protected:
  void SetUp() override {
    bodies_ = sample(GetParam().name, GetParam().tolerance);
    write_step(bodies_, folder_ / "own.stp");
    shape_ = occt_read(folder_ / "own.stp");
    occt_ = facts_of(shape_);
    ASSERT_EQ(occt_.volumes.size(), bodies_.size());
  }

  // `solids`: the file says which faces make a solid.
  void compare(const Descriptor& format, const std::string& path, bool solids) {
    const Reading reading = read(format, path);
    ASSERT_TRUE(reading.model.has_value());
    EXPECT_EQ(static_cast<int>(reading.model->face_count()), occt_.faces);
    EXPECT_EQ(solids_in(*reading.model), solids ? static_cast<int>(bodies_.size()) : 0);
    EXPECT_EQ(reading.yarns.size(), bodies_.size());
    const double from_occt = deviation(volumes_of(reading.yarns), occt_.volumes),
                 from_own = deviation(volumes_of(reading.yarns), volumes_of(bodies_));
    EXPECT_LT(from_own, 1e-6);
    EXPECT_LT(from_occt, 1e-6);
    std::printf("%-24s %-10s yarns %3zu faces %4d off OCCT %.1e off own %.1e\n", GetParam().name,
                fs::path(path).filename().c_str(), reading.yarns.size(), occt_.faces, from_occt, from_own);
  }

  Folder folder_;
  std::vector<yarn::Body> bodies_;
  TopoDS_Shape shape_;
  Facts occt_;
};

TEST_P(Foreign, StepOfOcct) {
  occt_write_step(shape_, folder_ / "occt.stp");
  compare(formats::step::descriptor(), folder_ / "occt.stp", true);
}

TEST_P(Foreign, IgesFacesOfOcct) {
  occt_write_iges(shape_, folder_ / "faces.igs", false);
  compare(formats::iges::descriptor(), folder_ / "faces.igs", false);
}

TEST_P(Foreign, IgesBrepOfOcct) {
  occt_write_iges(shape_, folder_ / "brep.igs", true);
  compare(formats::iges::descriptor(), folder_ / "brep.igs", true);
}

INSTANTIATE_TEST_SUITE_P(Samples, Foreign,
                         ::testing::Values(Sample{"plain4_grid", "1e-2"}, Sample{"plain4_path", "1e-2"},
                                           Sample{"ring", "1e-2"}, Sample{"jersey", "1e-2"},
                                           Sample{"weave_plain", "1e-2"}, Sample{"weave_twill22", "1e-2"},
                                           Sample{"cabled", "1e-2"}, Sample{"ply3_z", "1e-2"},
                                           Sample{"filaments7", "1e-2"}, Sample{"braid_tape", "1e-2"},
                                           Sample{"knit_rib_1x1", "1e-2"},
                                           Sample{"warpknit_pillar_atlas", "1e-2"},
                                           Sample{"braid_flat3", "1e-2"}, Sample{"weave_hybrid", "1e-2"},
                                           Sample{"sections", "1e-2"}),
                         [](const auto& test) {
                           std::string name = test.param.name;
                           return name;
                         });

}  // namespace
}  // namespace selvage
