#include "formats/knitout/program.h"

#include <fmt/format.h>

#include <limits>
#include <set>

#include "core/readable.h"
#include "core/text_lines.h"
#include "formats/knitout/machine.h"

namespace selvage::formats::knitout {

namespace {

class Runner {
 public:
  Runner(Program& program, TextReport& report) : program_(program), report_(report) {}

  // False: it would make a loop too many.
  bool line(std::string_view line, const Spot& begin, std::size_t max_loops) {
    if (!machine_ && line.starts_with(";;")) {
      read_header_line(line, begin, program_.header, report_);
      return true;
    }
    if (!read_operation(line.substr(0, line.find(';')), begin, operation_, report_)) return true;
    if (makes_loop(operation_) && machine_ && machine_->num_loops() == max_loops) return false;
    warn_of_carriers();
    start();
    if (operation_.verb == Verb::extension && extensions_.insert(operation_.word).second)
      report_.warning(operation_.spot, fmt::format("the extension {} is passed by, here and below",
                                                   in_quotes(operation_.word)));
    machine_->run(operation_);
    return true;
  }

  void finish() {
    start();
    program_.graph = machine_->finish();
  }

 private:
  void start() {
    if (!machine_) machine_.emplace(program_.header, report_);
  }
  void warn_of_carriers() {
    if (!machine_ && !program_.header.has_carriers)
      report_.warning(operation_.spot,
                      "the header names no carriers, as ';;Carriers: 1 2 3' does: any name is taken for one");
  }

  Program& program_;
  TextReport& report_;
  Operation operation_;
  std::optional<Machine> machine_;  // from the first operation on
  std::set<std::string_view> extensions_;
};

}  // namespace

std::optional<Program> run_program(const Source& source, TextReport& report) {
  return run_beginning(source, report, std::numeric_limits<std::size_t>::max());
}

std::optional<Program> run_beginning(const Source& source, TextReport& report, std::size_t max_loops) {
  constexpr std::size_t head_size = 4096;
  TextLines lines(source.bytes());
  lines.next();
  const FirstLine first = read_first_line(lines.line(), source.bytes().substr(0, head_size), report);
  if (first == FirstLine::wrong) return std::nullopt;
  Program program;
  Runner runner(program, report);
  if (first == FirstLine::missing) lines = TextLines(source.bytes());
  while (!report.is_full() && lines.next())
    if (!runner.line(lines.line(), lines.spot(), max_loops)) break;
  runner.finish();
  return program;
}

}  // namespace selvage::formats::knitout
