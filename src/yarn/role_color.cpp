#include "yarn/role_color.h"

#include <algorithm>
#include <cmath>

namespace selvage::yarn {

namespace {

Color color_of(Role role) {
  using enum Role;
  switch (role) {
    case warp:
      return {46, 98, 150};
    case weft:
      return {205, 140, 52};
    case wale:
      return {72, 128, 92};
    case course:
      return {58, 130, 140};
    case braider:
      return {150, 84, 120};
    case axial:
      return {120, 116, 66};
    case binder:
      return {176, 72, 60};
    case other:
      return {140, 146, 150};
  }
  return {};
}

}  // namespace

Color hue_color(std::size_t index) {
  constexpr double saturation = 0.42, lightness = 0.48, golden = 0.618034, first = 0.55;
  const double turn = std::fmod(first + golden * static_cast<double>(index), 1.0);
  const auto channel = [&](double place) {
    const double k = std::fmod(place + 12 * turn, 12.0);
    const double part = lightness - saturation * std::min(lightness, 1 - lightness) *
                                        std::clamp(std::min(k - 3, 9 - k), -1.0, 1.0);
    return static_cast<int>(std::lround(255 * part));
  };
  return {channel(0), channel(8), channel(4)};
}

Color role_color(Role role, std::size_t number) {
  const double shade = number % 2 == 0 ? 1.0 : 1.14;
  const auto shaded = [&](int part) { return std::min(255, static_cast<int>(std::lround(shade * part))); };
  const Color color = color_of(role);
  return {shaded(color.red), shaded(color.green), shaded(color.blue)};
}

}  // namespace selvage::yarn
