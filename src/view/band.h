// Rows at the foot of a picture, below what it shows, with boxes and lettering in black or white.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "view/picture.h"

namespace selvage::view {

// How high capitals of a picture of this size are, pixels.
int letter_height(int width, int height);

// Adds rows of the background's colour to a picture, which outlives it. Places are pixels: x to the right, y
// down, from the upper left of these rows; what lies outside of them is not drawn.
class Band {
 public:
  Band(Picture& picture, int rows, const yarn::Color& background);

  void box(double left, double top, double right, double bottom);
  void box(double left, double top, double right, double bottom, const yarn::Color& color);
  // Strokes of printable ASCII and µ (UTF-8); other letters are drawn as '?'. Its lower left corner is at (x,
  // y).
  void text(std::string_view text, double x, double y, double capital);
  static double width_of(std::string_view text, double capital);

 private:
  [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(picture_.width); }
  template <class Share>
  void for_each_pixel(double left, double top, double right, double bottom, const std::array<int, 3>& ink,
                      const Share& share);

  Picture& picture_;
  int first_;  // of its rows, in the picture
  std::array<int, 3> ink_{};
};

}  // namespace selvage::view
