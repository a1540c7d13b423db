// What the shared object selvage_occt shows to the program: one function that returns its table.
#include <Standard_Version.hxx>

#include "formats/step/writer.h"
#include "solid/brep.h"
#include "solid/occt/check.h"

extern "C" __attribute__((visibility("default"))) const void* selvage_occt() {
  static const selvage::solid::OcctModule table = {.version = OCC_VERSION_COMPLETE,
                                                   .check = selvage::solid::occt::check,
                                                   .open_step = selvage::formats::step::open_writer};
  return &table;
}
