// How far the vertices of yarns' skins are from the other yarns, with the sign: a picture of contact.
//
// Distances to triangles. A vertex is inside another skin where its nearest point there has an outward normal
// that points away from the vertex, with the angle-weighted normals of Baerentzen and Aanaes (2005) at edges
// and corners, for which that is exact on a closed skin.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::contact {

// One yarn's skin as triangles, counter-clockwise seen from outside. May be empty.
struct SkinMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<double> along;  // one a vertex: its v on the yarn's surface; of an end face: the end's
};

struct GapFieldOptions {
  double reach = 0;  // file units, > 0: the largest value
  int threads = 1;
  std::function<void(std::size_t done, std::size_t total)> progress;  // may be empty
};

// For each vertex of each skin, file units: the distance to the nearest other yarn, or other place of the
// same yarn (ContactOptions::with_itself says what that is); inside others minus the largest distance to
// their skins. At most the reach. `skins` has one entry a body. Same input, same result, for any number of
// threads. Open ends hold nothing: behind one is outside.
std::vector<std::vector<double>> gap_field(std::span<const yarn::Body> bodies,
                                           std::span<const SkinMesh> skins, const GapFieldOptions& options);

}  // namespace selvage::contact
