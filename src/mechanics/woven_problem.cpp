#include "mechanics/woven_problem.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "core/wrapped.h"
#include "nurbs/basis.h"

namespace selvage::mechanics {

using Eigen::VectorXd;
using std::numbers::pi;

namespace {

// Unknowns of a crossing: heights of the warp up to the next weft and of the weft up to the next warp, half
// width and half height of the warp here and half way to the next weft, of the weft likewise.
constexpr int block_size = 2 * spans_a_gap + 8;
constexpr int corner_places = 4;  // of the places of a half gap
constexpr int places_a_gap = 2 * spans_a_gap, nodes_a_span = 2;
constexpr int stations_a_gap = places_a_gap + nodes_a_span * spans_a_gap;
constexpr double steepest = 2.2;  // slope of a centre line, 66 degrees
constexpr double least_half_height = 0.02;
constexpr double hold = 1e-5;  // of yarns that nothing holds

template <class T>
int color_of(std::map<T, int>& known, const T& key) {
  return known.try_emplace(key, static_cast<int>(known.size())).first->second;
}

// Numbers of yarns: the same for yarns of the same kind with the same distances to their neighbours.
std::vector<int> kinds_of(const std::vector<WovenYarn>& yarns, const std::vector<double>& gaps) {
  std::map<std::tuple<double, double, double, double, double, double, double>, int> known;
  std::vector<int> made;
  for (std::size_t k = 0; k < yarns.size(); ++k) {
    const WovenYarn& yarn = yarns[k];
    const double before = gaps[(k + gaps.size() - 1) % gaps.size()];
    made.push_back(color_of(known, {yarn.fibre_area, yarn.packing, yarn.max_packing, yarn.aspect,
                                    yarn.stiffness, before, gaps[k]}));
  }
  return made;
}

double smooth_step(double t) {
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

Partition classes_of(const WovenCloth& cloth, int max_classes) {
  const std::vector<int> warps = kinds_of(cloth.warps, cloth.warp_gaps),
                         wefts = kinds_of(cloth.wefts, cloth.weft_gaps);
  std::map<std::tuple<int, int, char>, int> known;
  std::vector<int> colors;
  for (std::size_t pick = 0; pick < wefts.size(); ++pick)
    for (std::size_t end = 0; end < warps.size(); ++end)
      colors.push_back(
          color_of(known, {warps[end], wefts[pick], cloth.warp_on_top[pick * warps.size() + end]}));
  return stable_partition(colors, cloth.picks(), cloth.ends(), max_classes);
}

WovenProblem::WovenProblem(const WovenCloth& scaled, Partition classes)
    : cloth_(scaled), classes_(std::move(classes)) {
  num_unknowns_ = static_cast<Eigen::Index>(classes_.count()) * block_size;
  // Of all crossings, times the number of classes: what a class weighs does not depend on how many there are.
  const double crossings = static_cast<double>(classes_.class_of.size()) / classes_.count();
  for (const int representative : classes_.representatives)
    for (const WovenSystem system : {WovenSystem::warp, WovenSystem::weft})
      add_stations(system, crossing(representative));
  for (std::size_t k = 0; k < classes_.representatives.size(); ++k)
    add_terms(crossing(classes_.representatives[k]), classes_.sizes[k] / crossings);
  find_pairs();
}

std::size_t WovenProblem::index(Crossing at) const {
  return static_cast<std::size_t>(wrapped(at.pick, cloth_.picks())) * cloth_.warps.size() +
         static_cast<std::size_t>(wrapped(at.end, cloth_.ends()));
}

int WovenProblem::block(int pick, int end) const {
  return classes_.class_of[index({pick, end})] * block_size;
}

int WovenProblem::height(WovenSystem system, int pick, int end, int knot) const {
  const int at = wrapped(knot, spans_a_gap), by = (knot - at) / spans_a_gap;
  const Crossing there = along(system, {pick, end}, by);
  return block(there.pick, there.end) + (system == WovenSystem::warp ? 0 : spans_a_gap) + at;
}

int WovenProblem::width_at(WovenSystem system, int pick, int end, int half) const {
  const int at = wrapped(half, 2), by = (half - at) / 2;
  const Crossing there = along(system, {pick, end}, by);
  return block(there.pick, there.end) + 2 * spans_a_gap + (system == WovenSystem::warp ? 0 : 4) + 2 * at;
}

double WovenProblem::gap(WovenSystem system, Crossing at, int from) const {
  const std::vector<double>& gaps = system == WovenSystem::warp ? cloth_.weft_gaps : cloth_.warp_gaps;
  const int k = (system == WovenSystem::warp ? at.pick : at.end) + from;
  return gaps[static_cast<std::size_t>(wrapped(k, static_cast<int>(gaps.size())))];
}

const WovenYarn& WovenProblem::yarn(WovenSystem system, Crossing at) const {
  return system == WovenSystem::warp
             ? cloth_.warps[static_cast<std::size_t>(wrapped(at.end, cloth_.ends()))]
             : cloth_.wefts[static_cast<std::size_t>(wrapped(at.pick, cloth_.picks()))];
}

bool WovenProblem::warp_on_top(Crossing at) const {
  return cloth_.warp_on_top[index(at)] != 0;
}

std::size_t WovenProblem::first_station(WovenSystem system, Crossing at) const {
  return (2 * static_cast<std::size_t>(classes_.class_of[index(at)]) +
          (system == WovenSystem::warp ? 0 : 1)) *
         stations_a_gap;
}

std::size_t WovenProblem::station(WovenSystem system, Crossing at, int place) const {
  const int in_gap = wrapped(place, places_a_gap);
  return first_station(system, along(system, at, (place - in_gap) / places_a_gap)) +
         static_cast<std::size_t>(in_gap);
}

// Of the gap from a crossing to the next one along a yarn: at even places, and at the nodes of integration.
void WovenProblem::add_stations(WovenSystem system, Crossing at) {
  const std::size_t first = spans_.size();
  for (int span = 0; span < spans_a_gap; ++span) {
    Span made;
    // Function k of the four has its middle at knot span - 1 + k.
    for (int k = 0; k < 4; ++k)
      made.unknowns[static_cast<std::size_t>(k)] = height(system, at.pick, at.end, span - 1 + k);
    const int half = 2 * span / spans_a_gap;
    std::size_t next = heights_of_span;
    for (int k = 0; k < 2; ++k)
      for (int size = 0; size < 2; ++size)
        made.unknowns[next++] = width_at(system, at.pick, at.end, half + k) + size;
    spans_.push_back(made);
  }
  const auto span_of = [&](int span) { return first + static_cast<std::size_t>(span); };
  for (int place = 0; place < places_a_gap; ++place)
    stations_.push_back(station_at(system, at, span_of(place / 2), 0.5 * (place % 2)));
  const nurbs::GaussRule& rule = nurbs::gauss_rule(nodes_a_span);
  for (int span = 0; span < spans_a_gap; ++span)
    for (const double node : rule.nodes)
      stations_.push_back(station_at(system, at, span_of(span), 0.5 + 0.5 * node));
}

WovenProblem::Station WovenProblem::station_at(WovenSystem system, Crossing at, std::size_t span,
                                               double in_span) const {
  Station made;
  made.span = span;
  const auto number = static_cast<int>(span % spans_a_gap);
  const auto knot = [&](int k) {  // distance from the crossing
    const int in = wrapped(k, spans_a_gap), whole = (k - in) / spans_a_gap;
    double sum = gap(system, at, whole) * in / spans_a_gap;
    for (int g = 0; g < whole; ++g) sum += gap(system, at, g);
    for (int g = whole; g < 0; ++g) sum -= gap(system, at, g);
    return sum;
  };
  // Spans from two before this one to two beyond it.
  std::vector<double> knots;
  for (int k = number - 3; k <= number + 4; ++k) knots.push_back(knot(k));
  std::array<nurbs::BasisRow, 3> rows;
  nurbs::basis_derivatives(knots, 3, 3, knots[3] + in_span * (knots[4] - knots[3]), rows);
  for (std::size_t d = 0; d < made.path.size(); ++d)
    std::copy_n(rows[d].begin(), heights_of_span, made.path[d].begin());
  const double halves = 2.0 * (number + in_span) / spans_a_gap;
  made.step = smooth_step(halves - std::floor(halves));
  return made;
}

void WovenProblem::find_pairs() {
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> known;
  const auto find = [&](auto& term) {
    const std::size_t first = stations_[term.first].span, second = stations_[term.second].span;
    const auto [at, is_new] = known.try_emplace({first, second}, pairs_.size());
    if (is_new) pairs_.push_back({first, second, {}});
    term.pair = at->second;
  };
  for (Beside& term : besides_) find(term);
  for (Contact& term : contacts_) find(term);
}

void WovenProblem::find_places() {
  std::vector<char> is_used(pairs_.size(), 0);
  const std::size_t first_beside = packed_.size() + bounds_.size();
  for (std::size_t k = 0; k < besides_.size(); ++k)
    if (is_active_[first_beside + k] != 0) is_used[besides_[k].pair] = 1;
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    if (is_active_[first_contact() + k] != 0) is_used[contacts_[k].pair] = 1;
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(num_unknowns_));
  // All pairs of unknowns that a term joins, with where to note their place.
  const auto for_pairs = [&](const auto& use) {
    for (Span& span : spans_) {
      std::size_t k = 0;
      for (std::size_t i = 0; i < num_of_span; ++i)
        for (std::size_t j = 0; j <= i; ++j) use(span.unknowns[i], span.unknowns[j], span.places[k++]);
    }
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      if (is_used[p] == 0) continue;
      std::size_t k = 0;
      for (const int a : spans_[pairs_[p].first].unknowns)
        for (const int b : spans_[pairs_[p].second].unknowns) use(a, b, pairs_[p].places[k++]);
    }
  };
  for_pairs(
      [&](int a, int b, int&) { rows[static_cast<std::size_t>(std::min(a, b))].push_back(std::max(a, b)); });
  places_.resize(num_unknowns_, num_unknowns_);
  for (Eigen::Index column = 0; column < num_unknowns_; ++column) {
    std::vector<int>& in_column = rows[static_cast<std::size_t>(column)];
    std::sort(in_column.begin(), in_column.end());
    in_column.erase(std::unique(in_column.begin(), in_column.end()), in_column.end());
    places_.startVec(column);
    for (const int row : in_column) places_.insertBack(row, column) = 0.0;
  }
  places_.finalize();
  for_pairs([&](int a, int b, int& place) {
    const int* const begin = places_.innerIndexPtr() + places_.outerIndexPtr()[std::min(a, b)];
    const int* const end = places_.innerIndexPtr() + places_.outerIndexPtr()[std::min(a, b) + 1];
    place = static_cast<int>(std::lower_bound(begin, end, std::max(a, b)) - places_.innerIndexPtr());
  });
}

void WovenProblem::add_terms(Crossing at, double share) {
  for (const WovenSystem system : {WovenSystem::warp, WovenSystem::weft}) {
    add_yarn(system, at, share);
    add_beside(system, at);
  }
  add_contacts(at);
}

// The gap from a crossing to the next one along a yarn.
void WovenProblem::add_yarn(WovenSystem system, Crossing at, double share) {
  const WovenYarn& own = yarn(system, at);
  const WovenConstants& constants = cloth_.constants;
  const double length = gap(system, at, 0), area = own.fibre_area;
  const nurbs::GaussRule& rule = nurbs::gauss_rule(nodes_a_span);
  std::size_t node = first_station(system, at) + places_a_gap;
  for (int span = 0; span < spans_a_gap; ++span)
    for (const double rule_weight : rule.weights) {
      const double along = share * 0.5 * rule_weight * length / spans_a_gap, weight = area * along;
      paths_.push_back({node, weight * constants.bending, weight * tension(system), along, system});
      sections_.push_back({node, weight * constants.flattening * own.stiffness, weight * constants.compaction,
                           std::log(own.aspect), own.packing, area});
      ++node;
    }
  for (int half = 0; half < 2; ++half) {
    // Fibres leave the axis where the section changes: by the mean of the squares of their slopes, a quarter
    // of that at the surface; the square of the slope of a smooth step is 6/5 in the mean.
    const std::size_t here = station(system, at, half * spans_a_gap);
    const double factor = 0.5 * share * area * tension(system) * 0.25 * 1.2 / (0.5 * length);
    for (std::size_t size = 0; size < 2; ++size) changes_.push_back({stations_[here].span, size, factor});
    packed_.push_back({here, area / (pi * own.max_packing)});
    Bound high{here, -least_half_height, {}};
    high.weights[half_height] = 1.0;
    bounds_.push_back(high);
  }
  for (int place = 0; place < places_a_gap; ++place) {
    const std::size_t here = station(system, at, place);
    const bool is_knot = place % 2 == 0;
    if (is_knot) holds_.push_back({here, 0.5 * hold * share * area * length / spans_a_gap});
    for (const double side : {-1.0, 1.0}) {
      folds_.push_back({here, side});
      if (cloth_.thickness) {
        Bound plate{here, 0.5 * *cloth_.thickness, {}};
        plate.weights[z] = -side;
        plate.weights[half_height] = -1.0;
        bounds_.push_back(plate);
      }
      if (is_knot) continue;
      Bound steep{here, steepest, {}};
      steep.weights[slope] = side;
      bounds_.push_back(steep);
    }
  }
}

// A yarn and the next one of its system, side by side. On one side of the cloth neither comes over the other,
// and where they change sides they pass at one height.
void WovenProblem::add_beside(WovenSystem system, Crossing at) {
  constexpr int places = 8, half = places / 2, every = places_a_gap / places;  // a gap
  const WovenSystem other = system == WovenSystem::warp ? WovenSystem::weft : WovenSystem::warp;
  const Crossing next = along(other, at, 1);
  // How far the yarn is above the next one: by no side, or by one up or down.
  const auto above = [&](int crossing) {
    return (warp_on_top(along(system, at, crossing)) ? 1 : 0) -
           (warp_on_top(along(system, next, crossing)) ? 1 : 0);
  };
  const bool is_level_here = above(0) == 0, is_level_next = above(1) == 0,
             change_sides = above(0) * above(1) < 0;
  for (int place = 0; place < places; ++place) {
    const bool is_level =
        2 * place < places ? is_level_here : change_sides || (is_level_here && is_level_next);
    besides_.push_back({station(system, at, every * place), station(system, next, every * place), 0,
                        gap(other, at, 0), cloth_.clearance, is_level && place % half == 0});
  }
}

std::size_t WovenProblem::add_run(WovenSystem system, Crossing at, int direction, double sign) {
  Run run;
  run.sign = sign * direction;
  for (int k = 0; k <= places_a_half_gap; ++k)
    run.stations[static_cast<std::size_t>(k)] = station(system, at, direction * k);
  runs_.push_back(run);
  return runs_.size() - 1;
}

void WovenProblem::add_contacts(Crossing at) {
  const double side = warp_on_top(at) ? 1.0 : -1.0;
  constexpr int every = places_a_half_gap / corner_places;
  // Both yarns fall away from the crossing: the upper one down, the lower one up.
  const std::array<std::size_t, 2> warp_runs = {add_run(WovenSystem::warp, at, -1, -side),
                                                add_run(WovenSystem::warp, at, 1, -side)},
                                   weft_runs = {add_run(WovenSystem::weft, at, -1, side),
                                                add_run(WovenSystem::weft, at, 1, side)};
  const auto distance = [&](WovenSystem system, std::size_t d, int place) {
    return 0.5 * place / places_a_half_gap * (d == 0 ? -gap(system, at, -1) : gap(system, at, 0));
  };
  const auto add = [&](std::size_t warp_side, int warp_place, std::size_t weft_side, int weft_place) {
    contacts_.push_back({runs_[warp_runs[warp_side]].stations[static_cast<std::size_t>(warp_place)],
                         runs_[weft_runs[weft_side]].stations[static_cast<std::size_t>(weft_place)], 0, side,
                         distance(WovenSystem::warp, warp_side, warp_place),
                         distance(WovenSystem::weft, weft_side, weft_place), cloth_.clearance,
                         warp_runs[warp_side], weft_runs[weft_side], warp_place, weft_place});
  };
  add(0, 0, 0, 0);
  for (std::size_t d = 0; d < 2; ++d)
    for (int k = 1; k <= places_a_half_gap; ++k) {
      add(d, k, 0, 0);
      add(0, 0, d, k);
    }
  for (std::size_t d = 0; d < 2; ++d)
    for (std::size_t e = 0; e < 2; ++e)
      for (int k = 1; k <= corner_places; ++k)
        for (int m = 1; m <= corner_places; ++m) add(d, every * k, e, every * m);
}

VectorXd WovenProblem::start(double warp_share) const {
  VectorXd x = VectorXd::Zero(num_unknowns_);
  for (const int representative : classes_.representatives) {
    const Crossing at = crossing(representative);
    const auto half_height_at = [&](WovenSystem system, Crossing there) {
      const WovenYarn& own = yarn(system, there);
      return std::sqrt(own.fibre_area / (pi * own.packing * own.aspect));
    };
    for (const WovenSystem system : {WovenSystem::warp, WovenSystem::weft}) {
      const double share = system == WovenSystem::warp ? warp_share : warp_share - 1.0;
      const auto rise = [&](Crossing there) {
        const double both =
            half_height_at(WovenSystem::warp, there) + half_height_at(WovenSystem::weft, there);
        return (warp_on_top(there) ? share : -share) * both;
      };
      const double from = rise(at), to = rise(along(system, at, 1));
      for (int knot = 0; knot < spans_a_gap; ++knot)
        x[height(system, at.pick, at.end, knot)] =
            from + (to - from) * smooth_step(static_cast<double>(knot) / spans_a_gap);
      const double height_here = half_height_at(system, at);
      for (int half = 0; half < 2; ++half) {
        const int width = width_at(system, at.pick, at.end, half);
        x[width] = yarn(system, at).aspect * height_here;
        x[width + 1] = height_here;
      }
    }
  }
  return x;
}

VectorXd WovenProblem::equality() const {
  if (!cloth_.warp_share) return {};
  VectorXd made = VectorXd::Zero(num_unknowns_);
  for (std::size_t k = 0; k < classes_.representatives.size(); ++k) {
    const int representative = classes_.representatives[k];
    const Crossing at = crossing(representative);
    const double share = classes_.sizes[k] / static_cast<double>(classes_.class_of.size());
    const double side = warp_on_top(at) ? share : -share;
    // Of the sum of both, side * (warp - weft), the warp has this share.
    const auto add = [&](WovenSystem system, double by) {
      const Station& here = stations_[station(system, at, 0)];
      for (std::size_t i = 0; i < heights_of_span; ++i)
        made[spans_[here.span].unknowns[i]] += by * side * here.path[0][i];
    };
    add(WovenSystem::warp, 1.0 - *cloth_.warp_share);
    add(WovenSystem::weft, *cloth_.warp_share);
  }
  return made;
}

}  // namespace selvage::mechanics
