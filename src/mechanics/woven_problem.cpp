#include "mechanics/woven_problem.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "core/wrapped.h"
#include "nurbs/basis.h"

namespace selvage::mechanics {

using Eigen::VectorXd;
using std::numbers::pi;

namespace {

// Unknowns of a crossing: heights of each warp up to the next weft and of each weft up to the next warp; then
// half width and half height of each warp here and half way to the next weft, of each weft likewise.
constexpr int sizes_a_strand = 4, block_a_strand = spans_a_gap + sizes_a_strand;
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

// Numbers of rows or columns: the same for those of the same kinds of yarns with the same distances to their
// neighbours. `first`: of each the number of its first yarn.
template <class First>
std::vector<int> kinds_of(const std::vector<WovenYarn>& yarns, const std::vector<double>& gaps,
                          const First& first) {
  using Kind = std::tuple<double, double, double, double, double>;
  std::map<std::tuple<std::vector<Kind>, double, double>, int> known;
  std::vector<int> made;
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    std::vector<Kind> kinds;
    for (auto y = static_cast<std::size_t>(first(k)); y < static_cast<std::size_t>(first(k + 1)); ++y)
      kinds.emplace_back(yarns[y].fibre_area, yarns[y].packing, yarns[y].max_packing, yarns[y].aspect,
                         yarns[y].stiffness);
    made.push_back(color_of(known, {std::move(kinds), gaps[(k + gaps.size() - 1) % gaps.size()], gaps[k]}));
  }
  return made;
}

double smooth_step(double t) {
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

Partition classes_of(const WovenCloth& cloth, int max_classes) {
  const auto first_warp = [&](std::size_t column) { return cloth.first_warp(static_cast<int>(column)); };
  const auto first_weft = [&](std::size_t row) { return static_cast<int>(row) * cloth.wefts_a_row; };
  const std::vector<int> columns = kinds_of(cloth.warps, cloth.warp_gaps, first_warp),
                         rows = kinds_of(cloth.wefts, cloth.weft_gaps, first_weft);
  std::map<std::tuple<int, int, std::string>, int> known;
  std::vector<int> colors;
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (std::size_t column = 0; column < columns.size(); ++column) {
      std::string sides;
      for (int weft = first_weft(row); weft < first_weft(row + 1); ++weft)
        for (int warp = first_warp(column); warp < first_warp(column + 1); ++warp)
          sides.push_back(cloth.warp_on_top[static_cast<std::size_t>(weft) * cloth.warps.size() +
                                            static_cast<std::size_t>(warp)]);
      colors.push_back(color_of(known, {columns[column], rows[row], std::move(sides)}));
    }
  return stable_partition(colors, cloth.rows(), cloth.columns(), max_classes);
}

WovenProblem::WovenProblem(const WovenCloth& scaled, Partition classes)
    : cloth_(scaled), classes_(std::move(classes)) {
  // Of all crossings, times the number of classes: what a class weighs does not depend on how many there are.
  const double crossings = static_cast<double>(classes_.class_of.size()) / classes_.count();
  first_strands_.push_back(0);
  for (const int representative : classes_.representatives) {
    const Crossing at = crossing(representative);
    first_strands_.push_back(first_strands_.back() + count(WovenSystem::warp, at) +
                             count(WovenSystem::weft, at));
  }
  num_unknowns_ = static_cast<Eigen::Index>(first_strands_.back()) * block_a_strand + 1;
  for (const int representative : classes_.representatives)
    for (const Strand strand : strands(crossing(representative)))
      add_stations(strand, crossing(representative));
  for (std::size_t k = 0; k < classes_.representatives.size(); ++k)
    add_terms(crossing(classes_.representatives[k]), classes_.sizes[k] / crossings);
  add_plates();
  find_pairs();
}

std::size_t WovenProblem::index(Crossing at) const {
  return static_cast<std::size_t>(wrapped(at.pick, cloth_.rows())) * cloth_.warp_gaps.size() +
         static_cast<std::size_t>(wrapped(at.end, cloth_.columns()));
}

int WovenProblem::count(WovenSystem system, Crossing at) const {
  const int column = wrapped(at.end, cloth_.columns());
  return system == WovenSystem::weft ? cloth_.wefts_a_row
                                     : cloth_.first_warp(column + 1) - cloth_.first_warp(column);
}

std::vector<WovenProblem::Strand> WovenProblem::strands(Crossing at) const {
  std::vector<Strand> made;
  for (const WovenSystem system : {WovenSystem::warp, WovenSystem::weft})
    for (int layer = 0; layer < count(system, at); ++layer) made.push_back({system, layer});
  return made;
}

std::size_t WovenProblem::place_of(Strand strand, Crossing at) const {
  const int place = strand.layer + (strand.system == WovenSystem::warp ? 0 : count(WovenSystem::warp, at));
  return static_cast<std::size_t>(place);
}

WovenProblem::Rank WovenProblem::rank(Strand strand, Crossing at) const {
  const auto below = [&](int layer) {
    int sum = 0;
    for (int k = 0; k < count(other(strand.system), at); ++k)
      sum += (strand.system == WovenSystem::warp ? warp_on_top(at, layer, k) : !warp_on_top(at, k, layer))
                 ? 1
                 : 0;
    return sum;
  };
  Rank made{below(strand.layer), 0, 0};
  for (int layer = 0; layer < count(strand.system, at); ++layer) {
    if (below(layer) != made.below) continue;
    ++made.count;
    if (layer < strand.layer) ++made.place;
  }
  return made;
}

std::pair<WovenProblem::Strand, WovenProblem::Crossing> WovenProblem::located(WovenSystem system,
                                                                              int yarn) const {
  if (system == WovenSystem::weft)
    return {{system, yarn % cloth_.wefts_a_row}, {yarn / cloth_.wefts_a_row, 0}};
  if (cloth_.first_warps.empty()) return {{system, 0}, {0, yarn}};
  const auto after = std::upper_bound(cloth_.first_warps.begin(), cloth_.first_warps.end(), yarn);
  const auto column = static_cast<int>(after - cloth_.first_warps.begin()) - 1;
  return {{system, yarn - cloth_.first_warp(column)}, {0, column}};
}

int WovenProblem::block(Crossing at) const {
  return first_strands_[static_cast<std::size_t>(classes_.class_of[index(at)])] * block_a_strand;
}

int WovenProblem::height(WovenSystem system, int yarn, int knot) const {
  const auto [strand, at] = located(system, yarn);
  return height(strand, at, knot);
}

int WovenProblem::width_at(WovenSystem system, int yarn, int half) const {
  const auto [strand, at] = located(system, yarn);
  return width_at(strand, at, half);
}

int WovenProblem::height(Strand strand, Crossing at, int knot) const {
  const int in_gap = wrapped(knot, spans_a_gap);
  const Crossing there = along(strand.system, at, (knot - in_gap) / spans_a_gap);
  return block(there) + static_cast<int>(place_of(strand, there)) * spans_a_gap + in_gap;
}

int WovenProblem::width_at(Strand strand, Crossing at, int half) const {
  const int in_gap = wrapped(half, 2);
  const Crossing there = along(strand.system, at, (half - in_gap) / 2);
  const int count_there = count(WovenSystem::warp, there) + count(WovenSystem::weft, there);
  return block(there) + count_there * spans_a_gap +
         static_cast<int>(place_of(strand, there)) * sizes_a_strand + 2 * in_gap;
}

double WovenProblem::gap(WovenSystem system, Crossing at, int from) const {
  const std::vector<double>& gaps = system == WovenSystem::warp ? cloth_.weft_gaps : cloth_.warp_gaps;
  const int k = (system == WovenSystem::warp ? at.pick : at.end) + from;
  return gaps[static_cast<std::size_t>(wrapped(k, static_cast<int>(gaps.size())))];
}

const WovenYarn& WovenProblem::yarn(Strand strand, Crossing at) const {
  const bool is_warp = strand.system == WovenSystem::warp;
  const int number = strand.layer + (is_warp ? cloth_.first_warp(wrapped(at.end, cloth_.columns()))
                                             : wrapped(at.pick, cloth_.rows()) * cloth_.wefts_a_row);
  return (is_warp ? cloth_.warps : cloth_.wefts)[static_cast<std::size_t>(number)];
}

bool WovenProblem::warp_on_top(Crossing at, int warp_layer, int weft_layer) const {
  const int weft = wrapped(at.pick, cloth_.rows()) * cloth_.wefts_a_row + weft_layer,
            warp = cloth_.first_warp(wrapped(at.end, cloth_.columns())) + warp_layer;
  return cloth_.warp_on_top[static_cast<std::size_t>(weft) * cloth_.warps.size() +
                            static_cast<std::size_t>(warp)] != 0;
}

std::size_t WovenProblem::first_station(Strand strand, Crossing at) const {
  return (static_cast<std::size_t>(first_strands_[static_cast<std::size_t>(classes_.class_of[index(at)])]) +
          place_of(strand, at)) *
         stations_a_gap;
}

std::size_t WovenProblem::station(Strand strand, Crossing at, int place) const {
  const int in_gap = wrapped(place, places_a_gap);
  return first_station(strand, along(strand.system, at, (place - in_gap) / places_a_gap)) +
         static_cast<std::size_t>(in_gap);
}

// Of the gap from a crossing to the next one along a yarn: at even places, and at the nodes of integration.
void WovenProblem::add_stations(Strand strand, Crossing at) {
  const std::size_t first = spans_.size();
  for (int span = 0; span < spans_a_gap; ++span) {
    Span made;
    // Function k of the four has its middle at knot span - 1 + k.
    for (int k = 0; k < 4; ++k) made.unknowns[static_cast<std::size_t>(k)] = height(strand, at, span - 1 + k);
    const int half = 2 * span / spans_a_gap;
    std::size_t next = heights_of_span;
    for (int k = 0; k < 2; ++k)
      for (int size = 0; size < 2; ++size) made.unknowns[next++] = width_at(strand, at, half + k) + size;
    spans_.push_back(made);
  }
  const auto span_of = [&](int span) { return first + static_cast<std::size_t>(span); };
  for (int place = 0; place < places_a_gap; ++place)
    stations_.push_back(station_at(strand, at, span_of(place / 2), 0.5 * (place % 2)));
  const nurbs::GaussRule& rule = nurbs::gauss_rule(nodes_a_span);
  for (int span = 0; span < spans_a_gap; ++span)
    for (const double node : rule.nodes)
      stations_.push_back(station_at(strand, at, span_of(span), 0.5 + 0.5 * node));
}

WovenProblem::Station WovenProblem::station_at(Strand strand, Crossing at, std::size_t span,
                                               double in_span) const {
  const WovenSystem system = strand.system;
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
  for (Plate& term : plates_) find(term);
  for (Beside& term : besides_) find(term);
  for (Stack& term : stacks_) find(term);
  for (Contact& term : contacts_) find(term);
}

void WovenProblem::find_places() {
  std::vector<char> is_used(pairs_.size(), 0);
  for (std::size_t k = 0; k < plates_.size(); ++k)
    if (is_active_[first_plate() + k] != 0) is_used[plates_[k].pair] = 1;
  for (std::size_t k = 0; k < besides_.size(); ++k)
    if (is_active_[first_beside() + k] != 0) is_used[besides_[k].pair] = 1;
  for (std::size_t k = 0; k < stacks_.size(); ++k)
    if (is_active_[first_stack() + k] != 0) is_used[stacks_[k].pair] = 1;
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
  for (const Strand strand : strands(at)) {
    add_yarn(strand, at, share);
    add_beside(strand, at);
    if (strand.layer > 0) add_stack(strand, at);
  }
  for (int warp = 0; warp < count(WovenSystem::warp, at); ++warp)
    for (int weft = 0; weft < count(WovenSystem::weft, at); ++weft) add_contacts(at, warp, weft);
}

// The gap from a crossing to the next one along a yarn.
void WovenProblem::add_yarn(Strand strand, Crossing at, double share) {
  const WovenSystem system = strand.system;
  const WovenYarn& own = yarn(strand, at);
  const WovenConstants& constants = cloth_.constants;
  const double length = gap(system, at, 0), area = own.fibre_area;
  const nurbs::GaussRule& rule = nurbs::gauss_rule(nodes_a_span);
  std::size_t node = first_station(strand, at) + places_a_gap;
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
    const std::size_t here = station(strand, at, half * spans_a_gap);
    const double factor = 0.5 * share * area * tension(system) * 0.25 * 1.2 / (0.5 * length);
    for (std::size_t size = 0; size < 2; ++size) changes_.push_back({stations_[here].span, size, factor});
    packed_.push_back({here, area / (pi * own.max_packing)});
    Bound high{here, -least_half_height, {}};
    high.weights[half_height] = 1.0;
    bounds_.push_back(high);
  }
  for (int place = 0; place < places_a_gap; ++place) {
    const std::size_t here = station(strand, at, place);
    const bool is_knot = place % 2 == 0;
    if (is_knot) holds_.push_back({here, 0.5 * hold * share * area * length / spans_a_gap});
    for (const double side : {-1.0, 1.0}) {
      folds_.push_back({here, side});
      plates_.push_back({here, 0, 0, side});
      if (is_knot) continue;
      Bound steep{here, steepest, {}};
      steep.weights[slope] = side;
      bounds_.push_back(steep);
    }
  }
}

// Half their distance is the height of a station of their own.
void WovenProblem::add_plates() {
  Span span;
  span.unknowns.fill(static_cast<int>(num_unknowns_) - 1);
  Station station;
  station.span = spans_.size();
  station.path[0][0] = 1.0;
  for (Plate& plate : plates_) plate.second = stations_.size();
  if (cloth_.thickness) {
    Bound limit{stations_.size(), 0.5 * *cloth_.thickness, {}};
    limit.weights[z] = -1.0;
    bounds_.push_back(limit);
  }
  spans_.push_back(span);
  stations_.push_back(station);
  const auto mean = [](const std::vector<double>& gaps) {
    return std::accumulate(gaps.begin(), gaps.end(), 0.0) / static_cast<double>(gaps.size());
  };
  plates_area_ = classes_.count() * mean(cloth_.warp_gaps) * mean(cloth_.weft_gaps);
}

// A yarn and those of the next column or row of its system, side by side. Between the same yarns neither
// comes over the other, and where they change sides they pass at one height.
void WovenProblem::add_beside(Strand strand, Crossing at) {
  constexpr int places = 8, half = places / 2, every = places_a_gap / places;  // a gap
  const WovenSystem system = strand.system, across = other(system);
  const Crossing next = along(across, at, 1);
  for (int layer = 0; layer < count(system, next); ++layer) {
    const Strand beside{system, layer};
    const auto ranks = [&](int crossing) {
      return std::pair(rank(strand, along(system, at, crossing)),
                       rank(beside, along(system, next, crossing)));
    };
    // By how much the yarn is above the other one: 0 where nothing tells.
    const auto above = [&](int crossing) {
      const auto [own, its] = ranks(crossing);
      if (own.below != its.below) return own.below - its.below;
      return own.count == its.count ? own.place - its.place : 0;
    };
    const auto is_level_at = [&](int crossing) {
      const auto [own, its] = ranks(crossing);
      return own == its;
    };
    const bool is_level_here = is_level_at(0), is_level_next = is_level_at(1),
               change_sides = above(0) * above(1) < 0;
    for (int place = 0; place < places; ++place) {
      const bool is_level =
          2 * place < places ? is_level_here : change_sides || (is_level_here && is_level_next);
      besides_.push_back({station(strand, at, every * place), station(beside, next, every * place), 0,
                          gap(across, at, 0), cloth_.clearance, is_level && place % half == 0,
                          is_stacked(at)});
    }
  }
}

// A yarn and the one below it, up to the next crossing.
void WovenProblem::add_stack(Strand strand, Crossing at) {
  const Strand lower{strand.system, strand.layer - 1};
  for (int place = 0; place < places_a_gap; ++place)
    stacks_.push_back({station(lower, at, place), station(strand, at, place), 0, cloth_.clearance});
}

std::size_t WovenProblem::add_run(Strand strand, Crossing at, int direction, int places, double sign) {
  Run run;
  run.sign = sign * direction;
  for (int k = 0; k <= places; ++k) run.stations.push_back(station(strand, at, direction * k));
  runs_.push_back(std::move(run));
  return runs_.size() - 1;
}

void WovenProblem::add_contacts(Crossing at, int warp_layer, int weft_layer) {
  const double side = warp_on_top(at, warp_layer, weft_layer) ? 1.0 : -1.0;
  const Strand warp{WovenSystem::warp, warp_layer}, weft{WovenSystem::weft, weft_layer};
  constexpr int half_gap = places_a_gap / 2, every = half_gap / corner_places;
  // Neighbours above and below each other may be wider than their pitch.
  const int places = is_stacked(at) ? places_a_gap : half_gap,
            corners = is_stacked(at) ? corner_places * 3 / 2 : corner_places;
  // Both yarns fall away from the crossing: the upper one down, the lower one up.
  const std::array<std::size_t, 2> warp_runs = {add_run(warp, at, -1, places, -side),
                                                add_run(warp, at, 1, places, -side)},
                                   weft_runs = {add_run(weft, at, -1, places, side),
                                                add_run(weft, at, 1, places, side)};
  const auto distance = [&](WovenSystem system, std::size_t d, int place) {
    return 0.5 * place / half_gap * (d == 0 ? -gap(system, at, -1) : gap(system, at, 0));
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
    for (int k = 1; k <= places; ++k) {
      add(d, k, 0, 0);
      add(0, 0, d, k);
    }
  for (std::size_t d = 0; d < 2; ++d)
    for (std::size_t e = 0; e < 2; ++e)
      for (int k = 1; k <= corners; ++k)
        for (int m = 1; m <= corners; ++m) add(d, every * k, e, every * m);
}

double WovenProblem::rest_half_height(Strand strand, Crossing at) const {
  const WovenYarn& own = yarn(strand, at);
  return std::sqrt(own.fibre_area / (pi * own.packing * own.aspect));
}

// Of the yarns of a row or column, if they lay straight, with room for those that cross between them.
std::vector<double> WovenProblem::straight_heights(WovenSystem system, Crossing at) const {
  const int layers = count(system, at);
  std::vector<double> heights(static_cast<std::size_t>(layers), 0.0);
  if (layers == 1) return heights;
  std::vector<double> room(static_cast<std::size_t>(layers) + 1, 0.0);  // below each, and above all
  const int crossings = system == WovenSystem::warp ? cloth_.rows() : cloth_.columns();
  for (int k = 0; k < crossings; ++k) {
    const Crossing there = along(system, at, k);
    std::vector<double> needed(room.size(), 0.0);
    for (int layer = 0; layer < count(other(system), there); ++layer) {
      const Strand crossed{other(system), layer};
      needed[static_cast<std::size_t>(rank(crossed, there).below)] += 2.0 * rest_half_height(crossed, there);
    }
    for (std::size_t i = 0; i < room.size(); ++i) room[i] = std::max(room[i], needed[i]);
  }
  for (std::size_t i = 1; i < heights.size(); ++i) {
    const auto layer = static_cast<int>(i);
    heights[i] = heights[i - 1] + rest_half_height({system, layer - 1}, at) + room[i] +
                 rest_half_height({system, layer}, at);
  }
  const double middle = 0.5 * (heights.front() + heights.back());
  for (double& height : heights) height -= middle;
  return heights;
}

// Of a yarn, if those of `straight` lay so: beside those that it lies between, or in the middle of them.
double WovenProblem::height_between(WovenSystem straight, Strand strand, Crossing at) const {
  const std::vector<double> heights = straight_heights(straight, at);
  if (strand.system == straight) return heights[static_cast<std::size_t>(strand.layer)];
  const Rank own = rank(strand, at);
  double before = 0.0, all = 0.0;  // thicknesses of those between the same two
  for (int layer = 0; layer < count(strand.system, at); ++layer) {
    if (rank({strand.system, layer}, at).below != own.below) continue;
    const double thickness = 2.0 * rest_half_height({strand.system, layer}, at);
    all += thickness;
    if (layer < strand.layer) before += thickness;
  }
  const double half = rest_half_height(strand, at);
  const auto surface = [&](int layer, double side) {
    return heights[static_cast<std::size_t>(layer)] + side * rest_half_height({straight, layer}, at);
  };
  if (own.below == static_cast<int>(heights.size())) return surface(own.below - 1, 1.0) + before + half;
  if (own.below == 0) return surface(0, -1.0) - (all - before - 2.0 * half) - half;
  return 0.5 * (surface(own.below - 1, 1.0) + surface(own.below, -1.0) - all) + before + half;
}

VectorXd WovenProblem::start(double warp_share) const {
  VectorXd x = VectorXd::Zero(num_unknowns_);
  const auto rise = [&](Strand strand, Crossing at) {
    return warp_share * height_between(WovenSystem::weft, strand, at) +
           (1.0 - warp_share) * height_between(WovenSystem::warp, strand, at);
  };
  for (const int representative : classes_.representatives) {
    const Crossing at = crossing(representative);
    for (const Strand strand : strands(at)) {
      const double from = rise(strand, at), to = rise(strand, along(strand.system, at, 1));
      for (int knot = 0; knot < spans_a_gap; ++knot)
        x[height(strand, at, knot)] =
            from + (to - from) * smooth_step(static_cast<double>(knot) / spans_a_gap);
      const double height_here = rest_half_height(strand, at);
      for (int half = 0; half < 2; ++half) {
        const int width = width_at(strand, at, half);
        x[width] = yarn(strand, at).aspect * height_here;
        x[width + 1] = height_here;
      }
    }
  }
  x[num_unknowns_ - 1] = 0.5 * thickness(x);
  return x;
}

VectorXd WovenProblem::flattened(VectorXd x, double by) const {
  for (const int representative : classes_.representatives) {
    const Crossing at = crossing(representative);
    for (const Strand strand : strands(at)) {
      for (int knot = 0; knot < spans_a_gap; ++knot) x[height(strand, at, knot)] *= by;
      for (int half = 0; half < 2; ++half) {
        const int width = width_at(strand, at, half);
        x[width] /= std::sqrt(by);
        x[width + 1] *= by;
      }
    }
  }
  x[num_unknowns_ - 1] *= by;
  return x;
}

VectorXd WovenProblem::equality() const {
  if (!cloth_.warp_share) return {};
  VectorXd made = VectorXd::Zero(num_unknowns_);
  for (std::size_t k = 0; k < classes_.representatives.size(); ++k) {
    const int representative = classes_.representatives[k];
    const Crossing at = crossing(representative);
    const double share = classes_.sizes[k] / static_cast<double>(classes_.class_of.size());
    const double side = warp_on_top(at, 0, 0) ? share : -share;
    // Of the sum of both, side * (warp - weft), the warp has this share.
    const auto add = [&](WovenSystem system, double by) {
      const Station& here = stations_[station({system, 0}, at, 0)];
      for (std::size_t i = 0; i < heights_of_span; ++i)
        made[spans_[here.span].unknowns[i]] += by * side * here.path[0][i];
    };
    add(WovenSystem::warp, 1.0 - *cloth_.warp_share);
    add(WovenSystem::weft, *cloth_.warp_share);
  }
  return made;
}

}  // namespace selvage::mechanics
