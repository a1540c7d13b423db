// Energies and inequalities of woven cloths, with their derivatives.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <type_traits>

#include "mechanics/dual.h"
#include "mechanics/woven_problem.h"

namespace selvage::mechanics {

using Eigen::Index;
using Eigen::VectorXd;
using std::numbers::pi;

namespace {

constexpr std::size_t lower(std::size_t row, std::size_t column) {
  return row * (row + 1) / 2 + column;
}
double square(double value) {
  return value * value;
}
double reciprocal(double value) {
  return 1.0 / value;
}
using std::log;
using std::pow;
using std::sqrt;

// Over the length along the cloth, weights included: curvature squared and the length that the yarn has more.
template <class T, class Term>
T bending_of(const Term& term, const std::array<T, 2>& v) {
  return 0.5 * term.bending * square(v[1]) * pow(square(v[0]) + 1.0, -2.5);
}
template <class T, class Term>
T tension_of(const Term& term, const std::array<T, 2>& v) {
  return term.tension * (sqrt(square(v[0]) + 1.0) - 1.0);
}
// Against what the section has by itself.
template <class T, class Term>
T flattening_of(const Term& term, const std::array<T, 2>& v) {
  return 0.5 * term.flattening * square(log(v[0] * reciprocal(v[1])) - term.log_aspect);
}
// Work of the pressure k ((f / f0)^3 - 1) on a section with fibre fraction f (C. M. van Wyk, J. Text. Inst.
// 37 (1946) T285).
template <class T, class Term>
T compaction_of(const Term& term, const std::array<T, 2>& v) {
  const T area = pi * v[0] * v[1] * (term.packing / term.fibre_area);  // over that at rest
  const T fraction = reciprocal(area);                                 // over that at rest
  return term.compaction / term.packing * (0.5 * square(fraction) + area - 1.5);
}

// A function of a few of eight variables; with its derivatives by them all where the variables have some.
template <std::size_t M, class Function>
double of_few(const std::array<double, 8>& v, const std::array<std::size_t, M>& which,
              const Function& function) {
  std::array<double, M> few;
  for (std::size_t i = 0; i < M; ++i) few[i] = v[which[i]];
  return function(few);
}
template <std::size_t M, class Function>
Dual<8> of_few(const std::array<Dual<8>, 8>& v, const std::array<std::size_t, M>& which,
               const Function& function) {
  std::array<Dual<M>, M> few;
  for (std::size_t i = 0; i < M; ++i) few[i] = Dual<M>::variable(i, v[which[i]].value);
  const Dual<M> term = function(few);
  Dual<8> made(term.value);
  for (std::size_t i = 0, k = 0; i < M; ++i) {
    made.first[which[i]] = term.first[i];
    for (std::size_t j = 0; j <= i; ++j, ++k) made.second[lower(which[i], which[j])] = term.second[k];
  }
  return made;
}

// The distance of the planes that touch both yarns and are parallel to both centre lines, times the length of
// the normal (-u', -v', 1): what is free between them. Variables: z, slope, half width, half height of both.
template <class T, class Place>
T gap_of(const Place& place, const std::array<T, 8>& v) {
  const T apart = place.side * (v[0] - v[4] - v[1] * place.along_warp + v[5] * place.along_weft);
  // Of own slope, half width, half height and the other slope; of the weft with the slopes exchanged.
  const T warp = of_few<4>(v, {1, 2, 3, 5}, [](const auto& s) {
    return sqrt(square(s[1] * s[3]) + square(s[2]) * (square(s[0]) + 1.0));
  });
  const T weft = of_few<4>(v, {1, 5, 6, 7}, [](const auto& s) {
    return sqrt(square(s[2] * s[0]) + square(s[3]) * (square(s[1]) + 1.0));
  });
  const T normal =
      of_few<2>(v, {1, 5}, [](const auto& s) { return sqrt(square(s[0]) + square(s[1]) + 1.0); });
  return apart - warp - weft - place.clearance * normal;
}
// Ellipses side by side, as they are cut across the cloth: how far their axes lie apart, over the ellipse of
// the sum of their half sizes.
template <class T, class Place>
T beside_of(const Place& place, const std::array<T, 8>& v) {
  if (place.is_level) return (v[2] + v[6]) * -1.0 + (place.spacing - place.clearance);
  if (place.is_stacked) {
    // Sections that differ: planes along the normal of that ellipse touch them.
    const T first = v[3] * sqrt(square(v[1]) + 1.0), second = v[7] * sqrt(square(v[5]) + 1.0),
            up = v[0] - v[4];
    const T along = place.spacing * square(reciprocal(v[2] + v[6])),
            across = up * square(reciprocal(first + second));
    const T far = sqrt(place.spacing * along + up * across);
    return far - (sqrt(square(v[2] * along) + square(first * across)) +
                  sqrt(square(v[6] * along) + square(second * across)) +
                  place.clearance * sqrt(square(along) + square(across))) *
                     reciprocal(far);
  }
  const T width = v[2] + v[6] + place.clearance,
          height = v[3] * sqrt(square(v[1]) + 1.0) + v[7] * sqrt(square(v[5]) + 1.0) + place.clearance;
  return square(place.spacing * reciprocal(width)) + square((v[0] - v[4]) * reciprocal(height)) - 1.0;
}

// Sections above each other, as they are cut along the cloth: what is free between them.
template <class T, class Place>
T stack_of(const Place& place, const std::array<T, 8>& v) {
  const auto above_axis = [&](const T& half, const T& slope) {
    return (half + 0.5 * place.clearance) * sqrt(square(slope) + 1.0);
  };
  return v[4] - v[0] - above_axis(v[3], v[1]) - above_axis(v[7], v[5]);
}

// Values of a station by number, of one station or of two.
template <std::size_t N>
struct OneStation {
  std::size_t station;
  std::array<std::size_t, N> which;
};
struct TwoStations {
  std::size_t first, second, pair;
};
constexpr std::array<std::size_t, 4> of_two = {0, 1, 3, 4};  // all but the second derivative

template <std::size_t N, class All>
std::array<double, N> values_of(const OneStation<N>& at, const All& all) {
  std::array<double, N> made;
  for (std::size_t i = 0; i < N; ++i) made[i] = all[at.station][at.which[i]];
  return made;
}
template <class All>
std::array<double, 8> values_of(const TwoStations& at, const All& all) {
  std::array<double, 8> made;
  for (std::size_t i = 0; i < 4; ++i) {
    made[i] = all[at.first][of_two[i]];
    made[i + 4] = all[at.second][of_two[i]];
  }
  return made;
}

template <std::size_t N>
std::array<Dual<N>, N> duals_of(const std::array<double, N>& values) {
  std::array<Dual<N>, N> made;
  for (std::size_t i = 0; i < N; ++i) made[i] = Dual<N>::variable(i, values[i]);
  return made;
}

}  // namespace

template <class Use>
void WovenProblem::for_candidates(const Use& use) const {
  constexpr double fold_reserve = 1.05;  // radius of curvature over half the height, at least
  for (const Packed& p : packed_)
    use(OneStation<2>{p.station, {half_width, half_height}},
        [&](const auto& v) { return v[0] * v[1] * (1.0 / p.least_product) - 1.0; });
  for (const Bound& p : bounds_)
    use(OneStation<num_values>{p.station, {z, slope, curvature, half_width, half_height}},
        [&](const auto& v) {
          auto sum = v[0] * p.weights[0] + p.constant;
          for (std::size_t i = 1; i < num_values; ++i)
            if (p.weights[i] != 0.0) sum += v[i] * p.weights[i];
          return sum;
        });
  for (const Plate& p : plates_)
    use(TwoStations{p.first, p.second, p.pair}, [&](const auto& v) { return v[4] - v[0] * p.side - v[3]; });
  for (const Beside& p : besides_)
    use(TwoStations{p.first, p.second, p.pair}, [&](const auto& v) { return beside_of(p, v); });
  for (const Fold& p : folds_)
    use(OneStation<3>{p.station, {slope, curvature, half_height}},
        [&](const auto& v) { return pow(square(v[0]) + 1.0, 1.5) - fold_reserve * p.side * v[1] * v[2]; });
  for (const Stack& p : stacks_)
    use(TwoStations{p.first, p.second, p.pair}, [&](const auto& v) { return stack_of(p, v); });
  for (const Contact& p : contacts_)
    use(TwoStations{p.first, p.second, p.pair}, [&](const auto& v) { return gap_of(p, v); });
}

template <class Use>
void WovenProblem::for_active(const Use& use) const {
  std::size_t k = 0;
  Index row = 0;
  for_candidates([&](const auto& at, const auto& function) {
    if (is_active_[k++] != 0) use(row++, at, function);
  });
}

std::vector<WovenProblem::Values> WovenProblem::values_at(const VectorXd& x) const {
  std::vector<Values> made;
  made.reserve(stations_.size());
  for (const Station& station : stations_) {
    const auto& unknowns = spans_[station.span].unknowns;
    Values values{};
    for (std::size_t i = 0; i < heights_of_span; ++i)
      for (std::size_t d = 0; d < station.path.size(); ++d) values[d] += station.path[d][i] * x[unknowns[i]];
    for (std::size_t size = 0; size < 2; ++size)
      values[half_width + size] =
          (1.0 - station.step) * x[unknowns[4 + size]] + station.step * x[unknowns[6 + size]];
    made.push_back(values);
  }
  return made;
}

WovenEnergy WovenProblem::weighted_energy(const std::vector<Values>& values, const VectorXd& x) const {
  WovenEnergy sum;
  for (const PathTerm& term : paths_) {
    const auto v = values_of(OneStation<2>{term.station, {slope, curvature}}, values);
    sum.bending += bending_of(term, v);
    sum.tension += tension_of(term, v);
  }
  for (const SectionTerm& term : sections_) {
    const auto v = values_of(OneStation<2>{term.station, {half_width, half_height}}, values);
    if (!(v[0] > 0.0 && v[1] > 0.0)) {
      sum.flattening = std::numeric_limits<double>::infinity();
      return sum;
    }
    sum.flattening += flattening_of(term, v);
    sum.compaction += compaction_of(term, v);
  }
  for (const ChangeTerm& term : changes_) {
    const auto& unknowns = spans_[term.span].unknowns;
    sum.tension += term.factor * square(x[unknowns[6 + term.size]] - x[unknowns[4 + term.size]]);
  }
  return sum;
}

WovenEnergy WovenProblem::energy(const VectorXd& x) const {
  WovenEnergy made = weighted_energy(values_at(x), x);
  for (double* part : {&made.bending, &made.tension, &made.flattening, &made.compaction})
    *part /= classes_.count();
  return made;
}

double WovenProblem::thickness(const VectorXd& x) const {
  const std::vector<Values> values = values_at(x);
  double half = 0.0;
  for (const Fold& at : folds_)
    half = std::max(half, at.side * values[at.station][z] + values[at.station][half_height]);
  return 2.0 * half;
}

double WovenProblem::pressure(const Minimum& at) const {
  double force = 0.0;  // by half their distance
  Index row = 0;
  for (std::size_t k = 0; k < first_beside(); ++k) {
    if (is_active_[k] == 0) continue;
    if (k >= first_plate()) force += at.multipliers[row];
    ++row;
  }
  return 0.5 * force / plates_area_;
}

double WovenProblem::plates_force() const {
  return 2.0 * cloth_.pressure.value_or(cloth_.constants.pressure) * plates_area_;
}

double WovenProblem::crimp(WovenSystem system, const VectorXd& x) const {
  const std::vector<Values> values = values_at(x);
  double yarn = 0.0, cloth = 0.0;
  for (const PathTerm& term : paths_) {
    if (term.system != system) continue;
    yarn += term.length * sqrt(square(values[term.station][slope]) + 1.0);
    cloth += term.length;
  }
  return yarn / cloth - 1.0;
}

double WovenProblem::evaluate(const VectorXd& x, VectorXd& inequalities) const {
  const std::vector<Values> values = values_at(x);
  const double sum = weighted_energy(values, x).sum() + plates_force() * x[num_unknowns_ - 1];
  double held = 0.0;
  for (const HoldTerm& term : holds_) held += term.factor * square(values[term.station][z]);
  inequalities.resize(std::count(is_active_.begin(), is_active_.end(), 1));
  for_active([&](Index row, const auto& at, const auto& function) {
    inequalities[row] = function(values_of(at, values));
  });
  return sum + held;
}

// Derivatives by the values of a station, and second ones by those of two.
struct WovenProblem::StationSums {
  Values first{};
  std::array<double, num_values*(num_values + 1) / 2> second{};
};

std::array<double, WovenProblem::num_of_span> WovenProblem::of_unknowns(const Station& station,
                                                                        const Values& first) const {
  std::array<double, num_of_span> made{};
  for (std::size_t i = 0; i < heights_of_span; ++i)
    for (std::size_t d = 0; d < station.path.size(); ++d) made[i] += first[d] * station.path[d][i];
  for (std::size_t size = 0; size < 2; ++size) {
    made[4 + size] = (1.0 - station.step) * first[half_width + size];
    made[6 + size] = station.step * first[half_width + size];
  }
  return made;
}

void WovenProblem::add_station(const Station& station, const StationSums& sums, Derivatives& made) const {
  const Span& span = spans_[station.span];
  const auto first = of_unknowns(station, sums.first);
  for (std::size_t i = 0; i < num_of_span; ++i) made.gradient[span.unknowns[i]] += first[i];
  // Rows of the second derivatives by the values, then by the unknowns.
  std::array<std::array<double, num_of_span>, num_values> rows;
  for (std::size_t a = 0; a < num_values; ++a) {
    Values row;
    for (std::size_t b = 0; b < num_values; ++b) row[b] = sums.second[a >= b ? lower(a, b) : lower(b, a)];
    rows[a] = of_unknowns(station, row);
  }
  double* const values = made.second.valuePtr();
  for (std::size_t j = 0; j < num_of_span; ++j) {
    Values column;
    for (std::size_t a = 0; a < num_values; ++a) column[a] = rows[a][j];
    const auto by_unknowns = of_unknowns(station, column);
    for (std::size_t i = j; i < num_of_span; ++i) values[span.places[lower(i, j)]] += by_unknowns[i];
  }
}

void WovenProblem::differentiate(const VectorXd& x, const VectorXd& multipliers, const VectorXd& weights,
                                 Derivatives& made) const {
  const std::vector<Values> values = values_at(x);
  std::vector<StationSums> sums(stations_.size());
  double* const second = made.second.valuePtr();
  made.gradient = VectorXd::Zero(num_unknowns_);
  made.gradient[num_unknowns_ - 1] = plates_force();
  // Adds factor * (second derivatives of a term) + outer * (outer product of its gradient).
  const auto add_second = [&](const auto& at, const auto& term, double factor, double outer) {
    if constexpr (std::is_same_v<std::decay_t<decltype(at)>, TwoStations>) {
      const Station &a = stations_[at.first], &b = stations_[at.second];
      std::array<Values, num_values> cross{};
      for (std::size_t i = 0; i < 8; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
          const double value = factor * term.second[lower(i, j)] + outer * term.first[i] * term.first[j];
          if (i >= 4 && j < 4)
            cross[of_two[i - 4]][of_two[j]] = value;
          else
            sums[i < 4 ? at.first : at.second].second[lower(of_two[i % 4], of_two[j % 4])] += value;
        }
      std::array<std::array<double, num_of_span>, num_values> rows;
      for (const std::size_t i : of_two) rows[i] = of_unknowns(a, cross[i]);
      const SpanPair& pair = pairs_[at.pair];
      const auto &first = spans_[pair.first].unknowns, &next = spans_[pair.second].unknowns;
      for (std::size_t k = 0; k < num_of_span; ++k) {
        Values column{};
        for (const std::size_t i : of_two) column[i] = rows[i][k];
        const auto by_unknowns = of_unknowns(b, column);
        // What is off the diagonal counts twice in the whole matrix, as it must.
        for (std::size_t m = 0; m < num_of_span; ++m)
          second[pair.places[k * num_of_span + m]] +=
              first[k] == next[m] ? 2.0 * by_unknowns[m] : by_unknowns[m];
      }
    } else {
      for (std::size_t i = 0; i < at.which.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j)
          sums[at.station].second[lower(at.which[i], at.which[j])] +=
              factor * term.second[lower(i, j)] + outer * term.first[i] * term.first[j];
    }
  };
  const auto add = [&](const auto& at, const auto& term) {
    for (std::size_t i = 0; i < at.which.size(); ++i) sums[at.station].first[at.which[i]] += term.first[i];
    add_second(at, term, 1.0, 0.0);
  };
  for (const PathTerm& term : paths_) {
    const OneStation<2> at{term.station, {slope, curvature}};
    const auto v = duals_of(values_of(at, values));
    add(at, bending_of(term, v) + tension_of(term, v));
  }
  for (const SectionTerm& term : sections_) {
    const OneStation<2> at{term.station, {half_width, half_height}};
    const auto v = duals_of(values_of(at, values));
    add(at, flattening_of(term, v) + compaction_of(term, v));
  }
  for (const HoldTerm& term : holds_) {
    const OneStation<1> at{term.station, {z}};
    add(at, term.factor * square(duals_of(values_of(at, values))[0]));
  }
  for (const ChangeTerm& term : changes_) {
    const Span& span = spans_[term.span];
    const std::size_t from = 4 + term.size, to = 6 + term.size;
    const double difference = x[span.unknowns[to]] - x[span.unknowns[from]];
    made.gradient[span.unknowns[to]] += 2.0 * term.factor * difference;
    made.gradient[span.unknowns[from]] -= 2.0 * term.factor * difference;
    second[span.places[lower(to, to)]] += 2.0 * term.factor;
    second[span.places[lower(from, from)]] += 2.0 * term.factor;
    second[span.places[lower(to, from)]] -= 2.0 * term.factor;
  }
  const auto add_row = [&](std::size_t station, const Values& first) {
    const auto by_unknowns = of_unknowns(stations_[station], first);
    for (std::size_t i = 0; i < num_of_span; ++i)
      if (by_unknowns[i] != 0.0)
        made.gradients.add(spans_[stations_[station].span].unknowns[i], by_unknowns[i]);
  };
  for_active([&](Index row, const auto& at, const auto& function) {
    const auto term = function(duals_of(values_of(at, values)));
    if constexpr (std::is_same_v<std::decay_t<decltype(at)>, TwoStations>) {
      Values first{}, next{};
      for (std::size_t i = 0; i < 4; ++i) {
        first[of_two[i]] = term.first[i];
        next[of_two[i]] = term.first[i + 4];
      }
      add_row(at.first, first);
      add_row(at.second, next);
    } else {
      Values first{};
      for (std::size_t i = 0; i < at.which.size(); ++i) first[at.which[i]] = term.first[i];
      add_row(at.station, first);
    }
    made.gradients.end_row();
    add_second(at, term, -multipliers[row], weights[row]);
  });
  for (std::size_t k = 0; k < stations_.size(); ++k) add_station(stations_[k], sums[k], made);
}

// The place where the yarn leaves the crossing most steeply: beyond it a tangent leaves the yarn.
int WovenProblem::reach_of(const Run& run, const std::vector<Values>& values) const {
  constexpr double slack = 1e-3, turn = 0.05;
  double most = -std::numeric_limits<double>::infinity();
  if (run.stations.size() > 1 + spans_a_gap) {
    // Up to the next crossing: behind the first turn the yarn may come back.
    int reach = 0;
    for (std::size_t k = 0; k < run.stations.size(); ++k) {
      const double here = run.sign * values[run.stations[k]][slope];
      if (here < most - turn) break;
      if (here >= most - slack) reach = static_cast<int>(k);
      most = std::max(most, here);
    }
    return reach;
  }
  for (const std::size_t at : run.stations) most = std::max(most, run.sign * values[at][slope]);
  int reach = 0;
  for (std::size_t k = 0; k < run.stations.size(); ++k)
    if (run.sign * values[run.stations[k]][slope] >= most - slack) reach = static_cast<int>(k);
  return reach;
}

std::vector<int> WovenProblem::reaches(const std::vector<Values>& values) const {
  std::vector<int> made;
  made.reserve(runs_.size());
  for (const Run& run : runs_) made.push_back(reach_of(run, values));
  return made;
}

double WovenProblem::worst(const VectorXd& x) const {
  double least = 0.0;
  const std::vector<Values> values = values_at(x);
  const std::vector<int> reach = reaches(values);
  std::size_t k = 0;
  for_candidates([&](const auto& at, const auto& function) {
    const std::size_t index = k++;
    if (index >= first_contact()) {
      const Contact& contact = contacts_[index - first_contact()];
      if (contact.warp_place > reach[contact.warp_run] || contact.weft_place > reach[contact.weft_run])
        return;
    }
    least = std::min(least, static_cast<double>(function(values_of(at, values))));
  });
  return std::abs(least);
}

void WovenProblem::set_active(std::vector<char> active) {
  is_active_ = std::move(active);
  if (!is_active_.empty()) find_places();
}

bool WovenProblem::update(Minimum& at, double tolerance) {
  // What is not further from touching takes part; of yarns side by side twice the room, since soft ones widen
  // by much in one round.
  constexpr double near_any = 0.05, near_plate = 0.2, near_beside = 3.0;
  const bool is_first = is_active_.empty();
  const std::vector<Values> values = values_at(at.x);
  const std::vector<int> reach = reaches(values);
  std::vector<char> next;
  std::vector<double> slacks, multipliers;
  bool has_changed = is_first;
  Index row = 0;
  for_candidates([&](const auto& stations, const auto& function) {
    const std::size_t index = next.size();
    const bool was_active = !is_first && is_active_[index] != 0;
    const Index old = was_active ? row++ : -1;
    const double value = function(values_of(stations, values));
    bool is_valid = true;
    if (index >= first_contact()) {
      const Contact& contact = contacts_[index - first_contact()];
      is_valid =
          contact.warp_place <= reach[contact.warp_run] && contact.weft_place <= reach[contact.weft_run];
    }
    const bool is_pressing = was_active && at.multipliers[old] > tolerance;
    const double near = index < first_plate() || index >= first_fold() ? near_any
                        : index < first_beside()                       ? near_plate
                                                                       : near_beside;
    const bool is_near = value < near;
    bool is_active = is_valid && (was_active || is_near || index < packed_.size());
    // What presses and no longer holds has to go; what takes part and does not press may stay.
    if (!is_valid && was_active) is_active = !is_pressing;
    if (is_active != was_active && (is_active ? value < -tolerance : is_pressing)) has_changed = true;
    next.push_back(is_active ? 1 : 0);
    if (!is_active) return;
    slacks.push_back(was_active && at.slacks.size() > 0 ? at.slacks[old] : std::max(value, 1e-3));
    multipliers.push_back(was_active && at.multipliers.size() > 0 ? at.multipliers[old] : 1e-3);
  });
  if (next != is_active_) {
    is_active_ = std::move(next);
    find_places();
  }
  if (is_first) {
    at.slacks.resize(0);
    at.multipliers.resize(0);
  } else {
    at.slacks = Eigen::Map<const VectorXd>(slacks.data(), static_cast<Index>(slacks.size()));
    at.multipliers = Eigen::Map<const VectorXd>(multipliers.data(), static_cast<Index>(multipliers.size()));
  }
  return has_changed;
}

}  // namespace selvage::mechanics
