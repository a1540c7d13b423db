// A yarn's centre line as points: what formats of points carry of it.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::yarn {

// One point of the centre line and the section there. Lengths in file units.
struct LineSample {
  double parameter = 0;   // of Body::axis
  double arc_length = 0;  // from the start
  Vec3 position = Vec3::Zero();
  // Unit vectors: along the yarn; across it, to the section's first point (of swept sections the end of their
  // width); tangent x side, the direction of the thickness.
  Vec3 tangent = Vec3::Zero(), side = Vec3::Zero(), up = Vec3::Zero();
  double width = 0, height = 0;  // of the section, along `side` and along `up`
  double radius = 0;             // of the circle that has the section's area
  double curvature = 0;          // of the centre line, 1 / file unit
  double speed = 0;              // of the arc length by the parameter
};

// Points on the centre line so near to each other that no straight between two of them is farther than
// `tolerance` (> 0) from it, as samples between them tell, at every knot and at both ends at least; of a ring
// the last is the first again. Positions are those of Body::axis, to rounding. Sections are those of
// Body::surface at the same parameter: areas exact to rounding for polynomial surfaces, widths and heights
// those of eight points between every two knots round the section.
std::vector<LineSample> line_samples(const Body& body, double tolerance);

// The samples of yarns one after the other, all of a shape (Body::shape) within the same tolerance: each
// shape is sampled once, as long as there are not too many to keep.
class LineSampler {
 public:
  // Good until the next call.
  const std::vector<LineSample>& sample(const Body& body, double tolerance);

 private:
  struct Known {
    Vec3 start;  // of the centre line
    std::vector<LineSample> samples;
  };
  std::map<std::uint64_t, Known> known_;
  std::size_t kept_ = 0;  // samples
  std::vector<LineSample> samples_;
};

}  // namespace selvage::yarn
