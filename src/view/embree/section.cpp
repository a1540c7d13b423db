#include "view/embree/section.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace selvage::view::embree {

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr int most_hits = 100'000;

// The three axes of the yarns' space in camera space.
Vec3f axis_of(const Camera& camera, int axis) {
  return camera.direction(Vec3::Unit(axis)).cast<float>();
}

// Along x, y or z, pixels from the origin of the yarns' space.
std::pair<float, float> extent(const std::vector<Skin>& skins, const Camera& camera, int axis) {
  const Vec3f way = axis_of(camera, axis), origin = camera.to_picture(Vec3::Zero()).cast<float>();
  std::pair<float, float> found{infinity, -infinity};
  for (const Skin& skin : skins)
    for (const Vec3f& p : skin.points) {
      const float at = way.dot(p - origin);
      found = {std::min(found.first, at), std::max(found.second, at)};
    }
  return found;
}

// To the neighbours of a cube among others: each direction is within 28 degrees of one of them, or of its
// opposite.
std::array<Vec3f, 13> directions() {
  std::array<Vec3f, 13> all;
  std::size_t count = 0;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (9 * x + 3 * y + z > 0)
          all[count++] =
              Vec3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)).normalized();
  return all;
}

}  // namespace

Status check_section(const Section& section, const Camera& camera, const std::vector<Skin>& skins) {
  const Vec3f way = axis_of(camera, section.axis);
  const float place = way.dot(camera.to_picture(section.place * Vec3::Unit(section.axis)).cast<float>());
  for (const Skin& skin : skins) {
    bool below = false, above = false;
    for (const Vec3f& p : skin.points) (way.dot(p) < place ? below : above) = true;
    if (below && above) return {};
  }
  const auto [low, high] = extent(skins, camera, section.axis);
  return error(
      Kind::geometry,
      fmt::format("the section {}={:.6g} cuts no yarn; they reach from {:.4g} to {:.4g}", "xyz"[section.axis],
                  section.place, low / camera.pixels_per_unit(), high / camera.pixels_per_unit()));
}

CutScene::CutScene(const Section& section, const Camera& camera, const Scene& scene,
                   const std::vector<Skin>& skins)
    : scene_(scene), skins_(skins), normal_(axis_of(camera, section.axis)) {
  constexpr float edge_on = 1e-6F;
  if (std::abs(normal_.z()) < edge_on) normal_ = Vec3f(normal_.x(), normal_.y(), 0).normalized();
  if (normal_.z() < 0) normal_ = -normal_;
  place_ = normal_.dot(camera.to_picture(section.place * Vec3::Unit(section.axis)).cast<float>());
  float thinnest = infinity;
  for (int axis = 0; axis < 3; ++axis)
    if (const auto [low, high] = extent(skins, camera, axis); high - low < thinnest)
      thinnest = high - low, across_ = axis_of(camera, axis);
}

std::optional<float> CutScene::begin_of_sight(const Vec3f& point) const {
  const float beside = normal_.x() * point.x() + normal_.y() * point.y();
  if (normal_.z() > 0) return (place_ - beside) / normal_.z();
  return beside > place_ ? std::nullopt : std::optional(infinity);
}

float CutScene::way_out(const Vec3f& origin, const Vec3f& direction) const {
  const float pace = normal_.dot(direction), left = place_ - normal_.dot(origin);
  return pace > 0 ? std::max(0.0F, left / pace) : infinity;
}

std::optional<CutScene::Inner> CutScene::inside_at(const Vec3f& point) const {
  // A yarn holds the point so many times as a ray leaves it more often than it enters it.
  std::vector<std::pair<std::uint32_t, int>> depths;
  Walk walk(scene_, point, across_);
  for (int k = 0; k < most_hits; ++k) {
    const std::optional<Hit> hit = walk.next();
    if (!hit) break;
    auto depth = std::ranges::find(depths, hit->yarn, &std::pair<std::uint32_t, int>::first);
    if (depth == depths.end()) depth = depths.insert(depth, {hit->yarn, 0});
    depth->second += hit->facing.dot(across_) > 0.0F ? 1 : -1;
  }
  std::erase_if(depths, [](const auto& one) { return one.second <= 0; });
  if (depths.empty()) return std::nullopt;
  std::ranges::sort(depths);
  for (std::size_t k = 0; k < depths.size(); ++k)
    for (std::size_t l = k + 1; l < depths.size(); ++l)
      if (is_deep(point, depths[k].first, depths[l].first)) return Inner{depths[k].first, Inside::another};
  for (const auto& [yarn, depth] : depths)
    if (depth > 1 && is_deep(point, yarn, yarn)) return Inner{yarn, Inside::itself};
  return Inner{depths.front().first, Inside::nothing};
}

// The way to where one of the two yarns is left.
float CutScene::to_exit(const Vec3f& point, const Vec3f& direction, std::uint32_t a, std::uint32_t b) const {
  Walk walk(scene_, point, direction);
  for (int k = 0; k < most_hits; ++k) {
    const std::optional<Hit> hit = walk.next();
    if (!hit) break;
    if ((hit->yarn == a || hit->yarn == b) && hit->facing.dot(direction) > 0.0F) return hit->distance;
  }
  return 0;
}

// Is what they share thicker than what the skins' own errors can feign?
bool CutScene::is_deep(const Vec3f& point, std::uint32_t a, std::uint32_t b) const {
  static const std::array<Vec3f, 13> all = directions();
  const double doubt = skins_[a].uncertainty + skins_[b].uncertainty;
  return std::ranges::all_of(all, [&](const Vec3f& direction) {
    return to_exit(point, direction, a, b) + to_exit(point, -direction, a, b) > doubt;
  });
}

}  // namespace selvage::view::embree
