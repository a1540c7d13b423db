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

// The site of the triangle's corner that is nearest to `p`; none on an end face.
std::optional<Vec2> site_near(const Tessellation& skin, std::uint32_t triangle, const Vec3& p) {
  std::optional<Vec2> best;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::uint32_t v : skin.triangles[triangle]) {
    const double distance = (skin.vertices[v] - p).norm();
    if (!skin.sites[v].allFinite() || distance >= nearest) continue;
    best = skin.sites[v];
    nearest = distance;
  }
  return best;
}

// The window round the sites of some triangles, a tenth wider on each side; none where an end face is among them.
std::optional<Window> window_of(const yarn::Body& body, const Tessellation& skin,
                                const std::vector<std::uint32_t>& triangles) {
  if (triangles.empty()) return std::nullopt;
  const Vec2 period(body.surface.last_u() - body.surface.first_u(), body.surface.last_v() - body.surface.first_v());
  std::optional<Vec2> anchor;
  Eigen::AlignedBox2d box;
  for (std::uint32_t k : triangles)
    for (std::uint32_t v : skin.triangles[k]) {
      Vec2 site = skin.sites[v];
      if (!site.allFinite()) return std::nullopt;
      if (!anchor) anchor = site;
      site.x() -= period.x() * std::round((site.x() - anchor->x()) / period.x());
      if (body.closed_along) site.y() -= period.y() * std::round((site.y() - anchor->y()) / period.y());
      box.extend(site);
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
  const std::optional<Vec2> site_a = site_near(pair.skin_a, near.a, points.a);
  const std::optional<Vec2> site_b = site_near(pair.skin_b, near.b, points.b);
  if (!site_a || !site_b) return std::nullopt;
  std::optional<Critical> found = find_critical(pair.a, *site_a, pair.b, *site_b);
  // The surfaces are nearer than the triangles, or farther, by the chord errors at most.
  if (found && std::abs(found->depth + near.distance) > 1.5 * pair.chord) return std::nullopt;
  return found;
}

Measure measure_of(double depth, const Vec3& p, const Vec3& q, const Vec3& n) { return {depth, 0.5 * (p + q), n}; }
Measure measure_of(const Critical& c) { return measure_of(c.depth, c.p, c.q, c.normal); }

// The parting along n as a critical pair of the surfaces, when it is one: then it is exact, and n the easiest direction
// near it.
std::optional<Measure> settle(const Pair& pair, const SharedSpace& space, const Tessellation& on_a,
                              const Tessellation& on_b, const Vec3& n) {
  const Parting parting = space.parting(n);
  if (!(parting.distance > 0.0)) return std::nullopt;
  const std::optional<Vec2> site_a = site_near(on_a, parting.a, parting.p), site_b = site_near(on_b, parting.b, parting.q);
  if (!site_a || !site_b) return std::nullopt;
  const std::optional<Critical> found = find_critical(pair.a, *site_a, pair.b, *site_b);
  if (!found || found->normal.dot(n) < 0.7 || std::abs(found->depth - parting.distance) > 0.1 * parting.distance + pair.chord)
    return std::nullopt;
  // A line along the normal on which the two are deeper in each other: this is no largest one.
  if (space.parting(found->normal).distance > found->depth * 1.003) return std::nullopt;
  return measure_of(*found);
}

// The parting along a fixed direction on sheets that close in on where it is largest.
Measure close_in(const Pair& pair, const Vec3& n, const Parting& start, const Tessellation& on_a, const Tessellation& on_b) {
  Measure result = measure_of(start.distance, start.p, start.q, n);
  std::optional<Vec2> site_a = site_near(on_a, start.a, start.p), site_b = site_near(on_b, start.b, start.q);
  for (double share = 1.0 / 16.0; site_a && site_b && share > 1e-4; share /= 6.0) {
    const Tessellation sheet_a = sample(pair.a, window_about(pair.a, *site_a, share), sheet_cells);
    const Tessellation sheet_b = sample(pair.b, window_about(pair.b, *site_b, share), sheet_cells);
    const Parting parting = SharedSpace(sheet_a, sheet_b, sheet_a.vertices, false).parting(n);
    // Past an edge of the sheets the largest is elsewhere: what was found stands.
    if (std::abs(parting.distance - result.depth) > 0.1 * result.depth + pair.chord) break;
    result = measure_of(parting.distance, parting.p, parting.q, n);
    site_a = site_near(sheet_a, parting.a, parting.p);
    site_b = site_near(sheet_b, parting.b, parting.q);
  }
  return result;
}

std::vector<Vec3> corners_of(const Pair& pair, const Contact& contact) {
  std::vector<Vec3> points;
  for (std::uint32_t k : contact.a)
    for (std::uint32_t v : pair.skin_a.triangles[k]) points.push_back(pair.skin_a.vertices[v]);
  for (std::uint32_t k : contact.b)
    for (std::uint32_t v : pair.skin_b.triangles[k]) points.push_back(pair.skin_b.vertices[v]);
  return points;
}

// Which way A's wall of the contact faces against B's: the direction to part them in while the overlap is shallow; how
// much of the walls faces so (1: all).
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

Measure search(const Pair& pair, const SharedSpace& space, const Tessellation& on_a, const Tessellation& on_b,
               const std::vector<Vec3>& starts) {
  const Vec3 n = space.easiest_direction(starts);
  if (const std::optional<Measure> exact = settle(pair, space, on_a, on_b, n)) return *exact;
  return close_in(pair, n, space.parting(n), on_a, on_b);
}

// A shallow overlap: only the near parts of both surfaces count, as fine sheets.
std::optional<Measure> measure_shallow(const Pair& pair, const Contact& contact, const Vec3& facing) {
  const std::optional<Window> window_a = window_of(pair.a, pair.skin_a, contact.a);
  const std::optional<Window> window_b = window_of(pair.b, pair.skin_b, contact.b);
  if (!window_a || !window_b) return std::nullopt;
  const Tessellation sheet_a = sample(pair.a, *window_a, sheet_cells), sheet_b = sample(pair.b, *window_b, sheet_cells);
  const SharedSpace space(sheet_a, sheet_b, corners_of(pair, contact), false);
  if (std::optional<Measure> exact = settle(pair, space, sheet_a, sheet_b, facing)) return exact;
  if (space.parting(facing).distance > 0.0) return search(pair, space, sheet_a, sheet_b, {facing});
  // So shallow that no line met it.
  const std::optional<Critical> found = find_critical_near(pair, contact.nearest);
  if (!found) return std::nullopt;
  return measure_of(*found);
}

// The distance of two skins at their nearest pair of triangles, on sheets that close in on it.
Measure measure_gap(const Pair& pair, const TriangleTree::Pair& nearest) {
  Closest best = closest(corners_of(pair.skin_a, nearest.a), corners_of(pair.skin_b, nearest.b));
  std::optional<Vec2> site_a = site_near(pair.skin_a, nearest.a, best.a), site_b = site_near(pair.skin_b, nearest.b, best.b);
  for (double share = 1.0 / 16.0; site_a && site_b && share > 1e-3; share /= 6.0) {
    const Tessellation sheet_a = sample(pair.a, window_about(pair.a, *site_a, share), sheet_cells / 2);
    const Tessellation sheet_b = sample(pair.b, window_about(pair.b, *site_b, share), sheet_cells / 2);
    const TriangleTree::Pair found = TriangleTree::nearest_pair(TriangleTree(sheet_a), TriangleTree(sheet_b));
    best = closest(corners_of(sheet_a, found.a), corners_of(sheet_b, found.b));
    site_a = site_near(sheet_a, found.a, best.a);
    site_b = site_near(sheet_b, found.b, best.b);
  }
  return measure_of(-best.distance, best.a, best.b, (best.b - best.a).normalized());
}

Measure measure_near(const Pair& pair, const Contact& contact) {
  if (const std::optional<Critical> found = find_critical_near(pair, contact.nearest)) return measure_of(*found);
  return measure_gap(pair, contact.nearest);
}

}  // namespace

double touching(const yarn::Body& a, const yarn::Body& b) {
  return 64.0 * std::max(sewing_gap(a), sewing_gap(b));
}

Measure measure(const Skinned& a, const Skinned& b, const Contact& contact) {
  const Pair pair{*a.body, *b.body, *a.skin, *b.skin, a.chord + b.chord};
  const Facing facing = facing_of(pair, contact);
  if (!contact.shared) {
    const Measure near = measure_near(pair, contact);
    if (near.depth <= touching(*a.body, *b.body)) return near;
    return measure_shallow(pair, contact, facing.direction).value_or(near);
  }
  if (facing.share > 0.7)
    if (const std::optional<Measure> shallow = measure_shallow(pair, contact, facing.direction)) return *shallow;
  std::vector<Vec3> starts = directions_all_round();
  if (facing.share > 0.0) starts.push_back(facing.direction);
  const SharedSpace space(pair.skin_a, pair.skin_b, corners_of(pair, contact), true);
  return search(pair, space, pair.skin_a, pair.skin_b, starts);
}

}  // namespace selvage::solid
