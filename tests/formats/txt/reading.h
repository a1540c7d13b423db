// Reads a text in memory, as the tests like it.
#pragma once

#include "fabric_reading.h"
#include "formats/registry.h"

namespace selvage::test {

inline Reading read(const Source& source) {
  return read(formats::txt::descriptor(), source);
}

inline Reading read(std::string text) {
  return read(Source::from_memory(std::move(text), "test.txt"));
}

}  // namespace selvage::test
