#include "solid/cgal/depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solid/cgal/separation.h"
#include "solid/cgal/surface_pair.h"

namespace selvage::solid {

namespace {

constexpr int sheet_cells = 40;

Vec3 area_vector(const Tessellation& skin, std::uint32_t k) {
  const auto& t = skin.triangles[k];
  return 0.5 * (skin.vertices[t[1]] - skin.vertices[t[0]]).cross(skin.vertices[t[2]] - skin.vertices[t[0]]);
}

// How much of the directions' whole ranges a body's parameters go round in; infinite where they do not.
Vec2 periods(const yarn::Body& body) {
  const nurbs::Surface& s = body.surface;
  return {s.last_u() - s.first_u(),
          body.closed_along ? s.last_v() - s.first_v() : std::numeric_limits<double>::infinity()};
}

// The site that is `site` too, nearest to `anchor`.
Vec2 unrolled(const Vec2& site, const Vec2& anchor, const Vec2& period) {
  Vec2 out = site;
  for (int k = 0; k < 2; ++k)
    if (std::isfinite(period[k])) out[k] -= period[k] * std::round((site[k] - anchor[k]) / period[k]);
  return out;
}

// The site of a point on a triangle; none on an end face.
std::optional<Vec2> site_of(const yarn::Body& body, const Tessellation& skin, std::uint32_t triangle,
                            const Vec3& p) {
  const auto& t = skin.triangles[triangle];
  for (std::uint32_t v : t)
    if (!skin.sites[v].allFinite()) return std::nullopt;
  const Vec3 e1 = skin.vertices[t[1]] - skin.vertices[t[0]], e2 = skin.vertices[t[2]] - skin.vertices[t[0]];
  const Vec3 normal = e1.cross(e2), way = p - skin.vertices[t[0]];
  const double size = normal.squaredNorm();
  if (size == 0.0) return skin.sites[t[0]];
  const double s1 = std::clamp(way.cross(e2).dot(normal) / size, 0.0, 1.0);
  const double s2 = std::clamp(e1.cross(way).dot(normal) / size, 0.0, 1.0 - s1);
  const Vec2& first = skin.sites[t[0]];
  return (1.0 - s1 - s2) * first + s1 * unrolled(skin.sites[t[1]], first, periods(body)) +
         s2 * unrolled(skin.sites[t[2]], first, periods(body));
}

// The window round the sites of some triangles, a tenth wider on each side; none where an end face is among
// them.
std::optional<Window> window_of(const yarn::Body& body, const Tessellation& skin,
                                const std::vector<std::uint32_t>& triangles) {
  if (triangles.empty()) return std::nullopt;
  std::optional<Vec2> anchor;
  Eigen::AlignedBox2d box;
  for (std::uint32_t k : triangles)
    for (std::uint32_t v : skin.triangles[k]) {
      const Vec2& site = skin.sites[v];
      if (!site.allFinite()) return std::nullopt;
      if (!anchor) anchor = site;
      box.extend(unrolled(site, *anchor, periods(body)));
    }
  const Vec2 margin = 0.1 * box.diagonal();
  return Window{box.min() - margin, box.max() + margin};
}

// A square window about a site, as wide as a sixteenth of the section's way round.
Window window_about(const yarn::Body& body, const Vec2& site, double share) {
  const nurbs::SurfaceJet jet = nurbs::evaluate_jet(body.surface, site.x(), site.y());
  const double du = share * (body.surface.last_u() - body.surface.first_u());
  const double dv = std::min(du * jet.du.norm() / std::max(jet.dv.norm(), 1e-300),
                             0.5 * (body.surface.last_v() - body.surface.first_v()));
  return {site - Vec2(du, dv), site + Vec2(du, dv)};
}

struct Pair {
  const yarn::Body& a;
  const yarn::Body& b;
  const Tessellation& skin_a;
  const Tessellation& skin_b;
  double chord;  // of both together
};

Triangle corners_of(const Tessellation& skin, std::uint32_t k) {
  const auto& t = skin.triangles[k];
  return {skin.vertices[t[0]], skin.vertices[t[1]], skin.vertices[t[2]]};
}

// The critical pair of the surfaces that belongs to two near triangles.
std::optional<Critical> find_critical_near(const Pair& pair, const TriangleTree::Pair& near) {
  const Closest points = closest(corners_of(pair.skin_a, near.a), corners_of(pair.skin_b, near.b));
  const std::optional<Vec2> site_a = site_of(pair.a, pair.skin_a, near.a, points.a);
  const std::optional<Vec2> site_b = site_of(pair.b, pair.skin_b, near.b, points.b);
  if (!site_a || !site_b) return std::nullopt;
  std::optional<Critical> found = find_critical(pair.a, *site_a, pair.b, *site_b);
  // The surfaces are nearer than the triangles, or farther, by the chord errors at most.
  if (found && std::abs(found->depth + near.distance) > 1.5 * pair.chord) return std::nullopt;
  return found;
}

Measure measure_of(double depth, const Vec3& p, const Vec3& q, const Vec3& n) {
  return {depth, 0.5 * (p + q), n};
}
Measure measure_of(const Critical& c) {
  return measure_of(c.depth, c.p, c.q, c.normal);
}

// The parting along n as a critical pair of the surfaces, when it is one: then it is exact, and n the easiest
// direction near it.
std::optional<Measure> settle(const Pair& pair, const SharedSpace& space, const Tessellation& on_a,
                              const Tessellation& on_b, const Vec3& n) {
  const Parting parting = space.parting(n);
  if (!(parting.distance > 0.0)) return std::nullopt;
  const std::optional<Vec2> site_a = site_of(pair.a, on_a, parting.a, parting.p),
                            site_b = site_of(pair.b, on_b, parting.b, parting.q);
  if (!site_a || !site_b) return std::nullopt;
  const std::optional<Critical> found = find_critical(pair.a, *site_a, pair.b, *site_b);
  if (!found || found->normal.dot(n) < 0.7 ||
      std::abs(found->depth - parting.distance) > 0.1 * parting.distance + pair.chord)
    return std::nullopt;
  // A line along the normal on which the two are deeper in each other: this is no largest one.
  if (space.parting(found->normal).distance > found->depth * 1.003) return std::nullopt;
  return measure_of(*found);
}

// The parting along a fixed direction on sheets that close in on where it is largest, from two sites on.
// `start`: what is known of it; nothing when no line has met it yet.
std::optional<Measure> close_in(const Pair& pair, const Vec3& n, std::optional<Vec2> site_a,
                                std::optional<Vec2> site_b, std::optional<Measure> start) {
  for (double share = 1.0 / 16.0; site_a && site_b && share > 1e-4; share /= 6.0) {
    const Tessellation sheet_a = sample(pair.a, window_about(pair.a, *site_a, share), sheet_cells);
    const Tessellation sheet_b = sample(pair.b, window_about(pair.b, *site_b, share), sheet_cells);
    const Parting parting = SharedSpace(sheet_a, sheet_b, sheet_a.vertices, false).parting(n);
    if (!(parting.distance > 0.0)) continue;
    // Past an edge of the sheets the largest is elsewhere: what was found stands.
    if (start && std::abs(parting.distance - start->depth) > 0.1 * start->depth + pair.chord) break;
    start = measure_of(parting.distance, parting.p, parting.q, n);
    site_a = site_of(pair.a, sheet_a, parting.a, parting.p);
    site_b = site_of(pair.b, sheet_b, parting.b, parting.q);
  }
  return start;
}

std::vector<Vec3> corners_of(const Pair& pair, const Contact& contact) {
  std::vector<Vec3> points;
  for (std::uint32_t k : contact.a)
    for (std::uint32_t v : pair.skin_a.triangles[k]) points.push_back(pair.skin_a.vertices[v]);
  for (std::uint32_t k : contact.b)
    for (std::uint32_t v : pair.skin_b.triangles[k]) points.push_back(pair.skin_b.vertices[v]);
  return points;
}

// Which way A's wall of the contact faces against B's: the direction to part them in while the overlap is
// shallow; how much of the walls faces so (1: all).
struct Facing {
  Vec3 direction = Vec3::Zero();
  double share = 0;
};

Facing facing_of(const Pair& pair, const Contact& contact) {
  Vec3 sum = Vec3::Zero();
  double total = 0.0;
  for (std::uint32_t k : contact.a) {
    sum += area_vector(pair.skin_a, k);
    total += area_vector(pair.skin_a, k).norm();
  }
  for (std::uint32_t k : contact.b) {
    sum -= area_vector(pair.skin_b, k);
    total += area_vector(pair.skin_b, k).norm();
  }
  return {sum.normalized(), total > 0.0 ? sum.norm() / total : 0.0};
}

// Nothing: no line met the shared space, so thin is it.
std::optional<Measure> search(const Pair& pair, const SharedSpace& space, const Tessellation& on_a,
                              const Tessellation& on_b, const std::vector<Vec3>& starts) {
  const Vec3 n = space.easiest_direction(starts);
  if (std::optional<Measure> exact = settle(pair, space, on_a, on_b, n)) return exact;
  const Parting parting = space.parting(n);
  if (!(parting.distance > 0.0)) return std::nullopt;
  return close_in(pair, n, site_of(pair.a, on_a, parting.a, parting.p),
                  site_of(pair.b, on_b, parting.b, parting.q),
                  measure_of(parting.distance, parting.p, parting.q, n));
}

// A shallow overlap: only the near parts of both surfaces count, as fine sheets.
std::optional<Measure> measure_shallow(const Pair& pair, const Contact& contact, const Vec3& facing) {
  const std::optional<Window> window_a = window_of(pair.a, pair.skin_a, contact.a);
  const std::optional<Window> window_b = window_of(pair.b, pair.skin_b, contact.b);
  if (!window_a || !window_b) return std::nullopt;
  const Tessellation sheet_a = sample(pair.a, *window_a, sheet_cells),
                     sheet_b = sample(pair.b, *window_b, sheet_cells);
  const SharedSpace space(sheet_a, sheet_b, corners_of(pair, contact), false);
  if (std::optional<Measure> exact = settle(pair, space, sheet_a, sheet_b, facing)) return exact;
  if (space.parting(facing).distance > 0.0) return search(pair, space, sheet_a, sheet_b, {facing});
  // So shallow that no line met it.
  if (const std::optional<Critical> found = find_critical_near(pair, contact.nearest))
    return measure_of(*found);
  const Closest points =
      closest(corners_of(pair.skin_a, contact.nearest.a), corners_of(pair.skin_b, contact.nearest.b));
  return close_in(pair, facing, site_of(pair.a, pair.skin_a, contact.nearest.a, points.a),
                  site_of(pair.b, pair.skin_b, contact.nearest.b, points.b), std::nullopt);
}

// The distance of two skins at their nearest pair of triangles, on sheets that close in on it.
Measure measure_gap(const Pair& pair, const TriangleTree::Pair& nearest) {
  Closest best = closest(corners_of(pair.skin_a, nearest.a), corners_of(pair.skin_b, nearest.b));
  std::optional<Vec2> site_a = site_of(pair.a, pair.skin_a, nearest.a, best.a),
                      site_b = site_of(pair.b, pair.skin_b, nearest.b, best.b);
  for (double share = 1.0 / 16.0; site_a && site_b && share > 1e-3; share /= 6.0) {
    const Tessellation sheet_a = sample(pair.a, window_about(pair.a, *site_a, share), sheet_cells / 2);
    const Tessellation sheet_b = sample(pair.b, window_about(pair.b, *site_b, share), sheet_cells / 2);
    const TriangleTree::Pair found = TriangleTree::nearest_pair(TriangleTree(sheet_a), TriangleTree(sheet_b));
    best = closest(corners_of(sheet_a, found.a), corners_of(sheet_b, found.b));
    site_a = site_of(pair.a, sheet_a, found.a, best.a);
    site_b = site_of(pair.b, sheet_b, found.b, best.b);
  }
  return measure_of(-best.distance, best.a, best.b, (best.b - best.a).normalized());
}

Measure measure_near(const Pair& pair, const Contact& contact, const Vec3& facing) {
  const std::optional<Critical> found = find_critical_near(pair, contact.nearest);
  if (found && found->depth <= touching(pair.a, pair.b)) return measure_of(*found);
  // The surfaces can share space that their triangles do not.
  if (const std::optional<Measure> shallow = measure_shallow(pair, contact, facing)) return *shallow;
  return found ? measure_of(*found) : measure_gap(pair, contact.nearest);
}

}  // namespace

double touching(const yarn::Body& a, const yarn::Body& b) {
  return 64.0 * std::max(sewing_gap(a), sewing_gap(b));
}

Measure measure(const Skinned& a, const Skinned& b, const Contact& contact) {
  const Pair pair{*a.body, *b.body, *a.skin, *b.skin, a.chord + b.chord};
  const Facing facing = facing_of(pair, contact);
  if (!contact.shared) return measure_near(pair, contact, facing.direction);
  if (facing.share > 0.7)
    if (const std::optional<Measure> shallow = measure_shallow(pair, contact, facing.direction))
      return *shallow;
  std::vector<Vec3> starts = directions_all_round();
  if (facing.share > 0.0) starts.push_back(facing.direction);
  const SharedSpace space(pair.skin_a, pair.skin_b, corners_of(pair, contact), true);
  if (const std::optional<Measure> found = search(pair, space, pair.skin_a, pair.skin_b, starts))
    return *found;
  // The triangles meet, and yet nothing is to be measured: they touch.
  const std::vector<Vec3> corners = corners_of(pair, contact);
  return measure_of(0.0, corners.front(), corners.front(), Vec3::Zero());
}

}  // namespace selvage::solid
