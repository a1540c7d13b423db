#include <csignal>
#include <cstdio>

#include "cli/formats.h"
#include "cli/parse.h"
#include "core/standard_output.h"
#include "pipeline/batch.h"

namespace selvage::cli {

namespace {

// Prints what was asked for: the exit code, 1 (with a message) where standard output cannot be written.
int tell(std::string_view text) {
  const Status printed = write_to_standard_output(text);
  if (printed) return 0;
  std::fprintf(stderr, "%s\n", to_string(printed.error()).c_str());
  return 1;
}

int run(int count, char** words) {
  const Result<Parsed> parsed = parse(count, words);
  if (!parsed) return pipeline::refuse(parsed.error());
  if (!parsed->text.empty()) return tell(parsed->text);
  if (parsed->options.command == pipeline::Command::formats) return tell(table_of_formats());
  return pipeline::run(parsed->options);
}

}  // namespace

}  // namespace selvage::cli

int main(int count, char** words) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond the limit is then an error of writing, with its name
  if (const selvage::Status opened = selvage::open_standard_streams(); !opened)
    return selvage::pipeline::refuse(opened.error());
  return selvage::cli::run(count, words);
}
