// Yarns that a plane cuts, in camera space. Internal to the module selvage_embree.
#pragma once

#include <optional>
#include <vector>

#include "core/diagnostics.h"
#include "view/embree/scene.h"
#include "view/embree/shading.h"
#include "view/picture.h"

namespace selvage::view::embree {

// Error (geometry): the plane cuts none of them.
Status check_section(const Section& section, const Camera& camera, const std::vector<Skin>& skins);

class CutScene {
 public:
  // `scene` and `skins` outlive it.
  CutScene(const Section& section, const Camera& camera, const Scene& scene, const std::vector<Skin>& skins);

  // Unit, toward what is cut away.
  [[nodiscard]] const Vec3f& normal() const { return normal_; }
  // z from where the line of sight through `point` goes through what is left; +infinity: all of it; none:
  // nothing of it.
  [[nodiscard]] std::optional<float> begin_of_sight(const Vec3f& point) const;
  // How far it is from there to what is cut away.
  [[nodiscard]] float way_out(const Vec3f& origin, const Vec3f& direction) const;

  // The yarn that holds a point, the first of several, and whether the point is in another one, or in another
  // part of the same one, too.
  struct Inner {
    std::uint32_t yarn = 0;
    Inside shared = Inside::nothing;
  };
  [[nodiscard]] std::optional<Inner> inside_at(const Vec3f& point) const;

 private:
  [[nodiscard]] float to_exit(const Vec3f& point, const Vec3f& direction, std::uint32_t a,
                              std::uint32_t b) const;
  [[nodiscard]] bool is_deep(const Vec3f& point, std::uint32_t a, std::uint32_t b) const;

  const Scene& scene_;
  const std::vector<Skin>& skins_;
  Vec3f normal_;
  float place_ = 0;                // normal_ . p of the plane's points
  Vec3f across_ = Vec3f::UnitZ();  // unit: the direction in which the yarns together are thinnest
};

}  // namespace selvage::view::embree
