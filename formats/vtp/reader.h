// Centre lines from VTK XML polygonal data: README.md.
#pragma once

#include <optional>

#include "core/diagnostics.h"
#include "core/source.h"
#include "fabric/measured.h"

namespace selvage::formats::vtp {

// Errors, each at its place: what is no such file, binary data, missing arrays, values that are no numbers,
// arrays of other lengths than the points.
std::optional<fabric::Measured> read_points(const Source& source, Diagnostics& diagnostics);

}  // namespace selvage::formats::vtp
