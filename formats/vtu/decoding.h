// Arrays of VTK's XML as numbers, in the forms in which its programs write them.
#pragma once

#include <string_view>
#include <vector>

#include "core/diagnostics.h"

namespace selvage::formats::vtu {

struct Coding {
  bool is_big_endian = false;
  bool has_long_heads = false;  // header_type UInt64
  bool is_compressed = false;   // by zlib
};

// The numbers of words, as in format="ascii". Error (malformed): a word that is no finite number.
Result<std::vector<double>> decode_words(std::string_view text);

// The numbers of an array of this `type` ("Float64") that begins where `data` does and ends at some place
// before its end; in base64, or as bytes. Errors: malformed (no such data, or too little), unsupported (a
// type that is none of numbers, another compression), limit (more memory than the data can mean).
Result<std::vector<double>> decode(std::string_view data, bool is_base64, std::string_view type,
                                   const Coding& coding);

}  // namespace selvage::formats::vtu
