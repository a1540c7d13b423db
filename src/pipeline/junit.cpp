#include "pipeline/junit.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace selvage::pipeline {

namespace {

using Json = nlohmann::ordered_json;

// The length of the UTF-8 character at the beginning of `text`, if XML 1.0 allows it; else 0.
std::size_t character(std::string_view text) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return first >= 0x20 || first == '\t' || first == '\n' || first == '\r' ? 1 : 0;
  const std::size_t length = first >= 0xF0 && first < 0xF5 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
  if (length == 0 || first >= 0xF5 || text.size() < length) return 0;
  unsigned code = first & (0xFFU >> (length + 1));
  for (std::size_t k = 1; k < length; ++k) {
    if ((byte(k) & 0xC0U) != 0x80U) return 0;
    code = (code << 6U) | (byte(k) & 0x3FU);
  }
  const unsigned least = length == 2 ? 0x80U : length == 3 ? 0x800U : 0x10000U;
  if (code < least || code > 0x10FFFFU) return 0;
  return (code >= 0xD800U && code < 0xE000U) || code == 0xFFFEU || code == 0xFFFFU ? 0 : length;
}

struct Case {
  std::string class_name, name, body;
  double seconds = 0;
};

struct Suite {
  std::vector<Case> cases;
  std::size_t failures = 0, errors = 0, skipped = 0;
};

std::string text_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::string lines_of(const Json& object, const char* key) {
  std::string text;
  if (const auto found = object.find(key); found != object.end() && found->is_array())
    for (const Json& line : *found)
      if (line.is_string()) text += line.get<std::string>() + "\n";
  return text;
}

std::string errors_of(const Json& entry) {
  std::string text;
  if (const auto messages = entry.find("messages"); messages != entry.end())
    for (const Json& message : *messages) {
      if (text_at(message, "severity") != "error") continue;
      text += fmt::format("{}: {}\n", text_at(message, "where"), text_at(message, "text"));
    }
  return text.empty() ? "it failed\n" : text;
}

std::string outcome(std::string_view element, const std::string& text) {
  return fmt::format("<{} message=\"{}\">{}</{}>", element, xml_text(text.substr(0, text.find('\n'))),
                     xml_text(text), element);
}

void add_cases(const JunitInput& input, Suite& suite) {
  const Json entry = Json::parse(input.entry, nullptr, false);
  if (!entry.is_object()) {
    ++suite.skipped;
    suite.cases.push_back({input.path, "roundtrip", "<skipped/>", 0});
    return;
  }
  const auto trips = entry.find("roundtrips");
  if (trips == entry.end() || !trips->is_array() || trips->empty()) {
    ++suite.errors;
    suite.cases.push_back(
        {input.path, "roundtrip", outcome("error", errors_of(entry)), entry.value("seconds", 0.0)});
    return;
  }
  for (const Json& trip : *trips) {
    Case& one = suite.cases.emplace_back();
    one.class_name = input.path;
    one.name = text_at(trip, "format");
    one.seconds = trip.value("seconds", 0.0);
    if (const std::string failed = text_at(trip, "error"); !failed.empty()) {
      ++suite.errors;
      one.body = outcome("error", failed);
    } else if (!trip.value("equal", false)) {
      ++suite.failures;
      one.body = outcome("failure", lines_of(trip, "differences"));
    }
  }
}

}  // namespace

std::string xml_text(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = character(text);
    const std::string_view one = text.substr(0, std::max<std::size_t>(length, 1));
    if (length == 0)
      out += '?';
    else if (one == "&")
      out += "&amp;";
    else if (one == "<")
      out += "&lt;";
    else if (one == ">")
      out += "&gt;";
    else if (one == "\"")
      out += "&quot;";
    else if (one == "\r")
      out += "&#13;";
    else
      out += one;
    text.remove_prefix(one.size());
  }
  return out;
}

std::string junit_text(const std::vector<JunitInput>& inputs, const std::string& started, double seconds) {
  Suite suite;
  for (const JunitInput& input : inputs) add_cases(input, suite);
  const std::string counts =
      fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{:.3f}\"",
                  suite.cases.size(), suite.failures, suite.errors, suite.skipped, seconds);
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {}>\n"
      "<testsuite name=\"selvage roundtrip\" timestamp=\"{}\" {}>\n",
      counts, xml_text(started), counts);
  for (const Case& one : suite.cases)
    text += fmt::format("<testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\">{}</testcase>\n",
                        xml_text(one.class_name), xml_text(one.name), one.seconds, one.body);
  return text + "</testsuite>\n</testsuites>\n";
}

}  // namespace selvage::pipeline
