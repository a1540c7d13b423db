// A run of one job that is no batch: `diff`, `edit`.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "pipeline/job.h"

namespace selvage::pipeline {

struct Single {
  std::string what;                            // in messages: "the comparison"
  std::vector<std::string> inputs;             // paths, as for contain_job
  std::vector<std::filesystem::path> outputs;  // likewise
  std::function<Verdict(const Channel&)> work;
};

// Does it in a contained process of its own; messages go to standard error as they come, results to standard
// output at the end. Returns the program's exit code.
int run_single(const Options& options, const Single& single);

}  // namespace selvage::pipeline
