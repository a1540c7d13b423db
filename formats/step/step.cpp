#include "formats/registry.h"

#include "core/module.h"
#include "formats/step/options.h"
#include "formats/step/writer.h"
#include "formats/step/yarn_writer.h"

namespace selvage::formats::step {

namespace {

bool looks_like_step(std::string_view head) {
  const std::size_t start = head.find_first_not_of(" \t\r\n");
  return start != std::string_view::npos && head.substr(start).starts_with("ISO-10303-21");
}

// OpenCASCADE is opened here, not before: a job of yarns that are written never loads it.
Result<std::unique_ptr<BodyWriter>> open_in_module(OutputFile& output, const SurfaceOptions& options) {
  Result<const void*> table = open_module("occt", "selvage_step");
  if (!table) return table.error();
  return static_cast<const StepModule*>(*table)->open_writer(output, options);
}

// Yarns alone are written as they come, by a writer of our own; where anything else comes, OpenCASCADE builds
// the whole file. Which of the two it is, the options tell, and where nothing but others comes, the first.
class Writer : public BodyWriter {
 public:
  Writer(OutputFile& output, SurfaceOptions options) : output_(&output), options_(std::move(options)) {}

  Status add(const yarn::Body& body) override {
    return pass_on(options_.has_others, [&](BodyWriter& writer) { return writer.add(body); });
  }
  Status add_instance(const yarn::Body& body, const Instance& instance) override {
    return pass_on(options_.has_others,
                   [&](BodyWriter& writer) { return writer.add_instance(body, instance); });
  }
  Status add_part(const cad::Part& part) override {
    return pass_on(true, [&](BodyWriter& writer) { return writer.add_part(part); });
  }
  Status add_curve(const cad::NamedCurve& curve) override {
    return pass_on(true, [&](BodyWriter& writer) { return writer.add_curve(curve); });
  }
  Status add_piece(const fabric::PieceShape& piece) override {
    return pass_on(true, [&](BodyWriter& writer) { return writer.add_piece(piece); });
  }
  Result<WriteFacts> finish() override {
    if (!writer_) return error(Kind::geometry, "there is neither a yarn nor a piece to write");
    return writer_->finish();
  }

 private:
  template <class Add>
  Status pass_on(bool is_in_module, const Add& add) {
    if (!writer_) {
      Result<std::unique_ptr<BodyWriter>> opened =
          is_in_module ? open_in_module(*output_, options_) : open_yarn_writer(*output_, options_);
      if (!opened) return opened.error();
      writer_ = std::move(*opened);
      is_in_module_ = is_in_module;
    }
    if (is_in_module && !is_in_module_)
      return error(Kind::internal, "the STEP file was begun with yarns alone (SurfaceOptions::has_others)");
    return add(*writer_);
  }

  OutputFile* output_;
  SurfaceOptions options_;
  std::unique_ptr<BodyWriter> writer_;
  bool is_in_module_ = false;
};

Result<std::unique_ptr<BodyWriter>> open_bodies(OutputFile& output, const SurfaceOptions& options) {
  if (const Result<Schema> schema = schema_of(options); !schema) return schema.error();
  return std::unique_ptr<BodyWriter>(std::make_unique<Writer>(output, options));
}

std::optional<cad::Model> read_model(const Source& source, Diagnostics& diagnostics) {
  Result<const void*> table = open_module("occt", "selvage_step");
  if (table) return static_cast<const StepModule*>(*table)->read_model(source, diagnostics);
  diagnostics.add(table.error());
  return std::nullopt;
}

// Of what the reader does not judge already. It needs OpenCASCADE where the file states properties only.
void check_structure(const Source& source, Findings& findings) {
  Result<const void*> table = open_module("occt", "selvage_step");
  if (table) static_cast<const StepModule*>(*table)->check_properties(source, findings);
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {
      .name = "step",
      .title = "STEP AP242 or AP214, manifold solids and faces with names and colours",
      .extensions = {".stp", ".step"},
      .sniff = looks_like_step,
      .read_model = read_model,
      .check_structure = check_structure,
      .foreign_reader = "STEP",
      .open_bodies = open_bodies,
      .carries_curves = true,
      .carries_parts = true,
      .carries_lines = true,
      .options = option::all(),
      .is_usual = true};
  return self;
}

}  // namespace selvage::formats::step
