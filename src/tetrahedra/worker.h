// The program's side of selvage-tetgen: hands it closed surfaces, watches it, and judges what comes back:
// tetrahedra of their points only (refine.h puts others in).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "surface_mesh/triangle.h"

namespace selvage::fem {

struct TetgenJob {
  std::span<const Vec3> points;
  std::span<const Triangle> triangles;  // closed, counter-clockwise seen from outside
  // One a triangle; regions are numbered from 0, without a gap. Empty: one region, behind all of them.
  std::span<const Sides> sides{};
  double smallest_feature = 0;  // lengths far below this one mean nothing; 0: TetGen's default tolerance
};

struct TetgenLimits {
  double timeout = 300;  // seconds of wall-clock time
  double memory = 4096;  // MiB of address space
};

struct TetMesh {
  std::vector<Vec3> points;  // the job's own first, to the bit
  // ((p1-p0) x (p2-p0)) . (p3-p0) >= 0 but for rounding: between triangles of one plane there can be flat
  // ones.
  std::vector<std::array<std::uint32_t, 4>> cells;
  std::vector<std::uint32_t> regions;  // of each cell
};

// Runs `program` (selvage-tetgen), again to look for facets that cross where no mesh comes out soon. The
// result's boundary is exactly the job's triangles, each of them is a side of cells of just the regions that
// it parts, and the volume of each region is that of its own triangles to 1e-9: anything else is an error.
// Errors, each with a remedy and where known the place (in the job's coordinates), none naming a yarn:
// geometry (a coordinate that is not finite, an open surface, facets that cross or nearly touch), limit
// (time, memory), internal (a crash, a bad answer, no program).
Result<TetMesh> run_tetgen(const std::filesystem::path& program, const TetgenJob& job,
                           const TetgenLimits& limits);

}  // namespace selvage::fem
