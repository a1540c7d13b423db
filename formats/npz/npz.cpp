#include "core/module.h"
#include "formats/npz/archive.h"
#include "formats/npz/npy.h"
#include "formats/registry.h"

namespace selvage::formats::npz {
namespace {

std::string_view bytes_of(const void* data, std::size_t size) {
  return {static_cast<const char*>(data), size};
}

Result<WriteFacts> write(const fem::Raster& raster, OutputFile& output) {
  std::vector<Member> members;
  const auto add = [&](std::string_view name, std::string_view type,
                       const std::vector<std::size_t>& dimensions, std::string_view data) {
    members.push_back({std::string(name) + ".npy", npy_head(type, dimensions), data});
  };
  const auto [nx, ny, nz] = raster.count;
  for (const fem::RasterField& field : fem::fields_of(raster)) {
    std::vector<std::size_t> dimensions = {nz, ny, nx};
    if (field.components > 1) dimensions.push_back(field.components);
    add(field.name, field.type == fem::RasterField::Type::uint16 ? "<u2" : "<f4", dimensions,
        bytes_of(field.data, field.bytes));
  }
  const fem::PhaseColumns phases = fem::columns_of(raster.phases);
  const Vec3 lengths = raster.lengths();
  const std::vector<std::string> title = {raster.title};
  const TextArray name_array = text_array(phases.names), material_array = text_array(phases.materials),
                  title_array = text_array(title);
  add("phase_names", name_array.type, {phases.names.size()}, name_array.data);
  add("phase_materials", material_array.type, {phases.materials.size()}, material_array.data);
  add("phase_fractions", "<f8", {phases.fractions.size()},
      bytes_of(phases.fractions.data(), phases.fractions.size() * sizeof(double)));
  add("origin", "<f8", {3}, bytes_of(raster.origin.data(), 3 * sizeof(double)));
  add("lengths", "<f8", {3}, bytes_of(lengths.data(), 3 * sizeof(double)));
  add("vectors", "<f8", {3, 3}, bytes_of(raster.edges.data(), sizeof(raster.edges)));
  add("title", title_array.type, {1}, title_array.data);
  const Result<const ZipModule*> module = module_table<ZipModule>("minizip", "selvage_minizip");
  if (!module) return module.error();
  if (Status written = (*module)->write(members, output); !written) return written.error();
  return WriteFacts{.entities = {{"voxels", raster.voxels()}, {"phases", raster.phases.size()}}};
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "npz",
                                  .title = "NumPy arrays, a unit cell as fields on voxels",
                                  .extensions = {".npz"},
                                  .write_raster = write};
  return self;
}

}  // namespace selvage::formats::npz
