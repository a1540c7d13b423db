// Yarns in the coordinates of a cell that need be no box: B-splines stay what they are under a linear map of
// their control points, so that what a box can be asked can be asked of any parallelepiped.
#pragma once

#include <span>
#include <vector>

#include "core/parallelepiped.h"
#include "yarn/body.h"

namespace selvage::yarn {

// Points, axes and end faces in these coordinates, volumes in their unit; lengths, areas and bends stay those
// of space. Where the coordinates are those of space, the given bodies themselves, which outlive this.
class BodiesInAxes {
 public:
  BodiesInAxes(std::span<const Body> bodies, const ObliqueAxes& axes);
  BodiesInAxes(const BodiesInAxes&) = delete;
  BodiesInAxes& operator=(const BodiesInAxes&) = delete;

  [[nodiscard]] std::span<const Body> list() const { return list_; }

 private:
  std::vector<Body> made_;
  std::span<const Body> list_;
};

}  // namespace selvage::yarn
