// A knitout program from its first line to its last.
#pragma once

#include <cstddef>
#include <optional>

#include "core/source.h"
#include "core/text_report.h"
#include "formats/knitout/header.h"
#include "formats/knitout/stitch_graph.h"

namespace selvage::formats::knitout {

struct Program {
  Header header;
  StitchGraph graph;
};

// Runs the program on a machine (machine.h). Nothing after a first line that is not knitout's; with errors
// reported the graph is not whole.
std::optional<Program> run_program(const Source& source, TextReport& report);
// The same up to the operation that would make one loop more than `max_loops`.
std::optional<Program> run_beginning(const Source& source, TextReport& report, std::size_t max_loops);

}  // namespace selvage::formats::knitout
