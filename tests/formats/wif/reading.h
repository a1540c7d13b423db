// Reads a WIF in memory, and makes small ones.
#pragma once

#include <optional>
#include <string>

#include "formats/wif/wif.h"

namespace selvage::test {

struct Reading {
  std::optional<fabric::Fabric> fabric;
  Diagnostics diagnostics;

  [[nodiscard]] std::string text() const {
    std::string all;
    for (const Message& message : diagnostics.messages()) all += to_string(message) + "\n";
    return all;
  }
  [[nodiscard]] const fabric::Weave& weave() const { return std::get<fabric::Weave>(fabric->items.at(0)); }
};

inline Reading read(std::string text) {
  const Source source = Source::from_memory(std::move(text), "test.wif");
  Reading reading;
  reading.fabric = formats::wif::descriptor().read_fabric(source, reading.diagnostics);
  return reading;
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
