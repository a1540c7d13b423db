// How much of each yarn is inside the box.
#pragma once

#include <span>
#include <vector>

#include "cell/cut.h"
#include "cell/faces.h"

namespace selvage::cell {

// The volume of each body inside the box, file units cubed; 0 for those that do not enter it. Flux of (p -
// low corner) / 3 through what bounds it (divergence theorem): through the faces of the box by their areas,
// through the yarn's surface by Green's theorem in its parameters, with the inner integral by Gauss's rule,
// exact for polynomial surfaces, and the outer one along the arcs by one of fourth order: right to about 1e-8
// of the volume.
std::vector<double> volumes_inside(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut,
                                   const Division& division);

}  // namespace selvage::cell
