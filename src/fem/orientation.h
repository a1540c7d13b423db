// Which way the yarn runs in each element.
#pragma once

#include "fem/mesh.h"
#include "fem/surface_mesh.h"
#include "yarn/body.h"

namespace selvage::fem {

// Fills Mesh::along and Mesh::across of a mesh of one region in the body's units whose first nodes are the
// surface's points. along: the unit tangent of the centre line at the point nearest to the element's middle.
// across: from the centre line towards the section's seam at the same parameter (on a section with axes:
// along its width, where the seam stands), made perpendicular to `along`, unit.
void add_orientations(Mesh& mesh, const SurfaceMesh& surface, const yarn::Body& body);

}  // namespace selvage::fem
