#include "formats/knitout/reader.h"

#include "formats/knitout/chart.h"
#include "formats/knitout/program.h"
#include "formats/knitout/yarns.h"

namespace selvage::formats::knitout {

namespace {

std::optional<fabric::Fabric> read(const Source& source, TextReport& report) {
  const std::optional<Program> program = run_program(source, report);
  if (!program || report.errors() > 0) return std::nullopt;
  if (program->graph.loops.empty()) return report.error(Spot(), "this program knits no loop");
  std::optional<GraphChart> chart = chart_of(program->graph, report);
  if (!chart) return std::nullopt;
  fabric::Fabric fabric;
  fabric.file = source.name();
  fabric.units = Unit::mm;
  fabric.units_given = true;
  fabric.threads = read_yarns(program->header, program->graph, *chart, report);
  fabric.items.emplace_back(std::move(chart->knit));
  fabric.tell_threads_their_materials();
  return fabric;
}

}  // namespace

std::optional<fabric::Fabric> read_fabric(const Source& source, Diagnostics& diagnostics) {
  return reported(source, diagnostics, read);
}

}  // namespace selvage::formats::knitout
