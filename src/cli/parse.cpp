#include "cli/parse.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <sstream>

#include "pipeline/command_line.h"
#include "pipeline/versions.h"

namespace selvage::cli {

namespace {

using pipeline::Row;

// Words of the contract that come with later versions.
constexpr std::array<std::string_view, 1> later_commands = {"report"};

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const std::string_view near = nearest_word(word, std::vector<std::string_view>(known.begin(), known.end()));
  return near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near);
}

Message no_command(const CLI::App& program, const std::string& word) {
  if (std::find(later_commands.begin(), later_commands.end(), word) != later_commands.end())
    return error(Kind::usage, fmt::format("'selvage {}' is not in this version of selvage", word));
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands(nullptr)) names.push_back(command->get_name());
  return error(Kind::usage, fmt::format("unknown subcommand '{}'{} (help: selvage --help)", word,
                                        did_you_mean(word, names)));
}

Message with_help(std::string_view text, const CLI::App& program, const CLI::App& command) {
  return error(Kind::usage, fmt::format("{} (help: selvage {}--help)", text,
                                        &command == &program ? "" : command.get_name() + " "));
}

// Why the command line was refused.
Message refusal(const CLI::App& program, const CLI::ParseError& failure, int count, char** words) {
  const CLI::App* command = program.get_subcommands().empty() ? &program : program.get_subcommands().front();
  if (command == &program && count > 1) return no_command(program, words[1]);
  std::string text = failure.what();
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (failure.get_exit_code() != static_cast<int>(CLI::ExitCodes::ExtrasError)) continue;
    // Not as the beginning of a longer one.
    if (!word.starts_with("--") || (text + ' ').find(word + ' ') == std::string::npos) continue;
    std::vector<std::string> names;
    for (const CLI::Option* option : command->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    text = fmt::format("unknown option '{}'{}", word, did_you_mean(word, names));
    break;
  }
  return with_help(text, program, *command);
}

CLI::Option* add(CLI::App& command, const Row& row) {
  const Option& option = row.option;
  const std::string name(option.name);
  // Const: CLI11 takes another string for the place where the value goes.
  const std::string help = option.preset.empty()
                               ? std::string(option.help)
                               : fmt::format("{} (default: {})", option.help, option.preset);
  if (option.argument.form == Argument::Form::none) return command.add_flag(name, help)->group(row.group);
  CLI::Option* added = command.add_option(name, CLI::callback_t(), help);
  added->type_name(option.argument.in_help())->required(option.is_required)->group(row.group);
  if (option.argument.form == Argument::Form::texts) added->expected(CLI::detail::expected_max_vector_size);
  return added;
}

// What was given of the subcommand's options.
pipeline::Given given_of(const CLI::App& command, pipeline::Command what) {
  pipeline::Given given;
  for (const Row* row : pipeline::rows_of(what)) {
    const Option& option = row->option;
    const CLI::Option* found = command.get_option(std::string(option.long_name()));
    if (found->count() == 0) continue;
    if (option.argument.form != Argument::Form::none)
      given[option.name] = found->results();
    else if (found->as<bool>())
      given[option.name] = {""};
  }
  return given;
}

}  // namespace

Result<Parsed> parse(int count, char** words) {
  CLI::App program("Yarn-level fabrics: text in; CAD files, checked solids and solver-ready meshes out.",
                   "selvage");
  program.set_version_flag("--version", &pipeline::version_text);
  program.require_subcommand(1);
  for (const pipeline::Subcommand& known : pipeline::all_commands()) {
    CLI::App& command = *program.add_subcommand(std::string(known.name), std::string(known.help));
    // What no word names needs no options: to set up those of all commands takes longer than a small job.
    if (std::find(words, words + count, known.name) == words + count) continue;
    for (const Row* row : pipeline::rows_of(known.command)) add(command, *row);
  }
  try {
    program.parse(count, words);
    const CLI::App& command = *program.get_subcommands().front();
    for (const pipeline::Subcommand& known : pipeline::all_commands()) {
      if (known.name != command.get_name()) continue;
      Result<pipeline::Options> options =
          pipeline::understand(known.command, given_of(command, known.command));
      if (!options) return with_help(options.error().text, program, command);
      return Parsed{{}, std::move(*options)};
    }
    return error(Kind::internal, "a subcommand that is not in the table");
  } catch (const CLI::ParseError& failure) {
    if (failure.get_exit_code() != 0) return refusal(program, failure, count, words);
    std::ostringstream text;  // help, version
    program.exit(failure, text, text);
    return Parsed{text.str(), {}};
  }
}

}  // namespace selvage::cli
