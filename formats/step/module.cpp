// What the shared object selvage_occt shows to the program: a table for each part that it implements.
#include <Standard_Version.hxx>

#include "formats/step/properties.h"
#include "formats/step/reader.h"
#include "formats/step/writer.h"
#include "solid/brep.h"
#include "solid/occt/check.h"
#include "solid/occt/piece.h"

extern "C" __attribute__((visibility("default"))) const void* selvage_brep() {
  static const selvage::solid::BrepModule table = {.version = OCC_VERSION_COMPLETE,
                                                   .check = selvage::solid::occt::check,
                                                   .check_pieces = selvage::solid::occt::check_pieces};
  return &table;
}

extern "C" __attribute__((visibility("default"))) const void* selvage_step() {
  static const selvage::formats::step::StepModule table = {
      .open_writer = selvage::formats::step::open_writer,
      .read_model = selvage::formats::step::read_model,
      .check_properties = selvage::formats::step::check_properties};
  return &table;
}
