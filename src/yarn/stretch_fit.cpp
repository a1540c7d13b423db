#include "yarn/stretch_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "nurbs/basis.h"

namespace selvage::yarn {

namespace {

using Row = std::vector<Vec3>;

// The cubic over a stretch of the path that is cut into equal spans: its ends have exact values and slopes,
// between them it is the least-squares fit to samples at equal steps.
class StretchSolver {
 public:
  StretchSolver(int spans, int steps) : spans_(spans) {
    const int count = spans + 3;
    std::vector<double> knots(4, 0.0);
    for (int i = 1; i < spans; ++i) knots.push_back(static_cast<double>(i) / spans);
    knots.insert(knots.end(), 4, 1.0);
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(steps + 1, count);
    for (int i = 0; i <= steps; ++i) {
      const double s = static_cast<double>(i) / steps;
      const int span = nurbs::find_span(knots, 3, count, s);
      nurbs::BasisRow values{};
      nurbs::basis(knots, 3, span, s, values);
      Blend& blend = at_.emplace_back();
      blend.first = static_cast<std::size_t>(span - 3);
      std::copy_n(values.begin(), 4, blend.shares.begin());
      for (int j = 0; j <= 3; ++j) basis(i, span - 3 + j) = values[static_cast<std::size_t>(j)];
    }
    const Eigen::Index inner = count - 4;
    if (inner == 0) return;
    const auto free = basis.middleCols(2, inner);
    const Eigen::MatrixXd of_samples = (free.transpose() * free).ldlt().solve(free.transpose());
    Eigen::MatrixXd of_ends(inner, 4);
    of_ends << of_samples * basis.leftCols(2), of_samples * basis.rightCols(2);
    for (Eigen::Index k = 0; k < inner; ++k) {
      Gain& gain = gains_.emplace_back();
      for (int i = 0; i <= steps; ++i) gain.of_samples.push_back(of_samples(k, i));
      for (Eigen::Index i = 0; i < 4; ++i) gain.of_ends[static_cast<std::size_t>(i)] = of_ends(k, i);
    }
  }

  // `values`: one row a sample; slopes by the share of the stretch.
  [[nodiscard]] RowTable control(const RowTable& values, std::span<const Vec3> first,
                                 std::span<const Vec3> last) const {
    RowTable control(static_cast<std::size_t>(spans_) + 3, values.columns());
    const std::size_t end = control.rows() - 1;
    for (std::size_t c = 0; c < values.columns(); ++c) {
      const Vec3 &from = values.row(0)[c], &to = values.row(values.rows() - 1)[c];
      const std::array<Vec3, 4> ends = {from, from + first[c] / (3.0 * spans_), to - last[c] / (3.0 * spans_),
                                        to};
      control.row(0)[c] = ends[0];
      control.row(1)[c] = ends[1];
      control.row(end - 1)[c] = ends[2];
      control.row(end)[c] = ends[3];
      for (std::size_t k = 2; k + 2 <= end; ++k) {
        const Gain& gain = gains_[k - 2];
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < values.rows(); ++i) sum += gain.of_samples[i] * values.row(i)[c];
        for (std::size_t i = 0; i < ends.size(); ++i) sum -= gain.of_ends[i] * ends[i];
        control.row(k)[c] = sum;
      }
    }
    return control;
  }
  // Of the fit from a sample's values.
  void deviation(const RowTable& control, const RowTable& values, std::size_t sample,
                 std::span<Vec3> out) const {
    const auto& [first, shares] = at_[sample];
    const auto a = control.row(first), b = control.row(first + 1), c = control.row(first + 2),
               d = control.row(first + 3), value = values.row(sample);
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = shares[0] * a[i] + shares[1] * b[i] + shares[2] * c[i] + shares[3] * d[i] - value[i];
  }

 private:
  // The four control rows that count at a sample.
  struct Blend {
    std::size_t first = 0;
    std::array<double, 4> shares{};
  };
  // What an inner control row takes of the samples, and gives for the two rows at either end.
  struct Gain {
    std::vector<double> of_samples;
    std::array<double, 4> of_ends{};
  };
  int spans_;
  std::vector<Blend> at_;
  std::vector<Gain> gains_;
};

// The tube in the direction of the path: stretches between the knots of its centre line, at which the exact
// surface is one derivative less smooth than that line. Each is fitted by itself, with as many spans as the
// tolerance asks for; they meet in double knots.
//
// A path of arcs and straights is cut finer instead, and its sections slide along it, which leaves them on
// the surface: slopes at the ends of an arc are as long as those of the cubic that is nearest to it, and a
// straight takes what the arcs on both sides of it want.
class StretchFit {
 public:
  // `breaks`: the stretches' ends; `least`: spans of each; `grid`: of the knots.
  StretchFit(const Channels& channels, const CentreLine& path, const std::vector<double>& breaks,
             const std::vector<int>& least, const DecimalGrid& grid)
      : channels_(channels),
        closed_(path.closed),
        slides_(path.curve.is_rational() && path.curve.degree == 2),
        grid_(grid) {
    for (std::size_t k = 0; k < breaks.size(); ++k)
      joints_.push_back(
          joint_at(breaks[k], std::min(k > 0 ? breaks[k] - breaks[k - 1] : 1.0,
                                       k + 1 < breaks.size() ? breaks[k + 1] - breaks[k] : 1.0)));
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
      stretches_.emplace_back();
      stretches_.back().spans = slides_ ? 1 : least[k];
    }
  }

  // False when that would take more than `most` sections.
  bool refine(double tolerance, std::size_t most) {
    for (;;) {
      settle_slopes();
      std::size_t rows = 2;
      std::vector<Stretch> stretches;
      std::vector<Joint> joints;
      bool is_done = true;
      for (std::size_t k = 0; k < stretches_.size(); ++k) {
        Stretch& stretch = stretches_[k];
        const Joint &from = joints_[k], &to = joints_[k + 1];
        joints.push_back(from);
        const bool is_settled = !slides_ && stretch.control.rows() > 0 && stretch.error <= tolerance;
        if (stretch.control.rows() == 0 && !stretches.empty())
          fit_from(stretch, from, to, stretches.back().spans - 1, tolerance);
        else if (!is_settled)
          fit(stretch, from, to);
        int parts = 1;
        while (parts == 1 && stretch.error > tolerance) {
          // The error falls with the fourth power of the spans' number; never more of them than are needed.
          const double wanted = 0.6 * stretch.spans * std::sqrt(std::sqrt(stretch.error / tolerance));
          const int spans = std::max(stretch.spans + 1, static_cast<int>(std::min(wanted, 1e6)));
          if (rows + static_cast<std::size_t>(spans) + 1 > most) return false;
          if (slides_ || spans > most_spans) {
            parts = std::max(2, slides_ ? 2 : (spans + most_spans - 1) / most_spans);
          } else {
            stretch.spans = spans;
            fit(stretch, from, to);
          }
        }
        rows += static_cast<std::size_t>(stretch.spans) + 1;
        if (rows > most) return false;
        if (parts == 1) {
          if (!slides_) stretch.samples = {};  // nothing moves its ends any more
          stretches.push_back(std::move(stretch));
          continue;
        }
        is_done = false;
        stretches.resize(stretches.size() + static_cast<std::size_t>(parts));
        for (int i = 1; i < parts; ++i) {
          joints.push_back(
              joint_at(grid_.rounded(from.t + (to.t - from.t) * i / parts), (to.t - from.t) / parts));
          if (!(joints.back().t > joints[joints.size() - 2].t && joints.back().t < to.t)) return false;
        }
      }
      joints.push_back(joints_.back());
      stretches_ = std::move(stretches);
      joints_ = std::move(joints);
      if (is_done) break;
    }
    join(tolerance);
    assemble();
    return true;
  }

  [[nodiscard]] double error() const {
    double largest = 0.0;
    for (const Stretch& stretch : stretches_) largest = std::max(largest, stretch.error);
    return largest;
  }
  // When it is done.
  [[nodiscard]] RowTable& control() { return control_; }
  [[nodiscard]] std::vector<double>& knots() { return knots_; }

 private:
  struct Joint {
    double t = 0;
    Row exact;
    Slide slide;
    Row before, after;  // the exact slopes on both sides
    Row slope;          // the one that the fit has
  };
  // Of the exact surface, at equal steps, ends included.
  struct Samples {
    RowTable values;
    std::vector<Slide> slides;
  };
  struct Stretch {
    int spans = 1;
    Samples samples;
    double slide_from = 1, slide_to = 1;  // slopes at the ends by the exact ones, as the samples know them
    RowTable control;                     // spans + 3 rows
    double error = 0;
  };

  // Between stretches that are at least `length` long.
  [[nodiscard]] Joint joint_at(double t, double length) const {
    Joint joint;
    joint.t = t;
    joint.before = joint.after = joint.exact = Row(channels_.width());
    // Beside a knot of the path, which may have been rounded.
    const double beside = 1e-6 * length;
    channels_.sample(std::max(0.0, t - beside), joint.exact, joint.before);
    channels_.sample(std::min(1.0, t + beside), joint.exact, joint.after);
    joint.slide = channels_.sample(t, joint.exact);
    // Only jumps of curvature count.
    double jump = 0.0, whole = 0.0;
    for (std::size_t i = 0; i < joint.after.size(); ++i) {
      jump += (joint.after[i] - joint.before[i]).squaredNorm();
      whole += joint.after[i].squaredNorm();
    }
    if (t >= 1.0)
      joint.after = joint.before;
    else if (std::sqrt(jump) <= 1e-5 * std::sqrt(whole))
      joint.before = joint.after;
    joint.slope = joint.after;
    return joint;
  }

  // By how much longer slopes of the best cubic are than the exact ones of a circular arc (a straight: 0, it
  // takes any): 4/3 tan(angle/4) of the radius for its control points.
  [[nodiscard]] double wanted_slide(const Joint& from, const Joint& to, bool at_end) const {
    const Vec3 chord = to.exact[0] - from.exact[0];
    const double sine = from.slide.tangent.cross(to.slide.tangent).norm();
    const double angle = std::atan2(sine, from.slide.tangent.dot(to.slide.tangent));
    if (angle < 1e-6) return 0.0;
    const double radius = chord.norm() / (2.0 * std::sin(angle / 2.0));
    const Row& slope = at_end ? to.before : from.after;
    return 4.0 * radius * std::tan(angle / 4.0) / (slope[0].norm() * (to.t - from.t));
  }

  void settle_slopes() {
    const std::size_t last = joints_.size() - 1;
    for (std::size_t k = 0; k <= last; ++k) {
      Joint& joint = joints_[k];
      const auto blend = [&](double a, const Row& slope_a, double b, const Row& slope_b) {
        for (std::size_t i = 0; i < joint.slope.size(); ++i) joint.slope[i] = a * slope_a[i] + b * slope_b[i];
      };
      blend(0.5, joint.before, 0.5, joint.after);
      if (!slides_) continue;
      const std::size_t before = k > 0 ? k - 1 : last - 1, after = k < last ? k : 0;
      const bool has_before = k > 0 || closed_, has_after = k < last || closed_;
      const double a = has_before ? wanted_slide(joints_[before], joints_[before + 1], true) : 0.0,
                   b = has_after ? wanted_slide(joints_[after], joints_[after + 1], false) : 0.0;
      const Row &slope_a = has_before ? joints_[before + 1].before : joint.before,
                &slope_b = has_after ? joints_[after].after : joint.after;
      const double share = a > 0.0 && b > 0.0 ? 0.5 : 1.0;
      if (a > 0.0 || b > 0.0) blend(share * a, slope_a, share * b, slope_b);
    }
  }

  [[nodiscard]] const StretchSolver& solver(int spans, int steps) {
    return solvers_.try_emplace(std::pair(spans, steps), spans, steps).first->second;
  }

  // Samples of the exact surface, in as many equal steps; those of fewer steps are used again. Where sections
  // slide, they are taken where a cubic of the path's slopes has them.
  void sample(Stretch& stretch, const Joint& from, const Joint& to, int steps) const {
    const double first = from.slope[0].norm() / from.after[0].norm(),
                 last = to.slope[0].norm() / to.before[0].norm();
    if (first != stretch.slide_from || last != stretch.slide_to) stretch.samples = {};
    stretch.slide_from = first;
    stretch.slide_to = last;
    const Samples& known = stretch.samples;
    const std::size_t known_count = known.slides.empty() ? 0 : known.slides.size() - 1;
    const auto count = static_cast<std::size_t>(steps);
    if (known_count == count) return;
    Samples finer{RowTable(count + 1, channels_.width()), std::vector<Slide>(count + 1)};
    const auto take = [&](std::size_t i, std::span<const Vec3> values, const Slide& slide) {
      std::copy(values.begin(), values.end(), finer.values.row(i).begin());
      finer.slides[i] = slide;
    };
    take(0, from.exact, from.slide);
    take(count, to.exact, to.slide);
    for (std::size_t i = 1; i < count; ++i) {
      if (known_count > 0 && i * known_count % count == 0) {
        const std::size_t same = i * known_count / count;
        take(i, known.values.row(same), known.slides[same]);
        continue;
      }
      double share = static_cast<double>(i) / static_cast<double>(count);
      if (slides_) {
        const double rest = 1.0 - share;
        share = share * rest * (rest * first - share * last) + share * share * (3.0 - 2.0 * share);
      }
      finer.slides[i] = channels_.sample(from.t + (to.t - from.t) * share, finer.values.row(i));
    }
    stretch.samples = std::move(finer);
  }

  // The largest sampled deviation and what can hide between the samples: half the distance of two samples
  // holds at most an eighth of the second difference, taken twice for the change of curvature in between.
  void fit(Stretch& stretch, const Joint& from, const Joint& to) {
    int steps = 16;
    while (steps < 8 * stretch.spans) steps *= 2;
    sample(stretch, from, to, steps);
    const RowTable& values = stretch.samples.values;
    const StretchSolver& by = solver(stretch.spans, steps);
    const double length = to.t - from.t;
    Row first = from.slope, last = to.slope;
    for (Row* slope : {&first, &last})
      for (Vec3& v : *slope) v *= length;
    stretch.control = by.control(values, first, last);
    for (RowTable* table : {&across_, &along_, &bent_}) table->resize(values.rows(), values.columns());
    for (std::size_t i = 0; i < values.rows(); ++i) {
      const std::span<Vec3> across = across_.row(i), along = along_.row(i);
      by.deviation(stretch.control, values, i, across);
      const Vec3& tangent = stretch.samples.slides[i].tangent;
      for (std::size_t c = 0; c < across.size(); ++c) {
        along[c] = across[c].dot(tangent) * tangent;
        across[c] -= along[c];
      }
      if (i < 2) continue;
      const std::span<Vec3> before = across_.row(i - 2), middle = across_.row(i - 1), bent = bent_.row(i - 1);
      for (std::size_t c = 0; c < bent.size(); ++c) bent[c] = before[c] - 2.0 * middle[c] + across[c];
    }
    const auto deviation = [&](std::size_t i, const auto& length_of) {
      const Slide& slide = stretch.samples.slides[i];
      const double slid = length_of(along_.row(i));
      return length_of(across_.row(i)) + slide.slip * slid + 0.5 * slide.bend * slid * slid;
    };
    const auto bend = [&](std::size_t i, const auto& length_of) { return length_of(bent_.row(i)) / 4.0; };
    stretch.error = largest(0, values.rows(), deviation) + largest(1, values.rows() - 1, bend);
  }

  // The first fit of a stretch: with about as many spans as its neighbour has, and no more than are needed.
  void fit_from(Stretch& stretch, const Joint& from, const Joint& to, int spans, double tolerance) {
    const int least = stretch.spans;
    stretch.spans = std::max(least, spans);
    fit(stretch, from, to);
    while (stretch.spans > least && stretch.error <= tolerance) {
      Stretch fewer = stretch;
      --fewer.spans;
      fit(fewer, from, to);
      if (fewer.error > tolerance) break;
      stretch = std::move(fewer);
    }
  }

  // Of what `measure(i, length_of)` says of the rows from `first` to before `last`: those that cannot have
  // more than the most promising one are not looked at closely.
  template <class Measure>
  [[nodiscard]] double largest(std::size_t first, std::size_t last, const Measure& measure) {
    const auto bound = [&](std::span<const Vec3> row) { return channels_.bound(row); };
    const auto exact = [&](std::span<const Vec3> row) { return channels_.largest(row); };
    bounds_.clear();
    for (std::size_t i = first; i < last; ++i) bounds_.push_back(measure(i, bound));
    const auto best = std::max_element(bounds_.begin(), bounds_.end()) - bounds_.begin();
    double found = measure(first + static_cast<std::size_t>(best), exact);
    for (std::size_t i = first; i < last; ++i)
      if (bounds_[i - first] > found) found = std::max(found, measure(i, exact));
    return found;
  }

  // Neighbours of one span each that are far better than they have to be become one.
  void join(double tolerance) {
    if (slides_) return;
    std::vector<Stretch> stretches;
    std::vector<Joint> joints{std::move(joints_.front())};
    for (std::size_t k = 0; k < stretches_.size(); ++k) {
      stretches.push_back(std::move(stretches_[k]));
      joints.push_back(std::move(joints_[k + 1]));
      while (stretches.size() > 1) {
        const Stretch &a = stretches[stretches.size() - 2], &b = stretches.back();
        if (a.spans > 1 || b.spans > 1 || std::max(a.error, b.error) > 0.25 * tolerance) break;
        Stretch both;
        fit(both, joints[joints.size() - 3], joints.back());
        if (both.error > tolerance) break;
        stretches.pop_back();
        stretches.back() = std::move(both);
        joints.erase(joints.end() - 2);
      }
    }
    stretches_ = std::move(stretches);
    joints_ = std::move(joints);
  }

  void assemble() {
    std::size_t rows = 2;
    for (const Stretch& stretch : stretches_) rows += static_cast<std::size_t>(stretch.spans) + 1;
    control_ = RowTable(rows, channels_.width());
    knots_.assign(4, joints_.front().t);
    const auto set = [&](std::size_t row, std::span<const Vec3> values) {
      std::copy(values.begin(), values.end(), control_.row(row).begin());
    };
    set(0, stretches_.front().control.row(0));
    std::size_t next = 1;
    for (std::size_t k = 0; k < stretches_.size(); ++k) {
      const Stretch& stretch = stretches_[k];
      const double from = joints_[k].t, to = joints_[k + 1].t;
      for (std::size_t i = 1; i + 1 < stretch.control.rows(); ++i) set(next++, stretch.control.row(i));
      for (int i = 1; i < stretch.spans; ++i)
        knots_.push_back(grid_.rounded(from + (to - from) * i / stretch.spans));
      knots_.insert(knots_.end(), 2, to);
    }
    knots_.insert(knots_.end(), 2, joints_.back().t);
    const RowTable& last = stretches_.back().control;
    set(next, closed_ ? control_.row(0) : last.row(last.rows() - 1));
  }

  const Channels& channels_;
  bool closed_, slides_;
  DecimalGrid grid_;
  std::vector<Stretch> stretches_;
  std::vector<Joint> joints_;
  std::map<std::pair<int, int>, StretchSolver> solvers_;
  std::vector<double> knots_;
  RowTable control_;
  // What fit() works with: deviations across and along the path, second differences, bounds of them.
  RowTable across_, along_, bent_;
  std::vector<double> bounds_;
};

}  // namespace

std::optional<FittedRows> fit_stretches(const Channels& channels, const CentreLine& path,
                                        const Stretches& stretches, const DecimalGrid& knot_grid,
                                        double tolerance, std::size_t most) {
  StretchFit fit(channels, path, stretches.at, stretches.least, knot_grid);
  if (!fit.refine(tolerance, most)) return std::nullopt;
  const double error = fit.error();
  return FittedRows{std::move(fit.control()), std::move(fit.knots()), error};
}

}  // namespace selvage::yarn
