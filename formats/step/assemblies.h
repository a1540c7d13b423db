// How often the parts of a STEP file's assemblies occur, counted before anything is expanded: a file of some
// kilobytes can say 2^40 instances.
#pragma once

#include "formats/step/part21.h"

namespace selvage::formats::step {

// More are refused.
inline constexpr double most_instances = 1e6;

// Errors: a product or a representation that is part of itself; more than most_instances of one.
void check_assemblies(const Part21& file, TextReport& report);

}  // namespace selvage::formats::step
