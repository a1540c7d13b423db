// Tetrahedra inside each yarn of a dry fabric: every one is a block by itself. TetGen runs in a worker
// program (selvage-tetgen) with a time and a memory limit: whatever happens to it becomes a Message that
// names the yarn.
#pragma once

#include <span>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "tetrahedra/block.h"
#include "yarn/body.h"

namespace selvage::fem {

// The mesh of all bodies, one Region a body in their order; coordinates scaled from `units` to mm. Limits are
// a yarn's; `threads` yarns are worked on at once; no edge is longer than a yarn's narrowest section. With
// order 2 the midside nodes of boundary edges lie on the B-spline surface. Warnings (a quality target missed,
// ...) go to `diagnostics`. Errors: geometry (a surface that intersects itself), limit (time, memory, an
// estimate of more than 10^8 tetrahedra), internal (TetGen crashed), each with the yarn, the place where it
// is known and a remedy.
Result<Mesh> mesh_yarns(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies, Unit units,
                        const MeshOptions& options, Diagnostics& diagnostics);

}  // namespace selvage::fem
