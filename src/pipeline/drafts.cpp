#include "pipeline/drafts.h"

#include <fmt/format.h>

#include <filesystem>

#include "core/sha256.h"
#include "core/text_report.h"
#include "pipeline/detect.h"

namespace selvage::pipeline {

namespace {

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
  Diagnostics own;
  const std::optional<fabric::Fabric> fabric = (*format)->read_fabric(source, own);
  for (const Message& message : own.messages()) diagnostics.add(message);
  if (!fabric) return error(Kind::malformed, "it has errors");
  return only_draft(*fabric);
}

}  // namespace

std::vector<std::string> resolve_drafts(fabric::Fabric& fabric, const Source& source,
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
    std::filesystem::path path = std::filesystem::path(source.name()).parent_path() / weave->draft.file;
    if (path == "-") path = "./-";  // a file: standard input is the input's alone
    const Result<Source> named = Source::open(path);
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
