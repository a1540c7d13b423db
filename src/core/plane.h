// Polygons in the plane: their corners in order, the first one not repeated.
#pragma once

#include <cstddef>
#include <vector>

#include "core/vec.h"

namespace selvage {

// Twice the area of the triangle 0, a, b: positive where b lies to the left of a.
inline double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Positive: counter-clockwise. Rounding grows with the square of the distance from `origin`.
inline double twice_area(const std::vector<Vec2>& polygon, const Vec2& origin = Vec2::Zero()) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    sum += cross(polygon[i] - origin, polygon[(i + 1) % polygon.size()] - origin);
  return sum;
}

// Whether the ray from `p` along +x meets the side from a to b. Of the two sides at a corner that it meets
// either one counts, or both or neither where it does not pass from one side of the polygon to the other.
inline bool ray_meets(const Vec2& p, const Vec2& a, const Vec2& b) {
  if ((a.y() > p.y()) == (b.y() > p.y())) return false;
  return p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
}

inline bool contains(const std::vector<Vec2>& polygon, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    if (ray_meets(p, polygon[i], polygon[(i + 1) % polygon.size()])) inside = !inside;
  return inside;
}

inline constexpr std::size_t no_polygon = static_cast<std::size_t>(-1);

// Of polygons that bound regions of the plane together, the outer one of each one's region: itself where it
// runs counter-clockwise; of a hole the smallest of these that holds its first corner (no_polygon: none).
inline std::vector<std::size_t> outer_polygons(const std::vector<std::vector<Vec2>>& polygons) {
  std::vector<double> areas;
  areas.reserve(polygons.size());
  for (const auto& polygon : polygons) areas.push_back(twice_area(polygon, polygon.front()));
  std::vector<std::size_t> result(polygons.size(), no_polygon);
  for (std::size_t i = 0; i < polygons.size(); ++i)
    for (std::size_t k = 0; k < polygons.size(); ++k)
      if (areas[i] > 0 ? k == i
                       : areas[k] > 0 && contains(polygons[k], polygons[i].front()) &&
                             (result[i] == no_polygon || areas[k] < areas[result[i]]))
        result[i] = k;
  return result;
}

}  // namespace selvage
