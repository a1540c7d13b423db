// Arrays of VTK's XML as numbers, in the forms in which its programs write them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"

namespace selvage::formats::vtu {

struct Coding {
  bool is_big_endian = false;
  bool has_long_heads = false;  // header_type UInt64
  bool is_compressed = false;   // by zlib
};

// How many numbers all arrays of a file may have, by its size: a few bytes may stand for millions where they
// are compressed, or where several arrays are said to be at one place.
class NumberBudget {
 public:
  explicit NumberBudget(std::size_t file_size) : most_(8'000'000 + 8 * file_size), left_(most_) {}
  // Error (limit): they would be more.
  Status take(std::uint64_t numbers);

 private:
  std::uint64_t most_, left_;
};

// The numbers of words, as in format="ascii". Error (malformed): a word that is no finite number.
Result<std::vector<double>> decode_words(std::string_view text);

// The numbers of an array of this `type` ("Float64") that begins where `data` does and ends at some place
// before its end; in base64, or as bytes. Errors: malformed (no such data, or too little), unsupported (a
// type that is none of numbers, another compression), limit (more numbers than the budget has left).
Result<std::vector<double>> decode(std::string_view data, bool is_base64, std::string_view type,
                                   const Coding& coding, NumberBudget& budget);

}  // namespace selvage::formats::vtu
