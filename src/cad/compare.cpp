#include "cad/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <tuple>

#include "cad/basis.h"
#include "cad/outline.h"
#include "cad/region.h"
#include "cad/sampled_curve.h"
#include "core/parallel.h"
#include "core/readable.h"

namespace selvage::cad {

namespace {

using nurbs::Surface;

// What the arithmetic of distance_to leaves, as a share of the largest coordinate.
constexpr double arithmetic = 1e-13;
// A difference is told by bounds of which the upper one is at most this many times the lower one.
constexpr double largest_spread = 1.5;

struct Limits {
  double points = 0;     // control points that are this near are equal
  double distances = 0;  // surfaces over different bases
  double motion = 0;     // what a motion may leave
};

// Two surfaces that belong together.
struct SurfaceFinding {
  Reach reach;
  std::optional<ControlChange> points;  // where the bases agree
};

struct PairFinding {
  Reach reach;               // the worst of its surfaces
  std::size_t surface = 0;   // that has it, in a
  bool is_equal = true;      // within the limits
  bool is_reversed = false;  // the start of one yarn is the end of the other
  bool is_swapped = false;   // another pair has these two names the other way round
  std::optional<ControlChange> points;
  std::size_t changed = 0, count = 0;
  std::optional<Motion> motion;
};

// What of its surface `k` a thing has.
Range range_of(const Thing& thing, std::size_t k) {
  return k < thing.faces.size() ? used_range(*thing.faces[k]) : domain(*thing.surfaces[k]);
}

std::optional<Region> region_of(const Thing& thing, std::size_t k) {
  if (k >= thing.faces.size() || thing.faces[k]->loops.empty()) return std::nullopt;
  return Region(*thing.faces[k]);
}

class Comparer {
 public:
  Comparer(const Subject& a, const Subject& b, const CompareOptions& options)
      : a_(things_of(a, b)), b_(things_of(b, a)), subject_a_(a), subject_b_(b), options_(options) {
    double size = 0;
    for (const Things* things : {&a_, &b_})
      for (const Thing& thing : things->list)
        if (!thing.box.isEmpty())
          size =
              std::max({size, thing.box.min().cwiseAbs().maxCoeff(), thing.box.max().cwiseAbs().maxCoeff()});
    limits_.points = options.tolerance + options.rounding * size;
    limits_.distances = std::max(limits_.points, arithmetic * size);
    limits_.motion = std::max(limits_.points, 10 * arithmetic * size);
    near_ = std::max(2 * limits_.points, 1e-6 * size);
  }

  Comparison run();

 private:
  [[nodiscard]] PairFinding look_at(const Thing& a, const Thing& b) const;
  // Surface i of a is surface partner[i] of b.
  [[nodiscard]] PairFinding look_at(const Thing& a, const Thing& b,
                                    const std::vector<std::size_t>& partner) const;
  [[nodiscard]] SurfaceFinding compare_surfaces(const Thing& a, std::size_t i, const Thing& b,
                                                std::size_t j) const;
  // Do a few points tell that they differ?
  [[nodiscard]] std::optional<PairFinding> glance_at(const Thing& a, const Thing& b) const;
  // Nothing farther than `limit` was found.
  [[nodiscard]] bool is_within(const Reach& reach, double limit) const {
    return reach.at_most <= limit || (std::isfinite(reach.at_most) && reach.at_least <= limit);
  }
  [[nodiscard]] Reach distance_between(const Surface& s, const Surface& t) const;
  void look_beyond_points(const Thing& a, const Thing& b, const std::vector<std::size_t>& partner,
                          std::vector<SurfaceFinding>& found) const;
  [[nodiscard]] bool lies_on(const Thing& a, const Thing& b) const;
  void sum_up(const Thing& a, const std::vector<SurfaceFinding>& found, PairFinding& finding) const;
  [[nodiscard]] std::vector<std::size_t> partners(const Thing& a, const Thing& b) const;
  [[nodiscard]] PairFinding compare_unions(const Thing& a, const Thing& b) const;
  void find_motion(const Thing& a, const Thing& b, const std::vector<std::size_t>& partner,
                   const std::vector<SurfaceFinding>& found, PairFinding& finding) const;
  void report_pair(const Thing& a, const Thing& b, const PairFinding& finding);
  void report_lonely(const Thing& thing, Difference::Kind kind);
  void follow_names(Pairing& pairing, std::vector<PairFinding>& findings) const;
  void absorb_regrouped(Pairing& pairing);
  void release_regrouped(Pairing& pairing, std::vector<PairFinding>& findings);
  void add_notes();

  Things a_, b_;
  const Subject& subject_a_;
  const Subject& subject_b_;
  const CompareOptions& options_;
  Limits limits_;
  double near_ = 0;
  Comparison out_;
  std::size_t uncertain_ = 0;  // equal at all points that were looked at, without a bound that says so
  std::vector<std::string> reversed_;  // yarns that run the other way
  std::size_t without_name_ = 0, without_color_ = 0;
};

SurfaceFinding Comparer::compare_surfaces(const Thing& a, std::size_t i, const Thing& b,
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

Reach Comparer::distance_between(const Surface& s, const Surface& t) const {
  const SurveyOptions survey = {.near = largest_spread};
  const Reach there = distance_to(s, domain(s), SurfaceSet({&t}), limits_.distances, survey);
  const Reach back = distance_to(t, domain(t), SurfaceSet({&s}), limits_.distances, survey);
  return worse(there, back, limits_.distances);
}

// Where a seam lies elsewhere, or a yarn runs the other way, most control points are far from those of their
// number, and the surfaces are not.
void Comparer::look_beyond_points(const Thing& a, const Thing& b, const std::vector<std::size_t>& partner,
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
std::vector<std::size_t> Comparer::partners(const Thing& a, const Thing& b) const {
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
  const double same = std::max(near_, 1e-4 * all_a.diagonal().norm());
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
PairFinding Comparer::compare_unions(const Thing& a, const Thing& b) const {
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
void Comparer::find_motion(const Thing& a, const Thing& b, const std::vector<std::size_t>& partner,
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
bool Comparer::lies_on(const Thing& a, const Thing& b) const {
  constexpr int points = 36;
  const SurfaceSet all_b(b.surfaces);
  return std::ranges::all_of(a.surfaces, [&](const Surface* surface) {
    return sampled_distance(*surface, domain(*surface), all_b, limits_.distances, points).at_least <=
           limits_.distances;
  });
}

// The worst surface is one that differs, where there is such a one.
void Comparer::sum_up(const Thing& a, const std::vector<SurfaceFinding>& found, PairFinding& finding) const {
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

PairFinding Comparer::look_at(const Thing& a, const Thing& b, const std::vector<std::size_t>& partner) const {
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
PairFinding Comparer::look_at(const Thing& a, const Thing& b) const {
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
std::optional<PairFinding> Comparer::glance_at(const Thing& a, const Thing& b) const {
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

std::string surface_label(const Thing& thing, std::size_t k) {
  if (k >= thing.surfaces.size()) return "a surface of the second file";
  if (thing.surfaces.size() == 1) return {};
  if (thing.kind == Thing::Kind::yarn)
    return k == 0 ? "body" : k == 1 && thing.surfaces.size() == 3 ? "start" : "end";
  const std::string& name = thing.faces[k]->name;
  if (!name.empty() && name != thing.name) return fmt::format("surface '{}'", name);
  return fmt::format("surface {} of {}", k + 1, thing.surfaces.size());
}

Difference difference_of(const Thing& a, const Thing& b, Difference::Kind kind) {
  Difference difference;
  difference.kind = kind;
  difference.what = a.kind;
  difference.name = a.name;
  difference.other_name = b.name;
  if (!a.faces.empty()) difference.entity = a.faces.front()->origin.entity;
  return difference;
}

void Comparer::report_pair(const Thing& a, const Thing& b, const PairFinding& finding) {
  const std::size_t before = out_.differences.size();
  if (!finding.is_equal && finding.motion) {
    Difference& moved = out_.differences.emplace_back(difference_of(a, b, Difference::Kind::moved));
    moved.motion = *finding.motion;
    moved.reach = finding.reach;
  } else if (!finding.is_equal) {
    Difference& reshaped = out_.differences.emplace_back(difference_of(a, b, Difference::Kind::reshaped));
    reshaped.reach = finding.reach;
    reshaped.surface = surface_label(a, finding.surface);
    if (finding.points) {
      const Surface& surface = *a.surfaces[finding.surface];
      const int count_j = a.kind == Thing::Kind::curve ? 1 : surface.count_v;
      const std::size_t rows = a.kind == Thing::Kind::curve ? 2 : 1;
      reshaped.control_point = {finding.points->i + 1,  finding.points->j + 1, surface.count_u, count_j,
                                finding.changed / rows, finding.count / rows};
    }
  } else if (finding.reach.at_most > out_.largest) {
    out_.largest = finding.reach.at_most;
    out_.largest_of = a.name;
  }
  if (finding.is_equal && finding.reach.at_most > limits_.distances) ++uncertain_;
  if (a.name != b.name) {
    if (a.name.empty() || b.name.empty())
      ++without_name_;
    else
      out_.differences.emplace_back(difference_of(a, b, Difference::Kind::renamed)).is_swapped =
          finding.is_swapped;
  }
  if (finding.is_equal && finding.is_reversed) reversed_.push_back(a.name);
  if (a.color.has_value() != b.color.has_value()) ++without_color_;
  if (a.color && b.color && *a.color != *b.color) {
    Difference& recoloured = out_.differences.emplace_back(difference_of(a, b, Difference::Kind::recoloured));
    recoloured.before = *a.color;
    recoloured.after = *b.color;
  }
  if (out_.differences.size() == before) ++out_.equal;
}

void Comparer::report_lonely(const Thing& thing, Difference::Kind kind) {
  Difference& difference = out_.differences.emplace_back(difference_of(thing, thing, kind));
  difference.box = thing.box;
  difference.surfaces = thing.surfaces.size();
}

// Names that went round among things that stayed where they were: each of these is the other one's partner.
void Comparer::follow_names(Pairing& pairing, std::vector<PairFinding>& findings) const {
  constexpr std::size_t most = 2000;
  std::vector<std::size_t> changed;
  for (std::size_t k = 0; k < findings.size(); ++k)
    if (!findings[k].is_equal) changed.push_back(k);
  if (changed.size() < 2 || changed.size() > most) return;
  const auto at_one_place = [&](const Thing& a, const Thing& b) {
    const double near = std::max(near_, 1e-3 * a.box.diagonal().norm());
    return a.kind == b.kind && a.surfaces.size() == b.surfaces.size() &&
           (a.box.min() - b.box.min()).cwiseAbs().maxCoeff() <= near &&
           (a.box.max() - b.box.max()).cwiseAbs().maxCoeff() <= near;
  };
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> next(findings.size(), none);
  for (const std::size_t k : changed)
    for (const std::size_t l : changed)
      if (l != k && at_one_place(a_.list[pairing.pairs[k].first], b_.list[pairing.pairs[l].second]))
        next[k] = l;
  std::vector<bool> is_done(findings.size());
  for (const std::size_t first : changed) {
    std::vector<std::size_t> round;
    for (std::size_t k = first; k != none && !is_done[k]; k = next[k]) {
      is_done[k] = true;
      round.push_back(k);
    }
    if (round.size() < 2 || next[round.back()] != first) continue;
    std::vector<std::pair<std::size_t, PairFinding>> better;  // the other thing, and what is found of it
    for (const std::size_t k : round) {
      const std::size_t other = pairing.pairs[next[k]].second;
      PairFinding finding = look_at(a_.list[pairing.pairs[k].first], b_.list[other]);
      if (!finding.is_equal) break;
      finding.is_swapped = round.size() == 2;
      better.emplace_back(other, std::move(finding));
    }
    if (better.size() != round.size()) continue;
    for (std::size_t i = 0; i < round.size(); ++i) {
      pairing.pairs[round[i]].second = better[i].first;
      findings[round[i]] = std::move(better[i].second);
    }
  }
}

// Things without a partner whose surfaces lie on those of the other side that have none either: the same
// surfaces, cut or grouped in another way.
void Comparer::absorb_regrouped(Pairing& pairing) {
  if (pairing.only_a.empty() || pairing.only_b.empty()) return;
  for (const bool curves : {false, true}) {
    const auto surfaces_of = [&](const std::vector<Thing>& list, const std::vector<std::size_t>& which) {
      std::vector<const Surface*> all;
      for (const std::size_t i : which)
        if ((list[i].kind == Thing::Kind::curve) == curves)
          all.insert(all.end(), list[i].surfaces.begin(), list[i].surfaces.end());
      return all;
    };
    const std::vector<const Surface*> of_a = surfaces_of(a_.list, pairing.only_a);
    const std::vector<const Surface*> of_b = surfaces_of(b_.list, pairing.only_b);
    if (of_a.empty() || of_b.empty()) continue;
    const SurfaceSet all_a(of_a), all_b(of_b);
    const auto lies_on = [&](const Thing& thing, const SurfaceSet& others) {
      if ((thing.kind == Thing::Kind::curve) != curves) return false;
      double most = 0;
      for (std::size_t k = 0; k < thing.surfaces.size(); ++k) {
        const Surface& s = *thing.surfaces[k];
        const Range range = range_of(thing, k);
        const Vec3 middle = nurbs::evaluate(s, 0.5 * (range.u0 + range.u1), 0.5 * (range.v0 + range.v1));
        if (others.near(middle).distance > near_) return false;
        const std::optional<Region> region = region_of(thing, k);
        const SurveyOptions survey = {.near = largest_spread, .region = region ? &*region : nullptr};
        const Reach reach = distance_to(s, range, others, limits_.distances, survey);
        if (!is_within(reach, limits_.distances)) return false;
        most = std::max(most, reach.at_most);
      }
      if (most > limits_.distances) ++uncertain_;
      if (most > out_.largest) {
        out_.largest = most;
        out_.largest_of = thing.name;
      }
      return true;
    };
    const std::size_t count_a = pairing.only_a.size(), count_b = pairing.only_b.size();
    std::erase_if(pairing.only_a, [&](std::size_t i) { return lies_on(a_.list[i], all_b); });
    std::erase_if(pairing.only_b, [&](std::size_t j) { return lies_on(b_.list[j], all_a); });
    const std::size_t gone_a = count_a - pairing.only_a.size(), gone_b = count_b - pairing.only_b.size();
    out_.equal += gone_a;
    if (gone_a + gone_b > 0)
      out_.notes.push_back(
          fmt::format("{} of the first file and {} of the second are the same {}, cut or grouped in "
                      "another way",
                      gone_a, gone_b, curves ? "curves" : "surfaces"));
  }
}

// A part that the other file has as several (a shell that is no manifold comes apart in STEP) was paired with
// one of these, and differs from it. Such pairs are given up where all of them are what is left over, grouped
// in another way.
void Comparer::release_regrouped(Pairing& pairing, std::vector<PairFinding>& findings) {
  if (pairing.only_a.empty() && pairing.only_b.empty()) return;
  Pairing parted = {.pairs = {}, .only_a = pairing.only_a, .only_b = pairing.only_b};
  const auto is_regrouped = [&](std::size_t k) {
    const auto [i, j] = pairing.pairs[k];
    return !findings[k].is_equal && a_.list[i].surfaces.size() != b_.list[j].surfaces.size();
  };
  std::vector<PairFinding> kept;
  for (std::size_t k = 0; k < findings.size(); ++k) {
    const auto [i, j] = pairing.pairs[k];
    if (is_regrouped(k)) {
      parted.only_a.push_back(i);
      parted.only_b.push_back(j);
    } else {
      parted.pairs.push_back(pairing.pairs[k]);
      kept.push_back(findings[k]);
    }
  }
  if (kept.size() == findings.size()) return;
  const Comparison before = out_;
  const std::size_t uncertain = uncertain_;
  absorb_regrouped(parted);
  if (parted.only_a.empty() && parted.only_b.empty()) {
    pairing = std::move(parted);
    findings = std::move(kept);
  } else {
    out_ = before;
    uncertain_ = uncertain;
  }
}

Comparison::Counts counts_of(const Things& things) {
  Comparison::Counts counts;
  for (const Thing& thing : things.list) {
    if (thing.kind == Thing::Kind::curve) {
      ++counts.curves;
      continue;
    }
    ++(thing.kind == Thing::Kind::yarn ? counts.yarns : counts.parts);
    counts.surfaces += thing.surfaces.size();
  }
  return counts;
}

void Comparer::add_notes() {
  out_.uncertain = uncertain_;
  if (!reversed_.empty())
    out_.notes.push_back(
        fmt::format("{} the other way: '{}'{}",
                    reversed_.size() == 1 ? "a yarn runs" : fmt::format("{} yarns run", reversed_.size()),
                    reversed_.front(), reversed_.size() > 1 ? " and others" : ""));
  if (without_name_ > 0) out_.notes.push_back(fmt::format("{} have a name in one file only", without_name_));
  if (without_color_ > 0)
    out_.notes.push_back(fmt::format("{} have a colour in one file only", without_color_));
  const std::string &title_a = subject_a_.model.title, &title_b = subject_b_.model.title;
  if (title_a != title_b)
    out_.notes.push_back(
        fmt::format("titles: '{}' and '{}'", shortened(title_a, 80), shortened(title_b, 80)));
}

Comparison Comparer::run() {
  out_.a = counts_of(a_);
  out_.b = counts_of(b_);
  Pairing pairing = pair_things(a_.list, b_.list, near_);
  // Where most have changed, a few points of each tell by about how much; bounds are for what is left.
  constexpr std::size_t few = 8;
  std::vector<std::optional<PairFinding>> glances(pairing.pairs.size());
  if (pairing.pairs.size() > few)
    for_each_index(glances.size(), options_.threads, [&](std::size_t k) {
      const auto [i, j] = pairing.pairs[k];
      glances[k] = glance_at(a_.list[i], b_.list[j]);
    });
  const bool many_differ = std::ranges::count_if(glances, [](const auto& glance) {
                             return glance.has_value();
                           }) > static_cast<std::ptrdiff_t>(few);
  std::vector<PairFinding> findings(pairing.pairs.size());
  const auto look = [&](std::size_t k) {
    const auto [i, j] = pairing.pairs[k];
    findings[k] = many_differ && glances[k] ? *glances[k] : look_at(a_.list[i], b_.list[j]);
  };
  for_each_index(findings.size(), options_.threads, look, options_.progress);
  follow_names(pairing, findings);
  release_regrouped(pairing, findings);
  absorb_regrouped(pairing);
  std::size_t next = 0;
  for (std::size_t k = 0; k <= findings.size(); ++k) {
    const std::size_t until = k < findings.size() ? pairing.pairs[k].first : a_.list.size();
    for (; next < pairing.only_a.size() && pairing.only_a[next] < until; ++next)
      report_lonely(a_.list[pairing.only_a[next]], Difference::Kind::removed);
    if (k == findings.size()) break;
    const auto [i, j] = pairing.pairs[k];
    report_pair(a_.list[i], b_.list[j], findings[k]);
    out_.matches.push_back(
        {a_.list[i].kind, a_.list[i].name, findings[k].reach.at_least, findings[k].reach.at_most});
  }
  for (const std::size_t j : pairing.only_b) report_lonely(b_.list[j], Difference::Kind::added);
  add_notes();
  return std::move(out_);
}

}  // namespace

std::string_view name_of(Difference::Kind kind) {
  constexpr std::array<std::string_view, 6> names = {"added",    "removed", "moved",
                                                     "reshaped", "renamed", "recoloured"};
  return names[static_cast<std::size_t>(kind)];
}

Comparison compare(const Subject& a, const Subject& b, const CompareOptions& options) {
  return Comparer(a, b, options).run();
}

}  // namespace selvage::cad
