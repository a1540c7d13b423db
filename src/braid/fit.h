// What a braid needs to fit: its runs of columns, and the amplitude at which crossing yarns touch.
#pragma once

#include <cstdint>
#include <vector>

#include "braid/shape.h"
#include "core/vec.h"

namespace selvage::fabric {

// A run of columns in which the same set of braiders is on top: one axial yarn has its place in the middle.
struct Run {
  std::int64_t first = 0, last = 0;
  [[nodiscard]] double middle() const { return 0.5 * static_cast<double>(first + last); }
};

// Run number k. A tube's runs go round it, over columns from 0; a strip's lie side by side on columns 1 .. N
// - 1.
Run run_of(const BraidShape& shape, std::int64_t k);
std::int64_t run_count(const BraidShape& shape);

// Sets the smallest amplitude from `least` on at which the surfaces of crossing yarns keep `wanted` apart;
// where none does, the one that comes nearest. Returns the gap that it leaves (negative: an overlap), by
// samples on the exact swept sections. Outlines: polygons; of the axial yarns empty where there are none.
double fit_amplitude(BraidShape& shape, double least, double wanted, const std::vector<Vec2>& outline,
                     const std::vector<Vec2>& axial_outline);

}  // namespace selvage::fabric
