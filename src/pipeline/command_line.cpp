#include "pipeline/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/words.h"
#include "pipeline/option_table.h"

namespace selvage::pipeline {

namespace {

// The options that were given, in the order of the table.
using Line = std::vector<std::pair<const Row*, std::vector<std::string>>>;

// Takes one option, whose values get their canonical spelling.
Status take(const Row& row, std::vector<std::string>& values, Options& options) {
  const Option& option = row.option;
  for (std::string& value : values) {
    Result<std::string> canonical = option.argument.canonical(value);
    Status status = canonical ? Status() : Status(canonical.error());
    if (canonical) value = *canonical;
    if (canonical && row.take) status = row.take(options, value);
    if (!status.ok())
      return error(Kind::usage, fmt::format("{}: {}", option.long_name(), status.error().text));
    if (!row.take) options.of_formats.set(option, value);
    if (option.is_of_run || (!value.empty() && value == option.preset)) continue;
    options.settings += fmt::format(" {}{}{}", option.word(), value.empty() ? "" : "=", value);
  }
  return {};
}

// Options that would do nothing, or contradict each other, are mistakes.
Status check_company(const std::vector<const Row*>& rows, const Line& line) {
  // Of some names, those that the subcommand has, and whether one of them was given.
  const auto company = [&](std::string_view names) {
    std::pair<std::vector<std::string_view>, bool> found;
    for (const std::string_view name : words_of(names)) {
      const auto is_it = [&](const Row* row) { return row->option.long_name() == name; };
      if (std::none_of(rows.begin(), rows.end(), is_it)) continue;
      found.first.push_back(name);
      for (const auto& [row, values] : line) found.second = found.second || is_it(row);
    }
    return found;
  };
  for (const auto& [row, values] : line) {
    const Option& option = row->option;
    const bool is_preset = !option.preset.empty() && values.back() == option.preset;
    if (option.only_as.empty() ? is_preset : values.back() != option.only_as) continue;
    const auto [needed, has_needed] = company(option.needs);
    const auto [refused, has_refused] = company(option.not_with);
    if ((needed.empty() || has_needed) && !has_refused) continue;
    std::string text = fmt::format("{}{}{} {}: it", option.long_name(), option.only_as.empty() ? "" : " ",
                                   option.only_as, option.why);
    if (!needed.empty()) text += " goes with " + alternatives(needed);
    if (!refused.empty())
      text += (needed.empty() ? " does not go with " : ", and not with ") + alternatives(refused);
    return error(Kind::usage, std::move(text));
  }
  return {};
}

}  // namespace

// What a sweep may do with each variant.
constexpr std::array swept = {Command::check, Command::convert, Command::mesh, Command::info};

static bool is_of(const Row& row, Command command) {
  return std::find(row.commands.begin(), row.commands.end(), command) != row.commands.end();
}

std::vector<const Row*> rows_of(Command command) {
  std::vector<const Row*> rows;
  for (const Row& row : all_rows()) {
    const auto is_done = [&](Command done) { return is_of(row, done); };
    const auto is_own = [&](const Row& own) {
      return own.option.name == row.option.name && is_of(own, command);
    };
    const bool is_swept = command == Command::sweep && std::any_of(swept.begin(), swept.end(), is_done) &&
                          std::none_of(all_rows().begin(), all_rows().end(), is_own);
    if (is_of(row, command) || is_swept) rows.push_back(&row);
  }
  return rows;
}

// The rows of what a sweep does, and its own. Errors (usage): an option of another command.
static Result<std::vector<const Row*>> rows_of_sweep(Command done, const Given& given) {
  std::vector<const Row*> rows;
  for (const Row* row : rows_of(Command::sweep)) {
    if (is_of(*row, Command::sweep) || is_of(*row, done))
      rows.push_back(row);
    else if (given.contains(row->option.name))
      return error(Kind::usage, fmt::format("{} does not go with a sweep that does '{}' (--do)",
                                            row->option.long_name(), name_of(done)));
  }
  return rows;
}

// What a sweep does with each variant.
static Result<Command> done_by_sweep(const Given& given) {
  const auto found = given.find("--do");
  if (found == given.end()) return Command::check;
  for (const Command command : swept)
    if (name_of(command) == found->second.back()) return command;
  return error(Kind::usage,
               fmt::format("--do: '{}' is not one of check, convert, mesh, info", found->second.back()));
}

// What is of tetrahedra alone.
static Status check_elements(const Options& options) {
  if (options.elements == Elements::tetrahedra) return {};
  const std::string_view word = options.elements == Elements::hexahedra ? "hex"
                                : options.elements == Elements::beams   ? "beam"
                                                                        : "truss";
  const auto refused = [&](std::string_view name) {
    return error(Kind::usage,
                 fmt::format("{} is of tetrahedra: leave it out with --elements {}", name, word));
  };
  if (options.order > 1) return refused("--order 2");
  if (options.min_dihedral > 0) return refused("--min-dihedral");
  return {};
}

Result<Options> understand(Command command, const Given& given) {
  Options options;
  options.command = command;
  std::vector<const Row*> rows = rows_of(command);
  if (command == Command::sweep) {
    const Result<Command> done = done_by_sweep(given);
    if (!done) return done.error();
    Result<std::vector<const Row*>> own = rows_of_sweep(*done, given);
    if (!own) return own.error();
    rows = std::move(*own);
    options.command = *done;
    options.sweep.wanted = true;
  }
  Line line;
  for (const Row* row : rows) {
    const Option& option = row->option;
    if (!option.preset.empty() && row->take)
      if (Status status = row->take(options, std::string(option.preset)); !status.ok()) return status.error();
    const auto found = given.find(option.name);
    if (found == given.end()) continue;
    line.emplace_back(row, found->second);
    if (Status status = take(*row, line.back().second, options); !status.ok()) return status.error();
  }
  if (Status status = check_company(rows, line); !status.ok()) return status.error();
  if (Status status = check_elements(options); !status.ok()) return status.error();
  if (options.pores) options.matrix = true;
  if (options.matrix) options.cut = true;
  if (command == Command::relax) options.relaxing.wanted = true;
  if (options.resume && (options.report.empty() || options.report == "-"))
    return error(Kind::usage, "--resume goes by the report of the run before: name it with --report FILE");
  return options;
}

}  // namespace selvage::pipeline
