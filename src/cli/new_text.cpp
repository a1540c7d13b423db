#include "cli/new_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "cli/language.h"
#include "cli/words.h"
#include "core/output.h"
#include "formats/registry.h"
#include "pipeline/table.h"

namespace selvage::cli {

const formats::Language& language() {
  const auto& all = formats::all_formats();
  return (*std::find_if(all.begin(), all.end(),
                        [](const formats::Descriptor* format) { return format->language != nullptr; }))
      ->language();
}

Result<std::string> text_of_kind(const std::string& kind) {
  pipeline::Table table({"kind", "what"});
  std::vector<std::string> kinds;
  for (const formats::Template& text : language().templates) {
    if (text.kind == kind) return std::string(text.text);
    table.add({std::string(text.kind), std::string(text.title())});
    kinds.emplace_back(text.kind);
  }
  if (kind.empty()) return table.text();
  return error(Kind::usage, fmt::format("there is no text of the kind '{}'{} (all: selvage new)", kind,
                                        did_you_mean(kind, kinds)));
}

Status write_new_file(const std::string& path, const std::string& text) {
  std::error_code failure;
  if (std::filesystem::exists(std::filesystem::symlink_status(path, failure)))
    return error(Kind::io, "it is there already: name another file, or remove this one", {.file = path});
  Result<OutputFile> file = OutputFile::create(path);
  if (!file) return file.error();
  if (Status written = file->write(text); !written) return written;
  return file->commit();
}

}  // namespace selvage::cli
