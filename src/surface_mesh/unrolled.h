// A piece of a yarn's surface unrolled into the plane of its parameters: cut open where it goes round.
#pragma once

#include "surface_mesh/cell_curves.h"
#include "surface_mesh/triangle_mesh.h"

namespace selvage::fem {

// One domain, 0; nodes are known by the cell's numbers. Errors (geometry): a piece that cannot be cut open.
Result<PlanarRegion> unroll(const CellShape& shape, const CellCurves& curves, std::size_t piece,
                            const SizeField& field, const CellNodes& nodes);

}  // namespace selvage::fem
