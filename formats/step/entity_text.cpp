#include "formats/step/entity_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "core/pointed_number.h"
#include "formats/step/character.h"

namespace selvage::formats::step {

namespace {

char* write_id(char* out, Id id) {
  *out++ = '#';
  return write_number(out, static_cast<long long>(id.number));
}

std::string_view between(const char* first, const char* last) {
  return {first, static_cast<std::size_t>(last - first)};
}

// The same text as put() makes of it, which mostly is one line.
void append_point(std::string& out, const EntityText::Point& point) {
  static constexpr std::string_view name = " = CARTESIAN_POINT('',(";
  char text[name.size() + 4 * (max_number_length + 1)];
  std::array<char*, 4> at{write_id(text, point.id)};  // where its numbers begin, and one beyond the last
  at[0] += name.copy(at[0], name.size());
  for (std::size_t k = 0; k < 3; ++k) {
    char* end = write_pointed(at[k], point.at[static_cast<Eigen::Index>(k)]);
    *end = ',';
    at[k + 1] = end + 1;
  }
  const std::string_view line = between(text, at[3] - 1);
  if (line.size() <= Filling::filled_to) {
    out.append(line);
  } else {
    Filling filling;
    filling.token(out, between(text, at[0]));
    for (std::size_t k = 0; k < 3; ++k) {
      if (k > 0) filling.token(out, ",");
      filling.token(out, between(at[k], at[k + 1] - 1));
    }
  }
  out.append("));\n");
}

// "(#1,#2,...)", from the beginning of a line.
void append_row(std::string& out, std::span<const Id> ids) {
  char word[max_number_length + 2] = "(";
  std::size_t column = 0;
  for (const Id id : ids) {
    const std::string_view text = between(word, write_id(word + 1, id));
    if (column + text.size() > Filling::filled_to) {  // after its comma
      out.append(text.substr(0, 1)).append("\n").append(text.substr(1));
      column = text.size() - 1;
    } else {
      out.append(text);
      column += text.size();
    }
    word[0] = ',';
  }
  out.append(")");
}

}  // namespace

std::string encoded(std::string_view text) {
  std::string quoted = "'";
  while (!text.empty()) {
    const char32_t code = take_code(text);
    if (code == U'\'')
      quoted += "''";
    else if (code >= 0x20 && code < 0x7F && code != U'\\')
      quoted += static_cast<char>(code);
    else
      quoted += code < 0x10000 ? fmt::format("\\X2\\{:04X}\\X0\\", static_cast<unsigned>(code))
                               : fmt::format("\\X4\\{:08X}\\X0\\", static_cast<unsigned>(code));
  }
  return quoted + '\'';
}

void EntityText::begin(Id id) {
  value(id);
  token(" = ");
}

void EntityText::end() {
  constexpr std::size_t block = std::size_t{1} << 20U;
  text_ += ";\n";
  filling_ = {};
  if (text_.size() >= block) hand_over();
}

void EntityText::hand_over() {
  queue_.add(std::exchange(text_, {}));
}

Status EntityText::finish() {
  hand_over();
  return queue_.finish();
}

void EntityText::put_points(std::vector<Point> points) {
  static constexpr std::size_t chunk = 2048, many = 8192;
  if (points.size() < many) {
    for (const Point& point : points) append_point(text_, point);
    return;
  }
  hand_over();
  const auto all = std::make_shared<const std::vector<Point>>(std::move(points));
  for (std::size_t first = 0; first < all->size(); first += chunk)
    queue_.add([all, first](std::string& text) {
      for (const Point& point : std::span(*all).subspan(first).first(std::min(chunk, all->size() - first)))
        append_point(text, point);
    });
}

void EntityText::value(const Net& net) {
  constexpr std::size_t many = 20'000;
  const std::size_t length = net.ids.size() / net.rows;
  const bool are_many = net.ids.size() >= many;
  token("(\n");
  if (are_many) hand_over();
  const auto all = std::make_shared<const std::vector<Id>>(net.ids);
  for (std::size_t i = 0; i < net.rows; ++i) {
    const auto row = [all, i, length, is_last = i + 1 == net.rows](std::string& text) {
      append_row(text, std::span(*all).subspan(i * length, length));
      text += is_last ? "\n" : ",\n";
    };
    if (are_many)
      queue_.add(row);
    else
      row(text_);
  }
  token(")");
}

void EntityText::value(Id id) {
  char word[max_number_length + 1];
  token(between(word, write_id(word, id)));
}

void EntityText::value(int number) {
  char word[max_number_length];
  token(between(word, write_number(word, static_cast<long long>(number))));
}

void EntityText::value(double number) {
  char word[max_number_length];
  token(between(word, write_pointed(word, number)));
}

}  // namespace selvage::formats::step
