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
  // `all`: every finding is said, not one a kind with the worst.
  explicit CadCheck(bool all) : says_all_(all), structure_(all), geometry_(all) {}

  // To be called by Job::read(); the check outlives it.
  CadLook look();

  // Says what was found: defects, warnings, and notes, which -v shows; first those of the geometry, then
  // those of the file's header, records and flags.
  void say(Job& job) const;
  [[nodiscard]] std::size_t defects() const;
  // Was there a CAD file that could be read?
  [[nodiscard]] bool has_model() const { return measures_.has_value(); }
  // Is it a CAD file that another program wrote? Its tubes need not be yarns.
  [[nodiscard]] bool is_foreign() const { return has_model() && is_foreign_; }
  // What is true when there is no defect. `has_warned`: something was said of the file, also by its reader.
  [[nodiscard]] std::string_view sound(bool has_warned) const {
    return has_structure_ && !has_warned ? "the file keeps to its format, its surfaces are sound"
                                         : "its surfaces are sound";
  }
  // A line of how many defects and warnings the geometry has, and one of the header, records and flags.
  [[nodiscard]] std::string summary() const;
  // A table of what was measured.
  [[nodiscard]] std::string table(const Shown& shown) const;
  [[nodiscard]] const std::optional<cad::Measures>& measures() const { return measures_; }

 private:
  bool says_all_;
  Findings structure_, geometry_;
  std::optional<cad::Measures> measures_;
  bool has_structure_ = false, is_foreign_ = false;
};

}  // namespace selvage::pipeline
