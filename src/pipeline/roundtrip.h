// `selvage roundtrip`: which formats an input goes through.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "formats/format.h"
#include "pipeline/options.h"

namespace selvage::pipeline {

struct Trip {
  std::string name;  // of the format, or of the option that makes its other form
  const formats::Descriptor* format = nullptr;
  const Option* form = nullptr;  // that option; null: the format as it is
};

// Every format that surfaces are written to and read from, in each of its forms; those of --to where it is
// given. Error (usage): an unknown name, a format that is not both written and read.
Result<std::vector<Trip>> wanted_trips(const Options& options);
// The names of all that there are, for help.
std::string trip_names();

}  // namespace selvage::pipeline
