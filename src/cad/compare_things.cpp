#include "cad/compare_things.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <tuple>

#include "cad/outline.h"
#include "nurbs/basis.h"

namespace selvage::cad {

using nurbs::Surface;

Range range_of(const Thing& thing, std::size_t k) {
  return k < thing.faces.size() ? used_range(*thing.faces[k]) : domain(*thing.surfaces[k]);
}

std::optional<Region> region_of(const Thing& thing, std::size_t k) {
  if (k >= thing.faces.size() || thing.faces[k]->loops.empty()) return std::nullopt;
  return Region(*thing.faces[k]);
}

bool is_within(const Reach& reach, double limit) {
  return reach.at_most <= limit || (std::isfinite(reach.at_most) && reach.at_least <= limit);
}

SurfaceFinding ThingComparer::compare_surfaces(const Thing& a, std::size_t i, const Thing& b,
                                               std::size_t j) const {
  const Surface &s = *a.surfaces[i], &t = *b.surfaces[j];
  SurfaceFinding finding;
  finding.points = compare_control_points(s, t, limits_.points);
  const bool is_trimmed =
      i < a.faces.size() && j < b.faces.size() && (!a.faces[i]->loops.empty() || !b.faces[j]->loops.empty());
  if (finding.points) {
    finding.reach = {finding.points->largest, finding.points->bound,
                     s.point(finding.points->i, finding.points->j)};
    if (finding.reach.at_most <= limits_.points && !is_trimmed) return finding;
  }
  const bool by_points = finding.points && finding.reach.at_most <= limits_.points;
  if (!finding.points) finding.reach = {};
  if (is_trimmed) {
    const Reach outlines = outline_distance(*a.faces[i], *b.faces[j], limits_.distances);
    if (!by_points && !(is_flat(s) && is_flat(t))) {
      const Reach surfaces = trimmed_distance(*a.faces[i], *b.faces[j], limits_.distances);
      finding.reach = worse(surfaces, outlines, limits_.distances);
      finding.points.reset();
    } else if (!by_points || outlines.at_most > std::max(limits_.distances, finding.reach.at_most)) {
      finding.reach = outlines;
      finding.points.reset();
    } else if (outlines.at_most > finding.reach.at_most) {
      finding.reach.at_most = outlines.at_most;
      if (finding.reach.at_most > limits_.points) finding.points.reset();
    }
    return finding;
  }
  if (finding.points) return finding;
  finding.reach = distance_between(s, t);
  return finding;
}

Reach ThingComparer::distance_between(const Surface& s, const Surface& t) const {
  const SurveyOptions survey = {.near = largest_spread};
  const Reach there = distance_to(s, domain(s), SurfaceSet({&t}), limits_.distances, survey);
  const Reach back = distance_to(t, domain(t), SurfaceSet({&s}), limits_.distances, survey);
  return worse(there, back, limits_.distances);
}

// Where a seam lies elsewhere, or a yarn runs the other way, most control points are far from those of their
// number, and the surfaces are not.
void ThingComparer::look_beyond_points(const Thing& a, const Thing& b,
                                       const std::vector<std::size_t>& partner,
                                       std::vector<SurfaceFinding>& found) const {
  constexpr int points = 36;
  constexpr double far = 1e-4;
  for (std::size_t i = 0; i < found.size(); ++i) {
    SurfaceFinding& one = found[i];
    const Surface &s = *a.surfaces[i], &t = *b.surfaces[partner[i]];
    if (!one.points || one.reach.at_most <= limits_.points) continue;
    if (4 * one.points->changed < s.points.size()) continue;
    if (one.points->largest <= far * box_of(s.points).diagonal().norm()) continue;
    const Reach sample = sampled_distance(s, domain(s), SurfaceSet({&t}), limits_.distances, points);
    if (sample.found > 0.5 * one.points->largest) continue;
    const Reach distance = distance_between(s, t);
    if (distance.at_most > 0.5 * one.points->largest) continue;
    one.reach = distance;
    one.points.reset();
  }
}

// Which surface of b belongs to each one of a, which has as many: what lies at the same place, its own number
// first, then what is nearest.
std::vector<std::size_t> ThingComparer::partners(const Thing& a, const Thing& b) const {
  const std::size_t count = a.surfaces.size();
  std::vector<std::size_t> partner(count);
  std::iota(partner.begin(), partner.end(), 0);
  constexpr std::size_t most = 4000;
  if (count == 1 || count > most) return partner;
  std::vector<Place> of_a, of_b;
  Box3 all_a, all_b;
  for (std::size_t k = 0; k < count; ++k) {
    all_a.extend(of_a.emplace_back(place_of(*a.faces[k])).box);
    all_b.extend(of_b.emplace_back(place_of(*b.faces[k])).box);
  }
  const Vec3 moved = all_b.center() - all_a.center();
  const Vec3 shift = moved.norm() <= 1e-3 * all_a.diagonal().norm() ? Vec3(Vec3::Zero()) : moved;
  const auto box_distance = [&](std::size_t i, std::size_t j) {
    return (of_a[i].box.min() + shift - of_b[j].box.min()).norm() +
           (of_a[i].box.max() + shift - of_b[j].box.max()).norm();
  };
  // The points inside depend on how the parameters run: their middle tells only what the box does not.
  const auto distance = [&](std::size_t i, std::size_t j) {
    const std::optional<Vec3>&middle_a = of_a[i].middle, &middle_b = of_b[j].middle;
    const double inside = middle_a && middle_b ? (*middle_a + shift - *middle_b).norm() : 0.0;
    return box_distance(i, j) + 0.1 * inside;
  };
  struct FacePair {
    double distance;
    std::size_t i, order;
    bool operator<(const FacePair& other) const {
      return std::tie(distance, i, order) < std::tie(other.distance, other.i, other.order);
    }
  };
  std::vector<bool> done(count), taken(count);
  const auto take_best = [&](std::size_t i) {
    std::vector<FacePair> list;
    for (std::size_t k = 0; k < count; ++k)
      if (const std::size_t j = (i + k) % count; !taken[j]) list.push_back({distance(i, j), i, k});
    return list;
  };
  const double same = std::max(limits_.near, 1e-4 * all_a.diagonal().norm());
  for (std::size_t i = 0; i < count; ++i) {
    const std::vector<FacePair> list = take_best(i);
    const FacePair& best = *std::min_element(list.begin(), list.end());
    const std::size_t j = (i + best.order) % count;
    if (box_distance(i, j) > same) continue;
    partner[i] = j;
    done[i] = taken[j] = true;
  }
  std::vector<FacePair> rest;
  for (std::size_t i = 0; i < count; ++i)
    if (!done[i]) std::ranges::copy(take_best(i), std::back_inserter(rest));
  std::sort(rest.begin(), rest.end());
  for (const FacePair& candidate : rest) {
    const std::size_t j = (candidate.i + candidate.order) % count;
    if (done[candidate.i] || taken[j]) continue;
    partner[candidate.i] = j;
    done[candidate.i] = taken[j] = true;
  }
  return partner;
}

// Each surface against all of the other side's.
PairFinding ThingComparer::compare_unions(const Thing& a, const Thing& b) const {
  PairFinding finding;
  const SurfaceSet all_a(a.surfaces), all_b(b.surfaces);
  for (std::size_t i = 0; i < a.surfaces.size(); ++i) {
    const std::optional<Region> region = region_of(a, i);
    const SurveyOptions survey = {.near = largest_spread, .region = region ? &*region : nullptr};
    const Reach reach = distance_to(*a.surfaces[i], range_of(a, i), all_b, limits_.distances, survey);
    if (i > 0 && &worse(finding.reach, reach, limits_.distances) == &finding.reach) continue;
    finding.reach = reach;
    finding.surface = i;
  }
  for (std::size_t j = 0; j < b.surfaces.size(); ++j) {
    const std::optional<Region> region = region_of(b, j);
    const SurveyOptions survey = {.near = largest_spread, .region = region ? &*region : nullptr};
    const Reach reach = distance_to(*b.surfaces[j], range_of(b, j), all_a, limits_.distances, survey);
    if (&worse(finding.reach, reach, limits_.distances) == &finding.reach) continue;
    finding.reach = reach;
    finding.surface = a.surfaces.size();
  }
  finding.is_equal = is_within(finding.reach, limits_.distances);
  return finding;
}

// Of a shape with symmetries another way to lay the parameters may be nearer than the one that was moved.
void ThingComparer::find_motion(const Thing& a, const Thing& b, const std::vector<std::size_t>& partner,
                                const std::vector<SurfaceFinding>& found, PairFinding& finding) const {
  for (const bool plain : {true, false}) {
    std::vector<Vec3> from, to;
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (!found[k].points) return;
      const bool as_is = plain && found[k].points->fits_as_it_is;
      const Alignment alignment = as_is ? Alignment{} : found[k].points->alignment;
      const Surface &s = *a.surfaces[k], &t = *b.surfaces[partner[k]];
      from.insert(from.end(), s.points.begin(), s.points.end());
      for (int j = 0; j < s.count_v; ++j)
        for (int i = 0; i < s.count_u; ++i) to.push_back(t.points[alignment.index_in(t, i, j)]);
    }
    finding.motion = motion_between(from, to, std::min(limits_.motion, 1e-3 * finding.reach.at_least));
    if (finding.motion) return;
  }
}

// By a few points of each surface.
bool ThingComparer::lies_on(const Thing& a, const Thing& b) const {
  constexpr int points = 36;
  const SurfaceSet all_b(b.surfaces);
  return std::ranges::all_of(a.surfaces, [&](const Surface* surface) {
    return sampled_distance(*surface, domain(*surface), all_b, limits_.distances, points).at_least <=
           limits_.distances;
  });
}

// The worst surface is one that differs, where there is such a one.
void ThingComparer::sum_up(const Thing& a, const std::vector<SurfaceFinding>& found,
                           PairFinding& finding) const {
  finding = {};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const SurfaceFinding& one = found[i];
    finding.count += a.surfaces[i]->points.size();
    if (one.points) finding.changed += one.points->changed;
    const bool is_equal =
        one.points ? one.reach.at_most <= limits_.points : is_within(one.reach, limits_.distances);
    const bool is_worse = is_equal == finding.is_equal
                              ? &worse(finding.reach, one.reach, limits_.distances) == &one.reach
                              : !is_equal;
    finding.is_equal = finding.is_equal && is_equal;
    if (i > 0 && !is_worse) continue;
    finding.reach = one.reach;
    finding.points = one.points;
    finding.surface = i;
  }
}

PairFinding ThingComparer::look_at(const Thing& a, const Thing& b,
                                   const std::vector<std::size_t>& partner) const {
  std::vector<SurfaceFinding> found;
  for (std::size_t i = 0; i < a.surfaces.size(); ++i) found.push_back(compare_surfaces(a, i, b, partner[i]));
  PairFinding finding;
  sum_up(a, found, finding);
  if (!finding.is_equal && finding.reach.at_least > limits_.points) {
    find_motion(a, b, partner, found, finding);
    // A shape with symmetries that turns on its place may be what it was: a sphere is, with its seam
    // elsewhere.
    const bool may_be_equal = finding.motion && finding.motion->angle > 0 && lies_on(a, b);
    if (finding.points && (!finding.motion || may_be_equal)) {
      const PairFinding moved = finding;
      look_beyond_points(a, b, partner, found);
      sum_up(a, found, finding);
      if (!finding.is_equal && moved.motion) finding = moved;
    }
  }
  finding.is_reversed = a.kind == Thing::Kind::yarn && partner.size() == 3 && partner[0] == 0 &&
                        partner[1] == 2 && partner[2] == 1;
  return finding;
}

// Mostly the surfaces have kept their order.
PairFinding ThingComparer::look_at(const Thing& a, const Thing& b) const {
  const std::size_t count = a.surfaces.size();
  if (count != b.surfaces.size()) return compare_unions(a, b);
  std::vector<std::size_t> in_order(count);
  std::iota(in_order.begin(), in_order.end(), 0);
  bool bases_agree = true;
  for (std::size_t k = 0; k < count && bases_agree; ++k)
    bases_agree = have_one_basis(*a.surfaces[k], *b.surfaces[k]);
  std::optional<PairFinding> ordered;
  if (bases_agree || count == 1) {
    ordered = look_at(a, b, in_order);
    if (ordered->is_equal || ordered->motion || count == 1) return *ordered;
  }
  const std::vector<std::size_t> partner = partners(a, b);
  if (ordered && partner == in_order) return *ordered;
  PairFinding other = look_at(a, b, partner);
  return ordered && ordered->reach.at_most <= other.reach.at_most ? *ordered : other;
}

// A difference that a point shows is one however the surfaces belong together.
std::optional<PairFinding> ThingComparer::glance_at(const Thing& a, const Thing& b) const {
  constexpr int points_of_one = 160, points_of_many = 12;
  constexpr std::size_t many = 6;
  if (a.surfaces.size() == b.surfaces.size()) {
    bool bases_agree = true;
    for (std::size_t k = 0; k < a.surfaces.size() && bases_agree; ++k)
      bases_agree = have_one_basis(*a.surfaces[k], *b.surfaces[k]);
    if (bases_agree) return std::nullopt;  // their control points are compared
  }
  const SurfaceSet all_b(b.surfaces);
  for (std::size_t k = 0; k < a.surfaces.size(); ++k) {
    const std::optional<Region> region = region_of(a, k);
    if (region && !region->is_known()) continue;
    const Reach reach = sampled_distance(*a.surfaces[k], range_of(a, k), all_b, limits_.distances,
                                         a.surfaces.size() > many ? points_of_many : points_of_one,
                                         region ? &*region : nullptr);
    if (reach.at_least <= std::max(limits_.distances, 0.5 * reach.found)) continue;
    PairFinding finding;
    finding.reach = reach;
    finding.surface = k;
    finding.is_equal = false;
    return finding;
  }
  return std::nullopt;
}

}  // namespace selvage::cad
