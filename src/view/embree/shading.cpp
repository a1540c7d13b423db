#include "view/embree/shading.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "yarn/role_color.h"

namespace selvage::view::embree {

namespace {

constexpr float pi = std::numbers::pi_v<float>;

// The light: an even sky in all directions, and a lamp to the upper left behind the eye, of 14 degrees
// radius.
constexpr float sky = 0.46F, lamp_power = 0.66F, lamp_radius = 0.25F;
constexpr int stripes_round = 8;
constexpr float stripe_depth = 0.45F;
constexpr float ends_toward_white = 0.35F;
constexpr float tint_share = 0.85F;

Light mixed(const Light& a, const Light& b, float share) {
  return (1.0F - share) * a + share * b;
}

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0F, 1.0F);
  return t * t * (3.0F - 2.0F * t);
}

}  // namespace

Vec3f lamp_direction() {
  return Vec3f(-0.45F, 0.6F, 0.8F).normalized();
}

Light linear(const yarn::Color& color) {
  const auto channel = [](int value) {
    const float s = static_cast<float>(std::clamp(value, 0, 255)) / 255.0F;
    return s <= 0.04045F ? s / 12.92F : std::pow((s + 0.055F) / 1.055F, 2.4F);
  };
  return {channel(color.red), channel(color.green), channel(color.blue)};
}

std::uint8_t encoded(float linear) {
  const float l = std::clamp(linear, 0.0F, 1.0F);
  const float s = l <= 0.0031308F ? 12.92F * l : 1.055F * std::pow(l, 1.0F / 2.4F) - 0.055F;
  return static_cast<std::uint8_t>(std::lround(255.0F * s));
}

Paint paint_of(const yarn::Body& body, std::size_t number, const Skin& skin, double pixels_per_unit) {
  Paint paint;
  paint.color = linear(body.has_own_color ? body.color : yarn::role_color(body.role, number));
  paint.end_color = mixed(paint.color, Light::Ones(), ends_toward_white);
  if (body.twist == 0.0) return paint;
  // Pixels between two stripes, across them.
  const double round = std::numbers::pi * skin.size, slope = round * body.twist / pixels_per_unit;
  const double spacing = round / stripes_round / std::sqrt(1.0 + slope * slope);
  paint.stripes = stripe_depth * smooth_step(2.0F, 5.0F, static_cast<float>(spacing));
  return paint;
}

Look look_at(const Skin& skin, const Paint& paint, const Hit& hit) {
  const std::size_t quads = skin.quads(), columns = skin.columns;
  if (hit.facet >= quads) {
    const bool start = hit.facet - quads < columns - 1;
    return {paint.end_color, start ? skin.start_normal : skin.end_normal};
  }
  const std::size_t row = hit.facet / (columns - 1), column = hit.facet % (columns - 1);
  const std::size_t corner = row * columns + column;
  const Vec3f low = (1.0F - hit.u) * skin.normals[corner] + hit.u * skin.normals[corner + 1];
  const Vec3f high =
      (1.0F - hit.u) * skin.normals[corner + columns] + hit.u * skin.normals[corner + columns + 1];
  const Vec3f normal = (1.0F - hit.v) * low + hit.v * high;
  Look look{paint.color, normal.norm() > 0.0F ? normal.normalized() : hit.facing};
  if (paint.stripes > 0.0F) {
    const double u = hit.u, v = hit.v;
    const double turns = (1.0 - u) * skin.around[column] + u * skin.around[column + 1] -
                         (1.0 - v) * skin.along[row] - v * skin.along[row + 1];
    const double phase = stripes_round * turns;
    const float wave = 0.5F + 0.5F * std::cos(2.0F * pi * static_cast<float>(phase - std::floor(phase)));
    look.color *= 1.0F - paint.stripes * wave * wave;
  }
  return look;
}

float brightness(const Vec3f& normal, float surroundings, float lamp) {
  return sky * surroundings + lamp_power * lamp * std::max(0.0F, normal.dot(lamp_direction()));
}

namespace {

// The order of a 4 x 4 square in which each next one is far from those before.
constexpr std::array<int, pattern_size> dispersed = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};

float mirrored_bits(unsigned value) {
  float result = 0.0F, digit = 0.5F;
  for (; value != 0; value >>= 1U, digit *= 0.5F)
    if ((value & 1U) != 0) result += digit;
  return result;
}

// Two directions across n (Duff et al. 2017).
std::array<Vec3f, 2> across(const Vec3f& n) {
  const float sign = std::copysign(1.0F, n.z()), a = -1.0F / (sign + n.z()), b = n.x() * n.y() * a;
  return {Vec3f(1.0F + sign * n.x() * n.x() * a, sign * b, -sign * n.x()),
          Vec3f(b, sign + n.y() * n.y() * a, -n.y())};
}

}  // namespace

Patterns::Patterns() {
  const int count = pattern_size * rays_to_surroundings;
  for (int k = 0; k < count; ++k) {
    const float radius = std::sqrt((static_cast<float>(k) + 0.5F) / static_cast<float>(count));
    const float angle = 2.0F * pi * mirrored_bits(static_cast<unsigned>(k));
    hemisphere_.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                             std::sqrt(1.0F - radius * radius));
  }
  const Vec3f lamp = lamp_direction();
  const auto [a, b] = across(lamp);
  for (int k = 0; k < pattern_size; ++k) {
    constexpr float golden = 2.3999632F;
    const float radius = lamp_radius * std::sqrt((static_cast<float>(k) + 0.5F) / pattern_size);
    const float angle = golden * static_cast<float>(k);
    lamp_.push_back((lamp + radius * (std::cos(angle) * a + std::sin(angle) * b)).normalized());
  }
  std::vector<Vec3f> ordered(lamp_.size());
  for (std::size_t k = 0; k < lamp_.size(); ++k) ordered[k] = lamp_[static_cast<std::size_t>(dispersed[k])];
  lamp_ = ordered;
}

Vec3f Patterns::to_surroundings(int cell, int ray, const Vec3f& normal) const {
  const int k = ray * pattern_size + dispersed[static_cast<std::size_t>(cell)];
  const Vec3f& local = hemisphere_[static_cast<std::size_t>(k)];
  const auto [a, b] = across(normal);
  return local.x() * a + local.y() * b + local.z() * normal;
}

namespace {

// A part of the line of sight that is inside two yarns, or twice inside one.
class Shared {
 public:
  Shared(const std::vector<Skin>& skins, const Vec3f& direction) : skins_(skins), direction_(direction) {}

  // Deeper than what the skins' own errors can feign? At a grazing ray the way inside is longer than it is
  // deep.
  [[nodiscard]] bool is_real(const Hit& in, const Hit& out) const {
    const float steepness =
        std::max(std::abs(in.facing.dot(direction_)), std::abs(out.facing.dot(direction_)));
    const double doubt = skins_[in.yarn].uncertainty + skins_[out.yarn].uncertainty;
    return (out.distance - in.distance) * steepness > doubt;
  }

 private:
  const std::vector<Skin>& skins_;
  Vec3f direction_;
};

}  // namespace

Inside inside_of(const Scene& scene, const std::vector<Skin>& skins, const Vec3f& origin,
                 const Vec3f& direction, const Hit& first) {
  constexpr int most_hits = 32;
  const Shared shared(skins, direction);
  std::vector<Hit> entered;  // not left yet: `first`'s yarn and others
  Walk walk(scene, origin, direction, first);
  int depth = 1;  // how often the ray is inside the first yarn
  for (int k = 0; k < most_hits; ++k) {
    const std::optional<Hit> hit = walk.next();
    if (!hit) break;
    const bool own = hit->yarn == first.yarn;
    if (hit->facing.dot(direction) < 0.0F) {
      entered.push_back(*hit);
      depth += own ? 1 : 0;
      continue;
    }
    if (own && --depth == 0) {
      for (const Hit& other : entered)
        if (other.yarn != first.yarn && shared.is_real(other, *hit)) return Inside::another;
      break;
    }
    const auto open = std::find_if(entered.rbegin(), entered.rend(),
                                   [&](const Hit& other) { return other.yarn == hit->yarn; });
    if (open == entered.rend()) continue;
    if (shared.is_real(*open, *hit)) return own ? Inside::itself : Inside::another;
    entered.erase(std::next(open).base());
  }
  return Inside::nothing;
}

Light tinted(const Light& color, Inside inside) {
  if (inside == Inside::nothing) return color;
  return mixed(color, inside == Inside::another ? Light(1.0F, 0.0F, 0.6F) : Light(1.0F, 0.3F, 0.0F),
               tint_share);
}

}  // namespace selvage::view::embree
