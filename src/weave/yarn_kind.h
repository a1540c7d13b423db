// Twist factor of yarns: turns per metre times the square root of tex, by which a yarn in a cloth resists
// flattening (S. Afrashteh, A. A. Merati, A. A. A. Jeddi, Geometrical parameters of yarn cross-section in
// plain woven fabric, Indian Journal of Fibre & Textile Research 38 (2013) 126-131). From the thread's own
// twist, or the usual one of its kind of yarn.
#pragma once

#include <optional>
#include <string_view>

#include "core/diagnostics.h"
#include "core/units.h"
#include "fabric/model.h"

namespace selvage::fabric {

struct YarnKind {
  std::string_view name;    // "spun yarn", "worsted yarn", "filament yarn", "tow", "monofilament"
  double twist_factor = 0;  // usual one, turns/m sqrt(tex)
  bool is_solid = false;    // one piece without pores: never flattened, and its twist has no meaning
};

// Kind of a thread's yarn, by its number of filaments and its material; a spun yarn where neither is given.
// Warps of spun yarn have more twist than wefts.
YarnKind yarn_kind_of(const Thread& thread, bool is_warp);

// Twist factor of a thread, turns/m sqrt(tex); none: the yarn is solid. With a `twist` it is computed from
// these turns, of a ply yarn from those of the ply and the linear density of all plies. Linear density that
// is not given follows from the area of the cross-section, with a fibre density of 1.5 g/cm3 and a packing
// fraction of 0.6 where these are not given. Without twist it is that of yarn_kind_of. Error (geometry), at
// the thread: the fibres at the surface of the yarn are inclined by more than 45 degrees to its axis,
// tan(angle) = pi d T, d the diameter of a circle of the cross-section's area; or the thread has a twist but
// neither linear density nor size.
Result<std::optional<double>> twist_factor_of(const Thread& thread, Unit units, bool is_warp);

}  // namespace selvage::fabric
