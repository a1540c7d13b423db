#include "pipeline/sweep_table.h"

#include <algorithm>
#include <filesystem>

#include "core/csv.h"
#include "pipeline/report.h"

namespace selvage::pipeline {

namespace {

constexpr const char *result_column = "result", *message_column = "message";

// What lists of a report come to.
struct Summary {
  enum class How { count, sum, least, largest };
  const char *column, *list, *member;
  How how;
};
constexpr std::array summaries = {Summary{"length", "yarns", "length", Summary::How::sum},
                                  Summary{"volume", "yarns", "volume", Summary::How::sum},
                                  Summary{"min_bend_radius", "yarns", "min_bend_radius", Summary::How::least},
                                  Summary{"overlaps", "overlaps", nullptr, Summary::How::count},
                                  Summary{"depth", "overlaps", "depth", Summary::How::largest}};

// Null: the list is not there, or empty.
Json summary_of(const Json& report, const Summary& summary) {
  const auto list = report.find(summary.list);
  if (list == report.end() || !list->is_array()) return {};
  if (summary.how == Summary::How::count) return list->size();
  std::optional<double> value;
  for (const Json& item : *list) {
    const auto member = item.find(summary.member);
    if (member == item.end() || !member->is_number()) continue;
    const auto number = member->get<double>();
    if (!value)
      value = number;
    else if (summary.how == Summary::How::sum)
      *value += number;
    else
      value = summary.how == Summary::How::least ? std::min(*value, number) : std::max(*value, number);
  }
  return if_known(value);
}

std::string result_of(const Json& report) {
  if (!report.is_object()) return "not done";
  if (report.value("ok", false)) return "ok";
  return report.value("defect", false) ? "defect" : "failed";
}

std::string first_error(const Json& report) {
  const auto messages = report.find("messages");
  if (messages == report.end() || !messages->is_array()) return {};
  for (const Json& message : *messages)
    if (text_at(message, "severity") == "error") return text_at(message, "text");
  return {};
}

}  // namespace

void SweepTable::set(Row& row, std::vector<std::string>& columns, const std::string& column,
                     std::string value) {
  if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
  row.values[column] = std::move(value);
}

void SweepTable::add(const Input& input, std::string_view entry) {
  Row& row = rows_.emplace_back();
  row.values[subject_] = std::filesystem::path(input.stem).filename().string();
  for (const fabric::Setting& setting : input.settings) set(row, params_, setting.name, setting.value);
  const Json report = Json::parse(entry, nullptr, false);
  row.values[result_column] = result_of(report);
  if (!report.is_object()) return;
  row.values[message_column] = first_error(report);
  for (const Summary& summary : summaries)
    if (const Json value = summary_of(report, summary); !value.is_null())
      set(row, results_, summary.column, text_of(value));
  // Numbers, and those of objects within, by their paths.
  const auto visit = [&](const auto& self, const Json& object, const std::string& path) -> void {
    for (const auto& [key, value] : object.items()) {
      if (value.is_number()) set(row, results_, path + key, text_of(value));
      if (value.is_object()) self(self, value, path + key + ".");
    }
  };
  visit(visit, report, "");
}

std::string SweepTable::text() const {
  std::vector<std::string> columns = {subject_};
  columns.insert(columns.end(), params_.begin(), params_.end());
  columns.emplace_back(result_column);
  columns.insert(columns.end(), results_.begin(), results_.end());
  columns.emplace_back(message_column);
  std::string text;
  const auto add_row = [&](const auto& value_of) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) text += ',';
      text += csv_value(value_of(columns[i]));
    }
    text += '\n';
  };
  add_row([](const std::string& column) { return column; });
  for (const Row& row : rows_)
    add_row([&](const std::string& column) {
      const auto found = row.values.find(column);
      return found == row.values.end() ? std::string() : found->second;
    });
  return text;
}

}  // namespace selvage::pipeline
