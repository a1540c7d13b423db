// What the meshing of yarns and that of unit cells have in common.
#pragma once

#include "fabric/model.h"
#include "fem/mesh.h"
#include "pipeline/job.h"

namespace selvage::pipeline {

// The mesher's own limits end a little before the input's, so that its message can name the yarn.
template <class MesherOptions>
void set_mesher_limits(const Options& given, MesherOptions& options) {
  constexpr double worker_share = 0.9;
  if (given.timeout > 0) options.timeout = worker_share * given.timeout;
  if (given.memory > 0) options.memory = given.memory;
}

// Tetrahedra fill yarns; a garment piece is flat. False: it was said which piece is there.
bool has_only_yarns(Job& job, const fabric::Fabric& fabric);

// On the console: the cell's fractions, the worst volume.
void tell_volumes(Job& job, const fem::Mesh& mesh);

}  // namespace selvage::pipeline
