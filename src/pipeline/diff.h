// `selvage diff`: the geometry of two files of any readable formats.
#pragma once

#include <string>

#include "pipeline/options.h"

namespace selvage::pipeline {

struct DiffRequest {
  std::string a, b;      // paths; "-": standard input
  double tolerance = 0;  // in a's unit
  bool json = false;
  bool all = false;  // every difference, not only the first ones
  Options options;   // workers, timeout, memory, quiet, verbose, no_progress, detail
};

// Differences go to standard output, messages to standard error. Returns the exit code: 0 equal, 1 an input
// failed, 3 different, 130 interrupted.
int diff(const DiffRequest& request);

}  // namespace selvage::pipeline
