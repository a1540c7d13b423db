// Surfaces that are closed round: what the side of a yarn looks like in a file.
#pragma once

#include <optional>

#include "cad/model.h"

namespace selvage::cad {

struct TubeKind {
  bool round_is_v = false;  // the direction round the section is v
  bool is_ring = false;     // closed along as well
  double size = 0;          // mean thickness of the thinner end
  double tolerance = 0;     // within which points are one there
};

// Is the whole face (clamped) a tube: closed in one direction, with two ends that enclose an area, or a ring,
// closed in both? Of the two directions of a ring u is round, unless v is less than half as long.
// `resolution`: of the file, or 0.
std::optional<TubeKind> tube_kind(const Face& face, double resolution);

// The tube as a yarn: surface, closed_along, axis and quarters. Control points keep their bits, but where
// the last column (or row of a ring) is not quite the first.
yarn::Body body_of(const nurbs::Surface& surface, const TubeKind& kind);

}  // namespace selvage::cad
