#include <algorithm>
#include <csignal>

#include "cli/explain.h"
#include "cli/formats.h"
#include "cli/new_text.h"
#include "cli/parse.h"
#include "core/console.h"
#include "core/standard_output.h"
#include "pipeline/batch.h"
#include "pipeline/command_line.h"

namespace selvage::cli {

namespace {

// Prints what was asked for, or writes it to a file where one is named: the exit code, 2 (with a message)
// where there is none, or no such file; 1 where standard output cannot be written.
int tell(const Result<std::string>& text, const std::string& file = {}) {
  if (!text) return pipeline::refuse(text.error());
  if (!file.empty() && file != "-") {
    const Status written = write_new_file(file, *text);
    return written ? 0 : pipeline::refuse(written.error());
  }
  const Status printed = write_to_standard_output(*text);
  if (printed) return 0;
  write_messages(to_string(printed.error()) + "\n");
  return 1;
}

// Of the program, of a subcommand, or of a topic.
Result<std::string> help(const std::string& topic) {
  std::vector<std::string> words = {"selvage", "--help"};
  if (!topic.empty()) words.insert(words.begin() + 1, topic);
  const auto& commands = pipeline::all_commands();
  const auto is_it = [&](const pipeline::Subcommand& command) { return command.name == topic; };
  if (!topic.empty() && std::none_of(commands.begin(), commands.end(), is_it)) return help_of(topic);
  std::vector<char*> pointers;
  pointers.reserve(words.size());
  for (std::string& word : words) pointers.push_back(word.data());
  Result<Parsed> parsed = parse(static_cast<int>(pointers.size()), pointers.data());
  if (!parsed) return parsed.error();
  return parsed->text;
}

int run(int count, char** words) {
  const Result<Parsed> parsed = parse(count, words);
  if (!parsed) return pipeline::refuse(parsed.error());
  if (!parsed->text.empty()) return tell(parsed->text);
  const pipeline::Options& options = parsed->options;
  switch (options.command) {
    case pipeline::Command::formats:
      return tell(table_of_formats());
    case pipeline::Command::new_text:
      return tell(text_of_kind(options.subject), options.output);
    case pipeline::Command::explain:
      return tell(explain(options.subject));
    case pipeline::Command::help:
      return tell(help(options.subject));
    default:
      return pipeline::run(options);
  }
}

}  // namespace

}  // namespace selvage::cli

int main(int count, char** words) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit is then an error of writing, with its name
  if (const selvage::Status opened = selvage::open_standard_streams(); !opened)
    return selvage::pipeline::refuse(opened.error());
  return selvage::cli::run(count, words);
}
