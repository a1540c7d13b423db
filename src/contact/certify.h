// The proof that nothing was missed: pairs of cells are divided until slabs between their control points part
// them.
#pragma once

#include <functional>
#include <vector>

#include "contact/overlay.h"
#include "contact/place.h"

namespace selvage::contact {

// Two parts that no slab parts.
struct OpenPair {
  Part a, b;
  double low = 0;  // the bound of their distance; negative: they may overlap so deep
};

struct Certificate {
  std::vector<OpenPair> open;  // parts smaller than `size` that may overlap deeper than `depth`
  double unsettled = 0;        // the work ran out: an overlap up to this depth may be hidden
};

// Looks at all pairs of the cluster. `is_known`: a pair of boxes that lies in an overlap that is known is
// left alone. At most `work` divisions.
Certificate certify(const CellModel& model, const Cluster& cluster, double depth, double size, int work,
                    const std::function<bool(const Box3& a, const Box3& b)>& is_known);

}  // namespace selvage::contact
