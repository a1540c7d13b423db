// All skins of a picture in one Embree scene. Internal to the module selvage_embree.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "view/skin.h"

namespace selvage::view::embree {

// Where a ray meets a skin.
struct Hit {
  std::uint32_t yarn = 0;
  std::uint32_t facet = 0;
  float u = 0, v = 0;  // in the facet: along the columns, along the rows
  float distance = 0;
  Vec3f facing = Vec3f::Zero();  // the facet's own normal, outward, unit
};

class Scene {
 public:
  // `skins` outlive the scene. Error (limit): not enough memory.
  static Result<Scene> make(const std::vector<Skin>& skins);
  // One skin of triangles, whose facets these are; u and v of hits are the shares of the second and the third
  // corner.
  static Result<Scene> make(const std::vector<Vec3f>& points,
                            const std::vector<std::array<std::uint32_t, 3>>& triangles);

  // The nearest hit along `direction` (unit) farther than `beyond`.
  [[nodiscard]] std::optional<Hit> nearest(const Vec3f& origin, const Vec3f& direction,
                                           float beyond = 0) const;
  // Is there anything along `direction` (unit) nearer than `reach`?
  [[nodiscard]] bool is_blocked(const Vec3f& origin, const Vec3f& direction, float reach) const;

 private:
  template <auto Release>
  struct Releaser {
    template <class T>
    void operator()(T* handle) const {
      Release(handle);
    }
  };
  template <class Add>
  static Result<Scene> make_of(const Add& add);

  std::unique_ptr<RTCDeviceTy, Releaser<rtcReleaseDevice>> device_;
  std::unique_ptr<RTCSceneTy, Releaser<rtcReleaseScene>> scene_;
};

// The hits along a ray, the nearest first. Two facets of a skin that share an edge may both be hit there:
// that is one hit. Other skins are not one: those of yarns that touch lie nearer.
class Walk {
 public:
  // `scene` outlives it.
  Walk(const Scene& scene, Vec3f origin, Vec3f direction)
      : scene_(scene), origin_(std::move(origin)), direction_(std::move(direction)) {}
  // Behind a hit that is known.
  Walk(const Scene& scene, const Vec3f& origin, const Vec3f& direction, const Hit& first)
      : Walk(scene, origin, direction) {
    last_ = first;
  }
  std::optional<Hit> next();

 private:
  const Scene& scene_;
  Vec3f origin_, direction_;
  std::optional<Hit> last_;
};

}  // namespace selvage::view::embree
