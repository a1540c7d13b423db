// The signed distance of points to one yarn's triangles.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "contact/gap_field.h"
#include "core/box_tree.h"

namespace selvage::contact {

class SkinDistance {
 public:
  // `skin` outlives this.
  explicit SkinDistance(const SkinMesh& skin);

  [[nodiscard]] const Box3& box() const { return box_; }

  // Signed, > 0 outside; none: nothing is nearer than `reach`, by its size.
  [[nodiscard]] std::optional<double> at(const Vec3& point, double reach) const;

  // The same to the triangles for which `is_wanted` holds, and of these only to what faces the point (or
  // turns its back to it): the border of a part of a skin is no place to be near to.
  template <class Wanted>
  [[nodiscard]] std::optional<double> to_part(const Vec3& point, double reach, double depth,
                                              const Wanted& is_wanted) const;

 private:
  // Where on the triangle: 0 inside, 1 to 3 on the edge after corner 0 to 2, 4 to 6 at corner 0 to 2.
  struct Foot {
    Vec3 point = Vec3::Zero();
    int feature = 0;
  };
  [[nodiscard]] Foot foot_on(std::uint32_t triangle, const Vec3& point) const;
  template <class Wanted, class Counts>
  [[nodiscard]] std::optional<double> nearest(const Vec3& point, double reach, const Wanted& is_wanted,
                                              const Counts& counts) const;
  [[nodiscard]] Vec3 normal(std::uint32_t triangle) const;  // unit; zero where it has no area
  // Unit, outward, of a place on the triangle. Zero where it has none, and at the border of an open skin.
  [[nodiscard]] Vec3 normal_at(std::uint32_t triangle, int feature) const;
  void find_neighbours();
  void find_corner_normals();

  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  const SkinMesh& skin_;
  Box3 box_;
  BoxTree tree_;
  std::vector<std::array<std::uint32_t, 3>> neighbours_;  // across the edge after each corner
  std::vector<Vec3> corner_normals_;                      // one a vertex
};

template <class Wanted, class Counts>
std::optional<double> SkinDistance::nearest(const Vec3& point, double reach, const Wanted& is_wanted,
                                            const Counts& counts) const {
  std::optional<double> found;
  tree_.near_point(point, reach, [&](std::uint32_t triangle) {
    const double best = found ? std::abs(*found) : reach;
    if (!is_wanted(triangle)) return best;
    const Foot foot = foot_on(triangle, point);
    const Vec3 way = point - foot.point;
    const double distance = way.norm();
    if (distance >= best) return best;
    const double height = way.dot(normal_at(triangle, foot.feature));
    if (!counts(distance, height)) return best;
    found = height < 0.0 ? -distance : distance;
    return distance;
  });
  return found;
}

template <class Wanted>
std::optional<double> SkinDistance::to_part(const Vec3& point, double reach, double depth,
                                            const Wanted& is_wanted) const {
  constexpr double least_cosine = 0.5;
  return nearest(point, reach, is_wanted, [&](double distance, double height) {
    return std::abs(height) >= least_cosine * distance && (height >= 0.0 || distance <= depth);
  });
}

}  // namespace selvage::contact
