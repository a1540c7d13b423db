#include "cli/formats.h"

#include "formats/registry.h"
#include "pipeline/table.h"

namespace selvage::cli {

namespace {

std::string read_word(const formats::Descriptor& format) {
  if (format.read_fabric != nullptr) return "fabric";
  if (format.read_points != nullptr) return "points";
  if (format.read_mesh != nullptr) return "mesh";
  return format.read_model != nullptr ? "surfaces" : "-";
}

}  // namespace

std::string table_of_formats() {
  pipeline::Table table({"name", "extensions", "read", "write", "what"});
  for (const formats::Descriptor* format : formats::all_formats()) {
    std::string extensions, write;
    const auto append = [](std::string& list, std::string_view word) {
      list += (list.empty() ? "" : " ") + std::string(word);
    };
    for (std::string_view extension : format->extensions) append(extensions, extension);
    if (format->write_fabric != nullptr) append(write, "fabric");
    if (format->open_bodies != nullptr && format->carries_surfaces) append(write, "surfaces");
    if (format->open_bodies != nullptr && format->carries_curves) append(write, "curves");
    if (format->open_bodies != nullptr && format->carries_lines) append(write, "lines");
    if (format->write_mesh != nullptr) append(write, "mesh");
    if (format->write_beams != nullptr) append(write, "beams");
    if (format->write_raster != nullptr) append(write, "voxels");
    table.add({std::string(format->name), extensions, read_word(*format), write.empty() ? "-" : write,
               std::string(format->title)});
  }
  return table.text();
}

}  // namespace selvage::cli
