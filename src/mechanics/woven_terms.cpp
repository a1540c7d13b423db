// Energies and inequalities of woven cloths, with their derivatives.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mechanics/woven_problem.h"

namespace selvage::mechanics {

using Eigen::Index;
using Eigen::VectorXd;
using std::numbers::pi;

namespace {

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

// The distance of the planes that touch both yarns and are parallel to both centre lines, times the length of
// the normal (-u', -v', 1): what is free between them.
template <class T, class Place>
T gap_of(const Place& place, const std::array<T, 8>& v) {
  const auto& [u, du, width, height, w, dw, weft_width, weft_height] = v;
  const T uu = square(du), ww = square(dw);
  const T apart = place.side * (u - w - du * place.along_warp + dw * place.along_weft);
  return apart - sqrt(square(width) * ww + square(height) * (uu + 1.0)) -
         sqrt(square(weft_width) * uu + square(weft_height) * (ww + 1.0)) -
         place.clearance * sqrt(uu + ww + 1.0);
}
// Ellipses side by side, as they are cut across the cloth: how far their axes lie apart, over the ellipse of
// the sum of their half sizes.
template <class T, class Place>
T beside_of(const Place& place, const std::array<T, 8>& v) {
  const T width = v[2] + v[6] + place.clearance,
          height = v[3] * sqrt(square(v[1]) + 1.0) + v[7] * sqrt(square(v[5]) + 1.0) + place.clearance;
  return square(place.spacing * reciprocal(width)) + square((v[0] - v[4]) * reciprocal(height)) - 1.0;
}

}  // namespace

template <class Use>
void WovenProblem::for_candidates(const Use& use) const {
  constexpr double fold_reserve = 1.05;  // radius of curvature over half the height, at least
  for (const Packed& p : packed_)
    use(p.forms, [&](const auto& v) { return v[0] * v[1] * (1.0 / p.least_product) - 1.0; });
  for (const Linear& p : linears_) use(p.forms, [](const auto& v) { return v[0]; });
  for (const Beside& p : besides_) use(p.forms, [&](const auto& v) { return beside_of(p, v); });
  for (const Fold& p : folds_)
    use(p.forms,
        [&](const auto& v) { return pow(square(v[0]) + 1.0, 1.5) - fold_reserve * p.side * v[1] * v[2]; });
  for (const Contact& p : contacts_) use(p.forms, [&](const auto& v) { return gap_of(p, v); });
}

template <class Use>
void WovenProblem::for_active(const Use& use) const {
  std::size_t k = 0;
  Index row = 0;
  for_candidates([&](const auto& forms, const auto& function) {
    if (is_active_[k++] != 0) use(row++, forms, function);
  });
}

namespace {

template <std::size_t N>
std::array<double, N> values_of(const std::array<Form, N>& forms, const VectorXd& x) {
  std::array<double, N> made;
  for (std::size_t i = 0; i < N; ++i) made[i] = forms[i].at(x);
  return made;
}

}  // namespace

WovenEnergy WovenProblem::weighted_energy(const VectorXd& x) const {
  WovenEnergy sum;
  for (const PathTerm& term : paths_) {
    const auto v = values_of(term.forms, x);
    sum.bending += bending_of(term, v);
    sum.tension += tension_of(term, v);
  }
  for (const SectionTerm& term : sections_) {
    const auto v = values_of(term.forms, x);
    if (!(v[0] > 0.0 && v[1] > 0.0)) {
      sum.flattening = std::numeric_limits<double>::infinity();
      return sum;
    }
    sum.flattening += flattening_of(term, v);
    sum.compaction += compaction_of(term, v);
  }
  for (const SquareTerm& term : changes_) sum.tension += term.factor * square(term.form.at(x));
  return sum;
}

WovenEnergy WovenProblem::energy(const VectorXd& x) const {
  WovenEnergy made = weighted_energy(x);
  for (double* part : {&made.bending, &made.tension, &made.flattening, &made.compaction})
    *part /= classes_.count();
  return made;
}

double WovenProblem::crimp(WovenSystem system, const VectorXd& x) const {
  double yarn = 0.0, cloth = 0.0;
  for (const PathTerm& term : paths_) {
    if (term.system != system) continue;
    yarn += term.length * sqrt(square(term.forms[0].at(x)) + 1.0);
    cloth += term.length;
  }
  return yarn / cloth - 1.0;
}

double WovenProblem::evaluate(const VectorXd& x, VectorXd& inequalities) const {
  const double sum = weighted_energy(x).sum();
  double held = 0.0;
  for (const SquareTerm& term : holds_) held += term.factor * square(term.form.at(x));
  inequalities.resize(std::count(is_active_.begin(), is_active_.end(), 1));
  for_active([&](Index row, const auto& forms, const auto& function) {
    inequalities[row] = function(values_of(forms, x));
  });
  return sum + held;
}

void WovenProblem::differentiate(const VectorXd& x, const VectorXd& multipliers, const VectorXd& weights,
                                 Derivatives& made) const {
  made.gradient = VectorXd::Zero(num_unknowns_);
  const auto add = [&](const auto& forms, const auto& term) {
    add_first(made.gradient, forms, term, 1.0);
    add_second(made.second, forms, term, 1.0, 0.0);
  };
  for (const PathTerm& term : paths_) {
    const auto v = duals_of(term.forms, x);
    add(term.forms, bending_of(term, v) + tension_of(term, v));
  }
  for (const SectionTerm& term : sections_) {
    const auto v = duals_of(term.forms, x);
    add(term.forms, flattening_of(term, v) + compaction_of(term, v));
  }
  for (const std::vector<SquareTerm>* terms : {&changes_, &holds_})
    for (const SquareTerm& term : *terms) {
      const std::array<Form, 1> forms{term.form};
      add(forms, term.factor * square(duals_of(forms, x)[0]));
    }
  for_active([&](Index row, const auto& forms, const auto& function) {
    const auto value = function(duals_of(forms, x));
    add_row(made.gradients, forms, value);
    add_second(made.second, forms, value, -multipliers[row], weights[row]);
  });
}

// The place where the yarn leaves the crossing most steeply: beyond it a tangent leaves the yarn.
int WovenProblem::reach_of(const Run& run, const VectorXd& x) const {
  constexpr double slack = 1e-3;
  double most = -std::numeric_limits<double>::infinity();
  for (const Form& slope : run.slopes) most = std::max(most, run.sign * slope.at(x));
  int reach = 0;
  for (std::size_t k = 0; k < run.slopes.size(); ++k)
    if (run.sign * run.slopes[k].at(x) >= most - slack) reach = static_cast<int>(k);
  return reach;
}

double WovenProblem::worst(const VectorXd& x) const {
  double least = 0.0;
  std::vector<int> reach;
  for (const Run& run : runs_) reach.push_back(reach_of(run, x));
  const std::size_t first_contact = packed_.size() + linears_.size() + besides_.size() + folds_.size();
  std::size_t k = 0;
  for_candidates([&](const auto& forms, const auto& function) {
    const std::size_t index = k++;
    if (index >= first_contact) {
      const Contact& contact = contacts_[index - first_contact];
      if (contact.warp_place > reach[contact.warp_run] || contact.weft_place > reach[contact.weft_run])
        return;
    }
    least = std::min(least, static_cast<double>(function(values_of(forms, x))));
  });
  return -least;
}

bool WovenProblem::update(Minimum& at, double tolerance) {
  constexpr double near = 0.05;  // what is not further from touching takes part
  const bool is_first = is_active_.empty();
  const std::size_t first_contact = packed_.size() + linears_.size() + besides_.size() + folds_.size();
  std::vector<int> reach;
  for (const Run& run : runs_) reach.push_back(reach_of(run, at.x));
  std::vector<char> next;
  std::vector<double> slacks, multipliers;
  bool has_changed = is_first;
  Index row = 0;
  for_candidates([&](const auto& forms, const auto& function) {
    const std::size_t index = next.size();
    const bool was_active = !is_first && is_active_[index] != 0;
    const Index old = was_active ? row++ : -1;
    const double value = function(values_of(forms, at.x));
    bool is_valid = true;
    if (index >= first_contact) {
      const Contact& contact = contacts_[index - first_contact];
      is_valid =
          contact.warp_place <= reach[contact.warp_run] && contact.weft_place <= reach[contact.weft_run];
    }
    const bool is_pressing = was_active && at.multipliers[old] > tolerance;
    bool is_active = is_valid && (was_active || value < near);
    // What presses and no longer holds has to go; what takes part and does not press may stay.
    if (!is_valid && was_active) is_active = !is_pressing;
    if (is_active != was_active && (is_active ? value < -tolerance : is_pressing)) has_changed = true;
    next.push_back(is_active ? 1 : 0);
    if (!is_active) return;
    slacks.push_back(was_active && at.slacks.size() > 0 ? at.slacks[old] : std::max(value, 1e-3));
    multipliers.push_back(was_active && at.multipliers.size() > 0 ? at.multipliers[old] : 1e-3);
  });
  is_active_ = std::move(next);
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
