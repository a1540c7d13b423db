// What is known of two tubes without the code under test: dense samples of both surfaces with Newton's method
// from every local minimum of their distance, and the volume that CGAL finds in common.
#pragma once

#include <optional>

#include "yarn/body.h"

namespace selvage::test {

// Points of two surfaces that face each other: normals opposed, both on the line between them.
struct FacingPair {
  double depth = 0;  // (p - q) . normal: positive where the tubes overlap, else minus the gap
  Vec3 p = Vec3::Zero(), q = Vec3::Zero(), normal = Vec3::Zero();
};

// The deepest of them (of the nearest ones: `depth` is between -farthest and farthest), from round x along
// samples of both sides. Nothing: there is none.
std::optional<FacingPair> sampled_deepest(const yarn::Body& a, const yarn::Body& b, double farthest,
                                          int round, int along);

// The volume of the intersection of both, tessellated with this chord error: CGAL corefinement. Negative:
// CGAL cannot tell.
double common_volume(const yarn::Body& a, const yarn::Body& b, double chord);

}  // namespace selvage::test
