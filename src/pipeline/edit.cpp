#include "pipeline/edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>

#include "core/output.h"
#include "core/source.h"
#include "fabric/build.h"
#include "pipeline/batch.h"
#include "pipeline/detect.h"
#include "pipeline/drafts.h"
#include "pipeline/outputs.h"

namespace selvage::pipeline {

namespace {

void say(const EditRequest& request, Message message) {
  if (message.file.empty()) message.file = request.input == "-" ? "<stdin>" : request.input;
  if (message.severity == Severity::note || (request.quiet && message.severity != Severity::error)) return;
  std::fprintf(stderr, "%s\n", to_string(message).c_str());
}

void say_all(const EditRequest& request, const std::vector<Message>& messages) {
  for (const Message& message : messages) say(request, message);
}

// The line behind which the edit belongs: the end of the item that makes the yarn (of the last one, where its
// place is not known), or an edit behind it.
int line_before(const fabric::Fabric& fabric, TextPlace yarn) {
  int line = 0;
  for (std::size_t i = 0; i < fabric.items.size(); ++i) {
    const TextPlace place = std::visit([](const auto& item) { return item.place; }, fabric.items[i]);
    if (yarn.line == 0 || place.line <= yarn.line) line = std::max(line, fabric.item_ends[i]);
  }
  for (const fabric::Edit& edit : fabric.edits) line = std::max(line, edit.place.line);
  return line;
}

// Where the yarn is made, if the edit is possible; nothing when it is not (it was said why).
std::optional<TextPlace> try_edit(const EditRequest& request, const fabric::Fabric& before) {
  fabric::Fabric after = before;
  after.edits.push_back(request.edit.edit);
  Diagnostics diagnostics;
  fabric::BuildOptions options;
  options.detail = fabric::Detail::yarn;  // an edit moves the centre line of the whole yarn
  const std::optional<fabric::YarnBuilder> builder = fabric::YarnBuilder::create(after, options, diagnostics);
  say_all(request, diagnostics.messages());
  if (!builder) return std::nullopt;
  const std::optional<std::size_t> index = builder->find(request.edit.edit.yarn);
  if (!index) {
    say(request, error(Kind::geometry, fmt::format("there is no yarn '{}'", request.edit.edit.yarn)));
    return std::nullopt;
  }
  const Result<yarn::Body> body = builder->build(*index);
  if (!body) {
    say(request, body.error());
    return std::nullopt;
  }
  say_all(request, body->messages);
  return body->place;
}

Status write(const EditRequest& request, std::string_view text) {
  Result<OutputFile> file =
      request.output == "-" ? OutputFile::standard_output() : OutputFile::create(request.output);
  if (!file) return file.error();
  if (Status status = file->write(text); !status) return status;
  return file->commit();
}

bool work(const EditRequest& request) {
  const auto fail = [&](const Message& message) {
    say(request, message);
    return false;
  };
  const Result<Source> source = Source::open(request.input);
  if (!source) return fail(source.error());
  const Result<const formats::Descriptor*> format = detect_readable(*source);
  if (!format) return fail(format.error());
  if ((*format)->insert_edit == nullptr)
    return fail(
        error(Kind::unsupported, fmt::format("this is {} ({}): an `edit` line belongs in a Fabric TXT file",
                                             (*format)->name, (*format)->title)));
  Diagnostics diagnostics;
  std::optional<fabric::Fabric> fabric = (*format)->read_fabric(*source, diagnostics);
  if (fabric) resolve_drafts(*fabric, *source, diagnostics);
  say_all(request, diagnostics.messages());
  if (!fabric || diagnostics.has_errors()) return false;
  const std::optional<TextPlace> place = try_edit(request, *fabric);
  if (!place) return false;
  const std::string text =
      (*format)->insert_edit(source->bytes(), line_before(*fabric, *place), request.edit);
  const Status written = write(request, text);
  return written.ok() || fail(written.error());
}

}  // namespace

int edit(const EditRequest& asked) {
  const Result<std::filesystem::path> place = output_of_edit(asked.output, asked.input);
  if (!place) return refuse(place.error());
  EditRequest request = asked;
  request.output = place->string();
  try {
    return work(request) ? 0 : 1;
  } catch (const std::bad_alloc&) {
    say(request, error(Kind::limit, "needs more memory than there is"));
  } catch (const std::exception& failure) {
    say(request, error(Kind::internal, fmt::format("unexpected failure: {}", failure.what())));
  }
  return 1;
}

}  // namespace selvage::pipeline
