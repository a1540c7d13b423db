// What a place of a skin looks like. Internal to the module selvage_embree.
#pragma once

#include <vector>

#include "view/embree/scene.h"
#include "view/picture.h"

namespace selvage::view::embree {

// Linear red, green and blue, 0 .. 1.
using Light = Eigen::Vector3f;

// Toward the lamp, to the upper left behind the eye; unit.
Vec3f lamp_direction();

Light linear(const yarn::Color& color);
// 0 .. 255, by the transfer function of sRGB (IEC 61966-2-1).
std::uint8_t encoded(float linear);

// The look of one yarn.
struct Paint {
  Light color, end_color;
  float stripes =
      0;  // how dark the fibres' stripes are: 0 for none, 0 too where they would be too fine to see
};
// `number`: of the yarn among those that are shown.
Paint paint_of(const yarn::Body& body, std::size_t number, const Skin& skin, double pixels_per_unit);

// One place of a skin as the eye sees it.
struct Look {
  Light color;
  Vec3f normal;  // unit, toward the eye
};
Look look_at(const Skin& skin, const Paint& paint, const Hit& hit);

// Part of the colour that comes back when a share of the surroundings' light (0 .. 1) and a share of the
// lamp's reach a place.
float brightness(const Vec3f& normal, float surroundings, float lamp);

// Directions to look in for the light's hindrances. A square of 4 x 4 neighbouring samples uses a different
// set at each place, so that their mean is that of all the sets (interleaved sampling: Keller and Heidrich
// 2001).
inline constexpr int pattern_side = 4, pattern_size = pattern_side * pattern_side;
class Patterns {
 public:
  static constexpr int rays_to_surroundings = 3;
  Patterns();
  // `cell`: 0 .. pattern_size - 1. Cosine-weighted about `normal`.
  [[nodiscard]] Vec3f to_surroundings(int cell, int ray, const Vec3f& normal) const;
  [[nodiscard]] const Vec3f& to_lamp(int cell) const { return lamp_[static_cast<std::size_t>(cell)]; }

 private:
  std::vector<Vec3f> hemisphere_, lamp_;
};

// What the visible yarn holds inside, along the line of sight from its first hit to where it is left.
enum class Inside { nothing, another, itself };
Inside inside_of(const Scene& scene, const std::vector<Skin>& skins, const Vec3f& origin,
                 const Vec3f& direction, const Hit& first);
Light tinted(const Light& color, Inside inside);

}  // namespace selvage::view::embree
