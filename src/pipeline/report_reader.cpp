#include "pipeline/report_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/readable.h"
#include "pipeline/report_types.h"

namespace selvage::pipeline {

namespace {

constexpr std::string_view no_report =
    "this is not a report of selvage as --report FILE.json of other commands writes it";

// Members and elements from the outermost one to that which is meant.
class Place {
 public:
  void enter(std::string_view member) { steps_.push_back({member, 0}); }
  void enter(std::size_t index) { steps_.push_back({{}, index}); }
  void leave() { steps_.pop_back(); }
  // "inputs[2].messages[0].text"
  [[nodiscard]] std::string text() const {
    std::string text;
    for (const Step& step : steps_) {
      if (step.member.empty())
        text += fmt::format("[{}]", step.index);
      else
        text += fmt::format("{}{}", text.empty() ? "" : ".", shortened(step.member));
    }
    return text.empty() ? "it" : text;
  }

 private:
  struct Step {
    std::string_view member;  // empty: an element
    std::size_t index = 0;
  };
  std::vector<Step> steps_;
};

Message malformed(std::string_view what) {
  return error(Kind::malformed, fmt::format("{}: {}", no_report, what));
}

// Builds what the parser finds, as far as it is allowed to go. The parser does not recurse.
class Builder {
 public:
  explicit Builder(std::string_view bytes) : bytes_(bytes) {}
  Result<Json> take() {
    if (failure_) return std::move(*failure_);
    return std::move(whole_);
  }

  // What the parser calls; false ends it. Names and signatures are those of nlohmann::json_sax.
  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(Json::number_integer_t value) { return add(value); }
  bool number_unsigned(Json::number_unsigned_t value) { return add(value); }
  bool number_float(Json::number_float_t value, const std::string& /*text*/) { return add(value); }
  bool string(std::string& value) { return add(std::move(value)); }
  bool binary(Json::binary_t& /*value*/) { return false; }  // JSON has none
  bool key(std::string& name) {
    name_ = std::move(name);
    return true;
  }
  bool start_object(std::size_t /*size*/) { return open(Json::object()); }
  bool start_array(std::size_t /*size*/) { return open(Json::array()); }
  bool end_array() {
    open_.pop_back();
    return true;
  }
  bool end_object() {
    std::vector<std::string_view> names;
    for (const auto& member : open_.back()->get_ref<const Json::object_t&>()) names.push_back(member.first);
    std::sort(names.begin(), names.end());
    const auto twice = std::adjacent_find(names.begin(), names.end());
    if (twice != names.end())
      return fail(malformed(fmt::format("an object has two members '{}'", shortened(*twice))));
    open_.pop_back();
    return true;
  }
  bool parse_error(std::size_t position, const std::string& /*token*/, const Json::exception& why) {
    constexpr int out_of_range = 406;
    const std::string_view before = bytes_.substr(0, position == 0 ? 0 : position - 1);
    const std::size_t newline = before.rfind('\n'), line_begin = newline == before.npos ? 0 : newline + 1;
    return fail(malformed(fmt::format(
        "{} at line {}, column {}", why.id == out_of_range ? "a number is too large" : "it is no JSON",
        std::count(before.begin(), before.end(), '\n') + 1, before.size() - line_begin + 1)));
  }

 private:
  bool fail(Message message) {
    failure_ = std::move(message);
    return false;
  }

  // Where the value came to be.
  Json* put(Json value) {
    if (open_.empty()) return &(whole_ = std::move(value));
    if (open_.back()->is_array())
      return &open_.back()->get_ref<Json::array_t&>().emplace_back(std::move(value));
    // Not by its name: the search for that takes time in proportion to the members that are there.
    return &open_.back()->get_ref<Json::object_t&>().emplace_back(std::move(name_), std::move(value)).second;
  }
  bool add(Json value) {
    put(std::move(value));
    return true;
  }
  bool open(Json value) {
    if (open_.size() == deepest_report)
      return fail(error(Kind::limit, fmt::format("{}: lists and objects are nested more than {} deep",
                                                 no_report, deepest_report)));
    open_.push_back(put(std::move(value)));
    return true;
  }

  std::string_view bytes_;
  Json whole_;
  std::vector<Json*> open_;  // lists and objects that are not at their end
  std::string name_;         // of the member whose value comes next
  std::optional<Message> failure_;
};

std::string_view type_in_words(std::string_view type) {
  if (type == "number") return "a number";
  if (type == "duration") return "a number from 0 to 1e15";
  if (type == "count") return "a whole number from 0 to 1e15";
  if (type == "boolean") return "true or false";
  return type == "path" ? "a path" : "a text";
}

std::string_view in_words(const Json& value) {
  if (value.is_null()) return "null";
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  if (value.is_number()) return "a number";
  if (value.is_string()) return "a text";
  return value.is_array() ? "a list" : "an object";
}

bool is_of_type(const Json& value, std::string_view type) {
  constexpr double largest_sum = 1e15;  // of what reports are joined by: sums are exact, and finite
  if (type == "number") return value.is_number();
  if (type == "count") return value.is_number_unsigned() && value.get<double>() <= largest_sum;
  if (type == "duration")
    return value.is_number() && value.get<double>() >= 0 && value.get<double>() <= largest_sum;
  if (type == "boolean") return value.is_boolean();
  // What ends in a zero byte to some, and goes on for others, names no file.
  return value.is_string() &&
         (type != "path" || value.get_ref<const std::string&>().find('\0') == std::string::npos);
}

// `types` has the form of report_types.
Status check_types(const Json& value, const Json& types, Place& place) {
  const auto refuse = [&](std::string_view wanted) {
    return malformed(fmt::format("{} is {}, where {} is needed", place.text(), in_words(value), wanted));
  };
  if (types.is_string()) {
    const std::string& type = types.get_ref<const std::string&>();
    return is_of_type(value, type) ? Status() : refuse(type_in_words(type));
  }
  if (types.is_array()) {
    if (!value.is_array()) return refuse("a list");
    for (std::size_t i = 0; i < value.size(); ++i) {
      place.enter(i);
      if (Status well = check_types(value[i], types.front(), place); !well) return well;
      place.leave();
    }
    return {};
  }
  if (!value.is_object()) return refuse("an object");
  for (const auto& [name, member] : value.items()) {
    auto type = types.find(name);
    if (type == types.end()) type = types.find("*");
    if (type == types.end()) continue;
    place.enter(name);
    if (Status well = check_types(member, *type, place); !well) return well;
    place.leave();
  }
  return {};
}

const Json& types_of_report() {
  static const Json types = Json::parse(report_types);
  return types;
}
const Json& types_of_entry() {
  return types_of_report().at("inputs").front();
}

Result<Json> parse(std::string_view bytes) {
  if (bytes.size() > largest_report)
    return error(Kind::limit, fmt::format("a report of more than {} bytes is not read", largest_report));
  Builder builder(bytes);
  (void)Json::sax_parse(bytes, &builder);  // what failed is in the builder
  return builder.take();
}

Status check_named(const Json& entry, std::size_t number) {
  const auto path = entry.find("path");  // of what is no object: its end
  if (path != entry.end() && *path != "") return {};
  return malformed(fmt::format("its input {} has no path", number));
}

Status check_report(const Json& report) {
  const auto inputs = report.find("inputs");
  if (inputs != report.end() && inputs->is_array())
    for (std::size_t i = 0; i < inputs->size(); ++i)
      if (Status named = check_named((*inputs)[i], i + 1); !named) return named;
  Place place;
  if (Status well = check_types(report, types_of_report(), place); !well) return well;
  return inputs == report.end() ? malformed("it has no inputs") : Status();
}

Status check_entry(const Json& entry) {
  Place place;
  if (Status named = check_named(entry, 1); !named) return named;
  return check_types(entry, types_of_entry(), place);
}

}  // namespace

Result<Json> parse_report(std::string_view bytes, std::string_view name) {
  Result<Json> report = parse(bytes);
  if (report)
    if (Status well = check_report(*report); !well) report = well.error();
  if (!report) report.error().file = name;
  return report;
}

Result<Json> parse_entry(std::string_view bytes) {
  Result<Json> entry = parse(bytes);
  if (!entry) return entry;
  if (Status well = check_entry(*entry); !well) return well.error();
  return entry;
}

}  // namespace selvage::pipeline
