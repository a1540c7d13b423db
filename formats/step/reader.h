// The STEP reader. Internal to the module selvage_occt: the program opens it through formats/step/step.h.
#pragma once

#include "cad/model.h"
#include "core/diagnostics.h"
#include "core/source.h"

namespace selvage::formats::step {

// Everything placed, in the unit of the file (mm where Selvage has no such unit). Every error and warning
// goes to `diagnostics`, with its line; nothing comes back exactly when there was an error.
std::optional<cad::Model> read_model(const Source& source, Diagnostics& diagnostics);

}  // namespace selvage::formats::step
