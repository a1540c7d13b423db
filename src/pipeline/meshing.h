// What `mesh` asks for of yarns and of unit cells.
#pragma once

#include <optional>

#include "fabric/model.h"
#include "fem/block.h"
#include "pipeline/job.h"

namespace selvage::pipeline {

// What was asked for, with its limits a little before the input's, so that the mesher's message can name the
// yarn.
fem::MeshOptions mesh_options(Job& job);

// A mesh and, of a unit cell in tetrahedra, how many of them were expected.
struct MadeMesh {
  Result<fem::Mesh> mesh;
  std::optional<double> estimate{};
};

// Of the unit cell: its yarns, cut flush, and the matrix between them. Nothing when something is wrong with
// the yarns or the cell (it was said). The cell may be snapped to its yarns' repeats.
std::optional<MadeMesh> mesh_of_cell(Job& job, fabric::Fabric& fabric, const fabric::YarnBuilder& builder,
                                     Diagnostics& diagnostics);

}  // namespace selvage::pipeline
