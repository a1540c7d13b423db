// A yarn's surface as triangles, each corner with its place along the yarn.
#pragma once

#include <functional>

#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::fem {

struct YarnVertex {
  Vec3 at = Vec3::Zero();  // file units
  double v = 0;            // parameter along the yarn
};

using TakeTriangle = std::function<void(const YarnVertex& a, const YarnVertex& b, const YarnVertex& c)>;

// Hands over triangles whose edges are at most about `round` long round the yarn and `along` along it, closed
// with flat fans at its ends; all are turned the same way. Neighbours share their corners to the bit.
void triangulate_yarn(const yarn::Body& body, double round, double along, const TakeTriangle& take);

}  // namespace selvage::fem
