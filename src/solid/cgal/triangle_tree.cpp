#include "solid/cgal/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace selvage::solid {

namespace {

constexpr std::uint32_t leaf_size = 6;

double square(double x) {
  return x * x;
}

Box3 box_of(const Triangle& t) {
  Box3 box(t[0]);
  box.extend(t[1]);
  box.extend(t[2]);
  return box;
}

void keep_nearer(Closest& best, const Vec3& p, const Vec3& q) {
  const double distance = (p - q).norm();
  if (distance < best.distance) best = {distance, p, q};
}

// Ericson, Real-Time Collision Detection (2005), 5.1.9: two segments.
void nearest_of_segments(const Vec3& p1, const Vec3& q1, const Vec3& p2, const Vec3& q2, Closest& best) {
  const Vec3 d1 = q1 - p1, d2 = q2 - p2, r = p1 - p2;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r);
  const double c = d1.dot(r), b = d1.dot(d2), denominator = a * e - b * b;
  double s = denominator > 0.0 ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
  double t = (b * s + f) / e;
  if (t < 0.0) {
    t = 0.0;
    s = std::clamp(-c / a, 0.0, 1.0);
  } else if (t > 1.0) {
    t = 1.0;
    s = std::clamp((b - c) / a, 0.0, 1.0);
  }
  keep_nearer(best, p1 + s * d1, p2 + t * d2);
}

// The foot of a point on a triangle's plane, where it lies inside the triangle (edges are done by the
// segments).
bool foot_inside(const Vec3& p, const Triangle& t, Vec3& foot) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], normal = ab.cross(ac);
  const double size = normal.squaredNorm();
  if (size == 0.0) return false;
  foot = p - normal * (normal.dot(p - t[0]) / size);
  return normal.dot((t[1] - t[0]).cross(foot - t[0])) >= 0.0 &&
         normal.dot((t[2] - t[1]).cross(foot - t[1])) >= 0.0 &&
         normal.dot((t[0] - t[2]).cross(foot - t[2])) >= 0.0;
}

}  // namespace

Closest closest(const Triangle& a, const Triangle& b) {
  Closest best{std::numeric_limits<double>::infinity(), a[0], b[0]};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) nearest_of_segments(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3], best);
  Vec3 foot;
  for (std::size_t i = 0; i < 3; ++i) {
    if (foot_inside(a[i], b, foot)) keep_nearer(best, a[i], foot);
    if (foot_inside(b[i], a, foot)) keep_nearer(best, foot, b[i]);
  }
  return best;
}

double winding_number(const Tessellation& skin, const Vec3& point) {
  double angle = 0.0;
  for (const auto& t : skin.triangles) {
    const Vec3 a = skin.vertices[t[0]] - point, b = skin.vertices[t[1]] - point,
               c = skin.vertices[t[2]] - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle +=
        2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4.0 * std::numbers::pi);
}

TriangleTree::TriangleTree(const Tessellation& skin) : skin_(&skin), order_(skin.triangles.size()) {
  if (order_.empty()) return;
  std::iota(order_.begin(), order_.end(), 0U);
  std::vector<Vec3> centres;
  centres.reserve(order_.size());
  for (std::uint32_t k = 0; k < order_.size(); ++k) centres.push_back(box_of(triangle(k)).center());
  nodes_.push_back({Box3(), 0, static_cast<std::uint32_t>(order_.size())});
  split(0, centres);
  nodes_.shrink_to_fit();  // thousands of these are kept at a time
}

Triangle TriangleTree::triangle(std::uint32_t k) const {
  const auto& t = skin_->triangles[k];
  return {skin_->vertices[t[0]], skin_->vertices[t[1]], skin_->vertices[t[2]]};
}

void TriangleTree::split(std::uint32_t node, std::vector<Vec3>& centres) {
  const std::uint32_t first = nodes_[node].first, count = nodes_[node].count;
  Box3 box, spread;
  for (std::uint32_t k = first; k < first + count; ++k) {
    box.extend(box_of(triangle(order_[k])));
    spread.extend(centres[order_[k]]);
  }
  nodes_[node].box = box;
  if (count <= leaf_size) return;
  Eigen::Index axis = 0;
  spread.diagonal().maxCoeff(&axis);
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count,
                   [&](std::uint32_t x, std::uint32_t y) { return centres[x][axis] < centres[y][axis]; });
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({Box3(), first, count / 2});
  nodes_.push_back({Box3(), first + count / 2, count - count / 2});
  nodes_[node].first = left;
  nodes_[node].count = 0;
  split(left, centres);
  split(left + 1, centres);
}

// Visits the pairs of leaves whose boxes are no farther apart than `reach`, which `visit` may lower, the
// nearer child first.
template <class Visit>
void TriangleTree::descend(const TriangleTree& a, const TriangleTree& b, const double& reach,
                           const Visit& visit) {
  if (a.is_empty() || b.is_empty()) return;
  struct Step {
    std::uint32_t a, b;
    double distance2;
  };
  const auto between = [&](std::uint32_t i, std::uint32_t j) {
    return Step{i, j, a.nodes_[i].box.squaredExteriorDistance(b.nodes_[j].box)};
  };
  std::vector<Step> stack = {between(0, 0)};
  while (!stack.empty()) {
    const Step step = stack.back();
    stack.pop_back();
    if (step.distance2 > square(reach)) continue;
    const Node &na = a.nodes_[step.a], &nb = b.nodes_[step.b];
    if (na.count > 0 && nb.count > 0) {
      visit(na, nb);
      continue;
    }
    const bool open_a =
        nb.count > 0 || (na.count == 0 && na.box.volume() + na.box.diagonal().squaredNorm() >=
                                              nb.box.volume() + nb.box.diagonal().squaredNorm());
    Step one = open_a ? between(na.first, step.b) : between(step.a, nb.first);
    Step two = open_a ? between(na.first + 1, step.b) : between(step.a, nb.first + 1);
    if (one.distance2 < two.distance2) std::swap(one, two);
    stack.push_back(one);
    stack.push_back(two);
  }
}

std::vector<TriangleTree::Pair> TriangleTree::near_pairs(const TriangleTree& a, const TriangleTree& b,
                                                         double reach) {
  std::vector<Pair> pairs;
  descend(a, b, reach, [&](const Node& na, const Node& nb) {
    for (std::uint32_t i = na.first; i < na.first + na.count; ++i) {
      const Triangle ta = a.triangle(a.order_[i]);
      const Box3 box = box_of(ta);
      if (box.squaredExteriorDistance(nb.box) > square(reach)) continue;
      for (std::uint32_t j = nb.first; j < nb.first + nb.count; ++j) {
        const Triangle tb = b.triangle(b.order_[j]);
        const Box3 other = box_of(tb);
        if (box.squaredExteriorDistance(other) > square(reach)) continue;
        if (box.intersects(other) && do_meet(ta, tb)) {
          pairs.push_back({a.order_[i], b.order_[j], 0.0});
          continue;
        }
        const double distance = closest(ta, tb).distance;
        if (distance <= reach) pairs.push_back({a.order_[i], b.order_[j], std::max(distance, 1e-300)});
      }
    }
  });
  std::sort(pairs.begin(), pairs.end(),
            [](const Pair& x, const Pair& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  return pairs;
}

TriangleTree::Pair TriangleTree::nearest_pair(const TriangleTree& a, const TriangleTree& b, double limit) {
  Pair best{0, 0, std::numeric_limits<double>::infinity()};
  double reach = limit;
  descend(a, b, reach, [&](const Node& na, const Node& nb) {
    for (std::uint32_t i = na.first; i < na.first + na.count; ++i) {
      const Triangle ta = a.triangle(a.order_[i]);
      const Box3 box = box_of(ta);
      if (box.squaredExteriorDistance(nb.box) > square(reach)) continue;
      for (std::uint32_t j = nb.first; j < nb.first + nb.count; ++j) {
        const Triangle tb = b.triangle(b.order_[j]);
        if (box.squaredExteriorDistance(box_of(tb)) > square(reach)) continue;
        const double distance = closest(ta, tb).distance;
        if (distance > reach || distance >= best.distance) continue;
        best = {a.order_[i], b.order_[j], distance};
        reach = distance;
      }
    }
  });
  return best;
}

}  // namespace selvage::solid
