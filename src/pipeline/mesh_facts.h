// What the report says of a mesh.
#pragma once

#include "fem/mesh.h"
#include "pipeline/report.h"

namespace selvage::pipeline {

// Of tetrahedra or hexahedra, of dry yarns or a unit cell (all but MeshReport::estimate).
MeshReport mesh_facts(const fem::Mesh& mesh);

}  // namespace selvage::pipeline
