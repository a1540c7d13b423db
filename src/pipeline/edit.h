// `selvage edit`: what is asked for.
#pragma once

#include "core/diagnostics.h"
#include "formats/format.h"
#include "pipeline/options.h"

namespace selvage::pipeline {

// Errors (usage): words that do not go together, or are no numbers.
Result<formats::NewEdit> wanted_edit(const EditWords& words);

}  // namespace selvage::pipeline
