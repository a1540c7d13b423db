#include "view/embree/mesh_render.h"

#include <algorithm>
#include <cmath>

#include "view/color_scale.h"
#include "view/embree/scene.h"
#include "view/embree/shading.h"
#include "view/embree/tiles.h"

namespace selvage::view::embree {

namespace {

class MeshRenderer {
 public:
  MeshRenderer(const MeshSurface& surface, const PictureOptions& options, std::vector<Vec3f> points,
               const Scene& scene)
      : surface_(surface),
        options_(options),
        points_(std::move(points)),
        scene_(scene),
        background_(linear(options.background)) {
    for (const Vec3f& p : points_) eye_ = std::max(eye_, p.z() + 1.0F);
  }

  void draw_tile(int left, int top, int right, int bottom, Picture& picture) const {
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        Light sum = Light::Zero();
        for (const std::array<float, 2>& place : sample_places)
          sum += sample(static_cast<float>(x) + place[0], static_cast<float>(y) + place[1]).cwiseSqrt();
        put(picture, x, y, (sum / static_cast<float>(sample_places.size())).cwiseAbs2());
      }
  }

 private:
  // x, y: pixels from the upper left.
  [[nodiscard]] Light sample(float x, float y) const {
    const Vec3f origin(x - 0.5F * static_cast<float>(options_.width),
                       0.5F * static_cast<float>(options_.height) - y, eye_);
    const std::optional<Hit> hit = scene_.nearest(origin, Vec3f(0, 0, -1));
    if (!hit) return background_;
    return edge_light(*hit) * (options_.flat ? 1.0F : facing_light(hit->facing)) * color_at(*hit);
  }

  [[nodiscard]] Light color_at(const Hit& hit) const {
    if (surface_.values.empty()) return linear(surface_.colors[hit.facet]);
    double value = 0;
    if (surface_.values_are_of_points) {
      const auto& corners = surface_.triangles[hit.facet];
      value = (1.0 - hit.u - hit.v) * surface_.values[corners[0]] + hit.u * surface_.values[corners[1]] +
              hit.v * surface_.values[corners[2]];
    } else {
      value = surface_.values[hit.facet];
    }
    return linear(scale_color((value - surface_.low) / (surface_.high - surface_.low)));
  }

  static float facing_light(Vec3f normal) {
    constexpr float least = 0.5F;
    if (normal.z() < 0) normal = -normal;
    const float lit = normal.dot(lamp_direction()) / lamp_direction().z();
    return least + (1 - least) * std::clamp(lit, 0.0F, 1.0F);
  }

  // Edges of elements are dark lines, a pixel wide, that fade where triangles are smaller than a few pixels.
  [[nodiscard]] float edge_light(const Hit& hit) const {
    constexpr float half_width = 0.6F, smallest = 4, large = 14, darkest = 0.45F;
    const std::array<float, 3> shares = {1.0F - hit.u - hit.v, hit.u, hit.v};
    const auto& corners = surface_.triangles[hit.facet];
    const auto flat = [&](std::size_t k) -> Eigen::Vector2f { return points_[corners[k % 3]].head<2>(); };
    const Eigen::Vector2f a = flat(1) - flat(0), b = flat(2) - flat(0);
    const float twice_area = std::abs(a.x() * b.y() - a.y() * b.x());
    float nearest = large, height = large;
    for (std::size_t k = 0; k < 3; ++k) {
      if (surface_.inner[hit.facet] == k + 1) continue;
      const float length = (flat(k + 2) - flat(k + 1)).norm();
      if (!(length > 0.0F)) continue;
      nearest = std::min(nearest, shares[k] * twice_area / length);
      height = std::min(height, twice_area / length);
    }
    if (nearest > half_width) return 1;
    return 1 - (1 - darkest) * std::clamp((height - smallest) / (large - smallest), 0.0F, 1.0F);
  }

  const MeshSurface& surface_;
  const PictureOptions& options_;
  std::vector<Vec3f> points_;  // camera space
  const Scene& scene_;
  Light background_;
  float eye_ = 0;  // z from where all rays start
};

}  // namespace

Result<Picture> render_mesh(const MeshSurface& surface, const PictureOptions& options) {
  if (surface.triangles.empty()) return error(Kind::geometry, "there is no surface to show");
  const Camera camera(options.eye, surface.points, options.width, options.height);
  std::vector<Vec3f> points;
  points.reserve(surface.points.size());
  for (const Vec3& p : surface.points) {
    points.emplace_back(camera.to_picture(p).cast<float>());
    if (!points.back().allFinite()) return error(Kind::geometry, "a point of the mesh is not finite");
  }
  const Result<Scene> scene = Scene::make(points, surface.triangles);
  if (!scene) return scene.error();
  Picture picture = blank_picture(options, camera);
  const MeshRenderer renderer(surface, options, std::move(points), *scene);
  draw_tiles(options, [&](int left, int top, int right, int bottom) {
    renderer.draw_tile(left, top, right, bottom, picture);
  });
  return picture;
}

}  // namespace selvage::view::embree
