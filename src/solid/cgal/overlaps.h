// Which yarns share space, how deep and where; and how near the others come to each other.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "solid/check.h"
#include "solid/tessellation.h"

namespace selvage::solid {

struct Skinned {
  const yarn::Body* body = nullptr;
  const Tessellation* skin = nullptr;  // may be empty: then the yarn takes no part
  double chord = 0;
};

struct Neighbourhood {
  std::vector<Overlap> overlaps;  // deepest first
  std::optional<double> min_gap;
};

// Candidates by a sweep over the yarns' boxes. `progress` is called once a finished yarn. The same result
// with any number of threads. Throws what CGAL throws.
Neighbourhood find_overlaps(std::span<const Skinned> yarns, int threads,
                            const std::function<void()>& progress);

}  // namespace selvage::solid
