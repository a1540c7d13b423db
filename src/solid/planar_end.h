// A flat polygon as triangles, by ear clipping.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/vec.h"

namespace selvage::solid {

// The triangles of a simple polygon that runs counter-clockwise, as indices into `polygon`; all its points
// are used, none is added. The best shaped ear goes first. O(n^2). Empty: the polygon crosses itself, or has
// fewer than 3 points.
std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Vec2>& polygon);

}  // namespace selvage::solid
