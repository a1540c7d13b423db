#include "fuzz/reports.h"

#include <cstdlib>
#include <string>
#include <vector>

#include "core/output.h"
#include "pipeline/inputs.h"
#include "pipeline/junit.h"
#include "pipeline/parts.h"
#include "pipeline/report.h"
#include "pipeline/report_page.h"
#include "pipeline/report_reader.h"

namespace selvage::fuzz {

void run_report(std::string_view bytes) {
  using namespace pipeline;
  const Result<Json> report = parse_report(bytes, "report.json");
  if (!report) return;
  std::vector<JunitInput> inputs;
  bool has_paths = true;
  for (const Json& entry : report->at("inputs")) {
    const std::string path = text_at(entry, "path"), text = text_of(entry);
    has_paths = has_paths && !path.empty();
    for (const std::vector<std::string>& outputs : {std::vector<std::string>(), {"nowhere/output.igs"}})
      static_cast<void>(is_still_valid(text, text_at(entry, "sha256"), text_at(entry, "settings"), outputs));
    static_cast<void>(has_defect(text));
    static_cast<void>(marked_skipped(text));
    inputs.push_back({path, text});
  }
  for (const char* command : {"roundtrip", "diff"})
    static_cast<void>(junit_text(command, inputs, text_at(*report, "started"), 1));
  static_cast<void>(text_of(*report, 2));
  if (!has_paths) return;  // `report html` refuses it
  Result<OutputFile> page = OutputFile::in_memory();
  if (!page || !write_report_page(*report, entries_in_order(*report), {}, *page)) std::abort();
}

void run_lists(std::string_view bytes) {
  using namespace pipeline;
  const Result<std::vector<std::string_view>> names = names_in_list(bytes, "list.txt");
  if (!names) return;
  Inputs inputs;
  for (const std::string_view name : *names)
    inputs.add(
        {.path = std::string(name), .stem = std::filesystem::path(name).filename().replace_extension()});
  for (std::size_t i = 0; i < names->size(); ++i) {
    const Input input = inputs.at(i);
    if (input.path != (*names)[i] || inputs.path(i) != (*names)[i] || !input.settings.empty()) std::abort();
    const std::optional<std::filesystem::path> whole = whole_path(input.path);
    if (whole && part_path(*whole, part_number(input.path).value_or(0)) != input.path) std::abort();
  }
}

}  // namespace selvage::fuzz
