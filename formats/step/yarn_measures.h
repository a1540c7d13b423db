// What a yarn measures as the solid that is written, and whether it is one.
#pragma once

#include "nurbs/measure.h"
#include "yarn/body.h"

namespace selvage::formats::step {

struct YarnMeasures {
  bool is_closed = false;       // it has all its end faces; else only the area is known
  double area = 0, volume = 0;  // file units
  Vec3 centre = Vec3::Zero();   // of the volume
};

// Errors (geometry), with the yarn and the place: a coordinate, knot or weight that is no number, an end face
// that stands off the body's end curve by more than 1e-7 of the yarn's thickness, faces whose normals do not
// agree, a solid that is inside out.
Result<YarnMeasures> measured(const yarn::Body& body);

}  // namespace selvage::formats::step
