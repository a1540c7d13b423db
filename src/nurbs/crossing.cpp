// find_crossing: does a closed outline of Beziers cross itself?
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/plane.h"
#include "nurbs/bezier.h"

namespace selvage::nurbs {

namespace {

constexpr double relative_touch = 1e-9;  // of the outline's size

// A part of one curve of the outline.
struct Part {
  Bezier curve;
  Box2 box;  // of the control points
  bool is_flat = false;

  Part(const Bezier& points, double touch) : curve(points) {
    for (const Vec2& p : points) box.extend(p);
    // The curve keeps within the distance of its inner control points from the evenly run chord.
    const Bezier even = straight_bezier(points[0], points[3]);
    is_flat = std::max((points[1] - even[1]).norm(), (points[2] - even[2]).norm()) <= touch;
  }
  [[nodiscard]] const Vec2& first() const { return curve[0]; }
  [[nodiscard]] const Vec2& last() const { return curve[3]; }
  [[nodiscard]] std::array<Part, 2> halves(double touch) const {
    const auto& [a, b, c, d] = curve;
    const Vec2 ab = 0.5 * (a + b), bc = 0.5 * (b + c), cd = 0.5 * (c + d);
    const Vec2 left = 0.5 * (ab + bc), right = 0.5 * (bc + cd), middle = 0.5 * (left + right);
    return {Part({a, ab, left, middle}, touch), Part({middle, right, cd, d}, touch)};
  }
};

// The common ends of two parts: of a's last point with b's first, and of a's first with b's last.
struct Joints {
  bool a_to_b = false, b_to_a = false;
};

// The directions in which the part leaves `apex`, one of its ends, as angles about `middle`; false: they
// spread over a half circle or more.
struct Cone {
  double middle = 0, low = 0, high = 0;
};
bool cone_of(const Part& part, const Vec2& apex, Cone& cone) {
  Vec2 sum = Vec2::Zero();
  for (const Vec2& p : part.curve)
    if (p != apex) sum += (p - apex).normalized();
  if (sum.norm() < 1e-6) return false;
  cone = {std::atan2(sum.y(), sum.x()), 0.0, 0.0};
  for (const Vec2& p : part.curve) {
    if (p == apex) continue;
    const double angle = std::atan2(cross(sum, p - apex), sum.dot(p - apex));
    cone.low = std::min(cone.low, angle);
    cone.high = std::max(cone.high, angle);
  }
  return cone.high - cone.low < std::numbers::pi;
}

// True when two parts that leave one point in different directions have no other point in common.
bool only_meet_at(const Vec2& apex, const Part& a, const Part& b) {
  constexpr double sure = 1e-12;
  Cone of_a, of_b;
  if (!cone_of(a, apex, of_a) || !cone_of(b, apex, of_b)) return false;
  constexpr double turn = 2.0 * std::numbers::pi;
  const double apart = of_b.middle - of_a.middle;
  for (double way : {apart - turn, apart, apart + turn})
    if (way + of_b.low > of_a.high + sure && way + of_b.high < of_a.low + turn - sure) return true;
  return false;
}

// Where the chords of two flat parts meet or come nearer than `touch`.
std::optional<Vec2> meeting(const Part& a, const Part& b, double touch) {
  const Vec2 u = a.last() - a.first(), v = b.last() - b.first(), w = b.first() - a.first();
  const double area = cross(u, v);
  if (area != 0.0) {
    const double s = cross(w, v) / area, t = cross(w, u) / area;
    if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0) return a.first() + s * u;
  }
  for (const auto& [ends, chord] : {std::pair(&b, &a), std::pair(&a, &b)})
    for (const Vec2& p : {ends->first(), ends->last()}) {
      const Vec2 &from = chord->first(), &to = chord->last();
      const Vec2 foot = from + nearest_share(p, from, to) * (to - from);
      if ((p - foot).norm() <= touch) return foot;
    }
  return std::nullopt;
}

class Search {
 public:
  explicit Search(double touch) : touch_(touch) {}

  [[nodiscard]] Part part(const Bezier& curve) const { return {curve, touch_}; }

  // Where do a and b meet beside their joints?
  [[nodiscard]] std::optional<Vec2> between(const Part& a, const Part& b, Joints joints) const {
    if (!reach(a.box, b.box)) return std::nullopt;
    const bool joined = joints.a_to_b || joints.b_to_a;
    if (joints.a_to_b != joints.b_to_a && only_meet_at(joints.a_to_b ? a.last() : a.first(), a, b))
      return std::nullopt;
    if (!joined && a.is_flat && b.is_flat) return meeting(a, b, touch_);
    if (joined && a.box.diagonal().norm() <= touch_ && b.box.diagonal().norm() <= touch_)
      return std::nullopt;  // the joint itself
    std::vector<Part> of_a = parts(a, joined), of_b = parts(b, joined);
    for (std::size_t i = 0; i < of_a.size(); ++i)
      for (std::size_t j = 0; j < of_b.size(); ++j) {
        const bool last_of_a = i + 1 == of_a.size(), last_of_b = j + 1 == of_b.size();
        const Joints kept = {joints.a_to_b && last_of_a && j == 0, joints.b_to_a && i == 0 && last_of_b};
        if (std::optional<Vec2> found = between(of_a[i], of_b[j], kept)) return found;
      }
    return std::nullopt;
  }

  // Where does one curve meet itself? Nowhere while its control polygon runs within a half plane.
  [[nodiscard]] std::optional<Vec2> within(const Part& whole) const {
    Vec2 forward = Vec2::Zero();
    std::vector<Vec2> legs;
    for (std::size_t i = 0; i < 3; ++i)
      if (whole.curve[i] != whole.curve[i + 1])
        legs.push_back((whole.curve[i + 1] - whole.curve[i]).normalized());
    for (const Vec2& leg : legs) forward += leg;
    if (std::all_of(legs.begin(), legs.end(), [&](const Vec2& leg) { return leg.dot(forward) > 0.0; }) ||
        whole.box.diagonal().norm() <= touch_)
      return std::nullopt;
    const auto [left, right] = whole.halves(touch_);
    for (const Part* half : {&left, &right})
      if (std::optional<Vec2> found = within(*half)) return found;
    return between(left, right, {true, whole.first() == whole.last()});
  }

 private:
  [[nodiscard]] bool reach(const Box2& a, const Box2& b) const {
    return (a.min() - b.max()).maxCoeff() <= touch_ && (b.min() - a.max()).maxCoeff() <= touch_;
  }
  [[nodiscard]] std::vector<Part> parts(const Part& whole, bool even_if_flat) const {
    if (whole.is_flat && !even_if_flat) return {whole};
    const auto [left, right] = whole.halves(touch_);
    return {left, right};
  }

  double touch_;
};

}  // namespace

std::optional<Crossing> find_crossing(const std::vector<Bezier>& outline) {
  Box2 box;
  for (const Bezier& curve : outline)
    for (const Vec2& p : curve) box.extend(p);
  if (outline.empty()) return std::nullopt;
  const Search search(relative_touch * box.diagonal().norm());
  std::vector<Part> parts;
  parts.reserve(outline.size());
  for (const Bezier& curve : outline) parts.push_back(search.part(curve));
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (const std::optional<Vec2> at = search.within(parts[i])) return Crossing{i, i, *at};

  // From left to right: only curves whose ranges of x overlap are compared.
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    const double x = parts[i].box.min().x(), y = parts[j].box.min().x();
    return x != y ? x < y : i < j;
  });
  for (std::size_t first = 0; first < order.size(); ++first)
    for (std::size_t next = first + 1; next < order.size(); ++next) {
      if (parts[order[next]].box.min().x() > parts[order[first]].box.max().x()) break;
      const std::size_t a = std::min(order[first], order[next]), b = std::max(order[first], order[next]);
      const Joints joints = {b == a + 1, (b + 1) % parts.size() == a};
      if (const std::optional<Vec2> at = search.between(parts[a], parts[b], joints))
        return Crossing{a, b, *at};
    }
  return std::nullopt;
}

}  // namespace selvage::nurbs
