// Gmsh meshes, to be looked at.
#pragma once

#include <optional>

#include "core/diagnostics.h"
#include "core/source.h"
#include "results/field_mesh.h"

namespace selvage::formats::msh {

// Texts of the versions 4.1 and 2.2: solids, or surfaces where there are no solids; regions are the physical
// groups, else the entities. Errors, at their place: other versions and binary files, what is no number,
// elements of nodes that are not there, files without surfaces and solids.
std::optional<fem::FieldMesh> read_mesh(const Source& source, Diagnostics& diagnostics);

}  // namespace selvage::formats::msh
