// What OpenCASCADE reads in IGES and STEP files, as JSON, one object a line: for tests of the program.
//   occt_totals [--count] FILE...
// IGES: the file's solids, or the solids that its sewn roots make. STEP: the parts of its assembly, where
// they are placed. Volumes in cubic millimetres. --count: IGES entities, roots and faces
// only, without sewing.
#include <fmt/format.h>

#include <IGESControl_Reader.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Check.hxx>
#include <Interface_CheckIterator.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <TopExp_Explorer.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cstdio>
#include <string_view>

#include "formats/iges/occt_reader.h"
#include "formats/step/reading.h"

namespace {

void count_iges(const char* path) {
  ::Message::DefaultMessenger()->ChangePrinters().Clear();
  IGESControl_Reader reader;
  const bool ok = reader.ReadFile(path) == IFSelect_RetDone;
  int surfaces = 0;
  for (int i = 1; ok && i <= reader.IGESModel()->NbEntities(); ++i)
    surfaces += reader.IGESModel()->Entity(i)->TypeNumber() == 128 ? 1 : 0;
  int fails = 0;
  Interface_CheckIterator checks = reader.WS()->ModelCheckList();
  for (checks.Start(); checks.More(); checks.Next()) fails += checks.Value()->NbFails();
  const int roots = ok ? reader.NbRootsForTransfer() : 0;
  if (ok) reader.TransferRoots();
  int faces = 0;
  for (int i = 1; i <= reader.NbShapes(); ++i)
    for (TopExp_Explorer face(reader.Shape(i), TopAbs_FACE); face.More(); face.Next()) ++faces;
  fmt::print("{{\"ok\": {}, \"fails\": {}, \"roots\": {}, \"128\": {}, \"faces\": {}}}\n", ok, fails, roots,
             surfaces, faces);
}

void read_iges(const char* path) {
  selvage::test::OcctReading reading = selvage::test::read_with_occt(path, 0);
  if (reading.solids_in_file == 0) reading = selvage::test::read_with_occt(path, 1e-5);
  double volume = 0;
  int valid = 0;
  for (const selvage::test::OcctSolid& solid : reading.solids) {
    volume += solid.volume;
    valid += solid.valid && solid.closed && solid.free_edges == 0 ? 1 : 0;
  }
  fmt::print(
      "{{\"fails\": {}, \"roots\": {}, \"faces\": {}, \"solids\": {}, \"valid\": {}, \"volume\": {}}}\n",
      reading.load_fails, reading.roots, reading.faces, reading.solids.size(), valid, volume);
}

void read_step(const char* path) {
  const selvage::tests::ReadFile file = selvage::tests::read_step(path, true);
  double volume = 0;
  int valid = 0, solids = 0;
  std::string parts;
  for (const selvage::tests::ReadPart& part : file.parts) {
    volume += part.volume;
    solids += part.is_solid ? 1 : 0;
    valid += part.is_solid && part.valid && part.free_edges == 0 ? 1 : 0;
    const selvage::Vec3 low = part.box.min(), high = part.box.max();
    parts += fmt::format("{}[\"{}\", [{}, {}, {}], [{}, {}, {}], [{}, {}, {}]]", parts.empty() ? "" : ", ",
                         part.name, part.color[0], part.color[1], part.color[2], low.x(), low.y(), low.z(),
                         high.x(), high.y(), high.z());
  }
  fmt::print("{{\"ok\": {}, \"solids\": {}, \"valid\": {}, \"volume\": {}, \"parts\": [{}]}}\n", file.ok,
             solids, valid, volume, parts);
}

}  // namespace

int main(int argc, char** argv) {
  const bool count = argc > 1 && std::string_view(argv[1]) == "--count";
  for (int i = count ? 2 : 1; i < argc; ++i) {
    const std::string_view path = argv[i];
    if (count)
      count_iges(argv[i]);
    else if (path.ends_with(".stp"))
      read_step(argv[i]);
    else
      read_iges(argv[i]);
  }
  return 0;
}
