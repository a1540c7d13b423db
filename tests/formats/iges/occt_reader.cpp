#include "formats/iges/occt_reader.h"

#include <BRepBuilderAPI_MakeSolid.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <ShapeAnalysis_ShapeTolerance.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <XSControl_WorkSession.hxx>
#include <cmath>
#include <cstring>

namespace selvage::test {

namespace {

int count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  TopTools_IndexedMapOfShape map;
  TopExp::MapShapes(shape, kind, map);
  return map.Extent();
}

OcctSolid measured(const TopoDS_Solid& solid) {
  OcctSolid facts;
  facts.valid = BRepCheck_Analyzer(solid).IsValid();
  facts.closed = true;
  for (TopExp_Explorer shell(solid, TopAbs_SHELL); shell.More(); shell.Next())
    facts.closed = facts.closed && BRep_Tool::IsClosed(TopoDS::Shell(shell.Current()));
  TopTools_IndexedDataMapOfShapeListOfShape faces_of;
  TopExp::MapShapesAndAncestors(solid, TopAbs_EDGE, TopAbs_FACE, faces_of);
  for (int i = 1; i <= faces_of.Extent(); ++i) {
    const TopoDS_Edge& edge = TopoDS::Edge(faces_of.FindKey(i));
    // A seam has one face, twice; the pole of a fan has no length.
    if (faces_of(i).Extent() < 2 && !BRep_Tool::Degenerated(edge) &&
        !BRep_Tool::IsClosed(edge, TopoDS::Face(faces_of(i).First())))
      ++facts.free_edges;
  }
  GProp_GProps properties;
  BRepGProp::VolumeProperties(solid, properties, 1e-8);
  facts.volume = properties.Mass();
  facts.tolerance = ShapeAnalysis_ShapeTolerance().Tolerance(solid, 1);
  return facts;
}

}  // namespace

OcctReading read_with_occt(const std::filesystem::path& file, double sewing) {
  ::Message::DefaultMessenger()->ChangePrinters().Clear();
  IGESControl_Reader reader;
  OcctReading reading;
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) return reading;
  reader.TransferRoots();
  for (const bool loading : {true, false}) {
    Interface_CheckIterator checks =
        loading ? reader.WS()->ModelCheckList() : reader.WS()->LastRunCheckList();
    for (checks.Start(); checks.More(); checks.Next()) {
      const Handle(Interface_Check) check = checks.Value();
      reading.load_fails += check->NbFails();
      for (int i = 1; i <= check->NbWarnings(); ++i)
        if (std::strstr(check->CWarning(i), "periodic") == nullptr) ++reading.load_warnings;
    }
  }
  reading.roots = reader.NbRootsForTransfer();
  const TopoDS_Shape all = reader.OneShape();
  reading.faces = count(all, TopAbs_FACE);
  GProp_GProps areas;
  BRepGProp::SurfaceProperties(all, areas, 1e-10);
  reading.area = areas.Mass();
  reading.solids_in_file = count(all, TopAbs_SOLID);
  if (sewing <= 0) {
    for (TopExp_Explorer solid(all, TopAbs_SOLID); solid.More(); solid.Next())
      reading.solids.push_back(measured(TopoDS::Solid(solid.Current())));
    return reading;
  }
  for (int i = 1; i <= reader.NbShapes(); ++i) {
    BRepBuilderAPI_Sewing sewer(sewing);
    sewer.Add(reader.Shape(i));
    sewer.Perform();
    const TopoDS_Shape sewn = sewer.SewedShape();
    if (sewn.IsNull()) continue;
    TopoDS_Shape shells = sewn;
    if (count(shells, TopAbs_SHELL) == 0 && count(shells, TopAbs_FACE) == 1) {  // a ring stays a face
      TopoDS_Shell shell;
      BRep_Builder builder;
      builder.MakeShell(shell);
      builder.Add(shell, TopExp_Explorer(sewn, TopAbs_FACE).Current());
      shell.Closed(BRep_Tool::IsClosed(shell));
      shells = shell;
    }
    for (TopExp_Explorer shell(shells, TopAbs_SHELL); shell.More(); shell.Next()) {
      TopoDS_Solid solid = BRepBuilderAPI_MakeSolid(TopoDS::Shell(shell.Current()));
      BRepLib::OrientClosedSolid(solid);
      reading.solids.push_back(measured(solid));
      reading.solids.back().free_edges += sewer.NbFreeEdges();
    }
  }
  return reading;
}

}  // namespace selvage::test
