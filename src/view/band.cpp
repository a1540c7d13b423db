#include "view/band.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace selvage::view {

namespace {

constexpr double stroke_share = 0.13;  // of the height of capitals
constexpr int smallest_letters = 9;    // pixels
constexpr double letters_a_side = 45;

// A letter as strokes: points "xy", on a grid in which letters stand on the line y = 2 and capitals reach 8;
// strokes are parted by '|'. One point is a dot.
struct Letter {
  char sign;  // mu: µ
  int width;
  std::string_view strokes;
};
constexpr char mu = '\x01';
constexpr double units_a_capital = 6, foot = 2, gap = 1.7, blank = 3.4;
constexpr std::array letters = {
    Letter{'0', 4, "12 32 43 47 38 18 07 03 12"},
    Letter{'1', 2, "06 28 22"},
    Letter{'2', 4, "07 18 38 47 46 02 42"},
    Letter{'3', 4, "07 18 38 47 46 35 44 43 32 12 03|15 35"},
    Letter{'4', 4, "32 38 04 44"},
    Letter{'5', 4, "48 08 05 35 44 43 32 12 03"},
    Letter{'6', 4, "47 38 18 07 03 12 32 43 44 35 05"},
    Letter{'7', 4, "08 48 12"},
    Letter{'8', 4, "15 06 07 18 38 47 46 35 15 04 03 12 32 43 44 35"},
    Letter{'9', 4, "03 12 32 43 47 38 18 07 06 15 45"},
    Letter{'-', 3, "05 35"},
    Letter{'+', 4, "05 45|23 27"},
    Letter{'.', 0, "02"},
    Letter{',', 1, "12 01"},
    Letter{':', 0, "02|05"},
    Letter{';', 1, "12 01|15"},
    Letter{'/', 3, "01 38"},
    Letter{'(', 1, "19 07 03 11"},
    Letter{')', 1, "09 17 13 01"},
    Letter{'[', 1, "19 09 01 11"},
    Letter{']', 1, "09 19 11 01"},
    Letter{'%', 5, "12 48|07 18 27 16 07|33 44 53 42 33"},
    Letter{'_', 4, "01 41"},
    Letter{'=', 3, "04 34|06 36"},
    Letter{'*', 4, "05 45|17 33|37 13"},
    Letter{'<', 3, "37 05 33"},
    Letter{'>', 3, "07 35 03"},
    Letter{'\'', 0, "08 06"},
    Letter{'!', 0, "08 04|02"},
    Letter{'?', 3, "07 18 28 37 36 15 14|12"},
    Letter{'#', 4, "12 18|32 38|04 44|06 46"},
    Letter{'&', 4, "42 07 18 27 04 13 22 44"},
    Letter{'^', 2, "06 18 26"},
    Letter{'~', 4, "04 15 34 45"},
    Letter{'@', 4, "34 36 16 14 44 47 38 18 07 03 12 42"},
    Letter{'A', 4, "02 28 42|14 34"},
    Letter{'B', 4, "02 08 38 47 46 35 05|35 44 43 32 02"},
    Letter{'C', 4, "47 38 18 07 03 12 32 43"},
    Letter{'D', 4, "02 08 28 47 43 22 02"},
    Letter{'E', 4, "48 08 02 42|05 35"},
    Letter{'F', 4, "48 08 02|05 35"},
    Letter{'G', 4, "47 38 18 07 03 12 32 43 45 25"},
    Letter{'H', 4, "02 08|42 48|05 45"},
    Letter{'I', 0, "02 08"},
    Letter{'J', 3, "38 33 22 12 03"},
    Letter{'K', 4, "02 08|48 05 42"},
    Letter{'L', 3, "08 02 32"},
    Letter{'M', 4, "02 08 25 48 42"},
    Letter{'N', 4, "02 08 42 48"},
    Letter{'O', 4, "12 32 43 47 38 18 07 03 12"},
    Letter{'P', 4, "02 08 38 47 46 35 05"},
    Letter{'Q', 4, "12 32 43 47 38 18 07 03 12|24 41"},
    Letter{'R', 4, "02 08 38 47 46 35 05|25 42"},
    Letter{'S', 4, "47 38 18 07 06 15 35 44 43 32 12 03"},
    Letter{'T', 4, "08 48|28 22"},
    Letter{'U', 4, "08 03 12 32 43 48"},
    Letter{'V', 4, "08 22 48"},
    Letter{'W', 6, "08 12 36 52 68"},
    Letter{'X', 4, "02 48|08 42"},
    Letter{'Y', 4, "08 25 48|25 22"},
    Letter{'Z', 4, "08 48 02 42"},
    Letter{'a', 3, "36 32|35 26 16 05 03 12 22 33"},
    Letter{'b', 3, "08 02|05 16 26 35 33 22 12 03"},
    Letter{'c', 3, "35 26 16 05 03 12 22 33"},
    Letter{'d', 3, "38 32|35 26 16 05 03 12 22 33"},
    Letter{'e', 3, "04 34 35 26 16 05 03 12 22 33"},
    Letter{'f', 2, "28 18 07 02|06 26"},
    Letter{'g', 3, "36 31 20 10 01|35 26 16 05 03 12 22 33"},
    Letter{'h', 3, "02 08|05 16 26 35 32"},
    Letter{'i', 0, "02 06|08"},
    Letter{'j', 1, "16 11 00|18"},
    Letter{'k', 3, "08 02|36 03|14 32"},
    Letter{'l', 1, "08 03 12"},
    Letter{'m', 6, "02 06|05 16 26 35 32|35 46 56 65 62"},
    Letter{'n', 3, "02 06|05 16 26 35 32"},
    Letter{'o', 3, "12 22 33 35 26 16 05 03 12"},
    Letter{'p', 3, "06 00|05 16 26 35 33 22 12 03"},
    Letter{'q', 3, "36 30|35 26 16 05 03 12 22 33"},
    Letter{'r', 2, "06 02|05 16 26"},
    Letter{'s', 3, "35 26 16 05 14 24 33 22 12 03"},
    Letter{'t', 2, "08 03 12 22|06 26"},
    Letter{'u', 3, "06 03 12 22 33|36 32"},
    Letter{'v', 4, "06 22 46"},
    Letter{'w', 4, "06 12 26 32 46"},
    Letter{'x', 3, "06 32|36 02"},
    Letter{'y', 4, "06 22|46 22 10 00"},
    Letter{'z', 3, "06 36 02 32"},
    Letter{mu, 3, "00 06|03 12 22 33|36 32"},
};

const Letter* letter_of(char sign) {
  const auto find = [](char wanted) {
    return std::find_if(letters.begin(), letters.end(),
                        [&](const Letter& known) { return known.sign == wanted; });
  };
  const auto* const found = find(sign);
  return found != letters.end() ? found : find('?');
}

// The signs of a text in UTF-8: each as one character.
std::string signs_of(std::string_view text) {
  std::string signs;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const auto byte = static_cast<unsigned char>(text[k]);
    if ((byte & 0xC0U) == 0x80U) continue;
    signs += text.substr(k, 2) == "\u00b5" ? mu : byte < 0x80U ? text[k] : '?';
  }
  return signs;
}

struct Point {
  double x = 0, y = 0;
};
struct Stroke {
  Point from, to;
};

std::vector<Stroke> strokes_of(const Letter& letter) {
  std::vector<Stroke> strokes;
  std::optional<Point> last;
  bool is_first = true;  // of its stroke
  for (std::size_t k = 0; k + 1 < letter.strokes.size(); k += 3) {
    const Point here{static_cast<double>(letter.strokes[k] - '0'),
                     static_cast<double>(letter.strokes[k + 1] - '0')};
    const bool is_last = k + 2 >= letter.strokes.size() || letter.strokes[k + 2] == '|';
    if (!is_first) strokes.push_back({*last, here});
    if (is_first && is_last) strokes.push_back({here, here});
    last = here;
    is_first = is_last;
  }
  return strokes;
}

double distance(const Point& p, const Stroke& stroke) {
  const double dx = stroke.to.x - stroke.from.x, dy = stroke.to.y - stroke.from.y, square = dx * dx + dy * dy;
  const double along = (p.x - stroke.from.x) * dx + (p.y - stroke.from.y) * dy;
  const double t = square > 0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - stroke.from.x - t * dx, p.y - stroke.from.y - t * dy);
}

}  // namespace

int letter_height(int width, int height) {
  return std::max(smallest_letters, static_cast<int>(std::min(width, height) / letters_a_side));
}

Band::Band(Picture& picture, int rows, const yarn::Color& background)
    : picture_(picture), first_(picture.height) {
  const double bright = 0.299 * background.red + 0.587 * background.green + 0.114 * background.blue;
  ink_.fill(bright > 127 ? 0 : 255);
  picture.height += rows;
  const std::size_t count = static_cast<std::size_t>(rows) * width();
  picture.rgb.reserve(picture.rgb.size() + 3 * count);
  for (std::size_t k = 0; k < count; ++k)
    for (const int channel : {background.red, background.green, background.blue})
      picture.rgb.push_back(static_cast<std::uint8_t>(channel));
}

template <class Share>
void Band::for_each_pixel(double left, double top, double right, double bottom, const std::array<int, 3>& ink,
                          const Share& share) {
  const auto begin = [](double edge) { return std::max(0, static_cast<int>(std::floor(edge))); };
  const auto end = [](double edge, int most) { return std::min(most, static_cast<int>(std::ceil(edge))); };
  for (int y = begin(top); y < end(bottom, picture_.height - first_); ++y)
    for (int x = begin(left); x < end(right, picture_.width); ++x) {
      const double covered = share(x, y);
      std::uint8_t* const at =
          &picture_.rgb[3 * (static_cast<std::size_t>(first_ + y) * width() + static_cast<std::size_t>(x))];
      for (std::size_t channel = 0; channel < 3; ++channel)
        at[channel] =
            static_cast<std::uint8_t>(std::lround(at[channel] + covered * (ink[channel] - at[channel])));
    }
}

void Band::box(double left, double top, double right, double bottom) {
  box(left, top, right, bottom, {ink_[0], ink_[1], ink_[2]});
}

void Band::box(double left, double top, double right, double bottom, const yarn::Color& color) {
  const auto share = [](double low, double high, int pixel) {
    return std::max(0.0, std::min<double>(high, pixel + 1) - std::max<double>(low, pixel));
  };
  for_each_pixel(left, top, right, bottom, {color.red, color.green, color.blue},
                 [&](int x, int y) { return share(left, right, x) * share(top, bottom, y); });
}

void Band::text(std::string_view text, double x, double y, double capital) {
  const double unit = capital / units_a_capital, stroke = std::max(1.0, stroke_share * capital),
               reach = 0.5 * stroke + 1;
  for (const char sign : signs_of(text)) {
    if (sign == ' ') {
      x += blank * unit;
      continue;
    }
    const Letter& letter = *letter_of(sign);
    const std::vector<Stroke> strokes = strokes_of(letter);
    for_each_pixel(x - reach, y - units_a_capital * unit - reach, x + letter.width * unit + reach,
                   y + foot * unit + reach, ink_, [&](int column, int row) {
                     const Point p{(column + 0.5 - x) / unit, (y - row - 0.5) / unit + foot};
                     double nearest = std::numeric_limits<double>::infinity();
                     for (const Stroke& one : strokes) nearest = std::min(nearest, distance(p, one));
                     return std::clamp(0.5 * stroke + 0.5 - nearest * unit, 0.0, 1.0);
                   });
    x += (letter.width + gap) * unit;
  }
}

double Band::width_of(std::string_view text, double capital) {
  double units = 0;
  for (const char sign : signs_of(text)) units += sign == ' ' ? blank : letter_of(sign)->width + gap;
  return units * capital / units_a_capital;
}

}  // namespace selvage::view
