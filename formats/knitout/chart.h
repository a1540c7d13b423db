// Of a stitch graph the chart of a weft knit (knit/chart.h), which the product builds.
#pragma once

#include <optional>
#include <vector>

#include "core/text_report.h"
#include "fabric/model.h"
#include "formats/knitout/passes.h"
#include "formats/knitout/stitch_graph.h"

namespace selvage::formats::knitout {

// A chart as large as what is read at most, rows x wales: where a row of many wales has few loops, all others
// are stitches without one.
inline constexpr long long most_cells = 20'000'000, free_cells = 2'000'000, cells_a_loop = 100;

struct GraphChart {
  fabric::Knit knit;  // chart, moves, gating, feeds, courses, wales: what follows from the graph
  // Of each row, from the first one: index in StitchGraph::carrier_sets; -1: of a row without a yarn.
  std::vector<int> carrier_sets;
  bool is_doubled = false;  // two wales a needle
};

// Errors, each at its operation: what a chart does not hold (splits, transfers to the other bed of an
// opposite gating, loops of several courses that pass each other), and too many stitches.
std::optional<GraphChart> chart_of(const StitchGraph& graph, TextReport& report);

}  // namespace selvage::formats::knitout
