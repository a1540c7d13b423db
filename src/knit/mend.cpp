#include "knit/mend.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "knit/mend_system.h"
#include "knit/mend_touch.h"
#include "nurbs/basis.h"
#include "nurbs/interpolate.h"

namespace selvage::fabric {

namespace {

using mending::Linear;
using mending::Matrix;
using mending::Pull;
using mending::Residual;
using mending::Vector;

// Stiffnesses, for a radius of 1: of moves, of their bending and stretching along a line; of what keeps yarns
// apart and bends open. The last two are so large that little is missing in the first balance.
constexpr double hold = 1, bending = 1, stretching = 1, pressing = 8e2, opening = 1e3, lengthening = 1e3;
constexpr double negligible = 1e-2;  // shares in a place that steps leave out
constexpr double least_pull = 1e-6;  // the same where lines relax
// In radii:
constexpr double longest_step = 0.25, least_ahead = 0.05;
constexpr double stalled = 1e-3;
constexpr int most_halves = 12;  // of a step
constexpr int most_stalls = 4;
constexpr double settled = 0.02;        // share of the energy that a step gains
constexpr double least_stretch = 1e-4;  // of a line that keeps its length

struct State {
  Vector moves;
  std::vector<std::vector<Vec3>> points;
  std::vector<nurbs::Curve> curves;
  std::vector<CubicPath> paths;
  std::vector<Touch> touches;
  double energy = 0, missing = 0;
  Vec3 at = Vec3::Zero();
  double bending = 0;
  std::vector<double> lengths;  // of those lines that keep theirs; else 0
};

class Mender {
 public:
  explicit Mender(const MendProblem& problem)
      : problem_(problem), size_(3 * static_cast<Eigen::Index>(problem.freedom.size())) {
    for (const MendLine& line : problem.lines) radius_ = std::max(radius_, line.radius);
  }
  Mending run();

 private:
  [[nodiscard]] State state_at(Vector moves) const;
  void look(State& state, double more) const;
  [[nodiscard]] Vector step(const State& state, double more) const;
  [[nodiscard]] Vector mirrored_mean(const Vector& moves) const;
  void make_stiffness();
  void add_pulls(const MendLine& line, const State& state, std::size_t index, double place, int derivative,
                 const Vec3& along, const std::vector<std::vector<Share>>& shares,
                 std::vector<Pull>& pulls) const;
  [[nodiscard]] std::vector<Residual> residuals(const State& state, double more) const;
  // Calls each(place, weight, jet): a length is the sum of weight |measure d1|.
  template <class Each>
  void for_pieces(const CubicPath& path, const Each& each) const;
  [[nodiscard]] double bending_of(const State& state) const;
  void add_bending(const State& state, std::size_t line, const std::vector<std::vector<Share>>& shares,
                   std::vector<Residual>& found) const;
  std::optional<State> relax(State state, double more);
  [[nodiscard]] std::vector<double> lengths_of(const State& state) const;
  [[nodiscard]] Residual length_residual(const State& state, std::size_t line,
                                         const std::vector<std::vector<Share>>& shares) const;
  [[nodiscard]] double stretch_of(const State& state) const;
  // Calls each(line, place, jet, curvature, lack) wherever a bend is too tight.
  template <class Each>
  void for_tight_bends(const State& state, const Each& each) const;

  const MendProblem& problem_;
  Eigen::Index size_;
  double radius_ = 0;
  // Of each line that keeps its length: what it has to be, and what is asked for, that it may become that.
  std::vector<double> lengths_, asked_lengths_;
  double ahead_ = 0;  // what is nearer than this may be lacking after a step
  Matrix stiffness_;
  Vector held_;  // the moves at which it pulls with nothing
  bool is_relaxing_ = false;
  std::optional<TouchFinder> finder_;
};

constexpr int looks = 4;  // at the bend of a span

double curvature_of(const CubicPath::Jet& jet) {
  const double speed = jet.d1.norm();
  return jet.d1.cross(jet.d2).norm() / (speed * speed * speed);
}

State Mender::state_at(Vector moves) const {
  State state;
  state.moves = std::move(moves);
  for (const MendLine& line : problem_.lines) {
    std::vector<Vec3> points = line.points;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (line.classes[i] >= 0) points[i] += state.moves.segment<3>(3 * Eigen::Index{line.classes[i]});
    state.curves.push_back(line.curve(points));
    state.paths.emplace_back(state.curves.back(), line.period);
    state.points.push_back(std::move(points));
  }
  return state;
}

template <class Each>
void Mender::for_tight_bends(const State& state, const Each& each) const {
  for (std::size_t l = 0; l < state.paths.size(); ++l) {
    const CubicPath& path = state.paths[l];
    const double radius = problem_.lines[l].radius;
    const std::size_t end = path.spans() * looks + (path.is_periodic() ? 0 : 1);
    for (std::size_t i = 0; i < end; ++i) {  // most bends are sharpest at a data point
      const double place = static_cast<double>(i) / looks;
      const CubicPath::Jet jet = path.at(place);
      const double curvature = curvature_of(jet), lack = radius * curvature - 1 / problem_.bend;
      if (lack > 0) each(l, place, jet, curvature, radius_ * lack);
    }
  }
}

template <class Each>
void Mender::for_pieces(const CubicPath& path, const Each& each) const {
  // Gauss' three points in a half of each span, or five.
  static const double off = std::sqrt(0.15);
  static const std::vector<std::array<double, 2>> three = {
      {0.5 - off, 5.0 / 18}, {0.5, 4.0 / 9}, {0.5 + off, 5.0 / 18}};
  static const double near = std::sqrt(5 - 2 * std::sqrt(10.0 / 7)) / 6,
                      far = std::sqrt(5 + 2 * std::sqrt(10.0 / 7)) / 6,
                      of_near = (322 + 13 * std::sqrt(70.0)) / 1800,
                      of_far = (322 - 13 * std::sqrt(70.0)) / 1800;
  static const std::vector<std::array<double, 2>> five = {{0.5 - far, of_far},
                                                          {0.5 - near, of_near},
                                                          {0.5, 64.0 / 225},
                                                          {0.5 + near, of_near},
                                                          {0.5 + far, of_far}};
  for (std::size_t half = 0; half < 2 * path.spans(); ++half)
    for (const auto& [node, weight] : problem_.relaxes ? five : three) {
      const double place = 0.5 * (static_cast<double>(half) + node);
      each(place, 0.5 * weight, path.at(place));
    }
}

double Mender::bending_of(const State& state) const {
  double sum = 0;
  for (const CubicPath& path : state.paths)
    for_pieces(path, [&](double, double weight, const CubicPath::Jet& jet) {
      const Vec3 d1 = jet.d1.cwiseProduct(problem_.measure), d2 = jet.d2.cwiseProduct(problem_.measure);
      const double speed = d1.norm();
      sum += weight * d1.cross(d2).squaredNorm() / std::pow(speed, 5);
    });
  return sum;
}

// The curvature k = c''/s^2 - c' (c' c'')/s^4, with speed s, times the root of s: half of its squares' sum is
// the energy.
void Mender::add_bending(const State& state, std::size_t line, const std::vector<std::vector<Share>>& shares,
                         std::vector<Residual>& found) const {
  const double stiffness = std::pow(radius_, 3);
  for_pieces(state.paths[line], [&](double place, double weight, const CubicPath::Jet& jet) {
    const Vec3 d1 = jet.d1.cwiseProduct(problem_.measure), d2 = jet.d2.cwiseProduct(problem_.measure);
    const double s = d1.norm(), along = d1.dot(d2), root = std::sqrt(s);
    const Vec3 t = d1 / s, k = (d2 - d2.dot(t) * t) / (s * s);
    const Eigen::Matrix3d by_d2 = root / (s * s) * (Eigen::Matrix3d::Identity() - t * t.transpose());
    const Eigen::Matrix3d by_d1 =
        root * ((4 * along / std::pow(s, 5) * d1 - 2 / std::pow(s, 3) * d2) * t.transpose() -
                (along * Eigen::Matrix3d::Identity() + d1 * d2.transpose()) / std::pow(s, 4)) +
        k * t.transpose() / (2 * root);
    for (Eigen::Index i = 0; i < 3; ++i) {
      Residual residual{weight * stiffness, root * k(i), {}, true};
      add_pulls(problem_.lines[line], state, line, place, 2,
                -by_d2.row(i).transpose().cwiseProduct(problem_.measure), shares, residual.pulls);
      add_pulls(problem_.lines[line], state, line, place, 1,
                -by_d1.row(i).transpose().cwiseProduct(problem_.measure), shares, residual.pulls);
      found.push_back(std::move(residual));
    }
  });
}

std::vector<double> Mender::lengths_of(const State& state) const {
  std::vector<double> lengths(state.paths.size(), 0.0);
  for (std::size_t l = 0; l < lengths.size(); ++l)
    if (problem_.lines[l].keeps_length)
      for_pieces(state.paths[l], [&](double, double weight, const CubicPath::Jet& jet) {
        lengths[l] += weight * jet.d1.cwiseProduct(problem_.measure).norm();
      });
  return lengths;
}

double Mender::stretch_of(const State& state) const {
  double most = 0;
  for (std::size_t l = 0; l < lengths_.size(); ++l)
    if (lengths_[l] > 0) most = std::max(most, std::abs(state.lengths[l] / lengths_[l] - 1));
  return most;
}

Residual Mender::length_residual(const State& state, std::size_t line,
                                 const std::vector<std::vector<Share>>& shares) const {
  Residual residual{lengthening, asked_lengths_[line] - state.lengths[line], {}, true};
  std::vector<Pull> pulls;
  for_pieces(state.paths[line], [&](double place, double weight, const CubicPath::Jet& jet) {
    const Vec3 tangent = jet.d1.cwiseProduct(problem_.measure).normalized();
    pulls.clear();
    // A pull takes away from what is lacking.
    add_pulls(problem_.lines[line], state, line, place, 1, weight * tangent.cwiseProduct(problem_.measure),
              shares, pulls);
    residual.pulls.insert(residual.pulls.end(), pulls.begin(), pulls.end());
  });
  return residual;
}

// Finds the touches of a state and its energy when `more` than the needed distance is asked for.
void Mender::look(State& state, double more) const {
  state.touches = finder_->find(state.paths, more + ahead_);
  state.energy = 0.5 * (state.moves - held_).dot(stiffness_ * (state.moves - held_));
  if (problem_.relaxes) state.bending = bending_of(state);
  if (is_relaxing_) state.energy += 0.5 * std::pow(radius_, 3) * state.bending;
  state.missing = 0;
  state.lengths = lengths_of(state);
  for (std::size_t l = 0; l < asked_lengths_.size(); ++l)
    state.energy += 0.5 * lengthening * std::pow(asked_lengths_[l] - state.lengths[l], 2);
  for (const Touch& touch : state.touches) {
    const double lack = std::max(more - touch.slack, 0.0);
    state.energy += 0.5 * pressing * lack * lack;
    if (-touch.slack <= state.missing) continue;
    state.missing = -touch.slack;
    state.at = 0.5 * (touch.on_a + touch.on_b);
  }
  for_tight_bends(state, [&](std::size_t, double, const CubicPath::Jet&, double, double lack) {
    state.energy += 0.5 * opening * lack * lack;
  });
}

void Mender::make_stiffness() {
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int a, int b, const Eigen::Matrix3d& block) {
    if (a < 0 || b < 0) return;
    const Vec3 &free_a = problem_.freedom[static_cast<std::size_t>(a)],
               &free_b = problem_.freedom[static_cast<std::size_t>(b)];
    for (Eigen::Index i = 0; i < 3; ++i)
      for (Eigen::Index j = 0; j < 3; ++j) {
        const double value = free_a(i) * block(i, j) * free_b(j) + (a == b && i == j ? 1 - free_a(i) : 0.0);
        if (value != 0.0) entries.emplace_back(Eigen::Index{3} * a + i, Eigen::Index{3} * b + j, value);
      }
  };
  constexpr double unused = 1e-9;  // of classes that no point has
  for (std::size_t c = 0; c < problem_.freedom.size(); ++c)
    add(static_cast<int>(c), static_cast<int>(c), unused * Eigen::Matrix3d::Identity());
  for (const MendLine& line : problem_.lines) {
    std::vector<int> c = line.classes;
    const bool is_periodic = line.period != Vec3::Zero();
    // Each point of a periodic line counts once, with those that follow it in the next copy.
    const std::size_t own = is_periodic ? c.size() - 1 : c.size();
    if (is_periodic) c.push_back(c[1]);
    for (std::size_t i = 0; i < own; ++i) {
      add(c[i], c[i], hold * Eigen::Matrix3d::Identity());
      if (i + 1 < line.points.size()) {
        const Vec3 along = (line.points[i + 1] - line.points[i]).normalized();
        const Eigen::Matrix3d block = stretching * along * along.transpose();
        add(c[i], c[i], block);
        add(c[i + 1], c[i + 1], block);
        add(c[i], c[i + 1], -block);
        add(c[i + 1], c[i], -block);
      }
      if (i + 2 < c.size()) {
        const std::array<double, 3> weights = {1, -2, 1};
        for (std::size_t a = 0; a < 3; ++a)
          for (std::size_t b = 0; b < 3; ++b)
            add(c[i + a], c[i + b], bending * weights[a] * weights[b] * Eigen::Matrix3d::Identity());
      }
    }
  }
  held_ = Vector::Zero(size_);
  stiffness_.resize(size_, size_);
  stiffness_.setFromTriplets(entries.begin(), entries.end());
}

// Adds what the moves change in a place of a line (derivative 0) or in one of its derivatives (1, 2).
void Mender::add_pulls(const MendLine& line, const State& state, std::size_t index, double place,
                       int derivative, const Vec3& along, const std::vector<std::vector<Share>>& shares,
                       std::vector<Pull>& pulls) const {
  const nurbs::Curve& curve = state.curves[index];
  const CubicPath& path = state.paths[index];
  const double t = path.parameter(place);
  const double h = path.step(path.span_of(place));
  const int span = nurbs::find_span(curve.knots, curve.degree, static_cast<int>(curve.points.size()), t);
  std::array<nurbs::BasisRow, 3> rows;
  nurbs::basis_derivatives(curve.knots, curve.degree, span, t, rows);
  const double scale = derivative == 2 ? h * h : derivative == 1 ? h : 1.0;
  const std::size_t first = pulls.size();
  for (int j = 0; j <= curve.degree; ++j) {
    const double value = scale * rows[static_cast<std::size_t>(derivative)][static_cast<std::size_t>(j)];
    for (const Share& share :
         shares[static_cast<std::size_t>(span - curve.degree) + static_cast<std::size_t>(j)]) {
      const int c = line.classes[share.point];
      if (c < 0) continue;
      const auto same = std::find_if(pulls.begin() + static_cast<std::ptrdiff_t>(first), pulls.end(),
                                     [&](const Pull& pull) { return pull.index == c; });
      const Vec3 pull = value * share.weight * along;
      if (same == pulls.end())
        pulls.push_back({c, pull});
      else
        same->along += pull;
    }
  }
}

std::vector<Residual> Mender::residuals(const State& state, double more) const {
  std::vector<std::vector<std::vector<Share>>> shares;
  for (std::size_t l = 0; l < state.points.size(); ++l)
    shares.push_back(problem_.lines[l].shares(state.points[l]));
  std::vector<Residual> found;
  for (const Touch& touch : state.touches) {
    Residual residual{pressing, more - touch.slack, {}};
    add_pulls(problem_.lines[touch.line_a], state, touch.line_a, touch.place_a, 0, touch.normal,
              shares[touch.line_a], residual.pulls);
    std::vector<Pull> other;
    add_pulls(problem_.lines[touch.line_b], state, touch.line_b, touch.place_b, 0, -touch.normal,
              shares[touch.line_b], other);
    residual.pulls.insert(residual.pulls.end(), other.begin(), other.end());
    found.push_back(std::move(residual));
  }
  for_tight_bends(
      state, [&](std::size_t l, double place, const CubicPath::Jet& jet, double curvature, double lack) {
        // Curvature k n = (c'' - (c'' t) t) / s^2, with speed s: what c'' and what c' change in k.
        const double speed = jet.d1.norm();
        const Vec3 tangent = jet.d1 / speed;
        const double ahead_d2 = jet.d2.dot(tangent);
        const Vec3 towards = (jet.d2 - ahead_d2 * tangent) / (speed * speed * curvature);
        const Vec3 by_d1 = 2 * curvature / speed * tangent + ahead_d2 / (speed * speed * speed) * towards;
        const double scale = radius_ * problem_.lines[l].radius;
        Residual residual{opening, lack, {}};
        add_pulls(problem_.lines[l], state, l, place, 2, -scale / (speed * speed) * towards, shares[l],
                  residual.pulls);
        add_pulls(problem_.lines[l], state, l, place, 1, scale * by_d1, shares[l], residual.pulls);
        found.push_back(std::move(residual));
      });
  for (std::size_t l = 0; l < lengths_.size(); ++l)
    if (lengths_[l] > 0) found.push_back(length_residual(state, l, shares[l]));
  for (std::size_t l = 0; is_relaxing_ && l < shares.size(); ++l) add_bending(state, l, shares[l], found);
  for (Residual& residual : found) {
    // Classes that stand in it twice (both places are of one class) count once.
    std::stable_sort(residual.pulls.begin(), residual.pulls.end(),
                     [](const Pull& a, const Pull& b) { return a.index < b.index; });
    std::vector<Pull> merged;
    for (const Pull& pull : residual.pulls) {
      if (merged.empty() || merged.back().index != pull.index)
        merged.push_back(pull);
      else
        merged.back().along += pull.along;
    }
    for (Pull& pull : merged)
      pull.along = pull.along.cwiseProduct(problem_.freedom[static_cast<std::size_t>(pull.index)]);
    const double least = is_relaxing_ ? least_pull : negligible;
    std::erase_if(merged, [&](const Pull& pull) { return pull.along.norm() < least; });
    residual.pulls = std::move(merged);
  }
  return found;
}

// The Gauss-Newton step: the minimum of the penalties as they are to the first order, in which each counts
// only where it is lacking after the step. Found by taking in what lacks, until that is (nearly) the same.
Vector Mender::step(const State& state, double more) const {
  const std::vector<Residual> found = residuals(state, more);
  Linear linear(stiffness_, found);
  Vector step = Vector::Zero(size_);
  std::vector<bool> counts(found.size());
  constexpr int most_rounds = 8;
  for (int round = 0; round < most_rounds; ++round) {
    std::vector<std::size_t> rows;
    std::size_t changes = 0;
    for (std::size_t row = 0; row < found.size(); ++row) {
      const bool is_lacking = found[row].left(Linear::change(found[row], step)) != 0;
      if (is_lacking) rows.push_back(row);
      if (is_lacking != counts[row]) ++changes;
      counts[row] = is_lacking;
    }
    if (round > 0 && 20 * changes <= rows.size()) break;
    linear.count_only(std::move(rows));
    Vector next = step;
    solve(linear, linear.force() - stiffness_ * (state.moves - held_), next);
    // Not so far that what begins to lack outweighs what is gained.
    const Vector moved = state.moves - held_;
    const double before = linear.energy(moved, step);
    for (int half = 0; half < most_halves && linear.energy(moved, next) > before; ++half)
      next = (0.5 * (step + next)).eval();
    step = std::move(next);
  }
  return mirrored_mean(step);
}

// The mean of moves and their mirror image. Loops under pressure would give way to one side as well.
Vector Mender::mirrored_mean(const Vector& moves) const {
  if (problem_.images.empty()) return moves;
  const Vec3 mirror(-1, 1, 1);
  Vector mean(moves.size());
  for (std::size_t c = 0; c < problem_.images.size(); ++c)
    mean.segment<3>(3 * static_cast<Eigen::Index>(c)) =
        0.5 * (moves.segment<3>(3 * static_cast<Eigen::Index>(c)) +
               mirror.cwiseProduct(moves.segment<3>(3 * Eigen::Index{problem_.images[c]})));
  return mean;
}

double largest_of(const Vector& moves) {
  double largest = 0;
  for (Eigen::Index i = 0; i + 2 < moves.size(); i += 3)
    largest = std::max(largest, moves.segment<3>(i).norm());
  return largest;
}

// Does no yarn come to the other side of one that it is near to?
bool keeps_sides(const State& before, const State& after) {
  constexpr double least_share = 0.3;  // of the distance that has to be left
  return std::all_of(before.touches.begin(), before.touches.end(), [&](const Touch& touch) {
    const Vec3 apart = after.paths[touch.line_a].at(touch.place_a).position -
                       after.paths[touch.line_b].at(touch.place_b).position - touch.shift;
    return touch.normal.dot(apart) > least_share * (touch.on_a - touch.on_b).norm();
  });
}

// Steps of Gauss and Newton on the bending energy. The stiffness only damps them: it holds what nothing else
// does, above all data points that slide along their line. None: nothing that keeps the lengths was found.
std::optional<State> Mender::relax(State state, double more) {
  constexpr int most_steps = 400;
  constexpr double damping = 1e-2, settled_share = 1e-4, relaxed_share = 1e-8, least_left = 2e-7;
  is_relaxing_ = true;
  stiffness_ *= damping;
  const double margin = 2e-3 * radius_;
  State best = state;
  bool is_best_long_enough = stretch_of(best) <= least_left;
  for (int steps = 0; steps < most_steps; ++steps) {
    held_ = state.moves;
    look(state, more);
    Vector step = this->step(state, more);
    if (const double longest = largest_of(step); longest > longest_step * radius_)
      step *= longest_step * radius_ / longest;
    State next = state_at(state.moves + step);
    look(next, more);
    for (int half = 0; half < most_halves && (next.energy > state.energy || !keeps_sides(state, next));
         ++half) {
      step *= 0.5;
      next = state_at(state.moves + step);
      look(next, more);
    }
    const double gain = (state.energy - next.energy) / state.energy;
    if (gain > 0) state = std::move(next);
    const bool is_long_enough = stretch_of(state) <= least_left;
    if (state.missing == 0 && is_long_enough && (!is_best_long_enough || state.bending < best.bending)) {
      best = state;
      is_best_long_enough = true;
      if (gain < relaxed_share) break;
    }
    if (gain > settled_share) continue;
    if (state.missing > 0) more += 1.1 * state.missing + 0.1 * margin;
    for (std::size_t l = 0; l < lengths_.size(); ++l) asked_lengths_[l] += lengths_[l] - state.lengths[l];
  }
  return is_best_long_enough ? std::optional(std::move(best)) : std::nullopt;
}

Mending Mender::run() {
  make_stiffness();
  State state = state_at(Vector::Zero(size_));
  finder_.emplace(problem_, state.paths);
  // Asked for a little more than is needed: the balance of penalties leaves a little of it missing.
  const double margin = 2e-3 * radius_;
  double more = margin;
  ahead_ = 2 * longest_step * radius_;
  look(state, more);
  lengths_ = asked_lengths_ = state.lengths;
  int stalls = 0;
  State best = state;
  const bool is_needed = state.missing > 0;
  if (is_needed && !problem_.start.empty()) {
    Vector start(size_);
    for (std::size_t c = 0; c < problem_.start.size(); ++c)
      start.segment<3>(3 * static_cast<Eigen::Index>(c)) = problem_.start[c];
    state = state_at(std::move(start));
    look(state, more);
  }
  for (int steps = 0; is_needed && steps < problem_.max_steps; ++steps) {
    Vector step = this->step(state, more);
    const double longest = largest_of(step);
    if (longest > longest_step * radius_) step *= longest_step * radius_ / longest;
    State next = state_at(state.moves + step);
    for (int half = 0; half < most_halves && !keeps_sides(state, next); ++half) {
      step *= 0.5;
      next = state_at(state.moves + step);
    }
    look(next, more);
    for (int half = 0; half < 4 && next.energy > state.energy; ++half) {
      step *= 0.5;
      next = state_at(state.moves + step);
      look(next, more);
    }
    // Where every step would bring yarns to each other's other side there is no way.
    stalls = largest_of(step) < stalled * radius_ ? stalls + 1 : 0;
    const double gain = state.energy - next.energy;
    ahead_ = std::clamp(2 * largest_of(step), least_ahead * radius_, 2 * longest_step * radius_);
    state = std::move(next);
    // What is left to gain is the slow sliding of yarns along each other, which parts nothing.
    const bool is_settled = gain < settled * state.energy;
    if (state.missing < best.missing ||
        (state.missing == best.missing && stretch_of(state) < stretch_of(best)))
      best = state;
    if (stalls > most_stalls) break;
    if (!is_settled) continue;
    const bool has_lengths = stretch_of(state) <= least_stretch;
    if (state.missing == 0 && has_lengths) {
      best = std::move(state);
      break;
    }
    if (state.missing > 0) more += 1.1 * state.missing + 0.1 * margin;
    if (more > 0.5 * radius_) break;
    for (std::size_t l = 0; l < lengths_.size(); ++l) asked_lengths_[l] += lengths_[l] - state.lengths[l];
    look(state, more);
  }
  const double bent_before = best.bending;
  bool is_relaxed = false;
  if (problem_.relaxes && best.missing == 0)
    if (std::optional<State> relaxed = relax(best, more)) {
      best = std::move(*relaxed);
      is_relaxed = true;
    }
  Mending mending{{}, best.missing, best.at, bent_before, best.bending, is_relaxed, stretch_of(best)};
  for (std::size_t c = 0; c < problem_.freedom.size(); ++c)
    mending.moves.emplace_back(best.moves.segment<3>(3 * static_cast<Eigen::Index>(c)));
  return mending;
}

// Shares of the data rows in the control rows that interpolation makes of the unit matrix.
std::vector<std::vector<Share>> shares_in(const Eigen::MatrixXd& control, double least) {
  std::vector<std::vector<Share>> shares(static_cast<std::size_t>(control.rows()));
  for (Eigen::Index row = 0; row < control.rows(); ++row)
    for (Eigen::Index point = 0; point < control.cols(); ++point)
      if (std::abs(control(row, point)) > least)
        shares[static_cast<std::size_t>(row)].push_back(
            {static_cast<std::size_t>(point), control(row, point)});
  return shares;
}

}  // namespace

Mending mend(const MendProblem& problem) {
  return Mender(problem).run();
}

std::vector<std::vector<Share>> interpolation_shares(const std::vector<double>& parameters, double least) {
  // The share falls by 2 + sqrt(3) from point to point: to 1e-4 in seven, to 1e-9 in sixteen.
  const std::size_t near = least < least_share ? 16 : 7;
  const std::size_t count = parameters.size();
  std::vector<std::vector<Share>> shares(count + 2);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = i > near ? i - near : 0, last = std::min(count - 1, i + near);
    const std::vector<double> t(parameters.begin() + static_cast<std::ptrdiff_t>(first),
                                parameters.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    Eigen::MatrixXd data = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(t.size()), 1);
    data(static_cast<Eigen::Index>(i - first), 0) = 1;
    const Eigen::MatrixXd control =
        nurbs::interpolate_clamped(t, data, Eigen::RowVectorXd::Zero(1), Eigen::RowVectorXd::Zero(1));
    // Control points of the window that are none of the whole curve: the second and the last but one.
    for (Eigen::Index j = 0; j < control.rows(); ++j) {
      const bool is_first_pair = j < 2, is_last_pair = j + 2 >= control.rows();
      if ((is_first_pair && first > 0) || (is_last_pair && last + 1 < count)) continue;
      if (std::abs(control(j, 0)) > least)
        shares[first + static_cast<std::size_t>(j)].push_back({i, control(j, 0)});
    }
  }
  return shares;
}

std::vector<std::vector<Share>> periodic_shares(const std::vector<double>& parameters, double least) {
  const auto count = static_cast<Eigen::Index>(parameters.size()) - 1;
  return shares_in(nurbs::interpolate_periodic(parameters, Eigen::MatrixXd::Identity(count, count)), least);
}

}  // namespace selvage::fabric
