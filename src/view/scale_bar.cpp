#include "view/scale_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace selvage::view {

namespace {

// Shares of the height of capitals.
constexpr double rows_share = 2.2, stroke_share = 0.13;
constexpr int smallest_letters = 9;  // pixels
constexpr double letters_a_side = 45;

int letter_height(int width, int height) {
  return std::max(smallest_letters, static_cast<int>(std::min(width, height) / letters_a_side));
}

// A letter as strokes: points "xy", on a grid in which letters stand on the line y = 2 and capitals reach 8;
// strokes are parted by '|'. One point is a dot.
struct Letter {
  char sign;  // 'u': µ
  int width;
  std::string_view strokes;
};
constexpr double units_a_capital = 6, foot = 2, gap = 1.7, blank = 3.4;
constexpr std::array letters = {
    Letter{'0', 4, "12 32 43 47 38 18 07 03 12"},
    Letter{'1', 2, "06 28 22"},
    Letter{'2', 4, "07 18 38 47 46 02 42"},
    Letter{'5', 4, "48 08 05 35 44 43 32 12 03"},
    Letter{'.', 0, "02"},
    Letter{'m', 6, "02 06|05 16 26 35 32|35 46 56 65 62"},
    Letter{'u', 3, "00 06|03 12 22 33|36 32"},
    Letter{'i', 0, "02 06|08"},
    Letter{'n', 3, "02 06|05 16 26 35 32"},
    Letter{'c', 3, "35 26 16 05 03 12 22 33"},
    Letter{'h', 3, "02 08|05 16 26 35 32"},
};

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

// Pixels of the foot: x to the right, y down, from its upper left.
class Foot {
 public:
  Foot(Picture& picture, int rows, const yarn::Color& background)
      : picture_(picture),
        first_(picture.height),
        ground_{background.red, background.green, background.blue} {
    const double bright = 0.299 * background.red + 0.587 * background.green + 0.114 * background.blue;
    ink_ = bright > 127 ? 0 : 255;
    picture.height += rows;
    picture.rgb.reserve(picture.rgb.size() + 3 * static_cast<std::size_t>(rows) * width());
    for (std::size_t k = 0; k < static_cast<std::size_t>(rows) * width(); ++k)
      for (const int channel : ground_) picture.rgb.push_back(static_cast<std::uint8_t>(channel));
  }

  void box(double left, double top, double right, double bottom) {
    const auto share = [](double low, double high, int pixel) {
      return std::max(0.0, std::min<double>(high, pixel + 1) - std::max<double>(low, pixel));
    };
    for_each_pixel(left, top, right, bottom,
                   [&](int x, int y) { return share(left, right, x) * share(top, bottom, y); });
  }

  // Its lower left corner is on the line at (x, y).
  void letter(const Letter& letter, double x, double y, double unit, double stroke) {
    const std::vector<Stroke> strokes = strokes_of(letter);
    const double reach = 0.5 * stroke + 1;
    for_each_pixel(x - reach, y - units_a_capital * unit - reach, x + letter.width * unit + reach,
                   y + foot * unit + reach, [&](int column, int row) {
                     const Point p{(column + 0.5 - x) / unit, (y - row - 0.5) / unit + foot};
                     double nearest = std::numeric_limits<double>::infinity();
                     for (const Stroke& one : strokes) nearest = std::min(nearest, distance(p, one));
                     return std::clamp(0.5 * stroke + 0.5 - nearest * unit, 0.0, 1.0);
                   });
  }

 private:
  [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(picture_.width); }

  template <class Share>
  void for_each_pixel(double left, double top, double right, double bottom, const Share& share) {
    const auto begin = [](double edge) { return std::max(0, static_cast<int>(std::floor(edge))); };
    const auto end = [](double edge, int most) { return std::min(most, static_cast<int>(std::ceil(edge))); };
    for (int y = begin(top); y < end(bottom, picture_.height - first_); ++y)
      for (int x = begin(left); x < end(right, picture_.width); ++x) {
        const double covered = share(x, y);
        std::uint8_t* const at =
            &picture_.rgb[3 * (static_cast<std::size_t>(first_ + y) * width() + static_cast<std::size_t>(x))];
        for (int channel = 0; channel < 3; ++channel)
          at[channel] = static_cast<std::uint8_t>(std::lround(at[channel] + covered * (ink_ - at[channel])));
      }
  }

  Picture& picture_;
  int first_;  // of its rows, in the picture
  std::array<int, 3> ground_;
  int ink_ = 0;
};

// At most so long, file units.
struct RoundLength {
  double length = 0;  // file units
  std::string text;
};
RoundLength round_length(double most, Unit unit) {
  double size = millimetres_per(Unit::inch);  // mm
  std::string_view name = "inch";
  if (unit != Unit::inch) {
    const double millimetres = most * millimetres_per(unit);
    const Unit shown = millimetres < 0.1 ? Unit::um : millimetres < 1000 ? Unit::mm : Unit::m;
    size = millimetres_per(shown);
    name = name_of(shown);
  }
  const double value = most * millimetres_per(unit) / size;
  const int exponent = static_cast<int>(std::floor(std::log10(value)));
  const double power = std::pow(10.0, exponent);
  const double digit = value >= 5 * power ? 5 : value >= 2 * power ? 2 : 1;
  return {digit * power * size / millimetres_per(unit),
          fmt::format("{:.{}f} {}", digit * power, std::max(0, -exponent), name)};
}

}  // namespace

int scale_bar_rows(int width, int height) {
  const int letters_high = letter_height(width, height);
  const int rows = static_cast<int>(std::lround(rows_share * letters_high));
  return 4 * rows > height || width < 14 * letters_high ? 0 : rows;
}

void add_scale_bar(Picture& picture, int rows, Unit unit, const yarn::Color& background) {
  const double high = std::floor(rows / rows_share), stroke = std::max(1.0, stroke_share * high);
  const RoundLength length = round_length(picture.width / 4.0 / picture.pixels_per_unit, unit);
  Foot foot_of_picture(picture, rows, background);
  const double left = std::round(0.5 * rows), right = left + length.length * picture.pixels_per_unit;
  const double top = std::round(0.5 * (rows - high)), bottom = top + high, middle = 0.5 * (top + bottom);
  foot_of_picture.box(left, middle - 0.5 * stroke, right, middle + 0.5 * stroke);
  for (const double tick : {left, right - stroke})
    foot_of_picture.box(tick, top + 0.15 * high, tick + stroke, bottom - 0.15 * high);
  const double letter_unit = high / units_a_capital;
  double x = right + high;
  for (const char sign : length.text) {
    const auto* const letter =
        std::find_if(letters.begin(), letters.end(), [&](const Letter& known) { return known.sign == sign; });
    if (letter == letters.end()) {
      x += blank * letter_unit;
      continue;
    }
    foot_of_picture.letter(*letter, x, bottom, letter_unit, stroke);
    x += (letter->width + gap) * letter_unit;
  }
}

}  // namespace selvage::view
