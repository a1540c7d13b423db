// Completion of the command line: scripts for shells, each of which asks nothing of the program when it runs.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/generate.h"

namespace selvage::cli {

namespace {

using pipeline::Row;
using pipeline::Subcommand;

bool is_named(const Option& option) {
  return option.name.starts_with('-');
}

std::vector<std::string_view> names_of_commands() {
  std::vector<std::string_view> names;
  for (const Subcommand& command : pipeline::all_commands()) names.push_back(command.name);
  return names;
}

// In single quotes of a shell, as sh, zsh and fish read them; `quote` stands for a quote within.
std::string quoted(std::string_view text, std::string_view quote) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string(quote) : std::string(1, c);
  return out + "'";
}

// Words with blanks cannot be told from several ones: they are left out.
std::string words_text(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    if (word.find(' ') == std::string::npos) text += (text.empty() ? "" : " ") + word;
  return text;
}

// `files`, `inputs` or words: what the functions of bash and zsh below are given.
std::string what_of(const Expected& expected) {
  if (expected.takes_inputs) return "inputs";
  if (expected.takes_files) return "files";
  return fmt::format("{} {}", expected.is_list ? "list" : "words",
                     quoted(words_text(expected.words), "'\\''"));
}

// Cases "COMMAND OPTION") of what stands behind options, and "COMMAND") of what stands elsewhere.
std::string cases(std::string_view function) {
  std::string text;
  for (const Subcommand& command : pipeline::all_commands()) {
    std::string place = "words ''", names = "-h --help";
    for (const Row* row : pipeline::rows_of(command.command)) {
      const Option& option = row->option;
      const Expected what = expected(command.command, option);
      if (!is_named(option)) {
        place = what_of(what);
        continue;
      }
      std::string pattern;
      for (const std::string_view name : names_of(option)) {
        names += fmt::format(" {}", name);
        pattern += fmt::format("{}'{} {}'", pattern.empty() ? "" : "|", command.name, name);
      }
      if (option.argument.form != Argument::Form::none)
        text += fmt::format("    {}) {} {} ;;\n", pattern, function, what_of(what));
    }
    text += fmt::format("    '{} '*) {} options '{}' {} ;;\n", command.name, function, names, place);
  }
  return text;
}

}  // namespace

std::string bash_completion() {
  std::string extensions;
  for (const std::string_view extension : readable_extensions()) extensions += fmt::format(" {}", extension);
  return fmt::format(
      R"sh(# Completion of selvage for bash, made by: selvage --generate complete-bash
_selvage_reply() {{
  local extension
  case $1 in
    options)
      if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$2" -- "$word")
      else
        _selvage_reply "$3" "$4"
      fi ;;
    words) mapfile -t COMPREPLY < <(compgen -W "$2" -- "$word") ;;
    list)
      local before=
      [[ $word == *,* ]] && before=${{word%,*}},
      mapfile -t COMPREPLY < <(compgen -P "$before" -W "$2" -- "${{word##*,}}")
      compopt -o nospace 2> /dev/null ;;
    files)
      mapfile -t COMPREPLY < <(compgen -f -- "$word")
      compopt -o filenames 2> /dev/null ;;
    inputs)
      mapfile -t COMPREPLY < <(
        compgen -d -- "$word"
        for extension in{extensions}; do compgen -f -X "!*$extension" -- "$word"; done)
      compopt -o filenames 2> /dev/null ;;
  esac
  return 0
}}

_selvage() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} command= i
  # `--option=value` is three words to bash.
  if [[ $word == = ]]; then
    word=
  elif [[ $before == = ]]; then
    before=${{COMP_WORDS[COMP_CWORD - 2]}}
  fi
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    case ${{COMP_WORDS[i]}} in
      {commands})
        command=${{COMP_WORDS[i]}}
        break ;;
    esac
  done
  if [[ $before == --generate ]]; then
    _selvage_reply words '{forms}'
    return
  fi
  case "$command $before" in
    ' '*) _selvage_reply options '-h --help --version --generate' words '{all_commands}' ;;
{cases}  esac
}}

complete -F _selvage selvage
)sh",
      fmt::arg("extensions", extensions), fmt::arg("commands", fmt::join(names_of_commands(), "|")),
      fmt::arg("all_commands", fmt::join(names_of_commands(), " ")),
      fmt::arg("forms", fmt::join(generated_forms(), " ")), fmt::arg("cases", cases("_selvage_reply")));
}

std::string zsh_completion() {
  std::string patterns;
  for (const std::string_view extension : readable_extensions())
    patterns += fmt::format("{}*{}", patterns.empty() ? "" : "|", extension);
  return fmt::format(
      R"sh(#compdef selvage
# Completion of selvage for zsh, made by: selvage --generate complete-zsh
_selvage_reply() {{
  case $1 in
    options)
      if [[ $PREFIX == -* ]]; then
        compadd -- ${{=2}}
      else
        _selvage_reply "$3" "$4"
      fi ;;
    words) compadd -- ${{=2}} ;;
    list) _sequence compadd - ${{=2}} ;;
    files) _files ;;
    inputs) _files -g '({patterns})(-.)' ;;
  esac
}}

_selvage() {{
  local before=${{words[CURRENT - 1]}} command= i
  for ((i = 2; i < CURRENT; i++)); do
    case ${{words[i]}} in
      {commands})
        command=${{words[i]}}
        break ;;
    esac
  done
  if [[ $before == --generate ]]; then
    _selvage_reply words '{forms}'
    return
  fi
  case "$command $before" in
    ' '*) _selvage_reply options '-h --help --version --generate' words '{all_commands}' ;;
{cases}  esac
}}

_selvage "$@"
)sh",
      fmt::arg("patterns", patterns), fmt::arg("commands", fmt::join(names_of_commands(), "|")),
      fmt::arg("all_commands", fmt::join(names_of_commands(), " ")),
      fmt::arg("forms", fmt::join(generated_forms(), " ")), fmt::arg("cases", cases("_selvage_reply")));
}

std::string fish_completion() {
  constexpr std::string_view quote = "\\'";
  std::string text =
      "# Completion of selvage for fish, made by: selvage --generate complete-fish\n"
      "complete -c selvage -f\n"
      "complete -c selvage -s h -l help -d 'options, and examples'\n"
      "complete -c selvage -n __fish_use_subcommand -l version -d 'the version of the program'\n";
  text += fmt::format("complete -c selvage -n __fish_use_subcommand -l generate -xa '{}'\n",
                      fmt::join(generated_forms(), " "));
  for (const Subcommand& command : pipeline::all_commands()) {
    text += fmt::format("complete -c selvage -n __fish_use_subcommand -a {} -d {}\n", command.name,
                        quoted(command.help, quote));
    const std::string within =
        fmt::format("complete -c selvage -n '__fish_seen_subcommand_from {}'", command.name);
    for (const Row* row : pipeline::rows_of(command.command)) {
      const Option& option = row->option;
      const Expected what = expected(command.command, option);
      text += within;
      if (is_named(option)) {
        for (const std::string_view name : names_of(option))
          text += name.starts_with("--") ? fmt::format(" -l {}", name.substr(2))
                                         : fmt::format(" -s {}", name.substr(1));
        if (option.argument.form != Argument::Form::none) text += what.takes_files ? " -rF" : " -x";
        text += fmt::format(" -d {}", quoted(option.help, quote));
      } else if (what.takes_inputs) {
        text += " -F";
      }
      if (!what.words.empty()) text += fmt::format(" -a {}", quoted(words_text(what.words), quote));
      text += '\n';
    }
  }
  return text;
}

}  // namespace selvage::cli
