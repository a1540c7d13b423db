// The JSON report (src/cli/report.md): whoever finds something puts it there as it is to be read. Lengths in
// mm; what is unknown is left out.
#pragma once

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "core/units.h"
#include "core/vec.h"
#include "pipeline/inputs.h"

namespace selvage::pipeline {

using Json = nlohmann::ordered_json;

// Filled while an input is worked on, turned into text in its process, and put together with the others by
// the parent.
class InputReport {
 public:
  explicit InputReport(const Input& input);

  std::string settings;       // what the outputs depend on beside the input: `--resume` compares it
  std::optional<Unit> units;  // of the input, when it was read
  std::vector<Message> messages;

  // An entry, by its key; null: not known.
  Json& operator[](const char* key) { return entries_[key]; }
  // One JSON object. To be asked for when all is known.
  std::string text();

 private:
  Json entries_;
};

// A value, or null where it is not known: entries that are null are left out.
inline Json if_true(bool is_known, Json value) {
  return is_known ? std::move(value) : Json();
}
inline Json if_finite(double value) {
  return if_true(std::isfinite(value), value);
}
template <class T>
Json if_known(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}
template <class Point>
Json point_json(const Eigen::MatrixBase<Point>& point) {
  Json out = Json::array();
  for (Eigen::Index k = 0; k < point.size(); ++k) out.push_back(point[k]);
  return out;
}
// What `make` makes of each element.
template <class List, class Make>
Json list_json(const List& list, const Make& make) {
  Json out = Json::array();
  for (const auto& item : list) out.push_back(make(item));
  return out;
}

// Takes away the members that are null, numbers that are not finite, or lists with such.
void drop_unknown(Json& json);
// Names and messages may hold bytes that are not UTF-8: they are replaced, never a reason to fail. `indent`
// below 0: on one line.
std::string text_of(const Json& json, int indent = -1);
// The text under a key; empty where there is none.
std::string text_at(const Json& object, const char* key);
// The number; none where there is none.
std::optional<double> number_at(const Json& object, const char* key);
// Is it there, and true?
bool is_true(const Json& object, const char* key);

struct Counts {
  std::size_t inputs = 0, done = 0, failed = 0, skipped = 0;
};

// The whole report; `inputs` are texts of InputReport, empty ones (not done yet) are left out.
std::string whole_report(const std::string& started, double seconds, bool ok, const Counts& counts,
                         const std::vector<std::string>& inputs);

// A report of any run (pipeline/report_reader.h says what can be relied on). Errors: io, malformed, limit.
Result<Json> read_report(const std::string& path);

// An earlier report: the entry of each path as JSON text. Errors: as read_report().
Result<std::map<std::string, std::string>> read_entries(const std::string& report_path);

// True when `entry` (JSON text of an earlier run) says that this input, with these settings, gave whole
// outputs at `output_paths` that are still there, byte for byte; of a command without outputs: that it came
// to its end.
bool is_still_valid(const std::string& entry, const std::string& input_sha256, const std::string& settings,
                    const std::vector<std::string>& output_paths);

// Did it find a defect?
bool has_defect(const std::string& entry);

// The entry of an earlier run with `"skipped": true`.
std::string marked_skipped(const std::string& entry);

}  // namespace selvage::pipeline
