// What pictures and pages take of a mesh that was read.
#pragma once

#include "results/field_mesh.h"

namespace selvage::fuzz {

// Aborts where the mesh does not fit together: an index beyond its list, a field with another number of
// values than its nodes or elements have.
void evaluate(fem::FieldMesh& mesh);

}  // namespace selvage::fuzz
