#include "fem/planar_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::fem {
namespace {

using Index = std::uint32_t;
constexpr Index none = 0xffffffff;
// Wider than double: differences of doubles and their products keep (nearly) all their digits, so that signs
// are right.
__extension__ typedef __float128 Wide;

// Twice the area of a, b, c: positive counter-clockwise.
double orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double left = (b.x() - a.x()) * (c.y() - a.y()), right = (b.y() - a.y()) * (c.x() - a.x());
  const double fast = left - right;
  if (std::abs(fast) > 1e-14 * (std::abs(left) + std::abs(right))) return fast;
  const Wide exact =
      (Wide(b.x()) - a.x()) * (Wide(c.y()) - a.y()) - (Wide(b.y()) - a.y()) * (Wide(c.x()) - a.x());
  return static_cast<double>(exact);
}

// True when d lies inside the circle through a, b, c (counter-clockwise) by more than rounding.
bool in_circle(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const Vec2 p = a - d, q = b - d, r = c - d;
  const double pp = p.squaredNorm(), qq = q.squaredNorm(), rr = r.squaredNorm();
  const double det = pp * (q.x() * r.y() - q.y() * r.x()) - qq * (p.x() * r.y() - p.y() * r.x()) +
                     rr * (p.x() * q.y() - p.y() * q.x());
  const double scale = std::max({pp, qq, rr});
  return det > 1e-12 * scale * scale;
}

// Smallest angle of a triangle, as its sine; negative when it is not counter-clockwise.
double shape(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double ab = (b - a).norm(), bc = (c - b).norm(), ca = (a - c).norm();
  const double area = orientation(a, b, c);
  return area / std::max({ab * bc, bc * ca, ca * ab});
}

class Triangulation {
 public:
  explicit Triangulation(std::span<const Vec2> rim) : points_(rim.begin(), rim.end()), rim_(rim.size()) {}

  bool clip_ears();
  void insert(const Vec2& point);
  void flip_all();
  void smooth();
  PlanarMesh result() && { return {std::move(points_), std::move(triangles_)}; }

 private:
  using Corners = std::array<Index, 3>;

  [[nodiscard]] bool is_ear(const std::vector<Index>& left, std::size_t at) const;
  [[nodiscard]] double ear_shape(const std::vector<Index>& left, std::size_t at) const;
  void link();
  [[nodiscard]] Index locate(const Vec2& point) const;
  bool legalize(Index triangle, int side);
  void replace_neighbour(Index triangle, Index before, Index after);
  // The side of `triangle` beyond which `other` lies.
  [[nodiscard]] int side_to(Index triangle, Index other) const {
    const Corners& n = neighbours_[triangle];
    return n[0] == other ? 0 : n[1] == other ? 1 : 2;
  }

  std::vector<Vec2> points_;
  std::size_t rim_;
  std::vector<Corners> triangles_;
  std::vector<Corners> neighbours_;  // across the side opposite to each corner; none: the rim
  mutable Index last_ = 0;
};

bool Triangulation::is_ear(const std::vector<Index>& left, std::size_t at) const {
  const std::size_t n = left.size();
  const Index ia = left[(at + n - 1) % n], ib = left[at], ic = left[(at + 1) % n];
  const Vec2 &a = points_[ia], &b = points_[ib], &c = points_[ic];
  if (!(orientation(a, b, c) > 0)) return false;
  for (const Index other : left) {
    if (other == ia || other == ib || other == ic) continue;
    const Vec2& p = points_[other];
    if (orientation(a, b, p) >= 0 && orientation(b, c, p) >= 0 && orientation(c, a, p) >= 0) return false;
  }
  return true;
}

// How good an ear is: the best are cut first, so that straight sides do not leave flat triangles.
double Triangulation::ear_shape(const std::vector<Index>& left, std::size_t at) const {
  if (!is_ear(left, at)) return -1;
  const std::size_t n = left.size();
  return shape(points_[left[(at + n - 1) % n]], points_[left[at]], points_[left[(at + 1) % n]]);
}

bool Triangulation::clip_ears() {
  std::vector<Index> left(rim_);
  for (std::size_t i = 0; i < rim_; ++i) left[i] = static_cast<Index>(i);
  std::vector<double> shapes(rim_);
  for (std::size_t i = 0; i < rim_; ++i) shapes[i] = ear_shape(left, i);
  while (left.size() >= 3) {
    const auto best =
        static_cast<std::size_t>(std::max_element(shapes.begin(), shapes.end()) - shapes.begin());
    if (!(shapes[best] > 0)) return false;
    const std::size_t n = left.size();
    triangles_.push_back({left[(best + n - 1) % n], left[best], left[(best + 1) % n]});
    if (n == 3) break;
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
    shapes.erase(shapes.begin() + static_cast<std::ptrdiff_t>(best));
    // Only its two neighbours can have changed.
    shapes[(best + n - 2) % (n - 1)] = ear_shape(left, (best + n - 2) % (n - 1));
    shapes[best % (n - 1)] = ear_shape(left, best % (n - 1));
  }
  link();
  return true;
}

void Triangulation::link() {
  neighbours_.assign(triangles_.size(), {none, none, none});
  std::vector<std::array<Index, 4>> sides;  // ends, triangle, corner opposite
  for (Index t = 0; t < triangles_.size(); ++t)
    for (Index k = 0; k < 3; ++k) {
      const Index a = triangles_[t][(k + 1) % 3], b = triangles_[t][(k + 2) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), t, k});
    }
  std::sort(sides.begin(), sides.end());
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    if (sides[i][0] != sides[i + 1][0] || sides[i][1] != sides[i + 1][1]) continue;
    neighbours_[sides[i][2]][sides[i][3]] = sides[i + 1][2];
    neighbours_[sides[i + 1][2]][sides[i + 1][3]] = sides[i][2];
  }
}

// The triangle that holds the point: a walk from the last one, and a search of all where the walk leaves the
// polygon.
Index Triangulation::locate(const Vec2& point) const {
  auto inside = [&](Index t) {
    for (std::size_t k = 0; k < 3; ++k)
      if (orientation(points_[triangles_[t][k]], points_[triangles_[t][(k + 1) % 3]], point) < 0)
        return static_cast<int>((k + 2) % 3);  // beyond the side opposite to this corner
    return -1;
  };
  Index t = last_;
  for (std::size_t steps = 0; steps < triangles_.size() && t != none; ++steps) {
    const int side = inside(t);
    if (side < 0) return last_ = t;
    t = neighbours_[t][static_cast<std::size_t>(side)];
  }
  for (t = 0; t < triangles_.size(); ++t)
    if (inside(t) < 0) return last_ = t;
  return none;
}

void Triangulation::replace_neighbour(Index triangle, Index before, Index after) {
  if (triangle == none) return;
  for (Index& n : neighbours_[triangle])
    if (n == before) {
      n = after;
      return;
    }
}

// Splits the triangle that holds the point into three and restores the Delaunay property.
void Triangulation::insert(const Vec2& point) {
  const Index t = locate(point);
  if (t == none) return;
  const auto p = static_cast<Index>(points_.size());
  const Corners c = triangles_[t], n = neighbours_[t];
  // A point on the rim or on a corner has no place here.
  for (std::size_t k = 0; k < 3; ++k)
    if (n[k] == none && !(orientation(points_[c[(k + 1) % 3]], points_[c[(k + 2) % 3]], point) > 0)) return;
  points_.push_back(point);
  const auto t1 = static_cast<Index>(triangles_.size()), t2 = t1 + 1;
  triangles_[t] = {p, c[1], c[2]};
  neighbours_[t] = {n[0], t1, t2};
  triangles_.push_back({p, c[2], c[0]});
  neighbours_.push_back({n[1], t2, t});
  triangles_.push_back({p, c[0], c[1]});
  neighbours_.push_back({n[2], t, t1});
  replace_neighbour(n[1], t, t1);
  replace_neighbour(n[2], t, t2);
  for (const Index fresh : {t, t1, t2}) legalize(fresh, 0);
}

// Flips the side opposite to corner `side` of `triangle` when the other triangle's corner is in its circle,
// and goes on with the sides that this uncovers. True when it flipped.
bool Triangulation::legalize(Index triangle, int side) {
  const auto s = static_cast<std::size_t>(side);
  const Index other = neighbours_[triangle][s];
  if (other == none) return false;
  const auto o = static_cast<std::size_t>(side_to(other, triangle));
  const Index a = triangles_[triangle][s], b = triangles_[triangle][(s + 1) % 3],
              c = triangles_[triangle][(s + 2) % 3];
  const Index d = triangles_[other][o];
  const bool flat = !(orientation(points_[a], points_[b], points_[c]) > 0);
  if (!flat && !in_circle(points_[a], points_[b], points_[c], points_[d])) return false;
  // Only across a strictly convex quadrangle.
  if (!(orientation(points_[a], points_[b], points_[d]) > 0) ||
      !(orientation(points_[a], points_[d], points_[c]) > 0))
    return false;
  const Index beyond_ab = neighbours_[triangle][(s + 2) % 3], beyond_ca = neighbours_[triangle][(s + 1) % 3];
  // In `other` the corners run d, c, b: opposite to c lies side bd, opposite to b side dc.
  const Index beyond_db = neighbours_[other][(o + 1) % 3], beyond_cd = neighbours_[other][(o + 2) % 3];
  triangles_[triangle] = {a, b, d};
  neighbours_[triangle] = {beyond_db, other, beyond_ab};
  triangles_[other] = {a, d, c};
  neighbours_[other] = {beyond_cd, beyond_ca, triangle};
  replace_neighbour(beyond_db, other, triangle);
  replace_neighbour(beyond_ca, triangle, other);
  legalize(triangle, 0);
  legalize(other, 0);
  return true;
}

// Lawson's algorithm ends by itself; the bound only guards against rounding.
void Triangulation::flip_all() {
  bool flipped = true;
  for (int round = 0; flipped && round < 100; ++round) {
    flipped = false;
    for (Index t = 0; t < triangles_.size(); ++t)
      for (int side = 0; side < 3; ++side) flipped = legalize(t, side) || flipped;
  }
}

// Moves each inner point toward the middle of its neighbours, never so that a triangle turns over.
void Triangulation::smooth() {
  std::vector<Vec2> sum(points_.size(), Vec2::Zero());
  std::vector<int> count(points_.size(), 0);
  std::vector<std::vector<Index>> fans(points_.size());
  for (Index t = 0; t < triangles_.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Index p = triangles_[t][k];
      sum[p] += points_[triangles_[t][(k + 1) % 3]] + points_[triangles_[t][(k + 2) % 3]];
      count[p] += 2;
      fans[p].push_back(t);
    }
  for (std::size_t p = rim_; p < points_.size(); ++p) {
    const Vec2 before = points_[p];
    points_[p] = sum[p] / count[p];
    for (const Index t : fans[p]) {
      const Corners& c = triangles_[t];
      if (shape(points_[c[0]], points_[c[1]], points_[c[2]]) > 0.05) continue;
      points_[p] = before;
      break;
    }
  }
}

double distance_to_rim(std::span<const Vec2> rim, const Vec2& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < rim.size(); ++i) {
    const Vec2& a = rim[i];
    const Vec2 along = rim[(i + 1) % rim.size()] - a;
    const double t = std::clamp((point - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (point - a - t * along).norm());
  }
  return nearest;
}

bool is_inside(std::span<const Vec2> rim, const Vec2& point) {
  bool inside = false;
  for (std::size_t i = 0; i < rim.size(); ++i) {
    const Vec2 &a = rim[i], &b = rim[(i + 1) % rim.size()];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if (point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

// A hexagonal lattice about the middle of the rim's box, rows along x.
std::vector<Vec2> lattice(std::span<const Vec2> rim, double spacing) {
  Eigen::AlignedBox2d box;
  for (const Vec2& point : rim) box.extend(point);
  const double rise = spacing * std::numbers::sqrt3 / 2;
  const int rows = static_cast<int>(box.sizes().y() / 2 / rise) + 1;
  const int columns = static_cast<int>(box.sizes().x() / 2 / spacing) + 1;
  std::vector<Vec2> result;
  for (int j = -rows; j <= rows; ++j)
    for (int i = -columns; i <= columns; ++i) {
      const Vec2 point = box.center() + Vec2((i + (j % 2 == 0 ? 0.0 : 0.5)) * spacing, j * rise);
      if (is_inside(rim, point) && distance_to_rim(rim, point) > 0.6 * spacing) result.push_back(point);
    }
  return result;
}

}  // namespace

std::optional<PlanarMesh> mesh_polygon(std::span<const Vec2> rim, double spacing) {
  if (rim.size() < 3) return std::nullopt;
  Triangulation mesh(rim);
  if (!mesh.clip_ears()) return std::nullopt;
  mesh.flip_all();
  for (const Vec2& point : lattice(rim, spacing)) mesh.insert(point);
  for (int round = 0; round < 4; ++round) {
    mesh.smooth();
    mesh.flip_all();
  }
  return std::move(mesh).result();
}

}  // namespace selvage::fem
