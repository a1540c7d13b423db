// A tree of boxes over a skin's triangles: which triangles of two skins are near each other.
#pragma once

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/vec.h"
#include "solid/cgal/verdict.h"
#include "solid/tessellation.h"

namespace selvage::solid {

class TriangleTree {
 public:
  // `skin` outlives the tree.
  explicit TriangleTree(const Tessellation& skin);

  [[nodiscard]] bool is_empty() const { return nodes_.empty(); }
  [[nodiscard]] const Box3& box() const { return nodes_.front().box; }
  [[nodiscard]] const Tessellation& skin() const { return *skin_; }
  [[nodiscard]] Triangle triangle(std::uint32_t k) const;

  struct Pair {
    std::uint32_t a = 0, b = 0;  // triangles of the first and the second skin
    double distance = 0;         // 0: they meet (exactly)
  };

  // All pairs of triangles no farther apart than `reach`, in the order of the first tree.
  static std::vector<Pair> near_pairs(const TriangleTree& a, const TriangleTree& b, double reach);

  // The nearest pair that is nearer than `limit`; its distance is infinite when there is none. For skins that
  // do not meet.
  static Pair nearest_pair(const TriangleTree& a, const TriangleTree& b,
                           double limit = std::numeric_limits<double>::infinity());

 private:
  struct Node {
    Box3 box;
    std::uint32_t first = 0;  // leaf: into order_; else the left child, the right one follows it
    std::uint32_t count = 0;  // 0: not a leaf
  };
  void split(std::uint32_t node, std::vector<Vec3>& centres);
  template <class Visit>
  static void descend(const TriangleTree& a, const TriangleTree& b, const double& reach, const Visit& visit);

  const Tessellation* skin_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

// The least distance of two triangles that do not meet, and where it is.
struct Closest {
  double distance = 0;
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();
};
Closest closest(const Triangle& a, const Triangle& b);

// How often the skin goes round the point: 1 inside a closed outward skin, 0 outside (van Oosterom and
// Strackee 1983).
double winding_number(const Tessellation& skin, const Vec3& point);

}  // namespace selvage::solid
