// Binary data inside VTK's XML.
#pragma once

#include <cstddef>
#include <string>

#include "core/diagnostics.h"

namespace selvage::formats::vtu {

// Blocks of zlib, each array as VTK's vtkZLibDataCompressor writes it with header_type UInt64: the numbers of
// blocks, of bytes in a whole block and in a last smaller one, and of compressed bytes in each; then the
// blocks; head and blocks in base64. Error (limit): zlib has no memory.
Result<std::string> encode(const void* data, std::size_t size);

}  // namespace selvage::formats::vtu
