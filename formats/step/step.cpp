#include "formats/registry.h"

#include "core/module.h"
#include "formats/step/options.h"
#include "formats/step/writer.h"

namespace selvage::formats::step {

namespace {

bool looks_like_step(std::string_view head) {
  const std::size_t start = head.find_first_not_of(" \t\r\n");
  return start != std::string_view::npos && head.substr(start).starts_with("ISO-10303-21");
}

// OpenCASCADE is opened here, not before: a job without STEP never loads it.
Result<std::unique_ptr<BodyWriter>> open_bodies(OutputFile& output, const SurfaceOptions& options) {
  Result<const void*> table = open_module("occt", "selvage_step");
  if (!table) return table.error();
  return static_cast<const StepModule*>(*table)->open_writer(output, options);
}

std::optional<cad::Model> read_model(const Source& source, Diagnostics& diagnostics) {
  Result<const void*> table = open_module("occt", "selvage_step");
  if (table) return static_cast<const StepModule*>(*table)->read_model(source, diagnostics);
  diagnostics.add(table.error());
  return std::nullopt;
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {
      .name = "step",
      .title = "STEP AP242 or AP214, manifold solids and faces with names and colours",
      .extensions = {".stp", ".step"},
      .sniff = looks_like_step,
      .read_model = read_model,
      .foreign_reader = "STEP",
      .open_bodies = open_bodies,
      .carries_curves = true,
      .options = option::all(),
      .is_usual = true};
  return self;
}

}  // namespace selvage::formats::step
