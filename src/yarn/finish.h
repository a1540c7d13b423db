// The last step of building a yarn, the same for paths and grids.
#pragma once

#include "core/decimal_grid.h"
#include "yarn/body.h"
#include "yarn/ends.h"

namespace selvage::yarn {

// From a body with name, place, surface, axis, closed_along and quarters: finds which way its normals point,
// seals it, and measures length, volume, end area and bends. Errors (geometry): an end that cannot be sealed,
// a body without volume.
Status finish(Body& body, const Sealings& ends);
Status finish(Body& body, EndStyle ends);

// The same for a body that has its end faces (style and surface) already, and keeps them.
Status finish_as_sealed(Body& body);

// Moves a finished body whose tube stands on the grid by `by`, its surface to the nearest place at which it
// stands on the grid again. End faces are made anew.
void move(Body& body, const Vec3& by, const DecimalGrid& grid);

// Maps a finished body by a rigid map p -> linear p + by, all its control points alike. Where that mirrors, u
// runs the other way round, so that its normals keep pointing out of the yarn, and the fibres' twist changes
// its hand.
void map_rigidly(Body& body, const Eigen::Matrix3d& linear, const Vec3& by);

// One third of the flux of (position - origin) out of the yarn through one of its ends. Planar and open ends
// are what their outline says.
double end_flux(const Body& body, bool last, const Vec3& origin);

}  // namespace selvage::yarn
