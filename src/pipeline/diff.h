// `selvage diff`: the geometry of two files of any readable formats.
#pragma once

#include "pipeline/options.h"

namespace selvage::pipeline {

// Of the two inputs. Differences go to standard output, messages to standard error. Returns the exit code: 0
// equal, 1 an input failed, 2 both are standard input, 3 different, 130 interrupted.
int diff(const Options& options);

}  // namespace selvage::pipeline
