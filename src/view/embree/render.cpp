#include "view/embree/render.h"

#include <algorithm>

#include "core/parallel.h"
#include "view/embree/section.h"
#include "view/embree/shading.h"
#include "view/embree/tiles.h"

namespace selvage::view::embree {

namespace {

constexpr double chord = 0.1;           // pixels
constexpr float reach_in_sizes = 2.5F;  // how far from a yarn its surroundings shade it, in yarn diameters

// Neighbours that a sample averages its light with: a whole pattern, its own place among them.
constexpr int window_before = 2, window_after = 1;

struct Sample {
  static constexpr std::uint32_t nothing = 0xffffffffU;
  std::uint32_t yarn = nothing;
  Look look;
  Vec3f place;
  float surroundings = 1, lamp = 1;
  bool is_cut = false;  // the inside of a yarn, at a section
};

class Renderer {
 public:
  Renderer(const PictureOptions& options, const std::vector<Skin>& skins, const std::vector<Paint>& paints,
           const Scene& scene, const CutScene* cut)
      : options_(options),
        skins_(skins),
        paints_(paints),
        scene_(scene),
        cut_(cut),
        background_(linear(options.background)) {
    for (const Skin& skin : skins)
      for (const Vec3f& p : skin.points) eye_ = std::max(eye_, p.z() + 1.0F);
  }

  void draw_tile(int left, int top, int right, int bottom, Picture& picture) const;

 private:
  [[nodiscard]] Sample sample(int x, int y) const;
  void light(Sample& sample, const Hit& hit, int cell) const;
  [[nodiscard]] bool is_blocked(const Vec3f& origin, const Vec3f& direction, float reach) const;
  [[nodiscard]] Light pixel(const std::vector<Sample>& tile, int stride, int x, int y) const;

  const PictureOptions& options_;
  const std::vector<Skin>& skins_;
  const std::vector<Paint>& paints_;
  const Scene& scene_;
  const CutScene* cut_;  // null: the yarns are whole
  Light background_;
  Patterns patterns_;
  float eye_ = 0;  // z from where all rays start
};

// x, y: of the sample, counted over the whole picture (negative ones lie before it).
Sample Renderer::sample(int x, int y) const {
  const auto parity = [](int k) { return k & (samples_side - 1); };
  const std::array<float, 2>& place =
      sample_places[static_cast<std::size_t>(parity(y)) * samples_side + static_cast<std::size_t>(parity(x))];
  const auto pixel = [&](int k) {
    const int whole = (k - parity(k)) / samples_side;
    return static_cast<float>(whole);
  };
  Vec3f origin(pixel(x) + place[0] - 0.5F * static_cast<float>(options_.width),
               0.5F * static_cast<float>(options_.height) - pixel(y) - place[1], eye_);
  const Vec3f direction(0, 0, -1);
  Sample made;
  if (cut_ != nullptr) {
    const std::optional<float> start = cut_->begin_of_sight(origin);
    if (!start) return made;
    if (*start < eye_) {
      origin.z() = *start;
      if (const std::optional<CutScene::Inner> inner = cut_->inside_at(origin)) {
        made.yarn = inner->yarn;
        made.place = origin;
        made.look = {tinted(paints_[inner->yarn].color, inner->shared), cut_->normal()};
        made.is_cut = true;
        return made;
      }
    }
  }
  const std::optional<Hit> hit = scene_.nearest(origin, direction);
  if (!hit) return made;
  made.yarn = hit->yarn;
  made.place = origin + hit->distance * direction;
  made.look = look_at(skins_[hit->yarn], paints_[hit->yarn], *hit);
  made.look.color = tinted(made.look.color, inside_of(scene_, skins_, origin, direction, *hit));
  const auto in_pattern = [](int k) { return k & (pattern_side - 1); };
  if (!options_.flat) light(made, *hit, in_pattern(y) * pattern_side + in_pattern(x));
  return made;
}

// What is cut away casts no shadow.
bool Renderer::is_blocked(const Vec3f& origin, const Vec3f& direction, float reach) const {
  if (cut_ != nullptr) reach = std::min(reach, cut_->way_out(origin, direction));
  return reach > 0.0F && scene_.is_blocked(origin, direction, reach);
}

void Renderer::light(Sample& sample, const Hit& hit, int cell) const {
  constexpr float off_surface = 0.15F;  // pixels: more than the chord
  const Vec3f origin = sample.place + off_surface * hit.facing;
  const float reach = reach_in_sizes * static_cast<float>(skins_[hit.yarn].size);
  int free = 0;
  for (int ray = 0; ray < Patterns::rays_to_surroundings; ++ray)
    if (!is_blocked(origin, patterns_.to_surroundings(cell, ray, sample.look.normal), reach)) ++free;
  sample.surroundings = static_cast<float>(free) / Patterns::rays_to_surroundings;
  const Vec3f& to_lamp = patterns_.to_lamp(cell);
  const bool turned_away = sample.look.normal.dot(to_lamp) <= 0.0F;
  sample.lamp =
      turned_away || is_blocked(origin, to_lamp, std::numeric_limits<float>::infinity()) ? 0.0F : 1.0F;
}

// x, y: of the pixel's first sample in the tile's array. Samples are averaged nearly as the eye judges them,
// by their square roots: edges look smoother than with averages of light.
Light Renderer::pixel(const std::vector<Sample>& tile, int stride, int x, int y) const {
  constexpr float alike = 0.8F;  // cosine between normals that may share light
  constexpr float near_in_sizes = 0.5F;
  Light sum = Light::Zero();
  const auto at = [&](int i, int j) -> const Sample& {
    return tile[static_cast<std::size_t>(j) * static_cast<std::size_t>(stride) + static_cast<std::size_t>(i)];
  };
  for (int j = y; j < y + samples_side; ++j)
    for (int i = x; i < x + samples_side; ++i) {
      const Sample& own = at(i, j);
      if (own.yarn == Sample::nothing) {
        sum += background_.cwiseSqrt();
        continue;
      }
      if (own.is_cut) {
        constexpr float rim = 0.3F;
        bool is_rim = false;
        for (int l = j - window_before; l <= j + window_after; ++l)
          for (int k = i - window_before; k <= i + window_after; ++k)
            is_rim = is_rim || !at(k, l).is_cut || at(k, l).yarn != own.yarn;
        sum += ((is_rim ? rim : 1.0F) * own.look.color).cwiseSqrt();
        continue;
      }
      const float near = near_in_sizes * static_cast<float>(skins_[own.yarn].size);
      float surroundings = 0, lamp = 0;
      int count = 0;
      for (int l = j - window_before; l <= j + window_after; ++l)
        for (int k = i - window_before; k <= i + window_after; ++k) {
          const Sample& other = at(k, l);
          if (other.yarn != own.yarn || other.is_cut || std::abs(other.place.z() - own.place.z()) > near ||
              other.look.normal.dot(own.look.normal) < alike)
            continue;
          surroundings += other.surroundings;
          lamp += other.lamp;
          ++count;
        }
      const auto share = static_cast<float>(count);
      const float bright = brightness(own.look.normal, surroundings / share, lamp / share);
      sum += (bright * own.look.color).cwiseSqrt();
    }
  return (sum / (samples_side * samples_side)).cwiseAbs2();
}

void Renderer::draw_tile(int left, int top, int right, int bottom, Picture& picture) const {
  const int stride = (right - left) * samples_side + window_before + window_after;
  const int lines = (bottom - top) * samples_side + window_before + window_after;
  std::vector<Sample> tile;
  tile.reserve(static_cast<std::size_t>(stride) * static_cast<std::size_t>(lines));
  for (int j = 0; j < lines; ++j)
    for (int i = 0; i < stride; ++i)
      tile.push_back(sample(left * samples_side + i - window_before, top * samples_side + j - window_before));
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x)
      put(picture, x, y,
          pixel(tile, stride, (x - left) * samples_side + window_before,
                (y - top) * samples_side + window_before));
}

Result<std::vector<Skin>> make_skins(std::span<const yarn::Body> bodies, const Camera& camera, int threads) {
  std::vector<Skin> skins(bodies.size());
  std::vector<std::optional<Message>> failures(bodies.size());
  for_each_index(bodies.size(), threads, [&](std::size_t i) {
    Result<Skin> skin = make_skin(bodies[i], camera, chord);
    if (skin)
      skins[i] = std::move(*skin);
    else
      failures[i] = skin.error();
  });
  for (const std::optional<Message>& failure : failures)
    if (failure) return *failure;
  return skins;
}

}  // namespace

Result<Picture> render_yarns(std::span<const yarn::Body> bodies, const PictureOptions& options) {
  if (bodies.empty()) return error(Kind::geometry, "there is no yarn to show");
  const Camera camera(options.eye, bodies, options.width, options.height);
  const Result<std::vector<Skin>> skins = make_skins(bodies, camera, options.threads);
  if (!skins) return skins.error();
  const Result<Scene> scene = Scene::make(*skins);
  if (!scene) return scene.error();
  std::vector<Paint> paints;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    paints.push_back(paint_of(bodies[i], i, (*skins)[i], camera.pixels_per_unit()));
  std::optional<CutScene> cut;
  if (options.section) {
    if (Status status = check_section(*options.section, camera, *skins); !status.ok()) return status.error();
    cut.emplace(*options.section, camera, *scene, *skins);
  }

  Picture picture = blank_picture(options, camera);
  const Renderer renderer(options, *skins, paints, *scene, cut ? &*cut : nullptr);
  draw_tiles(options, [&](int left, int top, int right, int bottom) {
    renderer.draw_tile(left, top, right, bottom, picture);
  });
  return picture;
}

}  // namespace selvage::view::embree
