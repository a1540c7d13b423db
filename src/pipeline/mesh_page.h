// Pages of meshes that were read (results/field_mesh.h).
#pragma once

#include "pipeline/job.h"
#include "results/field_mesh.h"
#include "view/page/page.h"

namespace selvage::pipeline {

// The outside of the mesh with its fields, as a page has them, and how good its tetrahedra are. Fields that
// would make the page too large are left out, the last first, with a warning.
view::page::Page mesh_page(Job& job, const fem::FieldMesh& mesh);

}  // namespace selvage::pipeline
