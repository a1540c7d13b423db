#include "surface_mesh/kept_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/bounds.h"
#include "core/box_tree.h"
#include "surface_mesh/triangle_distance.h"

namespace selvage::fem {
namespace {

using Part = CellTriangles::Part;

constexpr double edge_share = 0.15;  // of the shortest edge at a corner that it may move
constexpr double steepest = 0.3;  // cosine between the normal and the way in a face: farther is not made up
constexpr std::uint32_t nobody = YarnFacet::no_yarn, several = nobody - 1;

class Keeper {
 public:
  Keeper(std::vector<Vec3>& points, const KeptVolume& surface)
      : points_(points), surface_(surface), corners_(points.size()), extra_(surface.volumes.size(), 0.0) {}

  // The largest share of a volume that is wrong.
  double run();

 private:
  // A corner of sides, with all that move with it.
  struct Corner {
    Vec3 normal = Vec3::Zero(), way = Vec3::Zero();  // way: for one length along the normal
    Vec3 end_normal = Vec3::Zero();
    std::array<bool, 3> in_face{};  // across x, y, z
    double weight = 0, height = 0;
    double shortest = std::numeric_limits<double>::infinity();  // edge of a side
    double least = 0, most = 0;                                 // lengths along the normal
    std::uint32_t yarn = nobody;
  };

  [[nodiscard]] std::uint32_t leader(std::uint32_t k) const {
    return surface_.leaders.empty() ? k : surface_.leaders[k];
  }
  [[nodiscard]] Corners3 corners_of(const YarnFacet& facet) const {
    return {points_[facet.corners[0]], points_[facet.corners[1]], points_[facet.corners[2]]};
  }
  void collect(const YarnFacet& facet);
  void find_ways();
  void keep_to_faces(const Corner& corner, Vec3& way, Vec3& end) const;
  void keep_in_cell();
  void keep_gaps();
  [[nodiscard]] double length_of(const Corner& corner) const;
  [[nodiscard]] Vec3 moved(std::uint32_t k) const {
    const Corner& corner = corners_[leader(k)];
    return points_[k] + length_of(corner) * corner.way;
  }
  [[nodiscard]] double volume_of(std::uint32_t yarn) const;
  [[nodiscard]] double free_area(std::uint32_t yarn) const;
  void fit(std::uint32_t yarn);
  bool hold_turned();

  std::vector<Vec3>& points_;
  const KeptVolume& surface_;
  std::vector<Corner> corners_;  // one a point; those of leaders mean something
  std::vector<double> extra_;    // one a yarn: the length that all of it moves
  std::vector<std::vector<const YarnFacet*>> of_yarn_;
};

Vec3 area_of(const Corners3& t) {
  return (t[1] - t[0]).cross(t[2] - t[0]) / 2;
}

// By the angles at the corner: it does not matter by which diagonal a square is two triangles.
void Keeper::collect(const YarnFacet& facet) {
  const Corners3 at = corners_of(facet);
  const Vec3 area = area_of(at), normal = area.stableNormalized();
  for (std::size_t k = 0; k < 3; ++k) {
    Corner& corner = corners_[leader(facet.corners[k])];
    if (facet.part == Part::start || facet.part == Part::end) corner.end_normal += area;
    if (facet.part == Part::box && surface_.cell)
      for (int axis = 0; axis < 3; ++axis)
        if (const int side = surface_.cell->side_of(at[0], axis);
            side != 0 && surface_.cell->side_of(at[1], axis) == side &&
            surface_.cell->side_of(at[2], axis) == side)
          corner.in_face[static_cast<std::size_t>(axis)] = true;
    if (facet.part != Part::side) continue;
    const Vec3 a = at[(k + 1) % 3] - at[k], b = at[(k + 2) % 3] - at[k];
    const double angle = std::atan2(a.cross(b).norm(), a.dot(b));
    corner.normal += angle * normal;
    corner.height += angle * facet.height;
    corner.weight += angle;
    corner.shortest = std::min({corner.shortest, a.norm(), b.norm()});
    corner.yarn = corner.yarn == nobody || corner.yarn == facet.yarn ? facet.yarn : several;
  }
}

// Takes from both what leaves the faces that the corner is in.
void Keeper::keep_to_faces(const Corner& corner, Vec3& way, Vec3& end) const {
  std::vector<Vec3> normals;  // at right angles to each other
  for (int axis = 0; axis < 3; ++axis) {
    if (!corner.in_face[static_cast<std::size_t>(axis)]) continue;
    Vec3 normal = surface_.cell->axes.normal(axis);
    for (const Vec3& other : normals) normal -= other.dot(normal) * other;
    normals.push_back(normal.normalized());
    way -= normals.back().dot(way) * normals.back();
    end -= normals.back().dot(end) * normals.back();
  }
}

void Keeper::find_ways() {
  for (Corner& corner : corners_) {
    if (corner.weight <= 0) continue;
    corner.height /= corner.weight;
    corner.normal.stableNormalize();
    Vec3 way = corner.normal, end = corner.end_normal;
    keep_to_faces(corner, way, end);
    end.stableNormalize();
    way -= end * end.dot(way);
    const double cosine = way.norm();
    if (!(cosine > 1e-3)) continue;
    const double stretch = 1 / std::max(cosine, steepest);
    corner.way = way * (stretch / cosine);
    corner.most = edge_share * corner.shortest / stretch;
    corner.least = -corner.most;
  }
}

void Keeper::keep_in_cell() {
  if (!surface_.cell) return;
  const Box3& box = surface_.cell->box;
  for (std::uint32_t k = 0; k < points_.size(); ++k) {
    Corner& corner = corners_[leader(k)];
    const Vec3 own_way = surface_.cell->axes.own(corner.way), own = surface_.cell->axes.own(points_[k]);
    for (int axis = 0; axis < 3; ++axis) {
      const double way = own_way[axis];
      if (std::abs(way) <= 1e-12 * own_way.norm()) continue;  // along the face, to rounding
      const double up = (box.max()[axis] - own[axis]) / std::abs(way);
      const double down = (own[axis] - box.min()[axis]) / std::abs(way);
      corner.most = std::min(corner.most, surface_.gap_share * std::max(way > 0 ? up : down, 0.0));
      corner.least = std::max(corner.least, -surface_.gap_share * std::max(way > 0 ? down : up, 0.0));
    }
  }
}

// Triangles that face each other: of two yarns any, of one those across a gap.
void Keeper::keep_gaps() {
  std::vector<const YarnFacet*> facets;
  std::vector<Box3> boxes;
  std::vector<Vec3> normals;
  std::vector<Box3> tight;
  // What is farther from a triangle holds none of its corners back.
  const auto reach_of = [&](const YarnFacet& facet) {
    double farthest = 0;
    for (const std::uint32_t k : facet.corners) {
      const Corner& corner = corners_[leader(k)];
      farthest = std::max(farthest, corner.most * corner.way.norm());
    }
    return farthest / surface_.gap_share;
  };
  for (const YarnFacet& facet : surface_.facets) {
    if (facet.part == Part::box) continue;
    const Vec3 reach = Vec3::Constant(reach_of(facet));
    facets.push_back(&facet);
    tight.push_back(bounds_of(corners_of(facet)));
    boxes.emplace_back(tight.back().min() - reach, tight.back().max() + reach);
    normals.push_back(area_of(corners_of(facet)).stableNormalized());
  }
  const auto limit = [&](const YarnFacet& facet, double distance) {
    for (const std::uint32_t k : facet.corners) {
      Corner& corner = corners_[leader(k)];
      const double size = corner.way.norm();
      if (size > 0) corner.most = std::min(corner.most, surface_.gap_share * distance / size);
    }
  };
  BoxTree(std::move(boxes)).near_pairs(0, [&](std::uint32_t i, std::uint32_t j) {
    const bool is_same = facets[i]->yarn == facets[j]->yarn;
    if (is_same && normals[i].dot(normals[j]) >= 0) return;
    if (tight[i].exteriorDistance(tight[j]) > std::max(reach_of(*facets[i]), reach_of(*facets[j]))) return;
    const Vec3 way = shortest_way(corners_of(*facets[i]), corners_of(*facets[j]));
    const double distance = way.norm();
    constexpr double across = 0.7;  // cosine
    if (is_same && !(way.dot(normals[i]) > across * distance && way.dot(normals[j]) < -across * distance))
      return;
    limit(*facets[i], distance);
    limit(*facets[j], distance);
  });
}

double Keeper::length_of(const Corner& corner) const {
  if (corner.weight <= 0) return 0;
  const double extra = corner.yarn < extra_.size() ? extra_[corner.yarn] : 0;
  return std::clamp(corner.height + extra, corner.least, corner.most);
}

double Keeper::volume_of(std::uint32_t yarn) const {
  double six = 0;
  const Vec3 origin = points_[of_yarn_[yarn].front()->corners[0]];
  for (const YarnFacet* facet : of_yarn_[yarn]) {
    const Vec3 a = moved(facet->corners[0]) - origin, b = moved(facet->corners[1]) - origin,
               c = moved(facet->corners[2]) - origin;
    six += a.cross(b).dot(c);
  }
  return six / 6;
}

// Of the corners that go on moving.
double Keeper::free_area(std::uint32_t yarn) const {
  double area = 0;
  for (const YarnFacet* facet : of_yarn_[yarn]) {
    if (facet->part != Part::side) continue;
    int count = 0;
    for (const std::uint32_t k : facet->corners) {
      const Corner& corner = corners_[leader(k)];
      const double length = length_of(corner);
      if (corner.yarn == yarn && length > corner.least && length < corner.most) ++count;
    }
    area += area_of(corners_of(*facet)).norm() * count / 3;
  }
  return area;
}

// Newton's method: the volume grows by the area that moves.
void Keeper::fit(std::uint32_t yarn) {
  constexpr int most_steps = 30;
  constexpr double near = 1e-10;
  for (int step = 0; step < most_steps; ++step) {
    const double missing = surface_.volumes[yarn] - volume_of(yarn);
    if (std::abs(missing) <= near * surface_.volumes[yarn]) return;
    const double area = free_area(yarn);
    if (!(area > 0)) return;
    extra_[yarn] += missing / area;
  }
}

// Corners of triangles that would turn, or all but vanish, move half as far. False: there are none.
bool Keeper::hold_turned() {
  constexpr double least_left = 0.3;  // of a triangle's area
  std::vector<bool> held(points_.size(), false);
  bool any = false;
  for (const YarnFacet& facet : surface_.facets) {
    const Vec3 before = area_of(corners_of(facet));
    const Vec3 after = area_of({moved(facet.corners[0]), moved(facet.corners[1]), moved(facet.corners[2])});
    if (after.dot(before) >= least_left * before.squaredNorm()) continue;
    for (const std::uint32_t k : facet.corners) held[leader(k)] = any = true;
  }
  for (std::size_t k = 0; k < held.size(); ++k) {
    if (!held[k]) continue;
    const double length = length_of(corners_[k]);
    corners_[k].most = std::min(corners_[k].most, std::max(length, 0.0) / 2);
    corners_[k].least = std::max(corners_[k].least, std::min(length, 0.0) / 2);
  }
  return any;
}

double Keeper::run() {
  of_yarn_.resize(surface_.volumes.size());
  for (const YarnFacet& facet : surface_.facets) {
    collect(facet);
    if (facet.yarn != YarnFacet::no_yarn) of_yarn_[facet.yarn].push_back(&facet);
  }
  find_ways();
  keep_in_cell();
  keep_gaps();
  constexpr int most_rounds = 20;
  for (int round = 0; round < most_rounds; ++round) {
    for (std::uint32_t yarn = 0; yarn < of_yarn_.size(); ++yarn)
      if (!of_yarn_[yarn].empty()) fit(yarn);
    if (!hold_turned()) break;
  }
  double worst = 0;
  for (std::uint32_t yarn = 0; yarn < of_yarn_.size(); ++yarn)
    if (!of_yarn_[yarn].empty())
      worst = std::max(worst, std::abs(volume_of(yarn) / surface_.volumes[yarn] - 1));
  std::vector<Vec3> result(points_.size());
  for (std::uint32_t k = 0; k < points_.size(); ++k) result[k] = moved(k);
  points_ = std::move(result);
  return worst;
}

}  // namespace

double mean_height(const yarn::Body& body, const std::array<SurfaceEnd, 3>& corners) {
  const Vec3 normal = area_of({corners[0].at, corners[1].at, corners[2].at}).stableNormalized();
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const SurfaceEnd &from = corners[k], &to = corners[(k + 1) % 3];
    sum += normal.dot(middle_on_surface(body, from, to) - (from.at + to.at) / 2);
  }
  return sum / 3;
}

double keep_volumes(std::vector<Vec3>& points, const KeptVolume& surface) {
  return Keeper(points, surface).run();
}

double keep_dry_volumes(std::vector<Vec3>& points, std::span<const YarnFacet> facets,
                        std::span<const double> volumes) {
  constexpr double right = 1e-3;
  const std::vector<Vec3> on_surface = points;
  const double worst = keep_volumes(points, {.facets = facets, .volumes = volumes});
  if (worst < right) return worst;
  points = on_surface;
  return keep_volumes(points, {.facets = facets, .volumes = volumes, .gap_share = 0.4});
}

}  // namespace selvage::fem
