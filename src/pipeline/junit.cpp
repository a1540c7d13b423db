#include "pipeline/junit.h"

#include <fmt/format.h>

#include "core/xml_text.h"
#include "pipeline/report.h"

namespace selvage::pipeline {

namespace {

struct Case {
  std::string class_name, name, body;
  double seconds = 0;
};

struct Suite {
  std::vector<Case> cases;
  std::size_t failures = 0, errors = 0, skipped = 0;
};

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

std::string escaped(std::string_view text) {
  return xml_text(text, "?");
}

std::string outcome(std::string_view element, const std::string& text) {
  return fmt::format("<{} message=\"{}\">{}</{}>", element, escaped(text.substr(0, text.find('\n'))),
                     escaped(text), element);
}

void add_check(const JunitInput& input, const Json& entry, Suite& suite) {
  Case& one = suite.cases.emplace_back();
  one.class_name = input.path;
  one.name = "check";
  one.seconds = entry.value("seconds", 0.0);
  if (entry.value("defect", false)) {
    ++suite.failures;
    one.body = outcome("failure", errors_of(entry));
  } else if (!entry.value("ok", false)) {
    ++suite.errors;
    one.body = outcome("error", errors_of(entry));
  }
}

void add_cases(std::string_view command, const JunitInput& input, Suite& suite) {
  const Json entry = Json::parse(input.entry, nullptr, false);
  if (!entry.is_object()) {
    ++suite.skipped;
    suite.cases.push_back({input.path, std::string(command), "<skipped/>", 0});
    return;
  }
  if (command == "check") return add_check(input, entry, suite);
  if (const auto things = entry.find("compared"); things != entry.end() && things->is_array()) {
    for (const Json& thing : *things) {
      Case& one = suite.cases.emplace_back();
      one.class_name = input.path;
      one.name = text_at(thing, "name");
      const std::string lines = lines_of(thing, "differences");
      if (lines.empty()) continue;
      ++suite.failures;
      one.body = outcome("failure", lines);
    }
    return;
  }
  const auto trips = entry.find("roundtrips");
  if (trips == entry.end() || !trips->is_array() || trips->empty()) {
    ++suite.errors;
    suite.cases.push_back(
        {input.path, std::string(command), outcome("error", errors_of(entry)), entry.value("seconds", 0.0)});
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

std::string junit_text(std::string_view command, const std::vector<JunitInput>& inputs,
                       const std::string& started, double seconds) {
  Suite suite;
  for (const JunitInput& input : inputs) add_cases(command, input, suite);
  const std::string counts =
      fmt::format("tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{:.3f}\"",
                  suite.cases.size(), suite.failures, suite.errors, suite.skipped, seconds);
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {}>\n"
      "<testsuite name=\"selvage {}\" timestamp=\"{}\" {}>\n",
      counts, escaped(command), escaped(started), counts);
  for (const Case& one : suite.cases)
    text += fmt::format("<testcase classname=\"{}\" name=\"{}\" time=\"{:.3f}\">{}</testcase>\n",
                        escaped(one.class_name), escaped(one.name), one.seconds, one.body);
  return text + "</testsuite>\n</testsuites>\n";
}

}  // namespace selvage::pipeline
