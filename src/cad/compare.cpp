#include "cad/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "cad/compare_things.h"
#include "core/parallel.h"
#include "core/readable.h"
#include "nurbs/basis.h"

namespace selvage::cad {

namespace {

using nurbs::Surface;

// What the arithmetic of distance_to leaves, as a share of the largest coordinate.
constexpr double arithmetic = 1e-13;

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
    limits_.near = std::max(2 * limits_.points, 1e-6 * size);
  }

  Comparison run();

 private:
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
  CompareLimits limits_;
  const ThingComparer comparer_{limits_};
  Comparison out_;
  std::size_t uncertain_ = 0;  // equal at all points that were looked at, without a bound that says so
  std::vector<std::string> reversed_;  // yarns that run the other way
  std::size_t without_name_ = 0, without_color_ = 0;
};

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
    const double near = std::max(limits_.near, 1e-3 * a.box.diagonal().norm());
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
      PairFinding finding = comparer_.look_at(a_.list[pairing.pairs[k].first], b_.list[other]);
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
        if (others.near(middle).distance > limits_.near) return false;
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
  Pairing pairing = pair_things(a_.list, b_.list, limits_.near);
  // Where most have changed, a few points of each tell by about how much; bounds are for what is left.
  constexpr std::size_t few = 8;
  std::vector<std::optional<PairFinding>> glances(pairing.pairs.size());
  if (pairing.pairs.size() > few)
    for_each_index(glances.size(), options_.threads, [&](std::size_t k) {
      const auto [i, j] = pairing.pairs[k];
      glances[k] = comparer_.glance_at(a_.list[i], b_.list[j]);
    });
  const bool many_differ = std::ranges::count_if(glances, [](const auto& glance) {
                             return glance.has_value();
                           }) > static_cast<std::ptrdiff_t>(few);
  std::vector<PairFinding> findings(pairing.pairs.size());
  const auto look = [&](std::size_t k) {
    const auto [i, j] = pairing.pairs[k];
    findings[k] = many_differ && glances[k] ? *glances[k] : comparer_.look_at(a_.list[i], b_.list[j]);
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
