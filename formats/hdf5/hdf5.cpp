#include "core/module.h"
#include "formats/hdf5/file.h"
#include "formats/registry.h"

namespace selvage::formats::hdf5 {
namespace {

Dataset::Type type_of(fem::RasterField::Type type) {
  return type == fem::RasterField::Type::uint16 ? Dataset::Type::uint16 : Dataset::Type::float32;
}

// A number an axis, or a phase.
Dataset numbers(const char* name, const double* data, std::size_t size) {
  return {name, Dataset::Type::float64, {size}, data};
}

Dataset texts(const char* name, std::vector<std::string> words) {
  Dataset list{name, Dataset::Type::text, {words.size()}};
  list.texts = std::move(words);
  return list;
}

Result<WriteFacts> write(const fem::Raster& raster, OutputFile& output) {
  std::vector<Dataset> datasets;
  const auto [nx, ny, nz] = raster.count;
  for (const fem::RasterField& field : fem::fields_of(raster)) {
    Dataset one{std::string(field.name), type_of(field.type), {nz, ny, nx}, field.data};
    if (field.components > 1) one.dimensions.push_back(field.components);
    one.order = "zyx";
    datasets.push_back(std::move(one));
  }
  const fem::PhaseColumns phases = fem::columns_of(raster.phases);
  const Vec3 lengths = raster.lengths();
  datasets.push_back(texts("phase_names", phases.names));
  datasets.push_back(texts("phase_materials", phases.materials));
  datasets.push_back(numbers("phase_fractions", phases.fractions.data(), phases.fractions.size()));
  datasets.push_back(numbers("origin", raster.origin.data(), 3));
  datasets.push_back(numbers("lengths", lengths.data(), 3));
  datasets.push_back({"vectors", Dataset::Type::float64, {3, 3}, raster.edges.data()});
  datasets.push_back(texts("title", {raster.title}));
  const Result<std::string> bytes = call(module_table<Hdf5Module>("hdf5", "selvage_hdf5"), &Hdf5Module::file,
                                         std::span<const Dataset>(datasets));
  if (!bytes) return bytes.error();
  if (Status written = output.write(*bytes); !written) return written.error();
  return WriteFacts{.entities = {{"voxels", raster.voxels()}, {"phases", raster.phases.size()}}};
}

bool is_hdf5(std::string_view head) {
  return head.starts_with("\x89HDF\r\n\x1a\n");
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "hdf5",
                                  .title = "HDF5, a unit cell as fields on voxels",
                                  .extensions = {".h5", ".hdf5"},
                                  .sniff = is_hdf5,
                                  .write_raster = write};
  return self;
}

}  // namespace selvage::formats::hdf5
