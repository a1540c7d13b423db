// From the text's fabric to yarns as geometry.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "yarn/body.h"

namespace selvage::fabric {

struct BuildOptions {
  yarn::EndStyle ends = yarn::EndStyle::patch;
  double tolerance = 0;  // file units; 0: the file's, or 1/1000 of the smallest section size in the file
  std::size_t max_control_points = 50'000'000;  // a yarn: a limit error instead of an exhausted memory
};

// The tolerance in force, file units.
double tolerance_of(const Fabric& fabric, const BuildOptions& options);

// Builds the yarns one at a time, in file order; nothing is kept between calls, so that a million yarns need
// the memory of one.
class YarnBuilder {
 public:
  // Errors: unsupported (constructions and edits that this version has no geometry for, each at its line; all
  // of them are reported), geometry (a thread without a size, ...). `fabric` outlives the builder.
  static std::optional<YarnBuilder> create(const Fabric& fabric, const BuildOptions& options,
                                           Diagnostics& diagnostics);

  [[nodiscard]] std::size_t count() const { return yarns_.size(); }
  // Errors: geometry, limit; with the yarn, its file and line. Warnings are in Body::messages.
  [[nodiscard]] Result<yarn::Body> build(std::size_t index) const;

 private:
  Status sweep_path(yarn::Body& body, const Yarn& yarn, const Thread& thread) const;

  const Fabric* fabric_ = nullptr;
  BuildOptions options_;
  double tolerance_ = 0;
  std::vector<const Yarn*> yarns_;
};

}  // namespace selvage::fabric
