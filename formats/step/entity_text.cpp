#include "formats/step/entity_text.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/parallel.h"
#include "core/pointed_number.h"
#include "formats/step/character.h"

namespace selvage::formats::step {

namespace {

// The word of a number, in the room for one.
class Word {
 public:
  explicit Word(Id id) : Word("#", static_cast<long long>(id.number)) {}
  explicit Word(int number) : Word("", static_cast<long long>(number)) {}
  explicit Word(double number) : end_(write_pointed(text_, number)) {}
  operator std::string_view() const { return {text_, static_cast<std::size_t>(end_ - text_)}; }

 private:
  Word(std::string_view before, long long number)
      : end_(write_number(text_ + before.copy(text_, before.size()), number)) {}

  char text_[max_number_length + 1];
  char* end_;
};

// The same tokens as put() makes of it.
void append_point(std::string& out, const EntityText::Point& point) {
  Filling filling;
  filling.token(out, Word(point.id));
  for (const std::string_view token : {" = ", "CARTESIAN_POINT", "(", "''", ",", "("})
    filling.token(out, token);
  filling.token(out, Word(point.at.x()));
  filling.token(out, ",");
  filling.token(out, Word(point.at.y()));
  filling.token(out, ",");
  filling.token(out, Word(point.at.z()));
  for (const std::string_view token : {")", ")"}) filling.token(out, token);
  out += ";\n";
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
  text_ << ";\n";
  filling_ = {};
}

void EntityText::put_points(std::span<const Point> points) {
  constexpr std::size_t chunk = 1024, many = 4096;
  const int threads = points.size() < many ? 1 : threads_;
  chunks_.resize(4 * static_cast<std::size_t>(threads));
  for_each_in_order(
      (points.size() + chunk - 1) / chunk, chunks_.size(), threads,
      [&](std::size_t i, std::size_t slot) {
        // A thread's own: strings side by side would share their processors' cache lines.
        std::string text = std::move(chunks_[slot]);
        text.clear();
        for (const Point& point : points.subspan(i * chunk, std::min(chunk, points.size() - i * chunk)))
          append_point(text, point);
        chunks_[slot] = std::move(text);
      },
      [&](std::size_t /*i*/, std::size_t slot) { text_ << chunks_[slot]; });
}

void EntityText::value(Id id) {
  token(Word(id));
}

void EntityText::value(int number) {
  token(Word(number));
}

void EntityText::value(double number) {
  token(Word(number));
}

}  // namespace selvage::formats::step
