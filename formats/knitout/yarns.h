// The sizes of a knitted cloth, and the threads of its carriers, as far as a program's header tells.
#pragma once

#include <string>
#include <vector>

#include "core/text_report.h"
#include "fabric/model.h"
#include "formats/knitout/chart.h"
#include "formats/knitout/header.h"
#include "formats/knitout/stitch_graph.h"

namespace selvage::formats::knitout {

// Where the header is silent: gauge, and what share of a wale a yarn is thick, and a course high.
inline constexpr double usual_gauge = 15, yarn_share = 1.0 / 6, course_share = 7.0 / 8;

// Gives the knit its pitches and threads (mm); gives back the threads. What is supposed is told in notes.
std::vector<fabric::Thread> read_yarns(const Header& header, const StitchGraph& graph, GraphChart& chart,
                                       TextReport& report);

}  // namespace selvage::formats::knitout
