// A whole run: every input in a process of its own, their messages, results and reports put together.
#pragma once

#include "pipeline/options.h"

namespace selvage::pipeline {

// Does what the options ask for; returns the program's exit code (src/cli/README.md). Messages go to standard
// error, results to standard output.
int run(const Options& options);

// How many jobs or threads at once: -j, or one a core that this process may use.
std::size_t available_cores(const Options& options);

// Says what is wrong with the command line; returns 2.
int refuse(const Message& message);

}  // namespace selvage::pipeline
