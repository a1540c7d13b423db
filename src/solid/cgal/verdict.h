// What CGAL says of one skin. The only place that includes CGAL (one translation unit costs half a minute and
// 2 GB).
#pragma once

#include <optional>

#include "core/vec.h"
#include "solid/tessellation.h"

namespace selvage::solid {

struct Verdict {
  bool consistent = false;         // no edge has three triangles, or two that run the same way along it
  bool closed = false;             // is_closed
  bool self_intersecting = false;  // does_self_intersect; false when not consistent (then it cannot be asked)
  bool bounds_volume = false;      // does_bound_a_volume
  bool outward = false;            // is_outward_oriented
  std::optional<Vec3> crossing;    // where two triangles cross
};

// Throws what CGAL throws.
Verdict judge(const Tessellation& skin);

const char* cgal_version();

}  // namespace selvage::solid
