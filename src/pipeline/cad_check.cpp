#include "pipeline/cad_check.h"

#include <fmt/format.h>

#include "core/words.h"
#include "pipeline/table.h"

namespace selvage::pipeline {

CadLook CadCheck::look() {
  return {.file =
              [this](const Source& source, const formats::Descriptor& format) {
                has_structure_ = format.check_structure != nullptr;
                if (has_structure_) format.check_structure(source, structure_);
              },
          .model =
              [this](const cad::Model& model, const formats::Descriptor& format) {
                is_foreign_ = !model.system.starts_with("selvage") && !model.system.starts_with("Selvage");
                measures_ = cad::judge(model, geometry_);
                cad::judge_for_receivers(model, *measures_, format.is_partly_ignored, geometry_);
              }};
}

void CadCheck::say(Job& job) const {
  for (const Findings* findings : {&geometry_, &structure_})
    for (Message& message : says_all_ ? findings->messages() : findings->summary())
      message.severity == Severity::error ? job.say_defect(std::move(message)) : job.say(std::move(message));
}

std::size_t CadCheck::defects() const {
  return static_cast<std::size_t>(structure_.defects()) + static_cast<std::size_t>(geometry_.defects());
}

std::string CadCheck::summary() const {
  const auto count_of = [](const Findings& findings) -> std::string {
    const auto defects = static_cast<std::size_t>(findings.defects()),
               warnings = static_cast<std::size_t>(findings.warnings());
    if (defects + warnings == 0) return "sound";
    if (defects == 0) return counted(warnings, "warning");
    return warnings == 0 ? counted(defects, "defect")
                         : counted(defects, "defect") + ", " + counted(warnings, "warning");
  };
  std::string text = fmt::format("  geometry: {}\n", count_of(geometry_));
  if (has_structure_) text += fmt::format("  header, records and flags: {}\n", count_of(structure_));
  return text;
}

std::string CadCheck::table(const Shown& shown) const {
  if (!measures_) return {};
  const auto length = [&](double value) { return cell(shown.length(value)); };
  Table table({"faces", "edges", "open edges", "poles", "largest gap", "tolerance", "shortest edge", "size"});
  table.add({std::to_string(measures_->faces), std::to_string(measures_->borders),
             std::to_string(measures_->open_borders), std::to_string(measures_->poles),
             length(measures_->largest_gap), length(measures_->tolerance), length(measures_->shortest_border),
             length(measures_->size)});
  return table.text();
}

}  // namespace selvage::pipeline
