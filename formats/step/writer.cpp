#include "formats/step/writer.h"

#include <fmt/format.h>

#include <APIHeaderSection_MakeHeader.hxx>
#include <Interface_HArray1OfHAsciiString.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopLoc_Location.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <mutex>
#include <ostream>
#include <streambuf>

#include "core/clock.h"
#include "solid/occt/guard.h"
#include "solid/occt/shape.h"

namespace selvage::formats::step {

namespace {

// OpenCASCADE's words.
const char* schema_word(std::string_view schema) {
  if (schema == "AP242") return "AP242DIS";
  if (schema == "AP214") return "AP214IS";
  return nullptr;
}

const char* unit_word(Unit unit) {
  switch (unit) {
    case Unit::m:
      return "M";
    case Unit::cm:
      return "CM";
    case Unit::mm:
      return "MM";
    case Unit::um:
      return "UM";
    case Unit::inch:
      return "INCH";
  }
  return "MM";
}

// OpenCASCADE keeps these for the whole process; they are set here and nowhere else, before each file.
void configure(const SurfaceOptions& options) {
  STEPCAFControl_Controller::Init();
  Interface_Static::SetCVal("write.step.schema", schema_word(options.step_schema));
  // Shapes and file in the same unit: no number is multiplied on its way.
  Interface_Static::SetCVal("xstep.cascade.unit", unit_word(options.units));
  Interface_Static::SetCVal("write.step.unit", unit_word(options.units));
  Interface_Static::SetIVal("write.surfacecurve.mode", 0);
}

// Bytes to the OutputFile in blocks; remembers the first refusal.
class OutputBuffer : public std::streambuf {
 public:
  explicit OutputBuffer(OutputFile& output) : output_(output), block_(1U << 20, '\0') {
    setp(block_.data(), block_.data() + block_.size());
  }

  Status flush() {
    sync();
    return status_;
  }

 protected:
  int overflow(int c) override {
    if (sync() != 0) return traits_type::eof();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }

  int sync() override {
    if (status_.ok() && pptr() > pbase())
      status_ = output_.write({pbase(), static_cast<std::size_t>(pptr() - pbase())});
    setp(block_.data(), block_.data() + block_.size());
    return status_.ok() ? 0 : -1;
  }

 private:
  OutputFile& output_;
  std::string block_;
  Status status_;
};

Handle(TCollection_HAsciiString) text(const std::string& words) {
  return new TCollection_HAsciiString(words.c_str());
}

class StepBodyWriter : public BodyWriter {
 public:
  StepBodyWriter(OutputFile& output, SurfaceOptions options)
      : output_(output), options_(std::move(options)), document_(new TDocStd_Document("BinXCAF")) {
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
    colors_ = XCAFDoc_DocumentTool::ColorTool(document_->Main());
    assembly_ = shapes_->NewShape();
  }

  Status add(const yarn::Body& body) override {
    return solid::occt::guarded(fmt::format("yarn '{}' to STEP", body.name), [&] { return add_shape(body); });
  }

  Result<WriteFacts> finish() override {
    return solid::occt::guarded("the STEP file", [&] { return write(); });
  }

 private:
  Status add_shape(const yarn::Body& body) {
    solid::occt::YarnShape yarn = solid::occt::build_shape(body, 1.0);
    if (!yarn.defects.empty()) return yarn.defects.front();
    ++count_;
    if (!yarn.closed) {
      ++facts_.entities["SHELL_BASED_SURFACE_MODEL"];
      Message open =
          warning(Kind::geometry, fmt::format("yarn '{}' has no end faces: it is written as an open shell, "
                                              "not as a solid; --ends patch closes it",
                                              body.name));
      open.yarn = body.name;
      open.place = body.place;
      facts_.messages.push_back(std::move(open));
    } else {
      ++facts_.entities["MANIFOLD_SOLID_BREP"];
    }
    const TDF_Label part = shapes_->AddShape(yarn.shape, false, false);
    const TDF_Label component = shapes_->AddComponent(assembly_, part, TopLoc_Location());
    const TCollection_ExtendedString name(body.name.c_str(), true);
    TDataStd_Name::Set(part, name);
    TDataStd_Name::Set(component, name);
    const auto share = [](int value) { return value / 255.0; };
    colors_->SetColor(part,
                      Quantity_Color(share(body.color.red), share(body.color.green), share(body.color.blue),
                                     Quantity_TOC_sRGB),
                      XCAFDoc_ColorGen);
    return {};
  }

  Result<WriteFacts> write() {
    if (count_ == 0) return error(Kind::geometry, "there is no yarn to write");
    static std::mutex one_at_a_time;  // OpenCASCADE's settings are the process's
    const std::lock_guard lock(one_at_a_time);
    configure(options_);
    shapes_->UpdateAssemblies();
    const std::string title = options_.title.empty() ? "fabric" : options_.title;
    TDataStd_Name::Set(assembly_, TCollection_ExtendedString(title.c_str(), true));
    STEPCAFControl_Writer writer;
    writer.SetColorMode(true);
    writer.SetNameMode(true);
    writer.SetLayerMode(false);
    writer.SetPropsMode(false);
    writer.SetSHUOMode(false);
    writer.SetDimTolMode(false);
    writer.SetMaterialMode(false);
    // One transfer for all yarns: one each would take time that grows with their square.
    if (!writer.Transfer(document_, STEPControl_AsIs))
      return error(Kind::internal, "OpenCASCADE does not translate the yarns to STEP");
    return send(writer.ChangeWriter().Model());
  }

  Result<WriteFacts> send(const Handle(StepData_StepModel) & model) {
    set_header(model);
    StepData_StepWriter lines(model);
    lines.FloatWriter().SetFormat("%.16E");  // 17 digits: every double reads back to the same bits
    lines.FloatWriter().SetZeroSuppress(true);
    lines.SendModel(Handle(StepData_Protocol)::DownCast(model->Protocol()));
    OutputBuffer buffer(output_);
    std::ostream stream(&buffer);
    const bool complete = lines.Print(stream);
    Status status = buffer.flush();
    if (!status.ok()) return status.error();
    if (!complete) return error(Kind::internal, "OpenCASCADE does not write the STEP file");
    return std::move(facts_);
  }

  void set_header(const Handle(StepData_StepModel) & model) {
    APIHeaderSection_MakeHeader header(model);
    header.SetName(text(options_.file_name));
    header.SetTimeStamp(text(iso_timestamp()));
    header.SetOriginatingSystem(text("selvage 0.1.0"));
    header.SetAuthorValue(1, text(""));
    header.SetOrganizationValue(1, text(""));
    header.SetAuthorisation(text(""));
    header.SetDescriptionValue(1, text(options_.title));
    header.Apply(model);
  }

  OutputFile& output_;
  SurfaceOptions options_;
  Handle(TDocStd_Document) document_;
  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colors_;
  TDF_Label assembly_;
  std::size_t count_ = 0;
  WriteFacts facts_;
};

}  // namespace

Result<std::unique_ptr<BodyWriter>> open_writer(OutputFile& output, const SurfaceOptions& options) {
  if (schema_word(options.step_schema) == nullptr)
    return error(Kind::usage, fmt::format("unknown STEP schema '{}': AP242 or AP214", options.step_schema));
  return solid::occt::guarded("the STEP file", [&]() -> Result<std::unique_ptr<BodyWriter>> {
    return std::unique_ptr<BodyWriter>(std::make_unique<StepBodyWriter>(output, options));
  });
}

}  // namespace selvage::formats::step
