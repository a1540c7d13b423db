#include "reading.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <ShapeAnalysis_ShapeTolerance.hxx>
#include <TColStd_HSequenceOfExtendedString.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TCollection_AsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDataStd_TreeNode.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <XCAFDoc.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_MaterialTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cmath>

#include "face_flux.h"

namespace selvage::tests {

namespace {

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  return TCollection_AsciiString(name->Get()).ToCString();
}

void add_faces(const TopoDS_Shape& shape, ReadPart& part) {
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    ++part.faces;
    const Handle(Geom_BSplineSurface) surface =
        Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(TopoDS::Face(it.Current())));
    if (surface.IsNull()) continue;
    for (int j = 1; j <= surface->NbVPoles(); ++j)
      for (int i = 1; i <= surface->NbUPoles(); ++i) {
        const gp_Pnt& pole = surface->Pole(i, j);
        part.box.extend(Vec3(pole.X(), pole.Y(), pole.Z()));
      }
  }
}

// About a point of the solid, from which little flows in and out that would cancel.
double volume_of(const TopoDS_Shape& solid) {
  const gp_Pnt centre = BRep_Tool::Pnt(TopoDS::Vertex(TopExp_Explorer(solid, TopAbs_VERTEX).Current()));
  double volume = 0.0;
  for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
    const std::optional<double> flux = flux_through(TopoDS::Face(face.Current()), centre);
    volume += flux.value_or(0.0);
    if (flux) continue;
    GProp_GProps properties;  // with trimmed planes: its own quadrature
    BRepGProp::VolumeProperties(solid, properties, 1e-9);
    return properties.Mass();
  }
  return volume;
}

ReadPart examine(const TopoDS_Shape& shape) {
  ReadPart part;
  part.is_solid = shape.ShapeType() == TopAbs_SOLID;
  part.valid = BRepCheck_Analyzer(shape).IsValid();
  TopTools_IndexedDataMapOfShapeListOfShape faces_of;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of);
  for (int i = 1; i <= faces_of.Extent(); ++i)
    if (faces_of(i).Extent() < 2 && !BRep_Tool::Degenerated(TopoDS::Edge(faces_of.FindKey(i))))
      ++part.free_edges;
  ShapeAnalysis_ShapeTolerance tolerance;
  part.tolerance =
      std::max(tolerance.Tolerance(shape, 1, TopAbs_EDGE), tolerance.Tolerance(shape, 1, TopAbs_VERTEX));
  if (part.is_solid) {
    part.volume = volume_of(shape);
  }
  add_faces(shape, part);
  return part;
}

}  // namespace

ReadFile read_step(const std::string& path, bool into_groups) {
  ReadFile file;
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPCAFControl_Controller::Init();
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  STEPCAFControl_Reader reader;
  reader.SetColorMode(true);
  reader.SetNameMode(true);
  reader.SetMatMode(true);
  reader.SetLayerMode(true);
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) return file;
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  for (int i = 1; i <= lengths.Length(); ++i) file.units.emplace_back(lengths(i).ToCString());
  Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  if (!reader.Transfer(document)) return file;
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const Handle(XCAFDoc_LayerTool) layers = XCAFDoc_DocumentTool::LayerTool(document->Main());
  const Handle(XCAFDoc_ColorTool) colors = XCAFDoc_DocumentTool::ColorTool(document->Main());
  TDF_LabelSequence roots;
  shapes->GetFreeShapes(roots);
  if (roots.Length() != 1) return file;
  file.title = name_of(roots(1));
  TDF_LabelSequence components;
  XCAFDoc_ShapeTool::GetComponents(roots(1), components);
  std::vector<TopLoc_Location> places(static_cast<std::size_t>(components.Length()));
  for (int i = 1; i <= components.Length(); ++i) {
    TDF_Label label;
    if (!XCAFDoc_ShapeTool::GetReferredShape(components(i), label)) return file;
    const TopLoc_Location place = places[static_cast<std::size_t>(i - 1)];
    TDF_LabelSequence inner;
    if (into_groups && XCAFDoc_ShapeTool::GetComponents(label, inner)) {
      for (int k = 1; k <= inner.Length(); ++k) {
        components.Append(inner(k));
        places.push_back(place * XCAFDoc_ShapeTool::GetLocation(components(i)));
      }
      continue;
    }
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    ReadPart part = examine(XCAFDoc_ShapeTool::GetShape(components(i)).Moved(place));
    part.name = name_of(components(i));
    Quantity_Color color;
    if (colors->GetColor(shape, XCAFDoc_ColorSurf, color) ||
        colors->GetColor(shape, XCAFDoc_ColorGen, color)) {
      double red = 0, green = 0, blue = 0;
      color.Values(red, green, blue, Quantity_TOC_sRGB);
      const auto byte = [](double share) { return static_cast<int>(std::lround(255 * share)); };
      part.color = {byte(red), byte(green), byte(blue)};
    }
    Handle(TDataStd_TreeNode) made_of;
    if (label.FindAttribute(XCAFDoc::MaterialRefGUID(), made_of) && made_of->HasFather()) {
      Handle(TCollection_HAsciiString) name, description, density_name, density_type;
      XCAFDoc_DocumentTool::MaterialTool(document->Main())
          ->GetMaterial(made_of->Father()->Label(), name, description, part.density, density_name,
                        density_type);
      part.material = name->ToCString();
    }
    Handle(TColStd_HSequenceOfExtendedString) its_layers;
    if (layers->GetLayers(shape, its_layers) && its_layers->Length() == 1)
      part.layer = TCollection_AsciiString(its_layers->Value(1)).ToCString();
    file.parts.push_back(std::move(part));
  }
  file.ok = true;
  return file;
}

}  // namespace selvage::tests
