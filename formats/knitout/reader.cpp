#include "formats/knitout/reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "formats/knitout/chart.h"
#include "formats/knitout/program.h"
#include "formats/knitout/yarns.h"

namespace selvage::formats::knitout {

namespace {

// Cloth that can be built, of a program or of its beginning.
struct Knitted {
  Program program;
  GraphChart chart;
};

// Its first `num_loops` loops; nothing where they make no chart, which is reported to `report`.
std::optional<Knitted> knit_loops(const Source& source, std::size_t num_loops, TextReport& report) {
  TextReport said(source);  // with the whole program
  std::optional<Program> program = run_beginning(source, said, num_loops);
  if (!program || program->graph.loops.empty()) return std::nullopt;
  std::optional<GraphChart> chart = chart_of(program->graph, report);
  if (!chart) return std::nullopt;
  return Knitted{std::move(*program), std::move(*chart)};
}

bool is_drawn_through(const StitchGraph& graph) {
  return std::any_of(graph.loops.begin(), graph.loops.end(),
                     [](const Loop& loop) { return !loop.is_tuck && loop.through_count > 0; });
}

// The longest beginning of a program that makes a chart, found by bisection of the number of loops. A warning
// says where it ends and why. Nothing where the chart fails of its size, or where no loop of it is drawn
// through another one.
std::optional<Knitted> knit_beginning(const Source& source, const StitchGraph& whole, TextReport& report) {
  std::optional<Knitted> built;
  Diagnostics reasons;
  std::size_t good = 0, bad = whole.loops.size();
  const auto is_chart = [&](std::size_t num_loops) {
    TextReport failed(source);
    std::optional<Knitted> knitted = knit_loops(source, num_loops, failed);
    if (knitted) {
      built = std::move(knitted);
      return true;
    }
    reasons = Diagnostics();
    failed.hand_over(reasons);
    return false;
  };
  is_chart(bad);  // for its reason
  while (bad - good > 1) {
    const Message* const reason = reasons.first_error();
    if (reason == nullptr || reason->kind == Kind::limit) return std::nullopt;
    const std::size_t middle = good + (bad - good) / 2;
    (is_chart(middle) ? good : bad) = middle;
  }
  const Message* const reason = reasons.first_error();
  if (!built || reason == nullptr || !is_drawn_through(built->program.graph)) return std::nullopt;
  report.warning(spot_at(source, reason->place),
                 fmt::format("{}; the cloth ends before line {}: {} of {} loops are built", reason->text,
                             whole.loops[good].spot.line, good, whole.loops.size()));
  return built;
}

std::optional<fabric::Fabric> read(const Source& source, TextReport& report) {
  std::optional<Program> program = run_program(source, report);
  if (!program || report.errors() > 0) return std::nullopt;
  if (program->graph.loops.empty()) return report.error(Spot(), "this program knits no loop");
  TextReport tried(source);
  std::optional<GraphChart> chart = chart_of(program->graph, tried);
  if (!chart) {
    std::optional<Knitted> beginning = knit_beginning(source, program->graph, report);
    if (!beginning) {
      chart_of(program->graph, report);
      return std::nullopt;
    }
    program = std::move(beginning->program);
    chart = std::move(beginning->chart);
  }
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
