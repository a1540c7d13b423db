// Cubic splines along a tube's path, as few sections as its tolerance asks for.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/decimal_grid.h"
#include "yarn/channels.h"
#include "yarn/tube.h"

namespace selvage::yarn {

// Spans of one stretch at most: solving takes their number's third power.
inline constexpr int most_spans = 16;

// Where the surface is one derivative less smooth than elsewhere: each stretch between is fitted by itself.
struct Stretches {
  std::vector<double> at;  // their ends, increasing
  std::vector<int> least;  // spans of each
};

struct FittedRows {
  RowTable control;           // of Channels' values, a row of each section
  std::vector<double> knots;  // clamped, degree 3
  double error = 0;           // bound of the distance between the tube and the exact one
};

// Nothing where that would take more than `most` sections. `knot_grid`: of new knots.
std::optional<FittedRows> fit_stretches(const Channels& channels, const CentreLine& path,
                                        const Stretches& stretches, const DecimalGrid& knot_grid,
                                        double tolerance, std::size_t most);

}  // namespace selvage::yarn
