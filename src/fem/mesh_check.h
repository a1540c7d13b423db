// What must hold of a surface before TetGen sees it, and of its mesh before anyone else does.
#pragma once

#include <span>

#include "core/diagnostics.h"
#include "fem/worker.h"

namespace selvage::fem {

// Finite coordinates, indices in range, every edge in exactly two triangles that run through it in opposite
// directions, a positive volume. Errors (geometry), with the place.
Status check_surface(std::span<const Vec3> points, std::span<const Triangle> triangles);

// Turns inverted cells round, then: the first points are the surface's to the bit, the cells' boundary is
// exactly the surface's triangles, they hang together by their faces, and their volume is the enclosed one to
// 1e-9. Errors: internal, and geometry where the boundary is another one.
Status check_mesh(TetMesh& mesh, std::span<const Vec3> points, std::span<const Triangle> triangles);

// The same of triangles between several regions: those of each region, seen from it, close it. Every region
// from 0 to the largest number is there.
Status check_complex(std::span<const Vec3> points, std::span<const Triangle> triangles,
                     std::span<const Sides> sides);

// Turns inverted cells round and fills TetMesh::regions: cells that share a face which is none of the
// triangles are of one region, and triangles say of which. Then: the first points are the job's to the bit,
// every triangle is a face of cells of its two regions, nothing else is outside, and the volume of each
// region is the enclosed one to 1e-9. Errors (internal).
Status find_regions(TetMesh& mesh, std::span<const Vec3> points, std::span<const Triangle> triangles,
                    std::span<const Sides> sides);

}  // namespace selvage::fem
