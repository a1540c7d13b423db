// What B-splines, transformations and colours say of themselves against their own numbers.
#pragma once

#include <string>

#include "core/findings.h"
#include "formats/iges/file.h"

namespace selvage::formats::iges {

// What the global section says of all coordinates, and what they are.
struct Bounds {
  double resolution = 0;       // 0: not given
  double largest_found = 0;    // over all control points that nothing moves
  std::string largest_entity;  // which has it
};

// Knots, weights, flags, ranges of a 126 and a 128; a 124; a 314. `values`: from the type on, at least as
// many as are its own.
void check_curve(const DirectoryEntry& entry, const Values& values, Bounds& bounds, Findings& findings);
void check_surface(const DirectoryEntry& entry, const Values& values, Bounds& bounds, Findings& findings);
void check_matrix(const DirectoryEntry& entry, const Values& values, Findings& findings);
void check_color(const DirectoryEntry& entry, const Values& values, Findings& findings);

}  // namespace selvage::formats::iges
