// Does an IGES file keep to its format in every respect? The reader puts up with what it can; this does not.
#pragma once

#include "core/findings.h"
#include "core/source.h"

namespace selvage::formats::iges {

// Lines, sections, sequence numbers, the global section, directory entries, parameter records, pointers, and
// what B-splines, transformations and colours say of themselves (knots, weights, closedness flags, ranges).
// Each with its line. Never fails: what is too broken to be judged further is a defect itself.
void check_structure(const Source& source, Findings& findings);

}  // namespace selvage::formats::iges
