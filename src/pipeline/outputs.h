// Which files a run writes: formats, names, and that no two of them are the same.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "formats/format.h"
#include "pipeline/inputs.h"
#include "pipeline/options.h"

namespace selvage::pipeline {

// What `selvage view` writes. Pictures and pages are no formats of fabrics: `selvage formats` and --to do not
// know them.
const formats::Descriptor& picture_format();
const formats::Descriptor& page_format();

struct PlannedOutput {
  const formats::Descriptor* format = nullptr;
  std::string path;
  bool to_standard_output = false;
  // Names that inputs and other outputs have, of those that this one may need where it takes several files.
  std::vector<std::filesystem::path> taken{};
  const formats::Companion* as_companion = nullptr;  // where it is the second file of another one
};

// A name in each folder that it writes to; the first is its file, of several the first one.
std::vector<std::filesystem::path> places_of(const PlannedOutput& output);

// Can this subcommand write it?
bool can_be_written(const formats::Descriptor& format, Command command);
// Of the format that `check --gap-map` writes, for help.
std::string_view extension_of_gap_maps();

struct PlannedInput {
  Input input;
  std::vector<PlannedOutput> outputs;  // none for commands that write no files (check: its gap map)
};

// The inputs of a run with their outputs.
class Plan {
 public:
  // Takes the inputs of `list`. Errors (usage): an unknown or unfitting format, several outputs where one
  // file was named, two outputs of one name, an output that is an input (but of `edit`).
  static Result<Plan> make(const Options& options, InputList& list);

  [[nodiscard]] const Inputs& inputs() const { return inputs_; }
  [[nodiscard]] std::size_t size() const { return inputs_.size(); }
  // Made anew by each call.
  [[nodiscard]] PlannedInput at(std::size_t index) const;
  // As Inputs.
  void keep_part(std::size_t part, std::size_t parts) { inputs_.keep_part(part, parts); }

 private:
  explicit Plan(const Options& options) : options_(&options) {}
  [[nodiscard]] std::vector<PlannedOutput> outputs_of(const Input& input) const;
  Status check_standard_input() const;
  Status check_names();

  const Options* options_;
  Inputs inputs_;
  std::vector<const formats::Descriptor*> formats_;
  std::map<std::string, std::vector<std::filesystem::path>> taken_;  // of an output's path, where there are
};

}  // namespace selvage::pipeline
