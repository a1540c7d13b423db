// The shape of a yarn's end face over the mean plane of its rim.
#pragma once

#include <optional>
#include <vector>

#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::fem {

class EndCap {
 public:
  // `rim` runs counter-clockwise seen from outside the yarn (at least 3 points that enclose an area); `face`
  // outlives this.
  EndCap(const std::vector<Vec3>& rim, const yarn::EndFace& face);

  [[nodiscard]] const std::vector<Vec2>& rim() const { return rim_; }
  [[nodiscard]] bool is_flat() const { return is_flat_; }
  // Coordinates in the mean plane.
  [[nodiscard]] Vec2 project(const Vec3& point) const;
  // The point of the end face above a point of the plane: on the patch or fan where there is one; otherwise
  // at a height blended from the rim's (mean value coordinates: Floater 2003), which is the plane itself for
  // a flat rim.
  [[nodiscard]] Vec3 lift(const Vec2& point) const;

 private:
  [[nodiscard]] std::optional<double> surface_height(const Vec2& point) const;
  [[nodiscard]] double blended_height(const Vec2& point) const;

  const yarn::EndFace* face_;
  Vec3 origin_, across_, up_, normal_;
  std::vector<Vec2> rim_;
  std::vector<double> heights_;
  double extent_ = 0;  // of the rim, from its middle
  bool is_flat_ = false;
  std::vector<Vec2> seeds_, seed_places_;  // (s, t) on the surface and where they are in the plane
};

}  // namespace selvage::fem
