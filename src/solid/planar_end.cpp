#include "solid/planar_end.h"

#include <algorithm>

#include "core/plane.h"

namespace selvage::solid {

namespace {

// Twice the area over the square of the longest side: 0.87 for the best shape, 0 or less for one that is no
// ear.
double shape(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return longest > 0.0 ? cross(b - a, c - a) / longest : 0.0;
}

bool holds(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& p) {
  return cross(b - a, p - a) >= 0.0 && cross(c - b, p - b) >= 0.0 && cross(a - c, p - c) >= 0.0;
}

class EarClipper {
 public:
  explicit EarClipper(const std::vector<Vec2>& polygon)
      : points_(polygon), next_(polygon.size()), previous_(polygon.size()), shapes_(polygon.size(), 0.0) {
    const std::size_t n = polygon.size();
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
    for (std::size_t i = 0; i < n; ++i) judge(i);
  }

  std::vector<std::array<std::size_t, 3>> run() {
    std::vector<std::array<std::size_t, 3>> triangles;
    for (std::size_t left = points_.size(); left >= 3; --left) {
      std::size_t best = best_ear();
      if (shapes_[best] <= flat) {  // what stood in an ear may be gone by now
        for (std::size_t i = 0; i < points_.size(); ++i)
          if (shapes_[i] >= 0.0) judge(i);
        best = best_ear();
        if (shapes_[best] <= flat) return {};
      }
      const std::size_t before = previous_[best], after = next_[best];
      triangles.push_back({before, best, after});
      next_[before] = after;
      previous_[after] = before;
      shapes_[best] = -1.0;
      if (left == 3) break;
      judge(before);
      judge(after);
    }
    return triangles;
  }

 private:
  // Three points in a row up to rounding make no ear: on a straight side the middle one waits for a better
  // partner.
  static constexpr double flat = 1e-12;

  [[nodiscard]] std::size_t best_ear() const {
    return static_cast<std::size_t>(std::max_element(shapes_.begin(), shapes_.end()) - shapes_.begin());
  }

  // The shape of the ear at point i; 0 when it is not one now.
  void judge(std::size_t i) {
    const std::size_t before = previous_[i], after = next_[i];
    const Vec2 &a = points_[before], &b = points_[i], &c = points_[after];
    double value = shape(a, b, c);
    for (std::size_t k = next_[after]; value > 0.0 && k != before; k = next_[k])
      if (holds(a, b, c, points_[k])) value = 0.0;
    shapes_[i] = std::max(value, 0.0);
  }

  const std::vector<Vec2>& points_;
  std::vector<std::size_t> next_, previous_;
  std::vector<double> shapes_;  // -1: clipped
};

}  // namespace

std::vector<std::array<std::size_t, 3>> triangulate(const std::vector<Vec2>& polygon) {
  if (polygon.size() < 3) return {};
  return EarClipper(polygon).run();
}

}  // namespace selvage::solid
