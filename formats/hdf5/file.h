// What an HDF5 file holds, and the module that writes it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/diagnostics.h"

namespace selvage::formats::hdf5 {

// An array of numbers, the last dimension the fastest, or a list of texts.
struct Dataset {
  enum class Type { uint16, float32, float64, text };
  std::string name;
  Type type = Type::float64;
  std::vector<std::size_t> dimensions;
  const void* data = nullptr;        // of numbers
  std::vector<std::string> texts{};  // UTF-8
  std::string order{};               // the attribute `permute_order`; empty: it has none
};

// What the module has.
struct Hdf5Module {
  // The bytes of a file with these datasets at its root; large ones in chunks, compressed. No times in it:
  // the same data give the same bytes. Errors: limit (memory), internal (what HDF5 says).
  Result<std::string> (*file)(std::span<const Dataset> datasets);
};

}  // namespace selvage::formats::hdf5
