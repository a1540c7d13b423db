// Reads an IGES file into a cad::Model.
#pragma once

#include "cad/model.h"
#include "core/diagnostics.h"
#include "core/source.h"

namespace selvage::formats::iges {

// Everything placed, in the unit of the file (mm where Selvage has no such unit). Entities of types that are
// not understood are counted. Every error and warning goes to `diagnostics`, with its line; nothing comes
// back exactly when there was an error.
std::optional<cad::Model> read_model(const Source& source, Diagnostics& diagnostics);

}  // namespace selvage::formats::iges
