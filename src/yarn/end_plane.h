// The plane that seals a flat end of a yarn, as a surface for files that trim it.
#pragma once

#include "yarn/body.h"

namespace selvage::yarn {

// The plane of an end as a bilinear surface a little larger than the end curve, whose parameters are lengths
// along two axes of the plane. The end curve runs counter-clockwise in them.
struct EndPlane {
  nurbs::Surface surface;
  Vec3 origin, axis_u, axis_v, normal;
  bool inward = false;                                                        // `normal` points into the yarn
  [[nodiscard]] nurbs::Curve in_parameters(const nurbs::Curve& curve) const;  // z = 0
};
EndPlane end_plane(const Body& body, const nurbs::Curve& end_curve, bool last);

}  // namespace selvage::yarn
