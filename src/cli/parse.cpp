#include "cli/parse.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

#include "cli/generate.h"
#include "cli/words.h"
#include "core/words.h"
#include "pipeline/command_line.h"
#include "pipeline/versions.h"

namespace selvage::cli {

namespace {

using pipeline::Row;

Message no_command(const std::string& word) {
  std::vector<std::string> names;
  for (const pipeline::Subcommand& command : pipeline::all_commands()) names.emplace_back(command.name);
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
  if (command == &program && count > 1) return no_command(words[1]);
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

// Flags before the subcommand, as in `selvage -q check FILE`, are the subcommand's. --version is the
// program's.
void put_command_first(int count, char** words) {
  if (count < 2 || std::string_view(words[1]) == "--version") return;
  char** const end = words + count;
  char** const first = std::find_if(words + 1, end, [](const char* word) { return *word != '-'; });
  if (first == end || first == words + 1) return;
  const auto& known = pipeline::all_commands();
  const auto is_it = [&](const pipeline::Subcommand& command) { return command.name == *first; };
  if (std::any_of(known.begin(), known.end(), is_it)) std::rotate(words + 1, first, first + 1);
}

// What `--generate` makes.
Result<Parsed> generated(std::string_view what) {
  Result<std::string> text = generate(what);
  if (!text) return text.error();
  return Parsed{std::move(*text), {}};
}

}  // namespace

Result<Parsed> parse(int count, char** words) {
  put_command_first(count, words);
  constexpr std::string_view generator = "--generate";
  if (count > 1 && words[1] == generator) return generated(count == 3 ? words[2] : "");
  CLI::App program("Yarn-level fabrics: text in; CAD files, checked solids and solver-ready meshes out.",
                   "selvage");
  program.set_version_flag("--version", &pipeline::version_text);
  const auto names = [&](std::string_view word) {
    return std::find(words, words + count, word) != words + count;
  };
  const bool wants_help = names("-h") || names("--help");
  if (wants_help)
    program.footer(
        fmt::format("To begin: selvage new plain -o plain.txt, then selvage view plain.txt -o "
                    "plain.png\nAlso:     selvage --generate {{{}}}",
                    fmt::join(generated_forms(), ",")));
  program.require_subcommand(1);
  for (const pipeline::Subcommand& known : pipeline::all_commands()) {
    // What no word names stands in the program's help alone, and has no options there: to set up those of all
    // commands takes longer than a small job.
    const bool is_named = names(known.name);
    if (!is_named && !wants_help) continue;
    CLI::App& command = *program.add_subcommand(std::string(known.name), std::string(known.help));
    if (!is_named) continue;
    for (const Row* row : pipeline::rows_of(known.command)) add(command, *row);
    command.footer(fmt::format("Examples:\n  {}", fmt::join(split(known.examples, '\n'), "\n  ")));
  }
  try {
    program.parse(count, words);
    const CLI::App& command = *program.get_subcommands().front();
    for (const pipeline::Subcommand& known : pipeline::all_commands()) {
      if (known.name != command.get_name()) continue;
      Result<pipeline::Options> options =
          pipeline::understand(known.command, given_of(command, known.command));
      if (!options) return with_help(options.error().text, program, command);
      if (known.command == pipeline::Command::show_version)
        return Parsed{pipeline::version_text() + "\n", {}};
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
