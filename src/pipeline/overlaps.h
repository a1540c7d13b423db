// Overlapping yarns in the report and in messages: the same for `check`, `mesh` and `convert --matrix`.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "pipeline/job.h"
#include "solid/check.h"
#include "yarn/body.h"

namespace selvage::pipeline {

// "yarns 'warp1' and 'weft2' overlap 0.013 mm deep", with the place; lengths in the input's unit.
Message overlap_message(const contact::Contact& overlap, std::span<const yarn::Body> bodies, Unit units);

// Nothing when it failed (it was said why).
std::optional<solid::SolidCheck> check_of(Job& job, std::span<const yarn::Body> bodies);

// Closedness, self-crossing, overlaps, near contacts where asked for, the smallest gap and Creo's accuracy,
// as the check found them.
void report_check(Job& job, const solid::SolidCheck& check, std::span<const yarn::Body> bodies);

// Are the yarns sound, and does none overlap another? What is found goes into the report and is said,
// overlaps as errors after `finish` has added the remedy (it may make them warnings). False when that fails
// the input.
bool check_overlaps(Job& job, std::span<const yarn::Body> bodies,
                    const std::function<void(Message&)>& finish);

}  // namespace selvage::pipeline
