// The STEP writer. Internal to the module selvage_occt: the program opens it through formats/step/step.h.
#pragma once

#include <memory>

#include "formats/format.h"

namespace selvage::formats::step {

// What the module exports for this format, as `selvage_step`.
struct StepModule {
  Result<std::unique_ptr<BodyWriter>> (*open_writer)(OutputFile& output, const SurfaceOptions& options);
  std::optional<cad::Model> (*read_model)(const Source& source, Diagnostics& diagnostics);
  void (*check_properties)(const Source& source, Findings& findings);
};

// Errors: usage (a schema other than AP242 and AP214).
Result<std::unique_ptr<BodyWriter>> open_writer(OutputFile& output, const SurfaceOptions& options);

}  // namespace selvage::formats::step
