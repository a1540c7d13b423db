#include "pipeline/cad_check.h"

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
                measures_ = cad::judge(model, geometry_);
                cad::judge_for_receivers(model, *measures_, format.is_partly_ignored, geometry_);
              }};
}

void CadCheck::say(Job& job) const {
  for (const Findings* findings : {&structure_, &geometry_})
    for (Message& message : findings->messages())
      message.severity == Severity::error ? job.say_defect(std::move(message)) : job.say(std::move(message));
}

std::size_t CadCheck::defects() const {
  return static_cast<std::size_t>(structure_.defects()) + static_cast<std::size_t>(geometry_.defects());
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
