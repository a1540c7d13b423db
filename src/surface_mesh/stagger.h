// Points of surfaces that face each other over narrow gaps, brought out of each other's way.
#pragma once

#include <span>

#include "surface_mesh/size_field.h"
#include "surface_mesh/triangle_mesh.h"

namespace selvage::fem {

// A yarn's surface; one yarn's are not joined.
struct StaggeredMesh {
  TriangleMesh* mesh;
  const Support* support;
};

// Where a gap is narrower than the triangles' edges are long, one layer of tetrahedra fills it. They are
// least flat when each point of one side is over the middle of an edge of the other: 27 degrees with edges of
// four gaps, where points over points allow 16 and two meshes that know nothing of each other have a percent
// below 8. Free points that face another surface within an edge's length repel all points near them, over the
// gap too, as particles of two layers do that settle in a staggered crystal (Goldoni and Peeters, Phys. Rev.
// B 53, 1996). Points stay on their surfaces, and edges about as long; where they got too long new points
// divide them. The same for any number of threads.
void stagger(std::span<const StaggeredMesh> meshes, const SizeField& field, int threads);

}  // namespace selvage::fem
