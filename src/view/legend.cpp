#include "view/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "view/band.h"
#include "view/color_scale.h"

namespace selvage::view {

namespace {

constexpr int shown_values = 5;
// From the top, in heights of capitals.
constexpr double title_foot = 1.9, bar_top = 2.6, bar_foot = 3.7, value_foot = 5.4, legend_foot = 6.2;
constexpr double bar_share = 0.7;  // of the width
constexpr double widest_title = 0.94;

}  // namespace

yarn::Color scale_color(double share) {
  if (std::isnan(share)) return color_of_none;
  const double at = std::clamp(share, 0.0, 1.0) * (color_scale.size() - 1);
  const std::size_t k = std::min(color_scale.size() - 2, static_cast<std::size_t>(at));
  const auto mixed = [&](int yarn::Color::*channel) {
    return static_cast<int>(
        std::lround(color_scale[k].*channel +
                    (at - static_cast<double>(k)) * (color_scale[k + 1].*channel - color_scale[k].*channel)));
  };
  return {mixed(&yarn::Color::red), mixed(&yarn::Color::green), mixed(&yarn::Color::blue)};
}

int legend_rows(int width, int height) {
  const int high = letter_height(width, height), rows = static_cast<int>(std::lround(legend_foot * high));
  return 3 * rows > height || width < 22 * high ? 0 : rows;
}

void add_legend(Picture& picture, int rows, const Legend& legend, const yarn::Color& background) {
  const double high = std::floor(rows / legend_foot), width = picture.width;
  Band band(picture, rows, background);
  const double wide = Band::width_of(legend.title, high);
  const double title = high * std::min(1.0, widest_title * width / wide);
  band.text(legend.title, 0.5 * (width - wide * title / high), title_foot * high, title);
  const double left = std::round(0.5 * (1 - bar_share) * width), right = std::round(width - left);
  for (double x = left; x < right; ++x)
    band.box(x, bar_top * high, x + 1, bar_foot * high, scale_color((x + 0.5 - left) / (right - left)));
  for (int k = 0; k < shown_values; ++k) {
    const double share = static_cast<double>(k) / (shown_values - 1), x = left + share * (right - left);
    // What is nothing but rounding beside the range is 0.
    const double value = legend.low + share * (legend.high - legend.low);
    const bool is_zero = std::abs(value) < 1e-9 * (legend.high - legend.low);
    const std::string text = fmt::format("{:.4g}", is_zero ? 0.0 : value);
    band.box(x - 0.5, bar_foot * high, x + 0.5, (bar_foot + 0.3) * high);
    band.text(text, x - 0.5 * Band::width_of(text, high), value_foot * high, high);
  }
}

}  // namespace selvage::view
