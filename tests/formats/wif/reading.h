// Reads a WIF in memory, and makes small ones.
#pragma once

#include "fabric_reading.h"
#include "formats/registry.h"

namespace selvage::test {

inline Reading read(std::string text) {
  return read(formats::wif::descriptor(), Source::from_memory(std::move(text), "test.wif"));
}

// A plain weave of 2 x 2 without lengths and colours. Thirteen lines; the tie-up and the treadling are the
// caller's.
inline const std::string plain =
    "[WIF]\nVersion=1.1\n"
    "[WEAVING]\nShafts=2\nTreadles=2\n"
    "[WARP]\nThreads=2\n"
    "[WEFT]\nThreads=2\n"
    "[THREADING]\n1=1\n2=2\n"
    "[TIEUP]\n";

}  // namespace selvage::test
