// occt_trip step|step-named|iges IN step|step-named|iges|iges-brep OUT: reads a file by OpenCASCADE and
// writes what it has read by OpenCASCADE. `named`: with names and colours (XDE); `iges-brep`: solids (186)
// instead of faces.
#include <IGESControl_Controller.hxx>
#include <IGESControl_Reader.hxx>
#include <IGESControl_Writer.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <STEPControl_Reader.hxx>
#include <STEPControl_Writer.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Shape.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cstdio>
#include <string>

namespace {

template <class Reader>
TopoDS_Shape read(const char* path) {
  Reader reader;
  if (reader.ReadFile(path) != IFSelect_RetDone) return {};
  reader.TransferRoots();
  return reader.OneShape();
}

bool named(const char* from, const char* to) {
  STEPCAFControl_Reader reader;
  reader.SetColorMode(true);
  reader.SetNameMode(true);
  Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  if (reader.ReadFile(from) != IFSelect_RetDone || !reader.Transfer(document)) return false;
  STEPCAFControl_Writer writer;
  writer.SetColorMode(true);
  writer.SetNameMode(true);
  return writer.Transfer(document) && writer.Write(to) == IFSelect_RetDone;
}

bool write(const TopoDS_Shape& shape, const std::string& form, const char* path) {
  if (form == "step") {
    STEPControl_Writer writer;
    return writer.Transfer(shape, STEPControl_AsIs) == IFSelect_RetDone &&
           writer.Write(path) == IFSelect_RetDone;
  }
  IGESControl_Writer writer("MM", form == "iges-brep" ? 1 : 0);
  if (!writer.AddShape(shape)) return false;
  writer.ComputeModel();
  return writer.Write(path);
}

}  // namespace

int main(int count, char** words) {
  if (count != 5) return 2;
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPCAFControl_Controller::Init();
  IGESControl_Controller::Init();
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  const std::string from = words[1], to = words[3];
  bool done = false;
  if (to == "step-named") {
    done = from == "step-named" && named(words[2], words[4]);
  } else {
    const TopoDS_Shape shape =
        from == "iges" ? read<IGESControl_Reader>(words[2]) : read<STEPControl_Reader>(words[2]);
    done = !shape.IsNull() && write(shape, to, words[4]);
  }
  if (!done) std::fprintf(stderr, "OpenCASCADE could not take %s to %s\n", words[2], words[4]);
  return done ? 0 : 1;
}
