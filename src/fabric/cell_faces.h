// What lies in the faces of a unit cell themselves.
#pragma once

#include <optional>
#include <span>

#include "core/vec.h"
#include "fabric/repeat.h"
#include "yarn/body.h"

namespace selvage::fabric {

// Do the centre lines within `margin` of the box's two faces across `axis` come to centre lines when they are
// moved by `repeat` along it, as far as that brings them to one of the faces? None: they do. Else a yarn and
// where its copy is missing: runs along a face cross it nowhere, so find_loose_end does not see them.
std::optional<LooseEnd> find_missing_in_faces(std::span<const yarn::Body> bodies, const Box3& box, int axis,
                                              double repeat, double margin, double tolerance);

}  // namespace selvage::fabric
