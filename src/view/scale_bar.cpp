#include "view/scale_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "view/band.h"

namespace selvage::view {

namespace {

// Shares of the height of capitals.
constexpr double rows_share = 2.2, bar_stroke_share = 0.13;

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
    name = shown == Unit::um ? "\u00b5m" : name_of(shown);
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
  const double high = std::floor(rows / rows_share), stroke = std::max(1.0, bar_stroke_share * high);
  const RoundLength length = round_length(picture.width / 4.0 / picture.pixels_per_unit, unit);
  Band foot(picture, rows, background);
  const double left = std::round(0.5 * rows), right = left + length.length * picture.pixels_per_unit;
  const double top = std::round(0.5 * (rows - high)), bottom = top + high, middle = 0.5 * (top + bottom);
  foot.box(left, middle - 0.5 * stroke, right, middle + 0.5 * stroke);
  for (const double tick : {left, right - stroke})
    foot.box(tick, top + 0.15 * high, tick + stroke, bottom - 0.15 * high);
  foot.text(length.text, right + high, bottom, high);
}

}  // namespace selvage::view
