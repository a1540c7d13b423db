// The manual page, in the man macros: groff_man(7).
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/codes.h"
#include "cli/generate.h"
#include "core/clock.h"
#include "core/words.h"
#include "pipeline/versions.h"

namespace selvage::cli {

namespace {

// Text that roff takes as it is: backslashes, dashes, what would be a request at the beginning of a line.
std::string roff(std::string_view text) {
  std::string out;
  if (text.starts_with('.') || text.starts_with('\'')) out = "\\&";
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '~')
      out += "\\(ti";
    else if (c == '^')
      out += "\\(ha";
    else if (c == '`' || c == '\'')
      out += c == '`' ? "\\(ga" : "\\(aq";
    else
      out += c;
  }
  return out;
}

// The same in lines, of which none is long.
std::string filled(std::string_view text) {
  constexpr std::size_t most = 70;
  std::string out, line;
  for (const std::string_view word : words_of(text)) {
    if (!line.empty() && line.size() + 1 + word.size() > most) {
      out += roff(line) + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + std::string(word);
  }
  return out + roff(line);
}

std::string paragraph(const std::string& tag, std::string_view text) {
  return fmt::format(".TP\n{}\n{}\n", tag, filled(text));
}

std::string tag_of(const Option& option) {
  std::string tag;
  for (const std::string_view name : names_of(option))
    tag += fmt::format("{}\\fB{}\\fR", tag.empty() ? "" : ", ", roff(name));
  const std::string argument = argument_of(option);
  return argument.empty() ? tag : fmt::format("{} \\fI{}\\fR", tag, roff(argument));
}

std::string help_of(const pipeline::Row& row) {
  std::string text(row.option.help);
  if (!row.option.preset.empty()) text += fmt::format(" (default: {})", row.option.preset);
  std::vector<std::string_view> commands;
  for (const pipeline::Command command : row.commands) commands.push_back(pipeline::name_of(command));
  return fmt::format("Of {}: {}", fmt::join(commands, ", "), text);
}

}  // namespace

std::string manual_page() {
  std::string page = fmt::format(
      ".\\\" Made by: selvage --generate man\n"
      ".TH SELVAGE 1 {} \"selvage {}\" \"User Commands\"\n"
      ".SH NAME\n"
      "selvage \\- fabrics yarn by yarn: text in; CAD files, solids and meshes out\n"
      ".SH SYNOPSIS\n"
      ".B selvage\n"
      ".I COMMAND\n"
      "[\\fIOPTIONS\\fR] [\\fIARGUMENTS\\fR]\n"
      ".br\n"
      ".B selvage\n"
      "\\fB\\-\\-help\\fR | \\fB\\-\\-version\\fR | \\fB\\-\\-generate\\fR \\fIFORM\\fR\n",
      iso_timestamp().substr(0, 10), pipeline::version());
  page += ".SH COMMANDS\n";
  for (const pipeline::Subcommand& command : pipeline::all_commands())
    page += paragraph(fmt::format("\\fB{}\\fR", roff(command.name)), command.help);
  page += ".SH OPTIONS\n";
  page += paragraph("\\fB\\-h\\fR, \\fB\\-\\-help\\fR", "Of every command: its options, and examples");
  page += paragraph("\\fB\\-\\-generate\\fR \\fIFORM\\fR",
                    fmt::format("Instead of a command: {}", fmt::join(generated_forms(), ", ")));
  for (const Group& group : all_groups()) {
    page += fmt::format(".SS {}\n", roff(group.heading));
    for (const pipeline::Row* row : group.rows) page += paragraph(tag_of(row->option), help_of(*row));
  }
  page += ".SH EXIT STATUS\n";
  for (const Code& code : all_codes())
    if (code.where == exit_codes) page += paragraph(fmt::format("\\fB{}\\fR", code.word), code.meaning);
  page += ".SH ENVIRONMENT\n";
  page += paragraph("\\fBNO_COLOR\\fR", "Set to anything: no colours on a terminal");
  page += paragraph("\\fBTMPDIR\\fR", "Where files of a run stand that go at its end");
  page += paragraph(
      "\\fBSOURCE_DATE_EPOCH\\fR",
      "The moment that headers of outputs name, in whole seconds of Unix time, of the years 1970 to 9999");
  page += ".SH EXAMPLES\n";
  page += ".nf\n";
  for (const pipeline::Subcommand& command : pipeline::all_commands()) page += roff(command.examples) + "\n";
  page += ".fi\n";
  return page;
}

}  // namespace selvage::cli
