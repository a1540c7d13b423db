#include "structured/yarn_columns.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/plane.h"
#include "structured/yarn_triangles.h"

namespace selvage::fem {
namespace {

// The x at which the edge between two vertices passes a line of constant y. The result does not depend on
// their order, so that the triangles on both sides of the edge agree on which side of it a line is.
double crossing_x(const Vec3& a, const Vec3& b, double y) {
  const bool ordered = a.y() < b.y();
  const Vec3 &low = ordered ? a : b, &high = ordered ? b : a;
  return low.x() + (y - low.y()) / (high.y() - low.y()) * (high.x() - low.x());
}

class Columns {
 public:
  Columns(std::span<const double> xs, std::span<const double> ys)
      : xs_(xs), ys_(ys), crossings_(xs.size() * ys.size()) {}

  void add(const YarnVertex& a, const YarnVertex& b, const YarnVertex& c) {
    const std::array<const YarnVertex*, 3> corners = {&a, &b, &c};
    const auto [low, high] = std::minmax({a.at.y(), b.at.y(), c.at.y()});
    const auto first = std::lower_bound(ys_.begin(), ys_.end(), low);
    const auto last = std::lower_bound(first, ys_.end(), high);  // y of the upper end does not count
    for (auto y = first; y != last; ++y) {
      // The line y cuts exactly two of the three edges (those that reach from below it to it or above).
      std::array<double, 2> ends{};
      int count = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &p = corners[k]->at, &q = corners[(k + 1) % 3]->at;
        if ((p.y() > *y) != (q.y() > *y) && count < 2)
          ends[static_cast<std::size_t>(count++)] = crossing_x(p, q, *y);
      }
      if (count < 2) continue;
      const auto [from, to] = std::minmax(ends[0], ends[1]);
      for (auto x = std::lower_bound(xs_.begin(), xs_.end(), from); x != xs_.end() && *x < to; ++x)
        meet(corners, static_cast<std::size_t>(x - xs_.begin()), static_cast<std::size_t>(y - ys_.begin()));
    }
  }

  std::vector<std::vector<Crossing>> finish() {
    for (auto& list : crossings_)
      std::sort(list.begin(), list.end(), [](const Crossing& a, const Crossing& b) { return a.z < b.z; });
    return std::move(crossings_);
  }

 private:
  void meet(const std::array<const YarnVertex*, 3>& corners, std::size_t i, std::size_t j) {
    const Vec3 &a = corners[0]->at, &b = corners[1]->at, &c = corners[2]->at;
    const Vec2 ab = (b - a).head<2>(), ac = (c - a).head<2>(), ap = Vec2(xs_[i], ys_[j]) - a.head<2>();
    const double whole = cross(ab, ac);
    double of_b = 1.0 / 3, of_c = 1.0 / 3;
    if (whole != 0) {
      of_b = std::clamp(cross(ap, ac) / whole, 0.0, 1.0);
      of_c = std::clamp(cross(ab, ap) / whole, 0.0, 1.0 - of_b);
    }
    const double of_a = 1 - of_b - of_c;
    crossings_[j * xs_.size() + i].push_back(
        {of_a * a.z() + of_b * b.z() + of_c * c.z(),
         of_a * corners[0]->v + of_b * corners[1]->v + of_c * corners[2]->v});
  }

  std::span<const double> xs_, ys_;
  std::vector<std::vector<Crossing>> crossings_;
};

}  // namespace

std::vector<std::vector<Crossing>> cross_yarn(const yarn::Body& body, std::span<const double> xs,
                                              std::span<const double> ys, double edge) {
  Columns result(xs, ys);
  triangulate_yarn(body, edge, edge, [&](const YarnVertex& a, const YarnVertex& b, const YarnVertex& c) {
    result.add(a, b, c);
  });
  return result.finish();
}

}  // namespace selvage::fem
