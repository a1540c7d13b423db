// Meshes from VTK's XML unstructured grids: README.md.
#pragma once

#include <optional>

#include "core/diagnostics.h"
#include "core/source.h"
#include "results/field_mesh.h"

namespace selvage::formats::vtu {

// Errors, each at its place: what is no such file, arrays that cannot be decoded or are missing, indices that
// no point has. Cells that are neither surfaces nor solids are left out with a warning.
std::optional<fem::FieldMesh> read_mesh(const Source& source, Diagnostics& diagnostics);

}  // namespace selvage::formats::vtu
