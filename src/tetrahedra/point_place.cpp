#include "tetrahedra/point_place.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tetrahedra/tet_complex.h"

namespace selvage::fem {
namespace {

constexpr double degree = std::numbers::pi / 180;

// The shortest vector in the convex hull (Gilbert's method: toward the extreme one, over and over).
Vec3 shortest_in_hull(const std::vector<Vec3>& vectors) {
  Vec3 best = vectors.front();
  for (int step = 0; step < 25; ++step) {
    const Vec3* extreme = &vectors.front();
    for (const Vec3& v : vectors)
      if (v.dot(best) < extreme->dot(best)) extreme = &v;
    const Vec3 way = best - *extreme;
    const double square = way.squaredNorm();
    if (square <= 1e-24 * best.squaredNorm() || best.dot(way) <= 1e-3 * best.squaredNorm()) break;
    best -= std::min(1.0, best.dot(way) / square) * way;
  }
  return best;
}

double distance_to_line(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  return (p - a).cross(ab).norm() / ab.norm();
}

// The smallest tet_quality of the point over the sides, or any value at most `enough` when it falls below
// that.
double star_quality(const Vec3& at, std::span<const StarSide> sides, double enough) {
  double least = 1;
  for (const StarSide& side : sides) {
    least = std::min(least, tet_quality(at, side[0], side[1], side[2]));
    if (least <= enough) break;
  }
  return least;
}

}  // namespace

// The angles of the tetrahedra of quality less than `below`, and how they change with the point.
void PointPlace::measure(const Vec3& at, std::span<const StarSide> sides, double below, const Vec3& normal) {
  angles_.clear();
  for (std::size_t s = 0; s < sides.size(); ++s) {
    if (qualities_[s] > below) continue;
    std::array<Vec3, 3> out;  // outward unit normals of the sides at the point, opposite each corner
    const StarSide& x = sides[s];
    for (std::size_t k = 0; k < 3; ++k)
      out[k] = (x[(k + 2) % 3] - at).cross(x[(k + 1) % 3] - at).normalized();
    const Vec3 base = (x[1] - x[0]).cross(x[2] - x[0]).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = x[k], &b = x[(k + 1) % 3], &c = x[(k + 2) % 3];
      // At the edge b c the point turns about it.
      const double fixed_edge = std::acos(std::clamp(-base.dot(out[k]), -1.0, 1.0));
      angles_.push_back({fixed_edge, out[k] / distance_to_line(at, b, c)});
      // At the edge from the point to a, as if b and c moved the other way, each by its share.
      const Vec3 &out_b = out[(k + 1) % 3], &out_c = out[(k + 2) % 3];
      const double own_edge = std::acos(std::clamp(-out_b.dot(out_c), -1.0, 1.0));
      const Vec3 edge = a - at;
      const double square = edge.squaredNorm();
      const double share_b = (b - at).dot(edge) / square, share_c = (c - at).dot(edge) / square;
      angles_.push_back({own_edge, -(1 - share_b) / distance_to_line(b, at, a) * out_c -
                                       (1 - share_c) / distance_to_line(c, at, a) * out_b});
    }
  }
  for (Angle& angle : angles_) angle.slope -= normal.dot(angle.slope) * normal;
}

double PointPlace::improve(Vec3& at, std::span<const StarSide> sides, double goal, const Vec3& normal) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const StarSide& side : sides)
    for (const Vec3& corner : side) shortest = std::min(shortest, (corner - at).norm());
  double now = inverted_quality;
  for (int step = 0; step < 12; ++step) {
    qualities_.clear();
    for (const StarSide& side : sides) qualities_.push_back(tet_quality(at, side[0], side[1], side[2]));
    now = *std::min_element(qualities_.begin(), qualities_.end());
    if (now >= goal || now <= inverted_quality) break;
    const double least = angle_of_quality(now);
    measure(at, sides, quality_of_angle(least + 12), normal);
    active_.clear();
    for (const Angle& angle : angles_)
      if (angle.value <= (least * 1.03 + 0.1) * degree) active_.push_back(angle.slope);
    if (active_.empty()) break;
    const Vec3 way = shortest_in_hull(active_);
    const double rise = way.squaredNorm();
    if (!(rise * shortest * shortest > 1e-12) || !std::isfinite(rise)) break;  // no way up
    // As far as another angle becomes the smallest one.
    double length = 0.3 * shortest / std::sqrt(rise);
    for (const Angle& angle : angles_) {
      const double slope = angle.slope.dot(way);
      if (slope < 0.9 * rise) length = std::min(length, (angle.value - least * degree) / (rise - slope));
    }
    length = std::max(length, 1e-3 * shortest / std::sqrt(rise));
    bool better = false;
    for (int halving = 0; halving < 5 && !better; ++halving, length /= 2) {
      const Vec3 place = at + length * way;
      const double value = star_quality(place, sides, now);
      if (value <= now) continue;
      better = true;
      at = place;
      if (angle_of_quality(value) < least + 0.02) return value;
      now = value;
    }
    if (!better) break;
  }
  return now;
}

}  // namespace selvage::fem
