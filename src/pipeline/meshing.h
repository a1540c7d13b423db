// What the meshing of yarns and that of unit cells have in common.
#pragma once

#include "fabric/model.h"
#include "fem/block.h"
#include "pipeline/job.h"

namespace selvage::pipeline {

// What was asked for, with its limits a little before the input's, so that the mesher's message can name the
// yarn.
fem::MeshOptions mesh_options(Job& job);

// Tetrahedra fill yarns; a garment piece is flat. False: it was said which piece is there.
bool has_only_yarns(Job& job, const fabric::Fabric& fabric);

// On the console: the cell's fractions, the worst volume.
void tell_volumes(Job& job, const fem::Mesh& mesh);

}  // namespace selvage::pipeline
