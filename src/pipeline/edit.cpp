#include "pipeline/edit.h"

#include <fmt/format.h>

#include <algorithm>

#include "construction/settle_cell.h"
#include "core/number_text.h"
#include "fabric/loft.h"
#include "garment/piece.h"
#include "pipeline/detect.h"
#include "pipeline/named_files.h"
#include "pipeline/writing.h"

namespace selvage::pipeline {

namespace {

// Three numbers, of a garment curve two, joined by commas, kept as they are written.
Status take_vector(const std::string& option, std::string_view text, formats::NewEdit& edit, Vec3& vector) {
  const auto refused = [&] {
    return error(Kind::usage, fmt::format("{} {}: {} joined by commas are expected, as in {}", option, text,
                                          edit.piece.empty() ? "three numbers" : "two numbers",
                                          edit.piece.empty() ? "1,0.2,-0.5" : "1,-0.5"));
  };
  const std::size_t count = edit.piece.empty() ? 3 : 2;
  std::string_view rest = text;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t comma = i + 1 < count ? rest.find(',') : rest.size();
    if (comma == rest.npos) return refused();
    const std::optional<double> value = read_number(rest.substr(0, comma));
    if (!value) return refused();
    vector[static_cast<Eigen::Index>(i)] = *value;
    edit.vector[i] = rest.substr(0, comma);
    if (i + 1 < count) rest.remove_prefix(comma + 1);
  }
  return {};
}

}  // namespace

Result<formats::NewEdit> wanted_edit(const EditWords& words) {
  formats::NewEdit added;
  fabric::Edit& edit = added.edit;
  if (words.piece.empty() != words.curve.empty())
    return error(Kind::usage, "--piece NAME and --curve NAME go together");
  if (words.yarn.empty() == words.piece.empty())
    return error(Kind::usage, "name either --yarn NAME, or --piece NAME with --curve NAME");
  added.piece = words.piece;
  edit.yarn = words.piece.empty() ? words.yarn : words.curve;
  edit.joint = words.point;
  added.length = words.length;
  if (words.along.empty() != words.length.empty())
    return error(Kind::usage, "--length L and --along X,Y,Z go together");
  if (words.to.empty() == words.along.empty())
    return error(Kind::usage, "name either --to X,Y,Z, or --length L with --along X,Y,Z");
  if (!words.to.empty()) {
    edit.form = words.by == "weight" ? fabric::Edit::Form::weight : fabric::Edit::Form::point;
    if (Status status = take_vector("--to", words.to, added, edit.target); !status) return status.error();
    return added;
  }
  if (words.by != "control") return error(Kind::usage, "--by weight goes with --to, not with --length");
  edit.form = fabric::Edit::Form::length;
  const std::optional<double> length = read_number(words.length);
  if (!length || *length <= 0.0)
    return error(Kind::usage, fmt::format("--length {}: a length is a number above 0", words.length));
  edit.length = *length;
  if (Status status = take_vector("--along", words.along, added, edit.direction); !status)
    return status.error();
  if (edit.direction == Vec3::Zero())
    return error(Kind::usage, fmt::format("--along {}: this is no direction", words.along));
  return added;
}

namespace {

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
std::optional<TextPlace> try_edit(Job& job, const fabric::Fabric& before, const fabric::Edit& edit) {
  fabric::Fabric after = before;
  after.edits.push_back(edit);
  Diagnostics diagnostics;
  fabric::BuildOptions options;
  options.detail = fabric::Detail::yarn;  // an edit moves the centre line of the whole yarn
  const std::optional<fabric::YarnBuilder> builder = fabric::YarnBuilder::create(after, options, diagnostics);
  job.say_all(diagnostics.messages());
  if (!builder) return std::nullopt;
  const std::optional<std::size_t> index = builder->find(edit.yarn);
  if (!index) return job.fail(error(Kind::geometry, fmt::format("there is no yarn '{}'", edit.yarn)));
  const Result<yarn::Body> body = builder->build(*index);
  if (!body) return job.fail(body.error());
  job.say_all(body->messages);
  return body->place;
}

// The line behind which an edit of a piece's curve belongs, the last one before the piece's `end`, if the
// edit is possible; nothing when it is not (it was said why).
std::optional<int> try_piece_edit(Job& job, const fabric::Fabric& before, const formats::NewEdit& added) {
  fabric::Fabric after = before;
  for (std::size_t i = 0; i < after.items.size(); ++i) {
    auto* piece = std::get_if<fabric::Piece>(&after.items[i]);
    if (piece == nullptr || piece->name != added.piece) continue;
    piece->edits.push_back(added.edit);
    piece->edits.back().place = piece->place;
    Diagnostics diagnostics;
    const bool is_built = fabric::build_piece(after, *piece, 0, diagnostics).has_value();
    job.say_all(diagnostics.messages());
    return is_built ? std::optional(after.item_ends[i] - 1) : std::nullopt;
  }
  return job.fail(error(Kind::geometry, fmt::format("there is no piece '{}'", added.piece)));
}

std::optional<int> line_of_edit(Job& job, const fabric::Fabric& fabric, const formats::NewEdit& added) {
  if (!added.piece.empty()) return try_piece_edit(job, fabric, added);
  const std::optional<TextPlace> place = try_edit(job, fabric, added.edit);
  if (!place) return std::nullopt;
  return line_before(fabric, *place);
}

}  // namespace

void edit(Job& job) {
  const Result<formats::NewEdit> added = wanted_edit(job.options.edit);
  if (!added) return job.say(added.error());
  const Result<Source> source = Source::open(job.input.path);
  if (!source) return job.say(source.error());
  const Result<const formats::Descriptor*> format = detect_readable(*source);
  if (!format) return job.say(format.error());
  if ((*format)->insert_edit == nullptr)
    return job.say(error(Kind::unsupported, fmt::format("this is {} ({}): an `edit` line belongs in a text",
                                                        (*format)->name, (*format)->title)));
  job.limit_time(**format);
  Diagnostics diagnostics;
  std::optional<fabric::Fabric> fabric = (*format)->read_fabric(*source, diagnostics);
  if (fabric) resolve_files(*fabric, *source, job.options.allow_outside, diagnostics);
  if (fabric) fabric::loft(*fabric, diagnostics);
  if (fabric && !diagnostics.has_errors()) fabric::settle_cell(*fabric, {}, 1, diagnostics);
  job.say_all(diagnostics.messages());
  if (!fabric || diagnostics.has_errors()) return;
  const std::optional<int> line = line_of_edit(job, *fabric, *added);
  if (!line) return;
  std::optional<OpenOutputs> outputs = open_outputs(job);
  if (!outputs) return;
  const std::string text = (*format)->insert_edit(source->bytes(), *line, *added);
  if (Status written = outputs->front().file.write(text); !written) return job.say(written.error());
  commit_all(job, *outputs);
}

}  // namespace selvage::pipeline
