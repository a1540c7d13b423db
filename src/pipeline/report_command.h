// `selvage report`: reports of several runs joined, or shown on a page.
#pragma once

#include "pipeline/options.h"

namespace selvage::pipeline {

// Returns the program's exit code; what went wrong was said.
int run_report(const Options& options);

}  // namespace selvage::pipeline
