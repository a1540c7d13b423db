#include "pipeline/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/sha256.h"
#include "core/source.h"
#include "pipeline/parts.h"
#include "pipeline/report_reader.h"
#include "pipeline/versions.h"

namespace selvage::pipeline {

namespace {

Json message_json(const Message& message, double to_mm) {
  std::string where = message.file;
  if (message.place.line > 0) where += fmt::format(":{}", message.place.line);
  if (message.place.line > 0 && message.place.column > 0) where += fmt::format(":{}", message.place.column);
  return {{"severity", name_of(message.severity)},
          {"where", if_true(!where.empty(), where)},
          {"text", message.text},
          {"yarn", if_true(!message.yarn.empty(), message.yarn)},
          {"at", message.at ? point_json(*message.at * to_mm) : Json()}};
}

}  // namespace

namespace {

bool is_unknown(const Json& json) {
  if (json.is_array()) return std::any_of(json.begin(), json.end(), is_unknown);
  return json.is_null() || (json.is_number_float() && !std::isfinite(json.get<double>()));
}

}  // namespace

void drop_unknown(Json& json) {
  if (!json.is_structured()) return;
  for (Json& entry : json) drop_unknown(entry);
  if (!json.is_object()) return;
  for (auto entry = json.begin(); entry != json.end();)
    entry = is_unknown(*entry) ? json.erase(entry) : std::next(entry);
}

std::string text_of(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string text_at(const Json& object, const char* key) {
  if (!object.is_object()) return {};
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::optional<double> number_at(const Json& object, const char* key) {
  if (!object.is_object()) return std::nullopt;
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? std::optional(found->get<double>()) : std::nullopt;
}

bool is_true(const Json& object, const char* key) {
  if (!object.is_object()) return false;
  const auto found = object.find(key);
  return found != object.end() && found->is_boolean() && found->get<bool>();
}

InputReport::InputReport(const Input& input)
    : entries_(Json::object({{"path", input.name()}, {"ok", false}, {"seconds", 0.0}})) {
  // In the order in which they are written.
  for (const char* key : {"sha256", "settings", "units", "yarn_count", "yarns", "pieces", "overlaps",
                          "contacts", "entities", "not_understood", "min_gap", "creo_absolute_accuracy",
                          "outputs", "instances", "relax", "mesh", "roundtrips", "defect"})
    entries_[key] = nullptr;
}

std::string InputReport::text() {
  if (!settings.empty()) entries_["settings"] = settings;
  if (units) entries_["units"] = name_of(*units);
  const double to_mm = millimetres_per(units.value_or(Unit::mm));
  entries_["messages"] = list_json(messages, [&](const Message& m) { return message_json(m, to_mm); });
  drop_unknown(entries_);
  return text_of(entries_);
}

std::string whole_report(const std::string& started, double seconds, bool ok, const Counts& counts,
                         const std::vector<std::string>& inputs) {
  Json libraries = Json::object();
  for (const Library& library : library_versions()) libraries[std::string(library.name)] = library.version;
  Json list = Json::array();
  for (const std::string& text : inputs)
    if (!text.empty()) list.push_back(Json::parse(text, nullptr, false));
  const Json out = {{"selvage", version()},
                    {"libraries", libraries},
                    {"started", started},
                    {"seconds", seconds},
                    {"ok", ok},
                    {"counts",
                     {{"inputs", counts.inputs},
                      {"done", counts.done},
                      {"failed", counts.failed},
                      {"skipped", counts.skipped}}},
                    {"inputs", list}};
  return text_of(out, 2) + "\n";
}

Result<Json> read_report(const std::string& path) {
  const Result<Source> source = Source::open(path, largest_report);
  if (!source) return source.error();
  return parse_report(source->bytes(), path);
}

Result<std::map<std::string, std::string>> read_entries(const std::string& report_path) {
  const Result<Json> report = read_report(report_path);
  if (!report) return report.error();
  std::map<std::string, std::string> entries;
  for (const Json& entry : report->at("inputs")) entries[text_at(entry, "path")] = text_of(entry);
  return entries;
}

bool is_still_valid(const std::string& entry, const std::string& input_sha256, const std::string& settings,
                    const std::vector<std::string>& output_paths) {
  const Json earlier = Json::parse(entry, nullptr, false);
  if (!earlier.is_object()) return false;
  const bool has_ended =
      earlier.value("ok", false) || (output_paths.empty() && earlier.value("defect", false));
  if (!has_ended) return false;
  if (text_at(earlier, "sha256") != input_sha256 || text_at(earlier, "settings") != settings) return false;
  const auto outputs = earlier.find("outputs");
  if (outputs == earlier.end() || !outputs->is_array()) return output_paths.empty();
  std::size_t matched = 0;
  const auto is_whole = [&](const std::string& path) {
    const auto found = std::find_if(outputs->begin(), outputs->end(),
                                    [&](const Json& output) { return text_at(output, "path") == path; });
    if (found == outputs->end()) return false;
    const Result<std::string> now = sha256_of_file(path);
    if (!now.ok() || *now != text_at(*found, "sha256")) return false;
    ++matched;
    return true;
  };
  for (const std::string& path : output_paths) {
    if (is_whole(path)) continue;
    // It may have taken several files.
    int number = 1;
    while (is_whole(part_path(path, number).string())) ++number;
    if (number == 1) return false;
  }
  return matched == outputs->size();
}

bool has_defect(const std::string& entry) {
  const Json earlier = Json::parse(entry, nullptr, false);
  return earlier.is_object() && earlier.value("defect", false);
}

std::string marked_skipped(const std::string& entry) {
  Json out = Json::parse(entry, nullptr, false);
  if (out.is_object()) out["skipped"] = true;
  return text_of(out);
}

}  // namespace selvage::pipeline
