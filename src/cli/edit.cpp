#include <fmt/format.h>

#include <limits>

#include "cli/cli.h"
#include "core/number_text.h"
#include "pipeline/batch.h"

namespace selvage::cli {

namespace {

struct Words {
  std::string to, along, by = "control";
};

// Three numbers joined by commas, kept as they are written.
Status take_vector(const std::string& option, std::string_view text, formats::NewEdit& edit, Vec3& vector) {
  const auto refused = [&] {
    return error(
        Kind::usage,
        fmt::format("{} {}: three numbers joined by commas are expected, as in 1,0.2,-0.5", option, text));
  };
  std::string_view rest = text;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t comma = i < 2 ? rest.find(',') : rest.size();
    if (comma == rest.npos) return refused();
    const std::optional<double> value = read_number(rest.substr(0, comma));
    if (!value) return refused();
    vector[static_cast<Eigen::Index>(i)] = *value;
    edit.vector[i] = rest.substr(0, comma);
    if (i < 2) rest.remove_prefix(comma + 1);
  }
  return {};
}

Status complete(const Words& words, formats::NewEdit& added) {
  fabric::Edit& edit = added.edit;
  if (words.along.empty() != added.length.empty())
    return error(Kind::usage, "--length L and --along X,Y,Z go together");
  if (words.to.empty() == words.along.empty())
    return error(Kind::usage, "name either --to X,Y,Z, or --length L with --along X,Y,Z");
  if (!words.to.empty()) {
    edit.form = words.by == "weight" ? fabric::Edit::Form::weight : fabric::Edit::Form::point;
    return take_vector("--to", words.to, added, edit.target);
  }
  if (words.by != "control") return error(Kind::usage, "--by weight goes with --to, not with --length");
  edit.form = fabric::Edit::Form::length;
  const std::optional<double> length = read_number(added.length);
  if (!length || *length <= 0.0)
    return error(Kind::usage, fmt::format("--length {}: a length is a number above 0", added.length));
  edit.length = *length;
  if (Status status = take_vector("--along", words.along, added, edit.direction); !status) return status;
  if (edit.direction == Vec3::Zero())
    return error(Kind::usage, fmt::format("--along {}: this is no direction", words.along));
  return {};
}

}  // namespace

void add_edit(CLI::App& program, Parsed& parsed) {
  CLI::App& command =
      *program.add_subcommand("edit", "move a point of a yarn: adds an `edit` line to a Fabric TXT file");
  pipeline::EditRequest& request = parsed.edit;
  const auto words = std::make_shared<Words>();
  command.add_option("INPUT", request.input, "a file of Fabric TXT, or - for standard input")->required();
  command.add_option("--yarn", request.edit.edit.yarn, "the yarn's name")->required();
  command.add_option("--point", request.edit.edit.joint, "which joint of its centre line, from 1")
      ->required()
      ->check(CLI::Range(1, std::numeric_limits<int>::max()));
  command.add_option("--to", words->to, "X,Y,Z: where the joint goes, in the file's unit");
  command.add_option("--by", words->by, "what moves it: control (a control point, the default) or weight")
      ->check(CLI::IsMember({"control", "weight"}));
  command.add_option("--length", request.edit.length,
                     "instead of --to: the length that the centre line gets");
  command.add_option("--along", words->along, "X,Y,Z: the direction in which the joint moves for --length");
  command.add_option("-o,--output", request.output, "the new text (may be INPUT), or - for standard output")
      ->required();
  command.add_flag("-q,--quiet", request.options.quiet, "errors only");
  add_limits(command, request.options);
  add_outside(command, request.options.allow_outside);
  command.callback([&parsed, words] {
    parsed.action = [&parsed, words] {
      if (Status status = complete(*words, parsed.edit.edit); !status)
        return pipeline::refuse(status.error());
      return pipeline::edit(parsed.edit);
    };
  });
}

}  // namespace selvage::cli
