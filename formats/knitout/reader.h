// A knitout program to the model: one weft knit. README.md: what is read, and how.
#pragma once

#include <optional>

#include "core/diagnostics.h"
#include "core/source.h"
#include "fabric/model.h"

namespace selvage::formats::knitout {

// Nothing comes back exactly when there was an error; at most 20 are reported, in the order of their lines.
std::optional<fabric::Fabric> read_fabric(const Source& source, Diagnostics& diagnostics);

}  // namespace selvage::formats::knitout
