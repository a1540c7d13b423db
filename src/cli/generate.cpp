#include "cli/generate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>

#include "cli/codes.h"
#include "cli/explain.h"
#include "cli/language.h"
#include "cli/words.h"
#include "core/words.h"
#include "formats/registry.h"
#include "pipeline/outputs.h"
#include "pipeline/report.h"
#include "pipeline/versions.h"

namespace selvage::cli {

namespace {

using pipeline::Command;
using pipeline::Json;
using pipeline::Row;
using pipeline::Subcommand;

std::string textmate() {
  return language().grammar(language());
}

Json argument_json(const Argument& argument) {
  switch (argument.form) {
    case Argument::Form::none:
      return {{"form", "flag"}};
    case Argument::Form::text:
    case Argument::Form::texts:
      return {{"form", argument.form == Argument::Form::text ? "text" : "texts"}, {"name", argument.words}};
    case Argument::Form::word:
      return {{"form", "word"}, {"words", words_of(argument.words)}};
    case Argument::Form::whole:
    case Argument::Form::real:
      return {{"form", argument.form == Argument::Form::whole ? "whole" : "real"},
              {"least", argument.least},
              {"most", argument.most < std::numeric_limits<double>::max() ? Json(argument.most) : Json()}};
  }
  return {};
}

// The words of the language, as `explain` has them.
Json language_json() {
  Json statements = Json::array(), values = Json::array();
  for (const formats::Lesson& lesson : language().lessons)
    statements.push_back({{"word", lesson.word},
                          {"blocks", words_of(lesson.blocks)},
                          {"usage", lesson.usage},
                          {"meaning", lesson.meaning},
                          {"example", lesson.example},
                          {"unit", lesson.unit.empty() ? Json() : Json(lesson.unit)},
                          {"default", lesson.preset.empty() ? Json() : Json(lesson.preset)},
                          {"opens_block", lesson.opens_block()}});
  for (const formats::Value& value : language().values)
    values.push_back(
        {{"word", value.word}, {"statements", words_of(value.statements)}, {"meaning", value.meaning}});
  return {{"name", language().name}, {"statements", std::move(statements)}, {"values", std::move(values)}};
}

// Everything that the command line knows, for programs that call it.
std::string usage_json() {
  Json commands = Json::array();
  for (const Subcommand& command : pipeline::all_commands()) {
    Json options = Json::array();
    for (const Row* row : pipeline::rows_of(command.command)) {
      const Option& option = row->option;
      options.push_back({{"names", names_of(option)},
                         {"help", option.help},
                         {"group", row->group},
                         {"argument", argument_json(option.argument)},
                         {"default", option.preset.empty() ? Json() : Json(option.preset)},
                         {"required", option.is_required},
                         {"needs", words_of(option.needs)},
                         {"not_with", words_of(option.not_with)}});
    }
    commands.push_back({{"name", command.name},
                        {"help", command.help},
                        {"options", std::move(options)},
                        {"examples", split(command.examples, '\n')}});
  }
  Json formats = Json::array(), kinds = Json::array(), codes = Json::object();
  for (const formats::Descriptor* format : formats::all_formats())
    formats.push_back({{"name", format->name},
                       {"title", format->title},
                       {"extensions", format->extensions},
                       {"readable", format->is_readable()}});
  for (const formats::Template& text : language().templates)
    kinds.push_back({{"kind", text.kind}, {"title", text.title()}});
  for (const Code& code : all_codes())
    if (code.where == exit_codes) codes[code.word] = code.meaning;
  Json all = {{"selvage", pipeline::version()}, {"commands", std::move(commands)},
              {"formats", std::move(formats)},  {"new", std::move(kinds)},
              {"explain", explained_words()},   {"topics", all_topics()},
              {"language", language_json()},    {"exit_codes", std::move(codes)}};
  pipeline::drop_unknown(all);
  return pipeline::text_of(all, 2) + "\n";
}

struct Form {
  std::string_view name;
  std::string (*make)();
};
constexpr std::array forms = {Form{"man", manual_page},
                              Form{"complete-bash", bash_completion},
                              Form{"complete-zsh", zsh_completion},
                              Form{"complete-fish", fish_completion},
                              Form{"json-usage", usage_json},
                              Form{"textmate", textmate}};

std::vector<std::string> names_of_formats(Command command) {
  std::vector<std::string> names;
  for (const formats::Descriptor* format : formats::all_formats())
    if (pipeline::can_be_written(*format, command)) names.emplace_back(format->name);
  return names;
}

}  // namespace

std::vector<std::string_view> generated_forms() {
  std::vector<std::string_view> names;
  names.reserve(forms.size());
  for (const Form& form : forms) names.push_back(form.name);
  return names;
}

Result<std::string> generate(std::string_view form) {
  for (const Form& known : forms)
    if (known.name == form) return known.make();
  return error(Kind::usage,
               fmt::format("--generate: '{}' is not one of {}", form, fmt::join(generated_forms(), ", ")));
}

std::vector<std::string_view> names_of(const Option& option) {
  return split(option.name, ',');
}

std::string argument_of(const Option& option) {
  std::string text = option.argument.in_help();
  if (option.argument.form == Argument::Form::texts) text += text.empty() ? "..." : " ...";
  return text;
}

std::vector<Group> all_groups() {
  std::vector<Group> groups;
  for (const Subcommand& command : pipeline::all_commands())
    for (const Row* row : pipeline::rows_of(command.command)) {
      auto group = std::ranges::find(groups, row->group, &Group::heading);
      if (group == groups.end()) group = groups.insert(group, {row->group, {}});
      if (std::ranges::count(group->rows, row) == 0) group->rows.push_back(row);
    }
  return groups;
}

Expected expected(Command command, const Option& option) {
  Expected found;
  const bool is_named = option.name.starts_with('-');
  if (option.argument.form == Argument::Form::word) {
    for (const std::string_view word : words_of(option.argument.words)) found.words.emplace_back(word);
  } else if (command == Command::new_text && !is_named) {
    for (const formats::Template& text : language().templates) found.words.emplace_back(text.kind);
  } else if (command == Command::explain) {
    found.words = explained_words();
  } else if (command == Command::help) {
    for (const Subcommand& one : pipeline::all_commands()) found.words.emplace_back(one.name);
    for (const std::string& word : explained_words()) found.words.push_back(word);
  } else if (option.argument.words == "FORMAT") {
    found.words = names_of_formats(command == Command::roundtrip ? Command::convert : command);
    found.is_list = true;
  } else if (command == Command::report && !is_named) {
    found.takes_files = true;
  } else if (!is_named) {
    found.takes_inputs = true;
  } else {
    found.takes_files = option.argument.words == "FILE" || option.argument.words == "PLACE";
  }
  return found;
}

std::vector<std::string_view> readable_extensions() {
  std::vector<std::string_view> all;
  for (const formats::Descriptor* format : formats::all_formats())
    if (format->is_readable()) all.insert(all.end(), format->extensions.begin(), format->extensions.end());
  return all;
}

}  // namespace selvage::cli
