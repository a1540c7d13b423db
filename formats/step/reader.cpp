#include "formats/step/reader.h"

#include <fmt/format.h>

#include <BRep_Tool.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Precision.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPConstruct_UnitContext.hxx>
#include <STEPControl_Reader.hxx>
#include <StepBasic_NamedUnit.hxx>
#include <StepBasic_UncertaintyMeasureWithUnit.hxx>
#include <StepBasic_Unit.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUncertaintyAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TransferBRep.hxx>
#include <Transfer_Binder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <istream>
#include <streambuf>
#include <unordered_map>

#include "cad/natural_border.h"
#include "formats/step/faces.h"
#include "formats/step/inspect.h"
#include "formats/step/session.h"
#include "solid/occt/guard.h"

namespace selvage::formats::step {

namespace {

// A file that holds little may say much: an assembly of assemblies of assemblies.
constexpr std::size_t most_points = 100'000'000, face_cost = 100;

// Bytes as a stream without a copy.
class ByteStream : public std::streambuf {
 public:
  explicit ByteStream(std::string_view bytes) {
    char* const begin = const_cast<char*>(bytes.data());  // NOLINT: the interface; nothing is written
    setg(begin, begin, begin + bytes.size());
  }
};

// "2026-11-21T13:05:00+01:00" as YYYYMMDD.HHNNSS; nothing for other things.
std::string date_of(std::string_view stamp) {
  std::string digits;
  for (const char c : stamp.substr(0, 19))
    if (c >= '0' && c <= '9') digits += c;
  if (digits.size() != 14) return {};
  return digits.substr(0, 8) + "." + digits.substr(8);
}

std::optional<Unit> unit_of(double millimetres) {
  for (const Unit unit : all_units)
    if (std::abs(millimetres / millimetres_per(unit) - 1.0) < 1e-9) return unit;
  return std::nullopt;
}

std::string name_of_label(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  const TCollection_ExtendedString& text = name->Get();
  std::string result(static_cast<std::size_t>(text.LengthOfCString()), '\0');
  Standard_PCharacter buffer = result.data();
  text.ToUTF8CString(buffer);
  // What OpenCASCADE calls a product without a name is none.
  if (result.starts_with("Open CASCADE STEP translator") || result.starts_with("=>[")) return {};
  return result;
}

cad::Color to_color(const Quantity_Color& color) {
  double red = 0, green = 0, blue = 0;
  color.Values(red, green, blue, Quantity_TOC_sRGB);
  const auto byte = [](double share) { return static_cast<int>(std::lround(255.0 * share)); };
  return {byte(red), byte(green), byte(blue)};
}

class ModelReader {
 public:
  ModelReader(const Source& source, const Part21& file, TextReport& report)
      : source_(source), file_(file), report_(report), document_(new TDocStd_Document("BinXCAF")) {}

  Result<cad::Model> read() {
    take_header();
    std::string kept;
    ByteStream buffer(readable_bytes(source_, file_, kept));
    std::istream stream(&buffer);
    // Files that it refers to stand beside it.
    const std::string path = std::filesystem::absolute(source_.name()).string();
    if (reader_.ChangeReader().ReadStream(path.c_str(), stream) != IFSelect_RetDone)
      return error(Kind::malformed, "OpenCASCADE does not read this STEP file");
    entities_ = reader_.ChangeReader().StepModel();
    take_units();
    XCAFDoc_DocumentTool::SetLengthUnit(document_, file_unit_ / working_, UnitsMethods_LengthUnit_Millimeter);
    count_entities();
    reader_.SetColorMode(true);
    reader_.SetNameMode(true);
    reader_.SetLayerMode(false);
    reader_.SetPropsMode(false);
    reader_.SetGDTMode(false);
    reader_.SetMatMode(false);
    reader_.SetViewMode(false);
    if (!reader_.Transfer(document_)) return error(Kind::malformed, "there is no geometry in this STEP file");
    find_entities();
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
    colors_ = XCAFDoc_DocumentTool::ColorTool(document_->Main());
    take_roots();
    if (points_ > most_points)
      return error(Kind::limit,
                   fmt::format("more than {} control points, every instance counted (or {} faces)",
                               most_points, most_points / face_cost));
    report_fails(reader_.ChangeReader().WS()->ModelCheckList(true));
    report_fails(reader_.ChangeReader().WS()->TransferReader()->LastCheckList());
    return std::move(model_);
  }

 private:
  void take_header() {
    model_.file = source_.name();
    model_.date = date_of(file_.time_stamp);
    model_.system = file_.originating_system;
    for (const Statement& statement : file_.statements)
      ++model_.entities[std::string(file_.type_of(statement))];
  }

  [[nodiscard]] int line_of(int id) const {
    const Statement* statement = file_.find(id);
    return statement == nullptr ? 0 : statement->spot.line;
  }
  [[nodiscard]] Spot spot_of(int id) const { return spot_at(source_, {line_of(id), 1}); }

  [[nodiscard]] cad::Origin origin_of(const Handle(Standard_Transient) & entity) const {
    if (entity.IsNull()) return {};
    const int id = entities_->IdentLabel(entity);
    return {{line_of(id), 1}, fmt::format("#{}", id)};
  }

  // Units and uncertainty of the first context that has any.
  void take_units() {
    double first = 0;
    for (int i = 1; i <= entities_->NbEntities(); ++i) {
      Handle(StepRepr_GlobalUnitAssignedContext) units;
      Handle(StepRepr_GlobalUncertaintyAssignedContext) uncertainty;
      const Handle(Standard_Transient) entity = entities_->Value(i);
      if (const auto with =
              Handle(StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx)::DownCast(entity);
          !with.IsNull()) {
        units = with->GlobalUnitAssignedContext();
        uncertainty = with->GlobalUncertaintyAssignedContext();
      } else if (const auto without = Handle(
                     StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext)::DownCast(entity);
                 !without.IsNull()) {
        units = without->GlobalUnitAssignedContext();
      }
      if (units.IsNull()) continue;
      STEPConstruct_UnitContext context;
      context.ComputeFactors(units);
      if (!context.LengthDone()) continue;
      const double millimetres = context.LengthFactor();
      if (first == 0) {
        first = millimetres;
        file_unit_ = millimetres;
        // Its tolerances have a fixed size, for things of some millimetres; a power of two costs no bit.
        working_ = std::exp2(std::round(std::log2(millimetres)));
        const std::optional<Unit> unit = unit_of(millimetres);
        model_.units = unit.value_or(Unit::mm);
        scale_ = unit ? 1.0 : millimetres;
        if (!uncertainty.IsNull()) take_uncertainty(*uncertainty, millimetres);
      } else if (std::abs(millimetres / first - 1) > 1e-9) {
        one_unit_ = false;
      }
    }
  }

  // The first measure, a length as a rule.
  void take_uncertainty(const StepRepr_GlobalUncertaintyAssignedContext& context, double millimetres) {
    if (context.NbUncertainty() < 1 || context.UncertaintyValue(1).IsNull()) return;
    const Handle(StepBasic_UncertaintyMeasureWithUnit) measure = context.UncertaintyValue(1);
    STEPConstruct_UnitContext unit;
    const Handle(StepBasic_NamedUnit) named = measure->UnitComponent().NamedUnit();
    if (measure->ValueComponentMember().IsNull() || named.IsNull()) return;
    unit.ComputeFactors(named);
    if (unit.LengthDone())
      model_.resolution = measure->ValueComponent() * scale_ * (unit.LengthFactor() / millimetres);
  }

  void count_entities() {
    for (int i = 1; i <= entities_->NbEntities(); ++i) {
      if (!entities_->IsUnknownEntity(i)) continue;
      const Statement* statement = file_.find(entities_->IdentLabel(entities_->Value(i)));
      if (statement != nullptr) ++model_.unknown[std::string(file_.type_of(*statement))];
    }
  }

  // Of shapes to what they were made of.
  void find_entities() {
    const Handle(Transfer_TransientProcess)& process =
        reader_.ChangeReader().WS()->TransferReader()->TransientProcess();
    for (int i = 1; i <= process->NbMapped(); ++i) {
      const auto item = Handle(StepRepr_RepresentationItem)::DownCast(process->Mapped(i));
      if (item.IsNull() || process->MapItem(i).IsNull()) continue;
      const TopoDS_Shape shape = TransferBRep::ShapeResult(process->MapItem(i));
      if (!shape.IsNull()) items_.emplace(shape.TShape().get(), item);
    }
  }

  [[nodiscard]] Handle(StepRepr_RepresentationItem) item_of(const TopoDS_Shape& shape) const {
    const auto found = items_.find(shape.TShape().get());
    return found == items_.end() ? Handle(StepRepr_RepresentationItem)() : found->second;
  }

  // As the file says it: OpenCASCADE's reader takes a doubled backslash for the beginning of a code.
  [[nodiscard]] std::string name_of_item(const Handle(StepRepr_RepresentationItem) & item) const {
    const Statement* const statement = item.IsNull() ? nullptr : file_.find(entities_->IdentLabel(item));
    return statement == nullptr ? std::string() : first_string(source_, *statement);
  }

  [[nodiscard]] std::optional<cad::Color> color_of_label(const TDF_Label& label) const {
    Quantity_Color color;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen})
      if (colors_->GetColor(label, type, color)) return to_color(color);
    return std::nullopt;
  }

  // What holds for the shapes of one product in one place.
  struct Context {
    std::string name, group;
    std::optional<cad::Color> color;
    std::unordered_map<const TopoDS_TShape*, cad::Color> colors;  // of its parts
    std::size_t parts = 0;                                        // how many were made of it
  };

  void take_roots() {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    if (roots.Length() == 1) model_.title = name_of_label(roots.First());
    if (file_.originating_system.starts_with("selvage")) model_.title = file_.description;
    for (const TDF_Label& root : roots) walk(root, TopLoc_Location(), "", 0, {});
  }

  void walk(const TDF_Label& label, const TopLoc_Location& above, const std::string& group, int depth,
            const std::optional<cad::Color>& color_above) {
    if (!spend(face_cost)) return;
    TDF_Label product = label;
    std::string name = name_of_label(label);
    TopLoc_Location place = above;
    std::optional<cad::Color> color = color_of_label(label);
    if (XCAFDoc_ShapeTool::IsReference(label)) {
      XCAFDoc_ShapeTool::GetReferredShape(label, product);
      place = above * XCAFDoc_ShapeTool::GetLocation(label);
      TDF_LabelSequence users;
      if (XCAFDoc_ShapeTool::GetUsers(product, users) == 1 || name.empty()) name = name_of_label(product);
      if (!color) color = color_of_label(product);
    }
    if (!color) color = color_above;
    if (!XCAFDoc_ShapeTool::IsAssembly(product)) return take_product(product, name, group, place, color);
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(product, components);
    for (const TDF_Label& component : components)
      walk(component, place, depth == 1 ? name : group, depth + 1, color);
  }

  void take_product(const TDF_Label& product, const std::string& name, const std::string& group,
                    const TopLoc_Location& place, const std::optional<cad::Color>& color) {
    Context context{name, group, color, {}, 0};
    TDF_LabelSequence subshapes;
    XCAFDoc_ShapeTool::GetSubShapes(product, subshapes);
    for (const TDF_Label& subshape : subshapes)
      if (const std::optional<cad::Color> own = color_of_label(subshape))
        context.colors.emplace(XCAFDoc_ShapeTool::GetShape(subshape).TShape().get(), *own);
    const std::size_t first_part = model_.parts.size(), first_curve = model_.curves.size();
    take_shape(XCAFDoc_ShapeTool::GetShape(product).Moved(place), context);
    // One thing in a product without a name of its own has the product's; where the product stands in several
    // places, that of the place, which tells them apart.
    TDF_LabelSequence users;
    const bool is_repeated = XCAFDoc_ShapeTool::GetUsers(product, users) > 1 && !name.empty();
    if (model_.parts.size() == first_part + 1 && (model_.parts.back().name.empty() || is_repeated))
      model_.parts.back().name = name;
    if (model_.curves.size() == first_curve + 1 && (model_.curves.back().name.empty() || is_repeated))
      model_.curves.back().name = name;
  }

  // Nothing but faces, bare or in shells of their own: a group of surfaces.
  static bool holds_only_faces(const TopoDS_Shape& shape) {
    for (TopoDS_Iterator it(shape); it.More(); it.Next()) {
      const TopAbs_ShapeEnum kind = it.Value().ShapeType();
      if (kind != TopAbs_FACE && (kind != TopAbs_SHELL || it.Value().NbChildren() != 1)) return false;
    }
    return shape.NbChildren() > 0;
  }

  void take_shape(const TopoDS_Shape& shape, Context& context) {
    switch (shape.ShapeType()) {
      case TopAbs_SOLID:
        return take_part(shape, cad::Part::Kind::solid, context);
      case TopAbs_SHELL:  // one face is joined to nothing
        return take_part(shape, shape.NbChildren() == 1 ? cad::Part::Kind::surfaces : cad::Part::Kind::shell,
                         context);
      case TopAbs_FACE:
        return take_part(shape, cad::Part::Kind::surfaces, context);
      case TopAbs_WIRE:
        return take_children(shape, context);
      case TopAbs_EDGE:
        return take_edge(TopoDS::Edge(shape), context);
      case TopAbs_VERTEX:
        return;
      default:
        break;
    }
    return holds_only_faces(shape) ? take_part(shape, cad::Part::Kind::surfaces, context)
                                   : take_children(shape, context);
  }

  void take_children(const TopoDS_Shape& shape, Context& context) {
    for (TopoDS_Iterator it(shape); it.More(); it.Next()) take_shape(it.Value(), context);
  }

  [[nodiscard]] static std::optional<cad::Color> color_in(const Context& context, const TopoDS_Shape& shape,
                                                          const std::optional<cad::Color>& otherwise) {
    const auto own = context.colors.find(shape.TShape().get());
    return own == context.colors.end() ? otherwise : own->second;
  }

  // Of what was made of `item`; `otherwise`: its colour where it has none of its own.
  [[nodiscard]] cad::Label label_of(const TopoDS_Shape& shape,
                                    const Handle(StepRepr_RepresentationItem) & item,
                                    const std::optional<cad::Color>& otherwise,
                                    const Context& context) const {
    return {name_of_item(item), color_in(context, shape, otherwise), 0, origin_of(item)};
  }

  void take_part(const TopoDS_Shape& shape, cad::Part::Kind kind, Context& context) {
    cad::Part part;
    part.kind = kind;
    part.label() = label_of(shape, item_of(shape), context.color, context);
    part.group = context.group;
    EdgeIds ids;
    take_faces(shape, part, part.color, ids, context);
    if (part.faces.empty()) return;
    part.kernel = std::make_shared<const TopoDS_Shape>(shape);
    part.kernel_scale = scale_ / working_;
    // Files give a group its colour face by face.
    const std::optional<cad::Color>& first = part.faces.front().color;
    if (!part.color && std::all_of(part.faces.begin(), part.faces.end(),
                                   [&](const cad::Face& face) { return face.color == first; }))
      part.color = first;
    model_.parts.push_back(std::move(part));
  }

  void take_faces(const TopoDS_Shape& shape, cad::Part& part, const std::optional<cad::Color>& color,
                  EdgeIds& ids, const Context& context) {
    if (shape.ShapeType() == TopAbs_FACE) return take_face(TopoDS::Face(shape), part, color, ids, context);
    for (TopoDS_Iterator it(shape); it.More(); it.Next())
      if (it.Value().ShapeType() <= TopAbs_FACE)
        take_faces(it.Value(), part, color_in(context, it.Value(), color), ids, context);
  }

  // Every placement of a thing costs something, empty ones too. False: nothing more is taken.
  bool spend(std::size_t points) {
    if (points_ <= most_points) points_ += points;
    return points_ <= most_points;
  }

  void take_face(const TopoDS_Face& shape, cad::Part& part, const std::optional<cad::Color>& color,
                 EdgeIds& ids, const Context& context) {
    if (points_ > most_points) return;
    const auto entity = Handle(StepShape_FaceSurface)::DownCast(item_of(shape));
    try {
      cad::Face face = to_face(shape, one_unit_ ? entity : Handle(StepShape_FaceSurface)(), working_, ids);
      stretch(face, scale_ / working_);
      cad::drop_natural_border(face, cad::border_tolerance(face, model_.resolution));
      face.label() = label_of(shape, entity, color, context);
      points_ += face.surface.points.size();
      for (const Vec3& p : face.surface.points)
        if (!p.allFinite()) throw Standard_Failure("a control point is no number");
      part.faces.push_back(std::move(face));
    } catch (const Standard_Failure& failure) {
      lost_face(origin_of(entity), failure);
    }
    spend(face_cost);
  }

  void lost_face(const cad::Origin& origin, const Standard_Failure& failure) {
    const char* reason = failure.GetMessageString();
    const std::string why = reason != nullptr && *reason != '\0' ? reason : failure.DynamicType()->Name();
    report_.error(spot_at(source_, origin.place), fmt::format("this face cannot be read: {}", why),
                  Kind::geometry);
  }

  void take_edge(const TopoDS_Edge& edge, Context& context) {
    double first = 0, last = 0;
    BRep_Tool::Range(edge, first, last);
    if (Precision::IsInfinite(first) || Precision::IsInfinite(last)) {
      report_.warning(spot_at(source_, origin_of(item_of(edge)).place), "a line without ends is left out");
      return;
    }
    cad::NamedCurve curve;
    curve.curve = to_curve(edge);
    if (curve.curve.points.empty()) return;
    stretch(curve.curve, scale_ / working_);
    curve.label() = label_of(edge, item_of(edge), context.color, context);
    model_.curves.push_back(std::move(curve));
  }

  // What OpenCASCADE could not use, as warnings: what it says of several once, of the first.
  void report_fails(const Interface_CheckIterator& checks) {
    struct Fail {
      std::string text;
      int id = 0;
      std::size_t others = 0;
    };
    std::vector<Fail> fails;
    std::unordered_map<std::string, std::size_t> known;  // to its place in the list
    for (checks.Start(); checks.More(); checks.Next()) {
      const Handle(Interface_Check)& check = checks.Value();
      if (!check->HasFailed()) continue;
      const Handle(Standard_Transient) entity =
          checks.Number() > 0 ? entities_->Value(checks.Number()) : check->Entity();
      const int id = entity.IsNull() ? 0 : entities_->IdentLabel(entity);
      const auto [place, is_new] = known.try_emplace(check->CFail(1), fails.size());
      if (is_new)
        fails.push_back({place->first, id});
      else
        ++fails[place->second].others;
    }
    for (const Fail& fail : fails)
      report_.warning(spot_of(fail.id),
                      fmt::format("#{}: {}{}", fail.id, fail.text,
                                  fail.others == 0 ? "" : fmt::format(", and {} more like it", fail.others)));
  }

  Session session_ = Session::to_read();  // before anything of OpenCASCADE's
  const Source& source_;
  const Part21& file_;
  TextReport& report_;
  cad::Model model_;
  double file_unit_ = 1;  // the first one of the file, mm
  double working_ = 1;    // OpenCASCADE's lengths over the file's numbers: a power of two
  double scale_ = 1;      // the model's lengths over the file's numbers
  bool one_unit_ = true;  // in all of the file
  STEPCAFControl_Reader reader_;
  Handle(TDocStd_Document) document_;
  Handle(StepData_StepModel) entities_;
  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colors_;
  std::unordered_map<const TopoDS_TShape*, Handle(StepRepr_RepresentationItem)> items_;
  std::size_t points_ = 0;
};

std::optional<cad::Model> read(const Source& source, TextReport& report) {
  const std::optional<Part21> file = inspect(source, report);
  if (!file) return std::nullopt;
  Result<cad::Model> model =
      solid::occt::guarded("the STEP file", [&] { return ModelReader(source, *file, report).read(); });
  if (model) return std::move(*model);
  report.error(Spot(), model.error().text, model.error().kind);
  return std::nullopt;
}

}  // namespace

std::optional<cad::Model> read_model(const Source& source, Diagnostics& diagnostics) {
  return reported(source, diagnostics, read);
}

}  // namespace selvage::formats::step
