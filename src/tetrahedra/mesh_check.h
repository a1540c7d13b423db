// What must hold of a surface before TetGen sees it, and of its mesh before anyone else does.
#pragma once

#include <span>

#include "core/diagnostics.h"
#include "tetrahedra/worker.h"

namespace selvage::fem {

// Of triangles with a region (or the outside) on each of their sides: finite coordinates, indices in range;
// those of each region, seen from it, close it round a positive volume. Errors (geometry), with the place
// where it is known; limit.
Status check_surface(std::span<const Vec3> points, std::span<const Triangle> triangles,
                     std::span<const Sides> sides);

// Turns all cells round where they are inverted, and fills TetMesh::regions: cells that share a face which is
// none of the triangles are of one region, and triangles say of which. Then: the first points are the job's
// to the bit, every triangle is a face of cells of its two regions, nothing else is outside, and the volume
// of each region is the enclosed one to 1e-9. Errors: geometry where the boundary is another one, as where
// triangles are in each other's way; internal.
Status find_regions(TetMesh& mesh, std::span<const Vec3> points, std::span<const Triangle> triangles,
                    std::span<const Sides> sides);

}  // namespace selvage::fem
