// `selvage check` on a CAD file: its format, its geometry, and what other systems would stumble on.
#pragma once

#include <optional>
#include <string>

#include "cad/judge.h"
#include "core/findings.h"
#include "pipeline/job.h"

namespace selvage::pipeline {

class CadCheck {
 public:
  // To be called by Job::read(); the check outlives it.
  CadLook look();

  // Says what was found: defects, warnings, and notes, which -v shows.
  void say(Job& job) const;
  [[nodiscard]] std::size_t defects() const;
  // Was there a CAD file that could be read?
  [[nodiscard]] bool has_model() const { return measures_.has_value(); }
  // What is true when there is no defect.
  [[nodiscard]] std::string_view sound() const {
    return has_structure_ ? "the file keeps to its format, its surfaces are sound" : "its surfaces are sound";
  }
  // A table of what was measured.
  [[nodiscard]] std::string table(const Shown& shown) const;
  [[nodiscard]] const std::optional<cad::Measures>& measures() const { return measures_; }

 private:
  Findings structure_, geometry_;
  std::optional<cad::Measures> measures_;
  bool has_structure_ = false;
};

}  // namespace selvage::pipeline
