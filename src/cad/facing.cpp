#include "cad/facing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "cad/border.h"
#include "cad/region.h"
#include "cad/sampled_curve.h"
#include "core/box_tree.h"

namespace selvage::cad {

namespace {

// A piece of a face's border, in the direction that has the face on its left, seen from outside.
struct Rim {
  std::size_t face;
  Border border;
  bool is_against;  // the direction is against that of `border`
};

// Inside the face from `at` in its parameters: the first of the two directions that leads into it.
std::optional<Vec2> into_face(const Region& region, const Vec2& at, const Vec2& across) {
  for (const double share : {0.03, 0.01, 0.003, 0.1}) {
    const Vec2 step = share * across;
    const bool ahead = region.contains(at.x() + step.x(), at.y() + step.y()),
               behind = region.contains(at.x() - step.x(), at.y() - step.y());
    if (ahead != behind) return ahead ? across : Vec2(-across);
  }
  return std::nullopt;
}

// Is the face on the right of a curve that goes along `tangent` through its point at (u, v), where `inside`
// leads into it? Nothing where the surface has no normal.
std::optional<bool> is_on_the_right(const Face& face, const Vec2& at, const Vec2& inside,
                                    const Vec3& tangent) {
  const nurbs::SurfaceJet jet = nurbs::evaluate_jet(face.surface, at.x(), at.y());
  const Vec3 normal = (face.reversed ? -1.0 : 1.0) * jet.du.cross(jet.dv), left = normal.cross(tangent),
             inwards = inside.x() * jet.du + inside.y() * jet.dv;
  const double cosine = left.dot(inwards) / (left.norm() * inwards.norm());
  if (!(std::abs(cosine) > 1e-3)) return std::nullopt;
  return cosine < 0;
}

Vec3 tangent_at(const nurbs::Curve& curve, double share) {
  return nurbs::evaluate_jet(curve, std::lerp(curve.first_parameter(), curve.last_parameter(), share)).d1;
}

// Where a loop passes a pole of its surface, parameters jump, and on which side of it the face lies is hard
// to tell.
bool runs_through_pole(const Face& face) {
  const double near = 1e-3 * box_of(face.surface.points).sizes().norm();
  for (const nurbs::Curve& side : sides_of(face.surface)) {
    if (!is_point(side, 1e-3 * near)) continue;
    const Vec3& pole = side.points.front();
    for (const Loop& loop : face.loops)
      for (const Edge& edge : loop.edges)
        if (!edge.curve.points.empty() && SampledCurve(edge.curve).nearest(pole).distance < near) return true;
  }
  return false;
}

class Finder {
 public:
  Finder(const Part& part, double tolerance) : part_(part), tolerance_(tolerance) {
    for (std::size_t i = 0; i < part.faces.size(); ++i) {
      if (part.faces[i].loops.empty())
        add_sides(i);
      else
        add_edges(i);
    }
  }

  std::vector<std::size_t> turned() {
    find_neighbours();
    std::vector<std::size_t> found;
    std::vector<int> side(part_.faces.size(), 0);  // 1 and -1; 0: not reached
    for (std::size_t start = 0; start < side.size(); ++start) {
      if (side[start] != 0) continue;
      std::vector<std::size_t> set = {start};
      side[start] = 1;
      for (std::size_t k = 0; k < set.size(); ++k)
        for (const auto& [next, same] : neighbours_[set[k]])
          if (side[next] == 0) {
            side[next] = same ? side[set[k]] : -side[set[k]];
            set.push_back(next);
          }
      const auto against = static_cast<std::size_t>(
          std::ranges::count_if(set, [&](std::size_t face) { return side[face] < 0; }));
      const int fewer = 2 * against <= set.size() ? -1 : 1;
      if (against > 0)
        for (const std::size_t face : set)
          if (side[face] == fewer) found.push_back(face);
    }
    std::ranges::sort(found);
    return found;
  }

 private:
  void add(std::size_t face, Border border, const std::optional<bool>& is_right) {
    if (is_right && border.length() > tolerance_) rims_.push_back({face, std::move(border), *is_right});
  }

  void add_sides(std::size_t number) {
    const Face& face = part_.faces[number];
    const nurbs::Surface& s = face.surface;
    const std::array<nurbs::Curve, 4> sides = sides_of(s);
    const double u = 0.5 * (s.first_u() + s.last_u()), v = 0.5 * (s.first_v() + s.last_v());
    const std::array<Vec2, 4> at = {Vec2(s.first_u(), v), Vec2(s.last_u(), v), Vec2(u, s.first_v()),
                                    Vec2(u, s.last_v())},
                              inside = {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1)};
    for (std::size_t i = 0; i < sides.size(); ++i)
      add(number, Border(sides[i]), is_on_the_right(face, at[i], inside[i], tangent_at(sides[i], 0.5)));
  }

  void add_edges(std::size_t number) {
    const Face& face = part_.faces[number];
    if (runs_through_pole(face)) return;
    const Region region(face);
    if (!region.is_known()) return;
    const std::size_t first = rims_.size();
    std::optional<SurfaceSet> surface;
    for (const Loop& loop : face.loops)
      for (const Edge& edge : loop.edges) {
        if (edge.curve.points.empty()) continue;
        const auto place = [&](double share) -> Vec2 {
          if (!edge.flat.points.empty()) return at_share(edge.flat, share).head<2>();
          if (!surface) surface.emplace(std::vector{&face.surface});
          const SurfaceSet::Foot foot = surface->near(at_share(edge.curve, share));
          return {foot.u, foot.v};
        };
        const Vec2 at = place(0.5), along = place(0.51) - place(0.49);
        const nurbs::SurfaceJet jet = nurbs::evaluate_jet(face.surface, at.x(), at.y());
        // Across the edge, as far as its length or the range goes.
        const double du = jet.du.norm(), dv = jet.dv.norm();
        if (!(du > 0) || !(dv > 0)) continue;
        Vec2 across(-along.y() * dv / du, along.x() * du / dv);
        const double length = std::hypot(across.x() * du, across.y() * dv);
        if (!(length > 0)) continue;
        Border border(edge.curve);
        across *= border.length() / length;
        const std::optional<Vec2> inside = into_face(region, at, across);
        if (inside)
          add(number, std::move(border), is_on_the_right(face, at, *inside, tangent_at(edge.curve, 0.5)));
      }
    // Loops have the face on one side all along: else it was not understood where the face is, as on a sphere
    // with loops through its poles.
    const auto differs = [&](const Rim& rim) { return rim.is_against != rims_[first].is_against; };
    if (std::any_of(rims_.begin() + static_cast<std::ptrdiff_t>(first), rims_.end(), differs))
      rims_.erase(rims_.begin() + static_cast<std::ptrdiff_t>(first), rims_.end());
  }

  // The rims of other faces that pass through the middle of a rim: one of them is its neighbour there.
  void find_neighbours() {
    neighbours_.resize(part_.faces.size());
    std::vector<Box3> boxes;
    boxes.reserve(rims_.size());
    for (const Rim& rim : rims_) boxes.push_back(rim.border.box());
    const BoxTree tree(std::move(boxes));
    for (std::size_t i = 0; i < rims_.size(); ++i) {
      const std::vector<Vec3>& points = rims_[i].border.points();
      const std::size_t middle = points.size() / 2;
      std::vector<std::size_t> near;
      tree.near_point(points[middle], 2 * tolerance_, [&](std::size_t k) {
        if (k != i && rims_[k].border.distance(points[middle], rims_[i].border.share(middle), 0,
                                               2 * tolerance_) <= tolerance_)
          near.push_back(k);
        return 2 * tolerance_;
      });
      if (near.size() != 1 || rims_[near.front()].face == rims_[i].face) continue;
      const Rim& other = rims_[near.front()];
      const Vec3 own = direction(rims_[i], points[middle]), its = direction(other, points[middle]);
      const double cosine = own.dot(its) / (own.norm() * its.norm());
      if (!(std::abs(cosine) > 0.5)) continue;
      const bool same = cosine < 0;
      neighbours_[rims_[i].face].emplace_back(other.face, same);
      neighbours_[other.face].emplace_back(rims_[i].face, same);
    }
  }

  // With the face on the left, at its point nearest to `p`.
  static Vec3 direction(const Rim& rim, const Vec3& p) {
    const std::vector<Vec3>& points = rim.border.points();
    const auto nearest =
        std::ranges::min_element(points, {}, [&](const Vec3& q) { return (q - p).squaredNorm(); });
    const auto k = static_cast<std::size_t>(nearest - points.begin());
    const Vec3 along = points[std::min(k + 1, points.size() - 1)] - points[k == 0 ? 0 : k - 1];
    return rim.is_against ? Vec3(-along) : along;
  }

  const Part& part_;
  double tolerance_;
  std::vector<Rim> rims_;
  std::vector<std::vector<std::pair<std::size_t, bool>>> neighbours_;  // of each face; looks the same way?
};

}  // namespace

std::vector<std::size_t> turned_faces(const Part& part, double tolerance) {
  return Finder(part, tolerance).turned();
}

}  // namespace selvage::cad
