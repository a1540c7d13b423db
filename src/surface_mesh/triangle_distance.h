// How near points and triangles come to triangles.
#pragma once

#include <array>

#include "core/vec.h"

namespace selvage::fem {

using Corners3 = std::array<Vec3, 3>;

// The shortest way from a triangle to another, from the first to the second; zero where they meet.
Vec3 shortest_way(const Corners3& from, const Corners3& to);

// The point of a triangle nearest to `p`.
Vec3 nearest_on(const Corners3& triangle, const Vec3& p);

}  // namespace selvage::fem
