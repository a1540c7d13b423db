// A picture's tiles, and where its pixels are looked through. Internal to the module selvage_embree.
#pragma once

#include <algorithm>
#include <array>

#include "core/parallel.h"
#include "view/embree/shading.h"
#include "view/picture.h"

namespace selvage::view::embree {

// Four samples a pixel, one in each quarter, none in a row or column with another.
inline constexpr int samples_side = 2;
inline constexpr std::array<std::array<float, 2>, 4> sample_places = {
    {{0.375F, 0.125F}, {0.875F, 0.375F}, {0.125F, 0.625F}, {0.625F, 0.875F}}};

inline Picture blank_picture(const PictureOptions& options, const Camera& camera) {
  Picture picture{options.width, options.height, {}, camera.pixels_per_unit()};
  picture.rgb.resize(3 * static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
  return picture;
}

inline void put(Picture& picture, int x, int y, const Light& light) {
  std::uint8_t* out =
      &picture.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                        static_cast<std::size_t>(x))];
  for (int channel = 0; channel < 3; ++channel) out[channel] = encoded(light[channel]);
}

// `draw(left, top, right, bottom)`, pixels, for each tile, with as many threads as the options have.
template <class Draw>
void draw_tiles(const PictureOptions& options, const Draw& draw) {
  constexpr int tile_side = 64;  // pixels
  const auto tiles = [](int pixels) {
    return static_cast<std::size_t>((pixels + tile_side - 1) / tile_side);
  };
  const std::size_t across = tiles(options.width), count = across * tiles(options.height);
  for_each_index(
      count, options.threads,
      [&](std::size_t k) {
        const int left = static_cast<int>(k % across) * tile_side,
                  top = static_cast<int>(k / across) * tile_side;
        draw(left, top, std::min(left + tile_side, options.width), std::min(top + tile_side, options.height));
      },
      options.progress);
}

}  // namespace selvage::view::embree
