// What `mesh` asks for of yarns and of unit cells.
#pragma once

#include <optional>

#include "fabric/model.h"
#include "pipeline/job.h"
#include "pipeline/unit_cell.h"
#include "structured/raster.h"
#include "tetrahedra/block.h"

namespace selvage::pipeline {

// What was asked for, with its limits a little before the input's, so that the mesher's message can name the
// yarn.
fem::MeshOptions mesh_options(Job& job);

// All yarns, as `mesh` takes them: with --twist ignore their fibres run along them. Nothing: one cannot be
// built (it was said).
std::optional<std::vector<yarn::Body>> bodies_to_mesh(Job& job, const fabric::YarnBuilder& builder);

// A mesh and, of a unit cell in tetrahedra, how many of them were expected.
struct MadeMesh {
  Result<fem::Mesh> mesh;
  std::optional<double> estimate{};
};

// The yarns of a unit cell, ready to be meshed.
struct ReadyCell {
  std::vector<yarn::Body> bodies;
  std::array<bool, 3> periodic{};
  CellSize size;  // not of voxels
};

// Yarns built and looked at; nothing when something is wrong with them or the cell (it was said). The cell
// may be snapped to its yarns' repeats.
std::optional<ReadyCell> prepare_cell(Job& job, fabric::Fabric& fabric, const fabric::YarnBuilder& builder);

// Its yarns, cut flush, and the matrix between them.
MadeMesh mesh_of_cell(Job& job, const fabric::Fabric& fabric, const ReadyCell& ready,
                      Diagnostics& diagnostics);

// The same on voxels, as fields.
Result<fem::Raster> raster_of_cell(Job& job, const fabric::Fabric& fabric, const ReadyCell& ready,
                                   Diagnostics& diagnostics);

}  // namespace selvage::pipeline
