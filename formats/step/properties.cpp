#include "formats/step/properties.h"

#include <fmt/format.h>

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc_Area.hxx>
#include <XCAFDoc_Centroid.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XCAFDoc_Volume.hxx>
#include <algorithm>
#include <cmath>
#include <istream>
#include <streambuf>
#include <vector>

#include "core/text_report.h"
#include "formats/step/inspect.h"
#include "formats/step/session.h"
#include "solid/occt/guard.h"

namespace selvage::formats::step {

namespace {

// Of the value; of the size for a centre. Our own files have theirs to 1e-9; others are of other integrals,
// some with an error of some thousandths, and of edges with tolerances.
constexpr double of_own = 1e-4, of_others = 1e-3, surely_wrong = 5e-3;
constexpr double fine = 1e-6;  // relative error of the second integral

// Bytes as a stream without a copy.
class PropertyStream : public std::streambuf {
 public:
  explicit PropertyStream(std::string_view bytes) {
    char* const begin = const_cast<char*>(bytes.data());  // NOLINT: the interface; nothing is written
    setg(begin, begin, begin + bytes.size());
  }
};

double area_of(const TopoDS_Shape& shape, bool again) {
  GProp_GProps properties;
  if (again)
    BRepGProp::SurfaceProperties(shape, properties, fine);
  else
    BRepGProp::SurfaceProperties(shape, properties);
  return properties.Mass();
}

struct SolidVolume {
  double volume = 0;
  gp_XYZ moment;  // of first order
};

// Of the solids in the shape; none: it has none.
std::optional<SolidVolume> volume_of(const TopoDS_Shape& shape, bool again) {
  std::optional<SolidVolume> all;
  for (TopExp_Explorer solids(shape, TopAbs_SOLID); solids.More(); solids.Next()) {
    GProp_GProps properties;
    if (again)
      BRepGProp::VolumeProperties(solids.Current(), properties, fine);
    else
      BRepGProp::VolumeProperties(solids.Current(), properties);
    if (!all) all.emplace();
    // A solid that is inside out encloses as much.
    const double volume = std::abs(properties.Mass());
    all->volume += volume;
    all->moment += properties.CentreOfMass().XYZ() * volume;
  }
  return all;
}

class PropertyCheck {
 public:
  PropertyCheck(const Source& source, const Part21& file, Findings& findings)
      : source_(source),
        file_(file),
        findings_(findings),
        is_own_(file.originating_system.starts_with("selvage")) {}

  void run() {
    std::string kept;
    PropertyStream buffer(readable_bytes(source_, file_, kept));
    std::istream stream(&buffer);
    STEPCAFControl_Reader reader;
    if (reader.ChangeReader().ReadStream(source_.name().c_str(), stream) != IFSelect_RetDone) return;
    Handle(TDocStd_Document) document(new TDocStd_Document("BinXCAF"));
    XCAFDoc_DocumentTool::SetLengthUnit(document, 1, UnitsMethods_LengthUnit_Millimeter);
    reader.SetColorMode(false);
    reader.SetNameMode(true);
    reader.SetLayerMode(false);
    reader.SetPropsMode(true);
    reader.SetGDTMode(false);
    reader.SetMatMode(false);
    reader.SetViewMode(false);
    if (!reader.Transfer(document)) return;
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document->Main());
    TDF_LabelSequence labels;
    shapes_->GetFreeShapes(labels);
    BRep_Builder().MakeCompound(all_);
    for (const TDF_Label& label : labels)
      if (const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label); !shape.IsNull())
        BRep_Builder().Add(all_, shape);
    labels.Clear();
    shapes_->GetShapes(labels);
    for (const TDF_Label& label : labels) {
      check(label);
      TDF_LabelSequence below;
      XCAFDoc_ShapeTool::GetSubShapes(label, below);
      for (const TDF_Label& part : below) check(part);
      below.Clear();
      XCAFDoc_ShapeTool::GetComponents(label, below);
      for (const TDF_Label& place : below) check(place);
    }
  }

 private:
  [[nodiscard]] static std::string name_of(const TDF_Label& label) {
    Handle(TDataStd_Name) name;
    if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
    const TCollection_ExtendedString& text = name->Get();
    std::string result(static_cast<std::size_t>(text.LengthOfCString()), '\0');
    Standard_PCharacter buffer = result.data();
    text.ToUTF8CString(buffer);
    return result;
  }

  void tell(const TDF_Label& label, std::string_view what, double said, double found, std::string_view unit) {
    const double off = std::abs(said - found) / std::abs(found);
    std::string text = fmt::format(
        "'{}': the file says that its {} is {:.8g} {}, and it is {:.8g} (geometric validation property)",
        name_of(label), what, said, unit, found);
    is_own_ || off > surely_wrong ? findings_.defect(std::move(text), {}, off)
                                  : findings_.warning(std::move(text), {}, off);
  }

  // Nothing is no measure of a shape that others were made of.
  [[nodiscard]] bool agree(double said, double found) const {
    return found == 0 || std::abs(said - found) <= (is_own_ ? of_own : of_others) * std::abs(found);
  }

  // A product of several bodies may have its properties at one of them: what the whole has will do.
  [[nodiscard]] std::vector<TopoDS_Shape> wholes_of(const TDF_Label& label) const {
    if (is_own_) return {};
    const TDF_Label above = label.Father();
    if (above.IsNull() || !XCAFDoc_ShapeTool::IsShape(above)) return {all_};
    return {XCAFDoc_ShapeTool::GetShape(above), all_};
  }

  void check(const TDF_Label& label) {
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    if (shape.IsNull()) return;
    double said = 0;
    if (XCAFDoc_Area::Get(label, said)) check_area(label, shape, said);
    if (!XCAFDoc_Volume::Get(label, said)) return;
    check_volume(label, shape, said);
    if (gp_Pnt centre; XCAFDoc_Centroid::Get(label, centre)) check_centre(label, shape, centre);
  }

  void check_area(const TDF_Label& label, const TopoDS_Shape& shape, double said) {
    if (agree(said, area_of(shape, false))) return;
    const double area = area_of(shape, true);
    const auto is_its = [&](const TopoDS_Shape& whole) { return agree(said, area_of(whole, true)); };
    if (agree(said, area) || std::ranges::any_of(wholes_of(label), is_its)) return;
    tell(label, "area", said, area, "mm^2");
  }

  void check_volume(const TDF_Label& label, const TopoDS_Shape& shape, double said) {
    const auto agrees = [&](const std::optional<SolidVolume>& found) {
      return !found || agree(said, found->volume);
    };
    if (agrees(volume_of(shape, false))) return;
    const std::optional<SolidVolume> found = volume_of(shape, true);
    const auto is_its = [&](const TopoDS_Shape& whole) { return agrees(volume_of(whole, true)); };
    if (agrees(found) || std::ranges::any_of(wholes_of(label), is_its)) return;
    tell(label, "volume", said, found->volume, "mm^3");
  }

  void check_centre(const TDF_Label& label, const TopoDS_Shape& shape, const gp_Pnt& said) {
    Bnd_Box box;
    BRepBndLib::Add(shape, box);
    if (box.IsVoid()) return;
    const double size = std::sqrt(box.SquareExtent());
    for (const bool again : {false, true}) {
      const std::optional<SolidVolume> found = volume_of(shape, again);
      if (!found || !(found->volume > 0)) return;
      const gp_Pnt centre(found->moment / found->volume);
      const double off = centre.Distance(said);
      if (off <= (is_own_ ? of_own : of_others) * size) return;
      if (!again) continue;
      std::string text = fmt::format(
          "'{}': the file says that its centre is ({:.6g}, {:.6g}, {:.6g}) mm, and that of its volume is "
          "({:.6g}, "
          "{:.6g}, {:.6g}), {:.3g} away (geometric validation property)",
          name_of(label), said.X(), said.Y(), said.Z(), centre.X(), centre.Y(), centre.Z(), off);
      // Some give that of the mass, or of what was drawn beside the shape.
      is_own_ ? findings_.defect(std::move(text), {}, off) : findings_.warning(std::move(text), {}, off);
    }
  }

  Session session_ = Session::to_read();  // before anything of OpenCASCADE's
  const Source& source_;
  const Part21& file_;
  Findings& findings_;
  bool is_own_;
  TopoDS_Compound all_;  // of the file
  Handle(XCAFDoc_ShapeTool) shapes_;
};

}  // namespace

void check_properties(const Source& source, Findings& findings) {
  if (source.bytes().find("geometric validation property") == std::string_view::npos) return;
  Diagnostics unsaid;
  // What kills OpenCASCADE's reader is told when the file is read.
  const auto looked =
      reported(source, unsaid, [](const Source& from, TextReport& report) { return inspect(from, report); });
  if (!looked) return;
  const Status done = solid::occt::guarded("the STEP file's properties", [&]() -> Status {
    PropertyCheck(source, *looked, findings).run();
    return {};
  });
  if (!done)
    findings.warning(fmt::format("its validation properties could not be checked: {}", done.error().text));
}

}  // namespace selvage::formats::step
