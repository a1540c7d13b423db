#include "formats/iges/reader.h"

#include "formats/iges/types.h"

namespace selvage::formats::iges {

namespace {

std::optional<cad::Model> read(const Source& source, TextReport& report) {
  Complaints complaints(report);
  const std::optional<File> file = File::open(source, complaints);
  if (!file) return std::nullopt;
  const Global& global = file->global();
  cad::Model model;
  model.file = source.name();
  // Our own writer puts the file's name where there is no title.
  if (global.product != global.file_name) model.title = global.product;
  model.file_name = global.file_name;
  model.date = global.date;
  model.system = global.system;
  model.units = global.units;
  model.resolution = global.resolution;
  Reading reading(*file, type_of, report, model);
  reading.stand_all();
  return model;
}

}  // namespace

std::optional<cad::Model> read_model(const Source& source, Diagnostics& diagnostics) {
  return reported(source, diagnostics, read);
}

}  // namespace selvage::formats::iges
