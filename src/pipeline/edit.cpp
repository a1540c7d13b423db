#include "pipeline/edit.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/output.h"
#include "core/source.h"
#include "fabric/build.h"
#include "pipeline/batch.h"
#include "pipeline/detect.h"
#include "pipeline/drafts.h"
#include "pipeline/limits.h"
#include "pipeline/outputs.h"
#include "pipeline/single.h"

namespace selvage::pipeline {

namespace {

// The request, and who is told of it.
struct Edit {
  const EditRequest& request;
  const Channel& channel;

  void say(Message message) const {
    if (message.file.empty()) message.file = request.input == "-" ? "<stdin>" : request.input;
    if (message.severity == Severity::note) return;
    if (!request.options.quiet || message.severity == Severity::error)
      channel.send(packet::message, to_string(message));
  }
  void say_all(const std::vector<Message>& messages) const {
    for (const Message& message : messages) say(message);
  }
};

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
std::optional<TextPlace> try_edit(const Edit& edit, const fabric::Fabric& before) {
  fabric::Fabric after = before;
  after.edits.push_back(edit.request.edit.edit);
  Diagnostics diagnostics;
  fabric::BuildOptions options;
  options.detail = fabric::Detail::yarn;  // an edit moves the centre line of the whole yarn
  const std::optional<fabric::YarnBuilder> builder = fabric::YarnBuilder::create(after, options, diagnostics);
  edit.say_all(diagnostics.messages());
  if (!builder) return std::nullopt;
  const std::optional<std::size_t> index = builder->find(edit.request.edit.edit.yarn);
  if (!index) {
    edit.say(error(Kind::geometry, fmt::format("there is no yarn '{}'", edit.request.edit.edit.yarn)));
    return std::nullopt;
  }
  const Result<yarn::Body> body = builder->build(*index);
  if (!body) {
    edit.say(body.error());
    return std::nullopt;
  }
  edit.say_all(body->messages);
  return body->place;
}

Status write(const EditRequest& request, std::string_view text) {
  Result<OutputFile> file =
      request.output == "-" ? OutputFile::standard_output() : OutputFile::create(request.output);
  if (!file) return file.error();
  if (Status status = file->write(text); !status) return status;
  return file->commit();
}

bool work(const Edit& edit) {
  const EditRequest& request = edit.request;
  const auto fail = [&](const Message& message) {
    edit.say(message);
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
  if (fabric) resolve_drafts(*fabric, *source, request.options.allow_outside, diagnostics);
  edit.say_all(diagnostics.messages());
  if (!fabric || diagnostics.has_errors()) return false;
  const std::optional<TextPlace> place = try_edit(edit, *fabric);
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
  Single single;
  single.what = "the edit";
  single.inputs = {request.input};
  if (request.output != "-") single.outputs = {request.output};
  single.work = [&](const Channel& channel) {
    return work({request, channel}) ? Verdict::done : Verdict::failed;
  };
  return run_single(request.options, single);
}

}  // namespace selvage::pipeline
