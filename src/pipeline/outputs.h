// Which files a run writes: formats, names, and that no two of them are the same.
#pragma once

#include <filesystem>
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
  std::string path;  // as text: a run may have 100,000, and each is kept to its end
  bool to_standard_output = false;
  // Names that inputs and other outputs have, of those that this one may need where it takes several files.
  std::vector<std::filesystem::path> taken{};
  bool is_companion = false;  // formats::Descriptor::companion of another one: of meshes with load cases only
};

// Can this subcommand write it?
bool can_be_written(const formats::Descriptor& format, Command command);
// Of the format that `check --gap-map` writes, for help.
std::string_view extension_of_gap_maps();

// The outputs of each input, in the order of `list.inputs`; empty lists for commands that write no files
// (check: its gap map).
// Errors (usage): an unknown or unfitting format, several outputs where one file was named, two outputs of
// one name, an output that is an input (but of `edit`).
Result<std::vector<std::vector<PlannedOutput>>> plan_outputs(const Options& options, const InputList& list);

}  // namespace selvage::pipeline
