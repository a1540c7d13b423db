#include <fmt/format.h>

#include <csignal>
#include <sstream>

#include "cli/cli.h"
#include "core/standard_output.h"
#include "pipeline/batch.h"
#include "pipeline/versions.h"

namespace selvage::cli {

namespace {

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const std::string_view near = nearest_word(word, std::vector<std::string_view>(known.begin(), known.end()));
  return near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near);
}

Message no_command(const CLI::App& program, const std::string& word) {
  if (const std::string later = later_command(word); !later.empty()) return error(Kind::usage, later);
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands(nullptr)) names.push_back(command->get_name());
  return error(Kind::usage, fmt::format("unknown subcommand '{}'{} (help: selvage --help)", word,
                                        did_you_mean(word, names)));
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
  return error(Kind::usage, fmt::format("{} (help: selvage {}--help)", text,
                                        command == &program ? "" : command->get_name() + " "));
}

int run(int count, char** words) {
  CLI::App program("Yarn-level fabrics: text in; IGES, STEP, checked solids and solver-ready meshes out.",
                   "selvage");
  program.set_version_flag("--version", fmt::format("selvage {}", pipeline::version()));
  program.require_subcommand(1);
  Parsed parsed;
  add_convert(program, parsed);
  add_check(program, parsed);
  add_relax(program, parsed);
  add_mesh(program, parsed);
  add_roundtrip(program, parsed);
  add_diff(program, parsed);
  add_info(program, parsed);
  add_edit(program, parsed);
  add_view(program, parsed);
  add_formats(program, parsed);
  try {
    program.parse(count, words);
  } catch (const CLI::ParseError& failure) {
    if (failure.get_exit_code() == 0) {  // help, version
      std::ostringstream text;
      program.exit(failure, text, text);
      return tell(text.str());
    }
    return pipeline::refuse(refusal(program, failure, count, words));
  }
  return parsed.action();
}

}  // namespace

}  // namespace selvage::cli

int main(int count, char** words) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit is then an error of writing, with its name
  if (const selvage::Status opened = selvage::open_standard_streams(); !opened)
    return selvage::pipeline::refuse(opened.error());
  return selvage::cli::run(count, words);
}
