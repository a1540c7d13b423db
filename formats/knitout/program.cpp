#include "formats/knitout/program.h"

#include <fmt/format.h>

#include <set>

#include "core/readable.h"
#include "core/text_lines.h"
#include "formats/knitout/machine.h"

namespace selvage::formats::knitout {

namespace {

class Runner {
 public:
  Runner(Program& program, TextReport& report) : program_(program), report_(report) {}

  void line(std::string_view line, const Spot& begin) {
    if (!machine_ && line.starts_with(";;")) return read_header_line(line, begin, program_.header, report_);
    if (!read_operation(line.substr(0, line.find(';')), begin, operation_, report_)) return;
    if (!machine_) machine_.emplace(program_.header, report_);
    if (operation_.verb == Verb::extension && extensions_.insert(operation_.word).second)
      report_.warning(operation_.spot, fmt::format("the extension {} is passed by, here and below",
                                                   in_quotes(operation_.word)));
    machine_->run(operation_);
  }

  void finish() {
    if (!machine_) machine_.emplace(program_.header, report_);
    program_.graph = machine_->finish();
  }

 private:
  Program& program_;
  TextReport& report_;
  Operation operation_;
  std::optional<Machine> machine_;  // from the first operation on
  std::set<std::string_view> extensions_;
};

}  // namespace

std::optional<Program> run_program(const Source& source, TextReport& report) {
  TextLines lines(source.bytes());
  lines.next();
  if (!read_first_line(lines.line(), report)) return std::nullopt;
  Program program;
  Runner runner(program, report);
  while (!report.is_full() && lines.next()) runner.line(lines.line(), lines.spot());
  runner.finish();
  return program;
}

}  // namespace selvage::formats::knitout
