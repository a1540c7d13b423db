// Reads a program of a knitting machine in memory.
#pragma once

#include "fabric_reading.h"
#include "formats/knitout/program.h"
#include "formats/registry.h"

namespace selvage::test {

inline Reading read(std::string text) {
  return read(formats::knitout::descriptor(), Source::from_memory(std::move(text), "test.knitout"));
}

// Four lines: carrier 1 is in.
inline const std::string head = ";!knitout-2\n;;Gauge: 10\n;;Carriers: 1 2 3\ninhook 1\n";

}  // namespace selvage::test
