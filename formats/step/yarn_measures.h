// What a yarn measures as the solid that is written, and whether it is one.
#pragma once

#include <deque>

#include "nurbs/measure.h"
#include "yarn/congruence.h"

namespace selvage::formats::step {

struct YarnMeasures {
  bool is_closed = false;       // it has all its end faces; else only the area is known
  double area = 0, volume = 0;  // file units
  Vec3 centre = Vec3::Zero();   // of the volume
};

// Errors (geometry), with the yarn and the place: a coordinate, knot or weight that is no number, an end face
// that stands off the body's end curve by more than 1e-7 of the yarn's thickness, a plane end whose outline
// crosses itself, faces whose normals do not agree, a solid that is inside out.
Result<YarnMeasures> measured(const yarn::Body& body);

// measured(), once for yarns that are the same but for a rigid motion and the rounding of their places.
class MeasuredYarns {
 public:
  Result<YarnMeasures> of(const yarn::Body& body);

 private:
  struct Known {
    yarn::Body body;
    yarn::Invariants invariants;
    YarnMeasures measures;
  };
  std::deque<Known> known_;  // the last ones
  std::size_t points_ = 0;   // of their bodies
};

}  // namespace selvage::formats::step
