// Points of yarns from a table: README.md.
#pragma once

#include <optional>

#include "core/diagnostics.h"
#include "core/source.h"
#include "fabric/measured.h"

namespace selvage::formats::csv {

// Errors, each at its value: a table that cannot be read, columns that are missing or that disagree in their
// unit, values that are no (positive) numbers, points that are not in order.
std::optional<fabric::Measured> read_points(const Source& source, Diagnostics& diagnostics);

}  // namespace selvage::formats::csv
