// Assemblies that OpenCASCADE wrote: parts placed through several levels, and more instances than can be
// held.
#include <gtest/gtest.h>
#include <unistd.h>

#include <BRepBuilderAPI_MakeFace.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS_Face.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <filesystem>
#include <gp_Ax1.hxx>
#include <gp_Pln.hxx>
#include <gp_Trsf.hxx>
#include <numbers>

#include "formats/registry.h"

namespace selvage {
namespace {

namespace fs = std::filesystem;

// Each level holds the one below `times` times, each time a quarter turn about z and a step along x farther.
std::string nested(int levels, int times) {
  ::Message::DefaultMessenger()->ChangePrinters().Clear();
  std::string folder = (fs::temp_directory_path() / "selvage-assembly-XXXXXX").string();
  EXPECT_NE(::mkdtemp(folder.data()), nullptr);
  const Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  TDF_Label below =
      shapes->AddShape(BRepBuilderAPI_MakeFace(gp_Pln(), 1.0, 3.0, 0.0, 1.0).Face(), false, false);
  TDataStd_Name::Set(below, "plate");
  for (int level = 1; level <= levels; ++level) {
    const TDF_Label assembly = shapes->NewShape();
    TDataStd_Name::Set(assembly, ("level " + std::to_string(level)).c_str());
    for (int i = 0; i < times; ++i) {
      gp_Trsf turn, step;
      turn.SetRotation(gp_Ax1(gp_Pnt(), gp_Dir(0, 0, 1)), std::numbers::pi / 2 * (i + 1));
      step.SetTranslation(gp_Vec(10.0 * (i + 1), 0, 0));
      const TDF_Label place = shapes->AddComponent(assembly, below, TopLoc_Location(step * turn));
      TDataStd_Name::Set(place, ("place " + std::to_string(level) + "." + std::to_string(i + 1)).c_str());
    }
    below = assembly;
  }
  shapes->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  EXPECT_TRUE(writer.Transfer(document));
  EXPECT_EQ(writer.Write((fs::path(folder) / "a.stp").c_str()), IFSelect_RetDone);
  std::string bytes;
  if (Result<Source> source = Source::open(fs::path(folder) / "a.stp")) bytes = source->bytes();
  fs::remove_all(folder);
  return bytes;
}

TEST(StepAssembly, PartsArePlacedThroughAllLevels) {
  Diagnostics diagnostics;
  const auto model =
      formats::step::descriptor().read_model(Source::from_memory(nested(2, 2), "a.stp"), diagnostics);
  ASSERT_TRUE(model.has_value());
  EXPECT_EQ(model->title, "level 2");
  ASSERT_EQ(model->parts.size(), 4U);
  // (x, y) -> the quarter turns of one level, then its step along x.
  const auto placed = [](Vec3 p, int i) {
    for (int turn = 0; turn <= i; ++turn) p = Vec3(-p.y(), p.x(), p.z());
    return Vec3(p + Vec3(10.0 * (i + 1), 0, 0));
  };
  for (int outer = 0; outer < 2; ++outer)
    for (int inner = 0; inner < 2; ++inner) {
      const cad::Part& part = model->parts[static_cast<std::size_t>(2 * outer + inner)];
      EXPECT_EQ(part.group, "place 2." + std::to_string(outer + 1));
      ASSERT_EQ(part.faces.size(), 1U);
      const nurbs::Surface& surface = part.faces[0].surface;
      EXPECT_TRUE(part.faces[0].loops.empty());
      ASSERT_EQ(surface.points.size(), 4U);
      for (int k = 0; k < 4; ++k) {
        const Vec3 corner(k % 2 == 0 ? 1.0 : 3.0, k < 2 ? 0.0 : 1.0, 0.0);
        EXPECT_LT((surface.points[static_cast<std::size_t>(k)] - placed(placed(corner, inner), outer)).norm(),
                  1e-12);
      }
    }
}

}  // namespace
}  // namespace selvage
