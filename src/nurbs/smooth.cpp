#include "nurbs/smooth.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>

#include "nurbs/basis.h"
#include "nurbs/interpolate.h"

namespace selvage::nurbs {

namespace {

constexpr int cubic = 3;
// Of a span: fewer would let the curve follow the noise of single points.
constexpr std::size_t fewest_points = 2;
// Of the weight of a control point's share of points, on second differences of control points: what few
// points hold, as at the ends, is kept straight.
constexpr double stiffness = 1e-3;
// Rounds of solving and of looking for the nearest parameters.
constexpr int rounds = 4;
// Knots are taken away again one by one, as long as that costs no more than so many points looked at.
constexpr double most_looks = 5e6;

// The spans' ends, 0 to 1, and what follows from them.
class Basis {
 public:
  Basis(const std::vector<double>& breaks, bool closed) : spans_(breaks.size() - 1), closed_(closed) {
    const auto m = static_cast<int>(spans_);
    for (int i = -cubic; i <= m + cubic; ++i) {
      const int whole = i < 0 ? -1 : i > m ? 1 : 0;
      knots_.push_back(closed ? breaks[static_cast<std::size_t>(i - whole * m)] + whole
                              : breaks[static_cast<std::size_t>(std::clamp(i, 0, m))]);
    }
  }
  [[nodiscard]] std::size_t unknowns() const {
    return closed_ ? std::max<std::size_t>(spans_, 1) : spans_ + cubic;
  }
  [[nodiscard]] int count() const { return static_cast<int>(spans_) + cubic; }
  [[nodiscard]] const std::vector<double>& knots() const { return knots_; }
  [[nodiscard]] std::size_t unknown(int control) const {
    return static_cast<std::size_t>(control) % unknowns();
  }

 private:
  std::size_t spans_;
  bool closed_;
  std::vector<double> knots_;
};

class Fit {
 public:
  Fit(const std::vector<Vec3>& points, bool closed) : points_(&points), closed_(closed) {
    parameters_ = nurbs::parameters(points, Parameterization::chord, closed);
    parameters_.resize(points.size());
  }

  // Solves for these spans; the parameters of the points follow.
  void solve(const std::vector<double>& breaks) {
    breaks_ = breaks;
    const Basis basis(breaks, closed_);
    for (int round = 0; round < rounds; ++round) {
      spread();
      solve_controls(basis);
      project();
    }
  }
  [[nodiscard]] double farthest() const { return *std::max_element(distances_.begin(), distances_.end()); }

  // Halves the spans with points that are too far; nothing where one of those has too few points.
  [[nodiscard]] std::optional<std::vector<double>> finer(double error) const {
    std::vector<double> breaks = {0.0};
    for (std::size_t k = 0; k + 1 < breaks_.size(); ++k) {
      const auto inside = [&](double t) {
        return t >= breaks_[k] && (t < breaks_[k + 1] || k + 2 == breaks_.size());
      };
      std::vector<double> here;
      bool is_far = false;
      for (std::size_t i = 0; i < points_->size(); ++i) {
        if (!inside(parameters_[i])) continue;
        here.push_back(parameters_[i]);
        is_far = is_far || distances_[i] > error;
      }
      if (is_far) {
        std::sort(here.begin(), here.end());
        if (here.size() < 2 * fewest_points) return std::nullopt;
        const double middle = 0.5 * (here[here.size() / 2 - 1] + here[here.size() / 2]);
        const double least = 1e-6 * (breaks_[k + 1] - breaks_[k]);
        if (middle - breaks_[k] < least || breaks_[k + 1] - middle < least) return std::nullopt;
        breaks.push_back(middle);
      }
      breaks.push_back(breaks_[k + 1]);
    }
    if (breaks.size() == breaks_.size()) return std::nullopt;
    return breaks;
  }
  [[nodiscard]] const std::vector<double>& breaks() const { return breaks_; }

  [[nodiscard]] Smoothed result() const {
    Smoothed smoothed{curve_, parameters_, farthest()};
    if (closed_) {
      smoothed.curve = sub_curve(curve_, 0.0, 1.0);
      smoothed.curve.points.back() = smoothed.curve.points.front();
      return smoothed;
    }
    // From the first point's place to the last one's: beyond, nothing holds it.
    const auto [first, length] = extent();
    smoothed.curve = sub_curve(curve_, first, first + length);
    for (double& knot : smoothed.curve.knots) knot = (knot - first) / length;
    for (double& t : smoothed.parameters) t = (t - first) / length;
    return smoothed;
  }

 private:
  struct Extent {
    double first = 0, length = 0;
  };
  [[nodiscard]] Extent extent() const {
    const auto [low, high] = std::minmax_element(parameters_.begin(), parameters_.end());
    return {*low, *high - *low};
  }

  // Over all of 0 to 1: a line that goes on beyond its points would be held by nothing there.
  void spread() {
    if (closed_) return;
    const auto [first, length] = extent();
    for (double& t : parameters_) t = (t - first) / length;
  }

  void solve_controls(const Basis& basis) {
    const auto n = static_cast<Eigen::Index>(basis.unknowns());
    std::vector<Eigen::Triplet<double>> terms;
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(n, 3);
    const double share = static_cast<double>(points_->size()) / static_cast<double>(n);
    for (std::size_t i = 0; i < points_->size(); ++i) {
      const int span = find_span(basis.knots(), cubic, basis.count(), parameters_[i]);
      BasisRow row;
      nurbs::basis(basis.knots(), cubic, span, parameters_[i], row);
      for (int a = 0; a <= cubic; ++a) {
        const auto at = static_cast<Eigen::Index>(basis.unknown(span - cubic + a));
        right.row(at) += row[static_cast<std::size_t>(a)] * (*points_)[i].transpose();
        for (int b = 0; b <= cubic; ++b)
          terms.emplace_back(at, static_cast<Eigen::Index>(basis.unknown(span - cubic + b)),
                             row[static_cast<std::size_t>(a)] * row[static_cast<std::size_t>(b)]);
      }
    }
    const auto wraps = [&](Eigen::Index i) { return i % n; };
    for (Eigen::Index i = 0; i + (closed_ ? 0 : 2) < n; ++i) {
      const std::array<double, 3> difference = {1.0, -2.0, 1.0};
      for (Eigen::Index a = 0; a < 3; ++a)
        for (Eigen::Index b = 0; b < 3; ++b)
          terms.emplace_back(wraps(i + a), wraps(i + b),
                             stiffness * share * difference[static_cast<std::size_t>(a)] *
                                 difference[static_cast<std::size_t>(b)]);
    }
    Eigen::SparseMatrix<double> normal(n, n);
    normal.setFromTriplets(terms.begin(), terms.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
    const Eigen::MatrixX3d controls = solver.solve(right);
    curve_ = {cubic, basis.knots(), {}, {}};
    for (int i = 0; i < basis.count(); ++i)
      curve_.points.emplace_back(controls.row(static_cast<Eigen::Index>(basis.unknown(i))).transpose());
  }

  // Newton's method on the distance, from where the points were. Noise larger than their steps changes their
  // order.
  void project() {
    distances_.clear();
    for (std::size_t i = 0; i < points_->size(); ++i) {
      double t = parameters_[i];
      for (int step = 0; step < 4; ++step) {
        const CurveJet jet = evaluate_jet(curve_, t);
        const Vec3 off = jet.position - (*points_)[i];
        const double slope = off.dot(jet.d1), change = jet.d1.squaredNorm() + off.dot(jet.d2);
        if (!(change > 0.25 * jet.d1.squaredNorm())) break;
        t = std::clamp(t - slope / change, 0.0, 1.0);
      }
      const double before = (evaluate(curve_, parameters_[i]) - (*points_)[i]).norm();
      const double after = (evaluate(curve_, t) - (*points_)[i]).norm();
      if (after < before) parameters_[i] = t;
      distances_.push_back(std::min(before, after));
    }
  }

  const std::vector<Vec3>* points_;
  bool closed_;
  std::vector<double> breaks_, parameters_, distances_;
  Curve curve_;
};

// As few of the knots as keep the error.
Fit with_fewer_knots(Fit best, double error, std::size_t fewest, std::size_t points) {
  double looks = 0.0;
  for (std::size_t k = 1; k + 1 < best.breaks().size();) {
    looks += static_cast<double>(points) * rounds;
    if (best.breaks().size() <= fewest + 1 || looks > most_looks) break;
    std::vector<double> breaks = best.breaks();
    breaks.erase(breaks.begin() + static_cast<std::ptrdiff_t>(k));
    Fit tried = best;
    tried.solve(breaks);
    if (tried.farthest() <= error)
      best = std::move(tried);
    else
      ++k;
  }
  return best;
}

}  // namespace

std::optional<Smoothed> smooth(const std::vector<Vec3>& points, double error, bool closed) {
  // A ring's spans are as many as a point of it is held by, and one more.
  const std::size_t fewest = closed ? cubic + 2 : 1;
  if (points.size() < (closed ? fewest : 2)) return std::nullopt;
  std::vector<double> breaks;
  for (std::size_t i = 0; i <= fewest; ++i)
    breaks.push_back(static_cast<double>(i) / static_cast<double>(fewest));
  Fit fit(points, closed);
  for (;;) {
    fit.solve(breaks);
    if (fit.farthest() <= error) break;
    std::optional<std::vector<double>> finer = fit.finer(error);
    if (!finer) return std::nullopt;
    breaks = std::move(*finer);
  }
  return with_fewer_knots(std::move(fit), error, fewest, points.size()).result();
}

}  // namespace selvage::nurbs
