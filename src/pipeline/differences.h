// What cad::compare found, as lines and as JSON.
#pragma once

#include <string>

#include "cad/compare.h"
#include "core/units.h"

namespace selvage::pipeline {

// One line, without its end: what changed, where, by how much.
std::string line_of(const cad::Difference& difference, Unit units);

// "2 of 4 yarns differ: 1 moved, 1 reshaped; ..." or "equal: 4 yarns, 12 surfaces; ...".
std::string summary_of(const cad::Comparison& found, double tolerance, Unit units);

// The object of `selvage diff --json` (src/cli/check.md).
std::string to_json(const cad::Comparison& found, const std::string& a, const std::string& b,
                    double tolerance, Unit units);

}  // namespace selvage::pipeline
