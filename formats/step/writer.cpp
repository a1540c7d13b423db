#include "formats/step/writer.h"

#include <fmt/format.h>

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRep_Builder.hxx>
#include <Interface_HArray1OfHAsciiString.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPConstruct.hxx>
#include <STEPConstruct_Styles.hxx>
#include <STEPControl_Writer.hxx>
#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_StepWriter.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_RepresentationContext.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepVisual_ColourRgb.hxx>
#include <StepVisual_MechanicalDesignGeometricPresentationRepresentation.hxx>
#include <StepVisual_PresentationStyleAssignment.hxx>
#include <StepVisual_StyledItem.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Iterator.hxx>
#include <Transfer_FinderProcess.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferWriter.hxx>
#include <XSControl_WorkSession.hxx>
#include <array>
#include <gp_Trsf.hxx>
#include <gp_Vec.hxx>
#include <map>
#include <optional>
#include <ostream>

#include "core/clock.h"
#include "core/text_report.h"
#include "formats/step/options.h"
#include "formats/step/part_shape.h"
#include "formats/step/session.h"
#include "formats/step/stream.h"
#include "solid/occt/check.h"
#include "solid/occt/guard.h"
#include "solid/occt/piece.h"
#include "solid/occt/shape.h"

namespace selvage::formats::step {

namespace {

Handle(TCollection_HAsciiString) text(const std::string& words) {
  return new TCollection_HAsciiString(words.c_str());
}

// Below this two places are one for the reading system, mm. The solids' faces share their edges, so their
// joints are as exact as doubles are; this is what OpenCASCADE takes for equal, and small against the finest
// fibre.
constexpr double written_uncertainty = 1e-7;

// A yarn's solid, a piece's shell, or what came from a CAD file.
struct Part {
  TopoDS_Shape shape;
  std::string name;
  std::optional<yarn::Color> color;
  std::vector<std::pair<TopoDS_Shape, yarn::Color>> colors;  // of faces that have their own
};

class StepBodyWriter : public BodyWriter {
 public:
  StepBodyWriter(OutputFile& output, SurfaceOptions options)
      : output_(output), options_(std::move(options)), document_(new TDocStd_Document("BinXCAF")) {
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
    assembly_ = shapes_->NewShape();
  }

  Status add(const yarn::Body& body) override {
    return solid::occt::guarded(fmt::format("yarn '{}' to STEP", body.name), [&] { return add_shape(body); });
  }

  Status add_instance(const yarn::Body& body, const Instance& instance) override {
    return solid::occt::guarded(fmt::format("yarn '{}' to STEP", body.name),
                                [&] { return add_copy(body, instance); });
  }

  Status add_piece(const fabric::PieceShape& piece) override {
    return solid::occt::guarded(fmt::format("piece '{}' to STEP", piece.name), [&]() -> Status {
      const solid::FaceCheck verdict = solid::occt::check_piece(piece);
      if (!verdict.defects.empty()) return verdict.defects.front();
      ++facts_.entities["SHELL_BASED_SURFACE_MODEL"];
      add_component_of({solid::occt::build_piece(piece, 1.0), piece.name, yarn::Color{}, {}}, "");
      return {};
    });
  }

  Status add_part(const cad::Part& part) override {
    return solid::occt::guarded(fmt::format("'{}' to STEP", part.name), [&] { return add_foreign(part); });
  }

  Status add_curve(const cad::NamedCurve& curve) override {
    return solid::occt::guarded(fmt::format("curve '{}' to STEP", curve.name), [&]() -> Status {
      if (Status finite = check_finite(curve.curve.points, curve.name); !finite.ok()) return finite;
      ++facts_.entities["GEOMETRIC_CURVE_SET"];
      TopoDS_Compound set;
      BRep_Builder().MakeCompound(set);
      BRep_Builder().Add(set, build_edge(curve.curve));
      add_component_of({set, curve.name, curve.color, {}}, "");
      return {};
    });
  }

  Result<WriteFacts> finish() override {
    return solid::occt::guarded("the STEP file", [&] { return write(); });
  }

 private:
  // A place of a part that is there already, or comes with it.
  Status add_copy(const yarn::Body& body, const Instance& instance) {
    const auto [known, is_new] = copied_.try_emplace(instance.shape);
    if (is_new) {
      Result<Part> part = part_of(*instance.body);
      if (!part) {
        copied_.erase(known);
        return part.error();
      }
      known->second = add_part_of(std::move(*part));
    }
    gp_Trsf motion;
    const Eigen::Matrix3d& r = instance.motion.rotation;
    const Vec3& t = instance.motion.offset;
    if (instance.motion.is_translation())
      motion.SetTranslation(gp_Vec(t.x(), t.y(), t.z()));
    else
      motion.SetValues(r(0, 0), r(0, 1), r(0, 2), t.x(), r(1, 0), r(1, 1), r(1, 2), t.y(), r(2, 0), r(2, 1),
                       r(2, 2), t.z());
    add_component(body.group.empty() ? assembly_ : group_assembly(body.group), known->second, body.name,
                  TopLoc_Location(motion));
    return {};
  }

  Status add_shape(const yarn::Body& body) {
    Result<Part> part = part_of(body);
    if (!part) return part.error();
    add_component_of(std::move(*part), body.group);
    return {};
  }

  Result<Part> part_of(const yarn::Body& body) {
    if (Status finite = check_finite(body.surface.points, "yarn '" + body.name + "'"); !finite.ok())
      return finite.error();
    const bool open_by_choice = !body.closed_along && (body.start.style == yarn::EndStyle::none ||
                                                       body.end.style == yarn::EndStyle::none);
    if (!open_by_choice) {
      const solid::BrepCheck verdict = solid::occt::check_topology(body);
      if (!verdict.defects.empty()) return verdict.defects.front();
    }
    solid::occt::YarnShape yarn = solid::occt::build_shape(body, 1.0);
    if (!yarn.defects.empty()) return yarn.defects.front();
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
    return Part{yarn.shape, body.name, body.color, {}};
  }

  // OpenCASCADE would write "nan", which no reader reads.
  static Status check_finite(const std::vector<Vec3>& points, const std::string& what) {
    for (const Vec3& p : points)
      if (!p.allFinite()) return error(Kind::geometry, what + " has a control point that is no number");
    return {};
  }

  // What OpenCASCADE read of it; without that, of its faces.
  static Result<PartShape> sound_part(const cad::Part& part, double tolerance) {
    const std::string who = part.name.empty() ? part.origin.entity : in_quotes(part.name);
    if (std::optional<PartShape> kept = kept_part(part)) return std::move(*kept);
    PartShape built = build_part(part, tolerance);
    if (const std::optional<std::string> flaw = flaw_of(built, part))
      return error(Kind::geometry, fmt::format("{} cannot be written as STEP: {}", who, *flaw));
    return built;
  }

  Status add_foreign(const cad::Part& part) {
    for (const cad::Face& face : part.faces)
      if (Status finite = check_finite(face.surface.points, "'" + part.name + "'"); !finite.ok())
        return finite;
    if (part.faces.empty()) return {};
    const double tolerance = std::max(1e-6 * cad::box_of(part).diagonal().norm(),
                                      written_uncertainty / millimetres_per(options_.units));
    Result<PartShape> made = sound_part(part, tolerance);
    if (!made) {
      made.error().place = part.origin.place;
      return made.error();
    }
    const PartShape& built = *made;
    ++facts_.entities[built.closed ? "MANIFOLD_SOLID_BREP" : "SHELL_BASED_SURFACE_MODEL"];
    Part added{built.shape, part.name, part.color, {}};
    for (std::size_t i = 0; i < part.faces.size(); ++i)
      if (part.faces[i].color && part.faces[i].color != added.color && !built.faces[i].IsNull())
        added.colors.emplace_back(built.faces[i], *part.faces[i].color);
    add_component_of(std::move(added), part.group);
    return {};
  }

  // Plies and filaments are parts of an assembly of their own, named as the yarn that they make up.
  void add_component_of(Part added, const std::string& group) {
    const std::string name = added.name;
    const TDF_Label part = add_part_of(std::move(added));
    add_component(group.empty() ? assembly_ : group_assembly(group), part, name);
  }

  TDF_Label add_part_of(Part added) {
    const TDF_Label part = shapes_->AddShape(added.shape, false, false);
    TDataStd_Name::Set(part, TCollection_ExtendedString(added.name.c_str(), true));
    parts_.push_back(std::move(added));
    return part;
  }

  TDF_Label group_assembly(const std::string& group) {
    const auto [known, is_new] = groups_.try_emplace(group);
    if (is_new) {
      known->second = shapes_->NewShape();
      TDataStd_Name::Set(known->second, TCollection_ExtendedString(group.c_str(), true));
      add_component(assembly_, known->second, group);
    }
    return known->second;
  }

  void add_component(const TDF_Label& assembly, const TDF_Label& part, const std::string& named,
                     const TopLoc_Location& place = {}) {
    const TDF_Label component = shapes_->AddComponent(assembly, part, place);
    TDataStd_Name::Set(component, TCollection_ExtendedString(named.c_str(), true));
  }

  Result<WriteFacts> write() {
    if (parts_.empty()) return error(Kind::geometry, "there is neither a yarn nor a piece to write");
    const Session session = Session::to_write(options_.units, options_.own.text(option::schema));
    shapes_->UpdateAssemblies();
    const std::string title = options_.title.empty() ? "fabric" : options_.title;
    TDataStd_Name::Set(assembly_, TCollection_ExtendedString(title.c_str(), true));
    STEPCAFControl_Writer writer;
    writer.ChangeWriter().SetTolerance(written_uncertainty / millimetres_per(options_.units));
    writer.SetColorMode(
        false);  // add_styles: its own go in the order of memory addresses, so no two files are alike
    writer.SetNameMode(true);
    writer.SetLayerMode(false);
    writer.SetPropsMode(false);
    writer.SetSHUOMode(false);
    writer.SetDimTolMode(false);
    writer.SetMaterialMode(false);
    // One transfer for all yarns: one each would take time that grows with their square.
    if (!writer.Transfer(document_, STEPControl_AsIs))
      return error(Kind::internal, "OpenCASCADE does not translate the yarns to STEP");
    if (Status styled = add_styles(writer.ChangeWriter()); !styled.ok()) return styled.error();
    number_places(writer.ChangeWriter().Model());
    return send(writer.ChangeWriter().Model());
  }

  // OpenCASCADE numbers the places of parts through all files of the process.
  static void number_places(const Handle(StepData_StepModel) & model) {
    int number = 0;
    for (int i = 1; i <= model->NbEntities(); ++i) {
      const auto place = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(model->Value(i));
      if (!place.IsNull()) place->SetId(text(std::to_string(++number)));
    }
  }

  // Yarns of one colour share its style.
  using Assignments = std::map<std::array<int, 3>, Handle(StepVisual_PresentationStyleAssignment)>;

  // Name and colour of each solid: a STYLED_ITEM in the context of its part, in file order.
  Status add_styles(STEPControl_Writer& writer) {
    const Handle(Transfer_FinderProcess) found = writer.WS()->TransferWriter()->FinderProcess();
    STEPConstruct_Styles styles(writer.WS());
    Assignments assignments;
    for (const Part& part : parts_) {
      const Handle(StepRepr_RepresentationContext) context = styles.FindContext(part.shape);
      styles.ClearStyles();
      for (const TopoDS_Shape& shape : named_shapes(part)) {
        const Handle(StepRepr_RepresentationItem) item = STEPConstruct::FindEntity(found, shape);
        if (item.IsNull() || context.IsNull())
          return error(Kind::internal, fmt::format("OpenCASCADE left out '{}'", part.name));
        item->SetName(text(part.name));
        if (part.color) styles.AddStyle(item, style_of(*part.color, item, styles, assignments), {});
      }
      for (const auto& [face, color] : part.colors) {
        const Handle(StepRepr_RepresentationItem) item = STEPConstruct::FindEntity(found, face);
        if (!item.IsNull()) styles.AddStyle(item, style_of(color, item, styles, assignments), {});
      }
      if (styles.NbStyles() == 0) continue;
      Handle(StepVisual_MechanicalDesignGeometricPresentationRepresentation) presentation;
      if (!styles.CreateMDGPR(context, presentation))
        return error(Kind::internal, fmt::format("OpenCASCADE refuses the colour of '{}'", part.name));
      writer.Model()->AddWithRefs(presentation);
    }
    return {};
  }

  // A compound is no entity of a STEP file: what is in it has the name.
  static std::vector<TopoDS_Shape> named_shapes(const Part& part) {
    if (part.shape.ShapeType() != TopAbs_COMPOUND) return {part.shape};
    std::vector<TopoDS_Shape> shapes;
    for (TopoDS_Iterator it(part.shape); it.More(); it.Next()) shapes.push_back(it.Value());
    return shapes;
  }

  static const Handle(StepVisual_PresentationStyleAssignment) &
      style_of(const yarn::Color& color, const Handle(StepRepr_RepresentationItem) & item,
               STEPConstruct_Styles& styles, Assignments& assignments) {
    auto& assignment = assignments[{color.red, color.green, color.blue}];
    if (assignment.IsNull()) {
      // Not OpenCASCADE's own colour, which is single precision; and no style of curves: it would draw lines
      // 0.1 wide.
      const Handle(StepVisual_ColourRgb) rgb = new StepVisual_ColourRgb;
      rgb->Init(text(""), color.red / 255.0, color.green / 255.0, color.blue / 255.0);
      assignment = styles.MakeColorPSA(item, rgb, {}, {}, 0.0);
    }
    return assignment;
  }

  Result<WriteFacts> send(const Handle(StepData_StepModel) & model) {
    set_header(model);
    StepData_StepWriter lines(model);
    // Exact, and four times faster than 17 decimal digits; StepStream makes decimals of them. (OpenCASCADE's
    // own way of short decimals, suppressed zeros, breaks after 16 characters.)
    lines.FloatWriter().SetFormat("%a");
    lines.SendModel(Handle(StepData_Protocol)::DownCast(model->Protocol()));
    StepStream buffer(output_);
    std::ostream stream(&buffer);
    const bool complete = lines.Print(stream);
    if (Status status = buffer.close(); !status.ok()) return status.error();
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
  TDF_Label assembly_;
  std::map<std::string, TDF_Label> groups_;  // by the yarn's name
  std::map<std::size_t, TDF_Label> copied_;  // parts that stand in several places, by the shape's number
  std::vector<Part> parts_;                  // in file order
  WriteFacts facts_;
};

}  // namespace

Result<std::unique_ptr<BodyWriter>> open_writer(OutputFile& output, const SurfaceOptions& options) {
  const std::string_view schema = options.own.text(option::schema);
  if (schema_word(schema) == nullptr)
    return error(Kind::usage, fmt::format("unknown STEP schema '{}': AP242 or AP214", schema));
  return solid::occt::guarded("the STEP file", [&]() -> Result<std::unique_ptr<BodyWriter>> {
    return std::unique_ptr<BodyWriter>(std::make_unique<StepBodyWriter>(output, options));
  });
}

}  // namespace selvage::formats::step
