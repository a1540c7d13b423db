// `selvage roundtrip`: which formats an input goes through.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "formats/format.h"
#include "pipeline/options.h"

namespace selvage::pipeline {

struct Trip {
  std::string name;  // "iges", "iges-solid", "step", "txt"
  const formats::Descriptor* format = nullptr;
  bool iges_solid = false;
};

// Every format that surfaces are written to and read from, IGES as surfaces and as solids; those of --to
// where it is given. Error (usage): an unknown name, a format that is not both written and read.
Result<std::vector<Trip>> wanted_trips(const Options& options);

}  // namespace selvage::pipeline
