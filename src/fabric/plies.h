// Ply yarns and multifilaments: a yarn replaced by its parts, each a yarn of its own.
#pragma once

#include <cstddef>

#include "core/diagnostics.h"
#include "fabric/plan.h"

namespace selvage::fabric {

// How many yarns a yarn of this thread becomes: 1 without plies and filaments.
std::size_t part_count(const Thread& thread);

// Part number `part` (from 0) of a yarn whose thread has more than one. Errors: geometry.
Result<YarnPlan> part_of(const Fabric& fabric, const YarnPlan& parent, std::size_t part);

}  // namespace selvage::fabric
