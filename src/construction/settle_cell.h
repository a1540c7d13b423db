// `cell repeat`: the unit cell of so many of the cloth's own repeats; `cell vectors`: one by its edges.
#pragma once

#include <array>
#include <optional>

#include "construction/build.h"
#include "core/diagnostics.h"
#include "fabric/model.h"

namespace selvage::fabric {

// Finds the corners of a cell that is told by its edges: where they say no height, it reaches beyond the
// yarns by the margin; where the text names no axes, it is periodic along the two edges. And of one that is
// told by repeats; other cells stay as they are. Along the axes along which the yarns repeat
// (YarnBuilder::repeat) it is so many repeats long and in the middle of what the text says, with faces that
// keep away from where surfaces of yarns turn round; along the others it reaches beyond the yarns by the
// margin. Where the text names no axes, it is periodic along those that repeat. A note in `diagnostics` tells
// the corners. Errors, at the cell: geometry (no repeat is known), and those of building the yarns.
void settle_cell(Fabric& fabric, const BuildOptions& options, int threads, Diagnostics& diagnostics);

// The shortest vectors after which a fabric repeats that has a repeat along x and along y, whatever its cell
// is; none: it has not, or cannot be built.
std::optional<std::array<Vec3, 2>> shortest_vectors(const Fabric& fabric, const BuildOptions& options,
                                                    int threads);

}  // namespace selvage::fabric
