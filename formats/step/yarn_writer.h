// Writes yarns as STEP solids, each when it comes: nothing but numbers of entities is kept, so memory does
// not grow with what is written. What is no yarn is written by the module's writer (writer.h).
#pragma once

#include <memory>

#include "formats/format.h"
#include "formats/step/products.h"

namespace selvage::formats::step {

// Error (usage): neither AP242 nor AP214.
Result<Schema> schema_of(const SurfaceOptions& options);

// Errors: as schema_of().
Result<std::unique_ptr<BodyWriter>> open_yarn_writer(OutputFile& output, const SurfaceOptions& options);

}  // namespace selvage::formats::step
