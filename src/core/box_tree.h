// A tree of boxes: which of them are near each other.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/vec.h"

namespace selvage {

// Of triangles, each by the numbers of its corners.
template <class Triangles>
std::vector<Box3> boxes_of(const std::vector<Vec3>& points, const Triangles& triangles) {
  std::vector<Box3> boxes(triangles.size());
  for (std::size_t k = 0; k < boxes.size(); ++k)
    for (const auto corner : triangles[k]) boxes[k].extend(points[corner]);
  return boxes;
}

class BoxTree {
 public:
  // A leaf holds up to `leaf_size` boxes: fewer where looking at a box is much work.
  explicit BoxTree(std::vector<Box3> boxes, std::uint32_t leaf_size = 4);

  // As many boxes as before, for what has moved: the tree keeps its structure.
  void refit(std::vector<Box3> boxes);
  [[nodiscard]] const Box3& box(std::uint32_t i) const { return boxes_[i]; }

  // Calls visit(i, j), i < j, once for each pair of boxes no farther apart than `reach`, in an order that
  // depends on the boxes alone.
  template <class Visit>
  void near_pairs(double reach, const Visit& visit) const;

  // The same of a box of this tree and one of another, which is moved by `shift` first: visit(i, j), each
  // pair once.
  template <class Visit>
  void near_pairs(const BoxTree& other, const Vec3& shift, double reach, const Visit& visit) const;

  // Calls visit(i) for each box that holds `point`, and for each that the ray from it along +x meets.
  template <class Visit>
  void along_ray(const Vec3& point, const Visit& visit) const;

  // Calls visit(i) for each box that meets this one, in an order that depends on the structure alone.
  template <class Visit>
  void meeting(const Box3& box, const Visit& visit) const {
    walk([&](const Box3& other) { return other.intersects(box); }, visit);
  }

  // Calls visit(i) for each box no farther from `point` than `reach`, about the nearest first; what it gives
  // is the reach from there on.
  template <class Visit>
  void near_point(const Vec3& point, double reach, const Visit& visit) const;

 private:
  struct Node {
    Box3 box;
    std::uint32_t first = 0;  // leaf: into order_; else the left child, the right one follows it
    std::uint32_t count = 0;  // 0: not a leaf
  };
  void split(std::uint32_t node);
  template <bool alone, class Visit>
  void descend(const BoxTree& other, const Vec3& shift, double reach, const Visit& visit) const;
  template <class Meets, class Visit>
  void walk(const Meets& meets, const Visit& visit) const;
  // Halves of halves: no deeper than the number of boxes has bits.
  static constexpr std::size_t most_deep = 72;

  std::vector<Box3> boxes_;
  std::uint32_t leaf_size_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

template <class Visit>
void BoxTree::near_pairs(double reach, const Visit& visit) const {
  descend<true>(*this, Vec3::Zero(), reach, [&](std::uint32_t i, std::uint32_t j) {
    const auto [x, y] = std::minmax(i, j);
    visit(x, y);
  });
}

template <class Visit>
void BoxTree::near_pairs(const BoxTree& other, const Vec3& shift, double reach, const Visit& visit) const {
  descend<false>(other, shift, reach, visit);
}

// `alone`: the other tree is this one, and each pair of its boxes is met once.
template <bool alone, class Visit>
void BoxTree::descend(const BoxTree& other, const Vec3& shift, double reach, const Visit& visit) const {
  if (nodes_.empty() || other.nodes_.empty()) return;
  const auto is_near = [&](const Box3& a, const Box3& b) {
    return a.squaredExteriorDistance(Box3(b.min() + shift, b.max() + shift)) <= reach * reach;
  };
  thread_local std::vector<std::pair<std::uint32_t, std::uint32_t>> stack;
  const std::size_t bottom = stack.size();  // what is visited may ask another tree
  stack.emplace_back(0U, 0U);
  while (stack.size() > bottom) {
    const auto [m, n] = stack.back();
    stack.pop_back();
    const Node &a = nodes_[m], &b = other.nodes_[n];
    const bool is_same = alone && m == n;
    if (!is_same && !is_near(a.box, b.box)) continue;
    if (is_same && a.count == 0) {
      stack.emplace_back(a.first, a.first);
      stack.emplace_back(a.first + 1, a.first + 1);
      stack.emplace_back(a.first, a.first + 1);
    } else if (a.count > 0 && b.count > 0) {
      for (std::uint32_t i = a.first; i < a.first + a.count; ++i)
        for (std::uint32_t j = is_same ? i + 1 : b.first; j < b.first + b.count; ++j)
          if (is_near(boxes_[order_[i]], other.boxes_[other.order_[j]])) visit(order_[i], other.order_[j]);
    } else if (b.count > 0 ||
               (a.count == 0 && a.box.diagonal().squaredNorm() >= b.box.diagonal().squaredNorm())) {
      stack.emplace_back(a.first, n);
      stack.emplace_back(a.first + 1, n);
    } else {
      stack.emplace_back(m, b.first);
      stack.emplace_back(m, b.first + 1);
    }
  }
}

template <class Meets, class Visit>
void BoxTree::walk(const Meets& meets, const Visit& visit) const {
  if (nodes_.empty()) return;
  std::array<std::uint32_t, most_deep> stack{};
  std::size_t depth = 1;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (!meets(node.box)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first + 1;
      stack[depth++] = node.first;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      if (meets(boxes_[order_[i]])) visit(order_[i]);
  }
}

template <class Visit>
void BoxTree::along_ray(const Vec3& point, const Visit& visit) const {
  walk(
      [&](const Box3& box) {
        return box.max().x() >= point.x() && box.min().y() <= point.y() && box.max().y() >= point.y() &&
               box.min().z() <= point.z() && box.max().z() >= point.z();
      },
      visit);
}

template <class Visit>
void BoxTree::near_point(const Vec3& point, double reach, const Visit& visit) const {
  if (nodes_.empty()) return;
  struct Entry {
    double distance;  // squared
    std::uint32_t node;
  };
  std::array<Entry, most_deep> stack{};
  std::size_t depth = 0;
  stack[depth++] = {nodes_[0].box.squaredExteriorDistance(point), 0U};
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.distance > reach * reach) continue;
    const Node& node = nodes_[entry.node];
    if (node.count == 0) {
      Entry near{nodes_[node.first].box.squaredExteriorDistance(point), node.first},
          far{nodes_[node.first + 1].box.squaredExteriorDistance(point), node.first + 1};
      if (far.distance < near.distance) std::swap(near, far);
      stack[depth++] = far;
      stack[depth++] = near;
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
      if (boxes_[order_[i]].squaredExteriorDistance(point) <= reach * reach) reach = visit(order_[i]);
  }
}

}  // namespace selvage
