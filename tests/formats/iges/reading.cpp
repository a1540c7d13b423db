#include "formats/iges/reading.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::test {

IgesReading read_iges(std::string bytes, const std::string& name) {
  IgesReading reading;
  const Source source = Source::from_memory(std::move(bytes), name);
  reading.model = formats::iges::read_model(source, reading.diagnostics);
  return reading;
}

std::string IgesReading::text() const {
  std::string all;
  for (const Message& message : diagnostics.messages()) all += to_string(message) + "\n";
  return all;
}

bool IgesReading::says(Severity severity, std::string_view words) const {
  const auto& all = diagnostics.messages();
  return std::any_of(all.begin(), all.end(), [&](const Message& message) {
    return message.severity == severity && message.place.line > 0 &&
           message.text.find(words) != std::string::npos;
  });
}

namespace {

class Section {
 public:
  Section(char letter, std::string_view line_end) : letter_(letter), line_end_(line_end) {}

  void add(std::string_view data, std::string_view tail = {}) {
    const std::size_t width = 72 - tail.size();
    text_ += fmt::format("{:<{}}{}{}{:>7}{}", data, width, tail, letter_, ++count_, line_end_);
  }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  char letter_;
  std::string_view line_end_;
  int count_ = 0;
  std::string text_;
};

// Breaks behind delimiters, but not within strings; a value that is longer than a line runs over.
std::vector<std::string> broken(const std::string& text, std::size_t width, char delimiter) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at, digits = at;
    while (digits < text.size() && text[digits] >= '0' && text[digits] <= '9') ++digits;
    if (digits > at && digits < text.size() && text[digits] == 'H')
      end = digits + 1 + std::stoul(text.substr(at, digits - at));
    end = std::min(text.find(delimiter, end), text.size() - 1) + 1;
    std::string token = text.substr(at, end - at);
    at = end;
    if (lines.back().size() + token.size() > width) lines.emplace_back();
    for (; token.size() > width; token.erase(0, width)) {
      lines.back() = token.substr(0, width);
      lines.emplace_back();
    }
    lines.back() += token;
  }
  return lines;
}

}  // namespace

std::string IgesText::bytes() const {
  Section start('S', line_end), globals('G', line_end), directory('D', line_end), parameters('P', line_end),
      terminate('T', line_end);
  start.add("Made by a test");
  for (const std::string& line : broken(global, 72, parameter_delimiter)) globals.add(line);
  for (const IgesEntity& entity : entities) {
    const int pointer = directory.count() + 1, first = parameters.count() + 1;
    const std::string values = fmt::format(
        "{}{}{}{}", entity.type, entity.parameters.empty() ? "" : std::string(1, parameter_delimiter),
        entity.parameters, record_delimiter);
    for (const std::string& line : broken(values, 64, parameter_delimiter))
      parameters.add(line, fmt::format("{:>8}", pointer));
    directory.add(fmt::format("{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}", entity.type, first, 0, 0,
                              entity.level, 0, entity.transformation, 0, entity.status));
    directory.add(fmt::format("{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}", entity.type, 0, entity.color,
                              parameters.count() - first + 1, entity.form, "", "", entity.label, 0));
  }
  terminate.add(fmt::format("S{:>7}G{:>7}D{:>7}P{:>7}", start.count(), globals.count(), directory.count(),
                            parameters.count()));
  return start.text() + globals.text() + directory.text() + parameters.text() + terminate.text();
}

std::string bilinear(double x, double y, double z) {
  std::string text = "1,1,1,1,0,0,1,0,0,0.,0.,1.,1.,0.,0.,1.,1.,1.,1.,1.,1.";
  for (const double dy : {0.0, 1.0})
    for (const double dx : {0.0, 1.0}) text += fmt::format(",{},{},{}", x + dx, y + dy, z);
  return text + ",0.,1.,0.,1.";
}

}  // namespace selvage::test
