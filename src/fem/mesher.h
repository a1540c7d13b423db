// Tetrahedra inside each yarn of a dry fabric. TetGen runs in a worker program (selvage-tetgen) with a time
// and a memory limit: whatever happens to it becomes a Message that names the yarn.
#pragma once

#include <functional>
#include <span>

#include "core/diagnostics.h"
#include "core/units.h"
#include "fabric/model.h"
#include "fem/mesh.h"
#include "yarn/body.h"

namespace selvage::fem {

struct MeshOptions {
  // Largest edge, in the bodies' unit, at most the yarn's narrowest section; 0: a quarter of that.
  double size = 0;
  int order = 1;             // 1 | 2
  double min_dihedral = 10;  // degrees wanted, 0..30 (improve.h)
  double timeout = 300;      // seconds a yarn
  double memory = 4096;      // MiB a yarn
  int threads = 1;           // workers at once
  // What is being done to the yarns, in words, and to how many of them it is done. May be empty.
  std::function<void(const char* step, std::size_t done, std::size_t total)> progress{};
};

// The mesh of all bodies, one Region a body in their order; coordinates scaled from `units` to mm. With order
// 2 the midside nodes of boundary edges lie on the B-spline surface. Warnings (a quality target missed, ...)
// go to `diagnostics`. Errors: geometry (a surface that intersects itself), limit (time, memory, an estimate
// of more than 10^8 tetrahedra), internal (TetGen crashed), each with the yarn, the place where it is known
// and a remedy.
Result<Mesh> mesh_yarns(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies, Unit units,
                        const MeshOptions& options, Diagnostics& diagnostics);

}  // namespace selvage::fem
