#include "fuzz/iges_mutation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <random>
#include <vector>

namespace selvage::fuzz {

namespace {

constexpr std::size_t columns = 80, letter_column = 72, parameter_columns = 64, field = 8;

struct Entity {
  std::string directory;   // 2 times 72 columns
  std::string parameters;  // as they follow each other, without line ends
};

struct File {
  std::string start, global;
  std::vector<Entity> entities;
};

int number_in(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  int value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::optional<File> taken_apart(std::string_view bytes) {
  std::array<std::vector<std::string_view>, 4> sections;
  while (!bytes.empty()) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    const std::string_view line = bytes.substr(0, end);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    if (line.size() < columns) continue;
    const std::size_t section = std::string_view("SGDP").find(line[letter_column]);
    if (section < sections.size()) sections[section].push_back(line.substr(0, letter_column));
  }
  const auto& [start, global, directory, parameters] = sections;
  if (directory.size() < 2 || parameters.empty()) return std::nullopt;
  File file;
  for (const std::string_view line : start) file.start += line;
  for (const std::string_view line : global) file.global += line;
  for (std::size_t i = 0; i + 1 < directory.size(); i += 2) {
    Entity& entity = file.entities.emplace_back();
    entity.directory = std::string(directory[i]) + std::string(directory[i + 1]);
    const int first = number_in(directory[i].substr(field, field)) - 1;
    const int count = number_in(directory[i + 1].substr(3 * field, field));
    for (int line = std::max(first, 0); line < first + count; ++line) {
      if (line >= static_cast<int>(parameters.size())) break;
      const std::string_view text = parameters[static_cast<std::size_t>(line)].substr(0, parameter_columns);
      entity.parameters += text.substr(0, text.find_last_not_of(' ') + 1);
    }
  }
  return file;
}

class Writer {
 public:
  std::string text(const File& file) {
    lines('S', file.start);
    lines('G', file.global);
    int first = 1;
    for (const Entity& entity : file.entities) {
      const int count = static_cast<int>(wrapped(entity.parameters).size());
      std::string directory = entity.directory;
      directory.resize(2 * letter_column, ' ');
      directory.replace(field, field, fmt::format("{:8}", first));
      directory.replace(letter_column + 3 * field, field, fmt::format("{:8}", count));
      line('D', directory.substr(0, letter_column));
      line('D', directory.substr(letter_column));
      first += count;
    }
    int pointer = 1;
    for (const Entity& entity : file.entities) {
      for (const std::string_view part : wrapped(entity.parameters))
        line('P',
             std::string(part).append(parameter_columns - part.size(), ' ') + fmt::format("{:8}", pointer));
      pointer += 2;
    }
    const std::array<int, 4> counts = counts_;
    line('T', fmt::format("S{:7}G{:7}D{:7}P{:7}", counts[0], counts[1], counts[2], counts[3]));
    return text_;
  }

 private:
  // Values stand whole in a line where they can.
  static std::vector<std::string_view> wrapped(std::string_view text) {
    std::vector<std::string_view> parts;
    while (text.size() > parameter_columns) {
      const std::size_t comma = text.substr(0, parameter_columns).rfind(',');
      const std::size_t length = comma == std::string_view::npos ? parameter_columns : comma + 1;
      parts.push_back(text.substr(0, length));
      text.remove_prefix(length);
    }
    parts.push_back(text);
    return parts;
  }
  void lines(char letter, std::string_view text) {
    for (std::size_t at = 0; at < text.size(); at += letter_column)
      line(letter, text.substr(at, letter_column));
  }
  void line(char letter, std::string_view text) {
    const std::size_t section = std::min<std::size_t>(std::string_view("SGDP").find(letter), 4);
    const int number = section < counts_.size() ? ++counts_[section] : 1;
    text_ += text;
    text_.append(letter_column - text.size(), ' ');
    fmt::format_to(std::back_inserter(text_), "{}{:7}\n", letter, number);
  }

  std::string text_;
  std::array<int, 4> counts_{};
};

class Change {
 public:
  Change(File& file, std::uint32_t seed, const Mutate& mutate)
      : file_(file), chance_(seed), mutate_(mutate) {}

  void make() {
    Entity& entity = file_.entities[below(file_.entities.size())];
    switch (below(10)) {
      case 0:
        mutate(file_.global);
        break;
      case 1:
        copy(entity);
        break;
      case 2:
        if (file_.entities.size() > 1) file_.entities.pop_back();
        break;
      case 3:
      case 4:
        change_directory(entity);
        break;
      case 5:
      case 6:
      case 7:
        change_value(entity);
        break;
      default:
        mutate(entity.parameters);
        break;
    }
  }

 private:
  std::size_t below(std::size_t count) { return chance_() % count; }

  void mutate(std::string& text) {
    mutate_(text, text.size() + 64);
    std::replace(text.begin(), text.end(), '\n', ' ');
  }
  void copy(Entity entity) {
    if (file_.entities.size() > 60) return;
    file_.entities.push_back(std::move(entity));
  }
  void change_directory(Entity& entity) {
    // Type, structure, level, matrix, status; type again, colour, form.
    constexpr std::array<std::size_t, 8> places = {0, 2, 4, 6, 8, 9, 11, 13};
    const std::size_t place = places[below(places.size())];
    entity.directory.resize(2 * letter_column, ' ');
    std::string value = fmt::format("{:8}", number());
    if (place == 8) value = fmt::format("{:02}{:02}{:02}{:02}", below(2), below(4), below(7), below(3));
    if (place == 0 || place == 9) {
      value = file_.entities[below(file_.entities.size())].directory.substr(0, field);
      entity.directory.replace(9 * field, field, value);
      entity.directory.replace(0, field, value);
      const std::size_t comma = entity.parameters.find_first_of(",;");
      if (comma != std::string::npos)
        entity.parameters.replace(0, comma, fmt::format("{}", number_in(value)));
      return;
    }
    entity.directory.replace(place * field, field, value);
  }
  int number() {
    switch (below(4)) {
      case 0:
        return static_cast<int>(below(20));
      case 1:
        return -static_cast<int>(below(2 * file_.entities.size()));
      default:
        return 2 * static_cast<int>(below(file_.entities.size())) + 1;
    }
  }
  // One value of the parameters becomes another one: special, a pointer, or a copy from elsewhere.
  void change_value(Entity& entity) {
    constexpr std::array<std::string_view, 16> special = {
        "",     "0",  "1.",    "-1.",   "0.5",   "1.D-9",  "1.E-300",    "1.E300",
        "1.E9", "-2", "1.E-6", "3H,;,", "99999", "1.E154", "2147483647", "1.0000001"};
    const std::string_view other = value_of(file_.entities[below(file_.entities.size())].parameters);
    const std::string value = below(3) == 0   ? std::string(special[below(special.size())])
                              : below(2) == 0 ? fmt::format("{}", number())
                                              : std::string(other);
    const std::string_view old = value_of(entity.parameters);
    if (old.data() == nullptr) return;
    entity.parameters.replace(static_cast<std::size_t>(old.data() - entity.parameters.data()), old.size(),
                              value);
  }
  std::string_view value_of(std::string_view text) {
    if (text.empty()) return {};
    std::size_t from = text.find_last_of(",;", below(text.size()));
    from = from == std::string_view::npos || from + 1 >= text.size() ? 0 : from + 1;
    return text.substr(from, std::min(text.find_first_of(",;", from), text.size()) - from);
  }

  File& file_;
  std::mt19937 chance_;
  const Mutate& mutate_;
};

}  // namespace

std::optional<std::string> mutated_iges(std::string_view bytes, std::uint32_t seed, const Mutate& mutate) {
  std::optional<File> file = taken_apart(bytes);
  if (!file) return std::nullopt;
  Change(*file, seed, mutate).make();
  return Writer().text(*file);
}

}  // namespace selvage::fuzz
