// Meshes from decks of Abaqus and CalculiX, to be looked at: nodes and elements, without sections and steps.
#pragma once

#include <optional>

#include "core/diagnostics.h"
#include "core/source.h"
#include "results/field_mesh.h"

namespace selvage::formats::inp {

// Surfaces and solids, a region for each element set that elements are given with. Errors, at their place:
// what is no number, elements of nodes that are not there, and a deck without surfaces and solids. Elements
// of other types are left out, with a warning.
std::optional<fem::FieldMesh> read_mesh(const Source& source, Diagnostics& diagnostics);

}  // namespace selvage::formats::inp
