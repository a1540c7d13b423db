// The HDF5 library behind formats/hdf5/file.h.
#include <hdf5.h>

#include <algorithm>
#include <stdexcept>

#include "core/module.h"
#include "formats/hdf5/file.h"

namespace selvage::formats::hdf5 {
namespace {

// What HDF5 counts, given back by its own function.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t), const char* what) : id_(id), close_(close) {
    if (id < 0) throw std::runtime_error(std::string("cannot make ") + what);
  }
  ~Handle() { close_(id_); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor)

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void done(herr_t status, const char* what) {
  if (status < 0) throw std::runtime_error(std::string("cannot ") + what);
}

Handle text_type() {
  return {H5Tcopy(H5T_C_S1), H5Tclose, "a type of texts"};
}

void add_order(hid_t dataset, const std::string& order) {
  const Handle type = text_type();
  done(H5Tset_size(type, H5T_VARIABLE), "set a text's size");
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, "a place");
  const Handle attribute(H5Acreate2(dataset, "permute_order", type, space, H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "an attribute");
  const char* const text = order.c_str();
  done(H5Awrite(attribute, type, &text), "write an attribute");
}

// Whole rows and layers, some 260,000 numbers.
std::vector<hsize_t> chunk_of(const std::vector<hsize_t>& dimensions) {
  constexpr hsize_t numbers = hsize_t{1} << 18U;
  std::vector<hsize_t> chunk = dimensions;
  hsize_t layer = 1;
  for (std::size_t i = dimensions.size(); i-- > 0;) {
    chunk[i] = std::max<hsize_t>(1, std::min(dimensions[i], numbers / layer));
    layer *= chunk[i];
  }
  return chunk;
}

void add(hid_t file, const Dataset& one) {
  const std::vector<hsize_t> dimensions(one.dimensions.begin(), one.dimensions.end());
  const Handle space(H5Screate_simple(static_cast<int>(dimensions.size()), dimensions.data(), nullptr),
                     H5Sclose, "a space");
  const Handle settings(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "settings");
  done(H5Pset_obj_track_times(settings, false), "leave out times");
  const Handle text = text_type();
  done(H5Tset_size(text, H5T_VARIABLE), "set a text's size");
  done(H5Tset_cset(text, H5T_CSET_UTF8), "set a text's characters");
  hid_t in_file = text, in_memory = text;
  switch (one.type) {
    case Dataset::Type::uint16:
      in_file = H5T_STD_U16LE;
      in_memory = H5T_NATIVE_UINT16;
      break;
    case Dataset::Type::float32:
      in_file = H5T_IEEE_F32LE;
      in_memory = H5T_NATIVE_FLOAT;
      break;
    case Dataset::Type::float64:
      in_file = H5T_IEEE_F64LE;
      in_memory = H5T_NATIVE_DOUBLE;
      break;
    case Dataset::Type::text:
      break;
  }
  constexpr std::size_t worth_packing = 4096;
  if (one.type != Dataset::Type::text &&
      H5Sget_simple_extent_npoints(space) >= static_cast<hssize_t>(worth_packing)) {
    const std::vector<hsize_t> chunk = chunk_of(dimensions);
    done(H5Pset_chunk(settings, static_cast<int>(chunk.size()), chunk.data()), "set chunks");
    done(H5Pset_shuffle(settings), "set the order of bytes");
    done(H5Pset_deflate(settings, 1), "set compression");
  }
  const Handle dataset(H5Dcreate2(file, one.name.c_str(), in_file, space, H5P_DEFAULT, settings, H5P_DEFAULT),
                       H5Dclose, "a dataset");
  std::vector<const char*> texts;
  for (const std::string& word : one.texts) texts.push_back(word.c_str());
  done(H5Dwrite(dataset, in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                one.type == Dataset::Type::text ? static_cast<const void*>(texts.data()) : one.data),
       "write a dataset");
  if (!one.order.empty()) add_order(dataset, one.order);
}

// In memory, for the program's own file has no name yet.
std::string file_of(std::span<const Dataset> datasets) {
  done(H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr), "keep still");  // errors are told here
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "settings");
  constexpr std::size_t grows_by = std::size_t{16} << 20U;
  done(H5Pset_fapl_core(access, grows_by, false), "keep a file in memory");
  done(H5Pset_libver_bounds(access, H5F_LIBVER_EARLIEST, H5F_LIBVER_V18), "set the version");
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "settings");
  const Handle file(H5Fcreate("voxels", H5F_ACC_TRUNC, creation, access), H5Fclose, "a file");
  for (const Dataset& one : datasets) add(file, one);
  done(H5Fflush(file, H5F_SCOPE_LOCAL), "finish the file");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size <= 0) throw std::runtime_error("the file is empty");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size)
    throw std::runtime_error("cannot copy the file");
  return bytes;
}

Result<std::string> guarded(std::span<const Dataset> datasets) {
  return guarded_by_module("HDF5", [&]() -> Result<std::string> { return file_of(datasets); });
}

}  // namespace
}  // namespace selvage::formats::hdf5

extern "C" __attribute__((visibility("default"))) const void* selvage_hdf5() {
  using namespace selvage::formats::hdf5;
  static const Hdf5Module table = {&guarded};
  return &table;
}
