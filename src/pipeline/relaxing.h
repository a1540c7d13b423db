// `selvage relax` and --relax: the fabric's yarns are built and moved apart, and the fabric that goes on
// through the pipeline has them as they are then.
#pragma once

#include <optional>

#include "fabric/model.h"
#include "pipeline/job.h"

namespace selvage::pipeline {

// Where the options ask for it: the same fabric (title, units, threads, materials, cell, pieces, ...) with
// every yarn, ply and filament a yarn of its own whose shape is its surface, moved apart as the options say.
// Nothing when that failed, or when there is no solution (Job::unsolved is then set): it was said why. Before
// and after are printed and in the report. Yarns that keep their distances already come back as they were
// built, to the bit. Without that the fabric as it is.
std::optional<fabric::Fabric> relaxed(Job& job, std::optional<fabric::Fabric> fabric);

}  // namespace selvage::pipeline
