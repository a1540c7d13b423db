#include "formats/knitout/program.h"

#include <fmt/format.h>

#include <set>

#include "core/readable.h"
#include "formats/knitout/machine.h"

namespace selvage::formats::knitout {

namespace {

// The line without its end, cut from the front of `rest`.
std::string_view next_line(std::string_view& rest) {
  const std::size_t newline = rest.find('\n');
  const std::string_view line = rest.substr(0, newline);
  rest.remove_prefix(newline == std::string_view::npos ? rest.size() : newline + 1);
  return line;
}

class Runner {
 public:
  Runner(Program& program, TextReport& report) : program_(program), report_(report) {}

  void line(std::string_view line, int number) {
    if (!machine_ && line.starts_with(";;")) return read_header_line(line, number, program_.header, report_);
    if (!read_operation(line.substr(0, line.find(';')), number, operation_, report_)) return;
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
  std::string_view rest = source.bytes();
  if (!read_first_line(next_line(rest), report)) return std::nullopt;
  Program program;
  Runner runner(program, report);
  for (int number = 2; !rest.empty() && !report.is_full(); ++number) runner.line(next_line(rest), number);
  runner.finish();
  return program;
}

}  // namespace selvage::formats::knitout
