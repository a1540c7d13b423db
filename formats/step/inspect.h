// A STEP file up to its hand-over to OpenCASCADE, without OpenCASCADE: its parser and its translation die of
// references to entities of another type, of attributes that are missing, and of assemblies without end.
#pragma once

#include <optional>

#include "formats/step/part21.h"

namespace selvage::formats::step {

// Reads the statements and judges them: the grammar (part21.h), the schema, types and number of attributes
// (attributes.h), the number of instances (assemblies.h). Errors go to `report`, each with line and column;
// nothing comes back then. Time and memory are linear in the file, at most n log n.
std::optional<Part21> inspect(const Source& source, TextReport& report);

}  // namespace selvage::formats::step
