// What `use` places: the fabric inside a block, and where its yarns go.
#pragma once

#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "fabric/repeat.h"

namespace selvage::fabric {

// An affine map of space.
struct Placement {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Vec3 shift = Vec3::Zero();
  [[nodiscard]] Vec3 of(const Vec3& p) const { return linear * p + shift; }
};
// `first`, then `then`.
Placement combined(const Placement& first, const Placement& then);
// One after the other. Quarter turns are exact.
Placement placement_of(const std::vector<Move>& moves);

// How a yarn goes there: its centre line is mapped by `line` (a shear; the identity where the map is rigid),
// swept, and the body moved by `body`, which is rigid and may mirror.
struct TwoSteps {
  Placement line, body;
};
TwoSteps steps_of(const Placement& placement);

// The repeat of what repeats by `own` where it was.
Repeat placed_repeat(const Repeat& own, const Eigen::Matrix3d& linear);

// The box in the block's own axes that holds the cell; periodic along those of them along which only periodic
// axes of the cell run.
Cell cell_inside(const Cell& cell, const Placement& placement);

// Null: there is none of this name.
const NamedBlock* find_block(const Fabric& fabric, std::string_view name);

// The block that an item uses; null: it uses none of the text's.
const NamedBlock* used_block(const Fabric& fabric, const Item& item);

// The block's fabric as it stands in the text round it: with its units, and what the block does not define
// itself. `user` has the block, by itself or from the text round it.
Fabric inside(const Fabric& user, const NamedBlock& block);

// Errors: blocks that use each other in a circle (malformed), more copies than a fabric may have yarns
// (limit), at a `use`; two materials of one name (malformed). To be called before anything else that looks
// into blocks, which these would send round without end.
Status check_uses(const Fabric& fabric);

}  // namespace selvage::fabric
