#include "tetrahedra/slide.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "fem/cell_sides.h"
#include "surface_mesh/body_support.h"
#include "tetrahedra/point_place.h"
#include "tetrahedra/tet_complex.h"

namespace selvage::fem {
namespace {

// The triangles, or cells, at each of the points that may slide.
template <std::size_t corners>
class Stars {
 public:
  Stars(std::span<const std::array<std::uint32_t, corners>> all, const std::vector<bool>& wanted)
      : first_(wanted.size() + 1, 0) {
    const auto each = [&](const auto& visit) {
      for (std::uint32_t k = 0; k < all.size(); ++k)
        for (const std::uint32_t p : all[k])
          if (p < wanted.size() && wanted[p]) visit(p, k);
    };
    each([&](std::uint32_t p, std::uint32_t) { ++first_[p + 1]; });
    for (std::size_t p = 0; p < wanted.size(); ++p) first_[p + 1] += first_[p];
    items_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    each([&](std::uint32_t p, std::uint32_t k) { items_[next[p]++] = k; });
  }
  [[nodiscard]] std::span<const std::uint32_t> at(std::uint32_t p) const {
    return std::span(items_).subspan(first_[p], first_[p + 1] - first_[p]);
  }

 private:
  std::vector<std::uint32_t> first_, items_;
};

Vec3 area_of(std::span<const Vec3> points, const Triangle& t) {
  return (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]) / 2;
}

// Points all of whose triangles are of one yarn's side, and hardly turned against each other there.
std::vector<bool> sliding_points(const Block& block, std::span<const Vec3> points) {
  constexpr double least_cosine = 0.8;  // between a triangle and the mean of those at a point
  const CellTriangles& surface = block.skin.surface;
  std::vector<bool> result(block.skin.nodes.points.size(), true);
  std::vector<Vec3> normals(result.size(), Vec3::Zero());
  for (std::size_t k = 0; k < surface.triangles.size(); ++k)
    for (const std::uint32_t p : surface.triangles[k]) {
      normals[p] += area_of(points, surface.triangles[k]);
      if (surface.parts[k] != CellTriangles::Part::side || block.skin.nodes.places[p].body == no_body)
        result[p] = false;
    }
  for (const Triangle& t : surface.triangles)
    for (const std::uint32_t p : t)
      if (area_of(points, t).stableNormalized().dot(normals[p].stableNormalized()) < least_cosine)
        result[p] = false;
  return result;
}

class Slider {
 public:
  Slider(TetMesh& tets, Block& block, double goal, bool on_surface)
      : tets_(tets),
        block_(block),
        goal_(quality_of_angle(goal)),
        on_surface_(on_surface),
        slides_(sliding_points(block, tets.points)),
        cells_(tets.cells, slides_),
        triangles_(block.skin.surface.triangles, slides_),
        start_(tets.points.begin(), tets.points.begin() + static_cast<std::ptrdiff_t>(slides_.size())) {}

  std::size_t run() {
    std::vector<bool> moved(slides_.size(), false);
    for (int sweep = 0; sweep < sweeps; ++sweep)
      for (std::uint32_t p = 0; p < slides_.size(); ++p)
        if (slides_[p] && move(p)) moved[p] = true;
    for (std::uint32_t p = 0; p < slides_.size(); ++p)
      if (moved[p]) place(p) = settled(p, tets_.points[p]).parameters;
    return static_cast<std::size_t>(std::count(moved.begin(), moved.end(), true));
  }

 private:
  static constexpr double farthest = 0.4;  // of the shortest edge
  static constexpr int sweeps = 2;

  [[nodiscard]] Vec2& place(std::uint32_t p) { return block_.skin.nodes.places[p].parameters; }
  // On the yarn's surface.
  [[nodiscard]] Support::Place settled(std::uint32_t p, const Vec3& at) {
    const yarn::Body& body = block_.bodies[block_.skin.nodes.places[p].body];
    const Support::Place found = BodySupport(body).nearest(place(p), at);
    return {cell::in_domain(body, found.parameters), found.point};
  }
  [[nodiscard]] double quality(const Vec3& at) const {
    double least = 1;
    for (const StarSide& side : sides_) least = std::min(least, tet_quality(at, side[0], side[1], side[2]));
    return least;
  }
  bool move(std::uint32_t p);

  TetMesh& tets_;
  Block& block_;
  double goal_;
  bool on_surface_;
  std::vector<bool> slides_;
  Stars<4> cells_;
  Stars<3> triangles_;
  std::vector<Vec3> start_;
  std::vector<StarSide> sides_;  // of the point that is being moved
  PointPlace point_place_;
};

bool Slider::move(std::uint32_t p) {
  std::vector<Vec3>& points = tets_.points;
  sides_.clear();
  for (const std::uint32_t c : cells_.at(p)) {
    const Tetrahedron& t = tets_.cells[c];
    const auto& side = opposite_sides[static_cast<std::size_t>(std::find(t.begin(), t.end(), p) - t.begin())];
    sides_.push_back({points[t[side[0]]], points[t[side[1]]], points[t[side[2]]]});
  }
  const double before = quality(points[p]);
  if (before >= goal_) return false;
  Vec3 area = Vec3::Zero();
  double shortest = std::numeric_limits<double>::infinity();
  for (const std::uint32_t k : triangles_.at(p)) {
    area += area_of(points, block_.skin.surface.triangles[k]);
    for (const std::uint32_t q : block_.skin.surface.triangles[k])
      if (q != p) shortest = std::min(shortest, (start_[q] - start_[p]).norm());
  }
  Vec3 at = points[p];
  point_place_.improve(at, sides_, goal_, area.stableNormalized());
  if (on_surface_) at = settled(p, at).point;
  if (quality(at) <= before || (at - start_[p]).norm() > farthest * shortest) return false;
  points[p] = at;
  return true;
}

}  // namespace

std::size_t slide_points(TetMesh& tets, Block& block, double goal, bool on_surface) {
  return Slider(tets, block, goal, on_surface).run();
}

}  // namespace selvage::fem
