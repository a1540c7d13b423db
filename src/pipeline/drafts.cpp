#include "pipeline/drafts.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/sha256.h"
#include "core/text_report.h"
#include "pipeline/detect.h"

namespace selvage::pipeline {

namespace {

namespace fs = std::filesystem;
using fabric::Draft;
using fabric::Weave;

Result<Draft> only_draft(const fabric::Fabric& fabric) {
  const Draft* draft = nullptr;
  std::size_t weaves = 0;
  for (const fabric::Item& item : fabric.items) {
    const auto* const weave = std::get_if<Weave>(&item);
    if (weave == nullptr) continue;
    draft = &weave->draft;
    ++weaves;
  }
  if (weaves != 1) return error(Kind::malformed, fmt::format("it has {} weaves, not one", weaves));
  if (draft->form == Draft::Form::file)
    return error(Kind::unsupported,
                 fmt::format("its draft stands in a file, too: {}", in_quotes(draft->file)));
  return *draft;
}

// The draft of a file; an error says why there is none in the words that follow the file's name.
Result<Draft> draft_in(const Source& source, Diagnostics& diagnostics) {
  const Result<const formats::Descriptor*> format = detect_readable(source);
  if (!format) return format.error();
  if ((*format)->read_fabric == nullptr)
    return error(Kind::unsupported, fmt::format("it is {} ({}), which holds geometry and no draft",
                                                (*format)->name, (*format)->title));
  Diagnostics own;
  const std::optional<fabric::Fabric> fabric = (*format)->read_fabric(source, own);
  for (const Message& message : own.messages()) diagnostics.add(message);
  if (!fabric) return error(Kind::malformed, "it has errors");
  return only_draft(*fabric);
}

bool is_below(const fs::path& file, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

// The file that `name` is for a text in `folder`, if it may be read; an error says why not in the words that
// follow its name.
Result<Source> open_named(const std::string& name, const fs::path& folder, bool allow_outside) {
  std::error_code failure;
  const fs::path home = fs::canonical(folder.empty() ? fs::path(".") : folder, failure);
  if (failure) return error(Kind::io, fmt::format("cannot open its folder: {}", failure.message()));
  const fs::path file = fs::canonical(home / name, failure);
  if (failure) return error(Kind::io, fmt::format("cannot open: {}", failure.message()));
  if (!allow_outside && !is_below(file, home))
    return error(Kind::usage,
                 "it is neither in this text's folder nor below it: move it there, or --allow-outside reads "
                 "it");
  if (!fs::is_regular_file(file, failure)) return error(Kind::io, "it is not a regular file");
  return Source::open(folder / name == "-" ? "./-" : folder / name);  // standard input is the input's alone
}

}  // namespace

std::vector<std::string> resolve_drafts(fabric::Fabric& fabric, const Source& source, bool allow_outside,
                                        Diagnostics& diagnostics) {
  std::vector<std::string> read;
  TextReport report(source);
  const auto refuse = [&](const Draft& draft, const Message& why) {
    report.error(spot_at(source, draft.place),
                 fmt::format("no draft in the file {}: {}", in_quotes(draft.file), why.text), why.kind);
  };
  for (fabric::Item& item : fabric.items) {
    auto* const weave = std::get_if<Weave>(&item);
    if (weave == nullptr || weave->draft.form != Draft::Form::file) continue;
    const Result<Source> named =
        open_named(weave->draft.file, fs::path(source.name()).parent_path(), allow_outside);
    if (!named) {
      refuse(weave->draft, named.error());
      continue;
    }
    read.push_back(fmt::format("{} {}", weave->draft.file, sha256(named->bytes())));
    Result<Draft> draft = draft_in(*named, diagnostics);
    if (!draft) {
      refuse(weave->draft, draft.error());
      continue;
    }
    draft->place = weave->draft.place;
    weave->draft = std::move(*draft);
  }
  report.hand_over(diagnostics);
  return read;
}

}  // namespace selvage::pipeline
