#include "pipeline/report_command.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>

#include "core/console.h"
#include "core/output.h"
#include "pipeline/report.h"
#include "pipeline/report_page.h"
#include "pipeline/thumbnails.h"

namespace selvage::pipeline {

namespace {

constexpr std::string_view page_extension = ".html";

// As one run would have written it, in the order in which they were named: what they say of the program from
// the first one, and when the first one began.
Json merged(const std::vector<Json>& reports) {
  Json all = reports.front();
  constexpr std::array tallied = {"inputs", "done", "failed", "skipped"};
  std::array<std::uint64_t, tallied.size()> counts{};
  for (const Json& report : reports)
    for (std::size_t k = 0; k < tallied.size(); ++k)
      counts[k] +=
          static_cast<std::uint64_t>(number_at(report.value("counts", Json()), tallied[k]).value_or(0));
  all["counts"] = Json::object();
  for (std::size_t k = 0; k < tallied.size(); ++k) all["counts"][tallied[k]] = counts[k];
  Json& inputs = all["inputs"];
  for (std::size_t k = 1; k < reports.size(); ++k) {
    const Json& other = reports[k];
    const std::string started = text_at(other, "started");
    if (!started.empty() && started < text_at(all, "started")) all["started"] = started;
    all["seconds"] = number_at(all, "seconds").value_or(0) + number_at(other, "seconds").value_or(0);
    all["ok"] = is_true(all, "ok") && is_true(other, "ok");
    for (const Json& entry : other.at("inputs")) inputs.push_back(entry);
  }
  return all;
}

Result<Json> read_all(const std::vector<std::string>& paths) {
  std::vector<Json> reports;
  for (const std::string& path : paths) {
    Result<Json> report = read_report(path);
    if (!report) return report.error();
    reports.push_back(std::move(*report));
  }
  return merged(reports);
}

Status write_page(const Options& options, const Json& report, OutputFile& file) {
  const std::vector<const Json*> entries = entries_in_order(report);
  std::vector<Thumbnail> pictures;
  if (!options.no_pictures) {
    Result<std::vector<Thumbnail>> made = thumbnails_of(options, entries);
    if (!made) return made.error();
    pictures = std::move(*made);
  }
  return write_report_page(report, entries, pictures, file);
}

Status write(const Options& options) {
  const Result<Json> report = read_all(options.inputs);
  if (!report) return report.error();
  Result<OutputFile> file =
      options.output == "-" ? OutputFile::standard_output() : OutputFile::create(options.output);
  if (!file) return file.error();
  const Status written = options.subject == "html" ? write_page(options, *report, *file)
                                                   : file->write(text_of(*report, 2) + "\n");
  return written ? file->commit() : written;
}

}  // namespace

int run_report(const Options& options) {
  const bool is_page = options.output.ends_with(page_extension);
  if (options.output != "-" && is_page != (options.subject == "html")) {
    write_messages(fmt::format(
        "selvage: error: -o: '{}' is no name for {}\n", options.output,
        is_page ? "a report, it is that of a page (selvage report html)" : "a page: it ends with .html"));
    return 2;
  }
  const Status done = write(options);
  if (done) return 0;
  write_messages(to_string(done.error()) + "\n");
  return done.error().kind == Kind::interrupted ? 130 : 1;
}

}  // namespace selvage::pipeline
