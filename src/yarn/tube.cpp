#include "yarn/tube.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <tuple>

#include "nurbs/basis.h"
#include "nurbs/divided.h"
#include "yarn/frame.h"
#include "yarn/size_profile.h"

namespace selvage::yarn {

namespace {

using std::numbers::pi;
using Row = std::vector<Vec3>;

// Rows of equally many vectors, one after the other.
class RowTable {
 public:
  RowTable() = default;
  RowTable(std::size_t rows, std::size_t columns) { resize(rows, columns); }
  // What it holds is lost.
  void resize(std::size_t rows, std::size_t columns) {
    columns_ = columns;
    vectors_.resize(rows * columns);
  }
  [[nodiscard]] std::size_t rows() const { return columns_ == 0 ? 0 : vectors_.size() / columns_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::span<const Vec3> row(std::size_t i) const { return {&vectors_[i * columns_], columns_}; }
  [[nodiscard]] std::span<Vec3> row(std::size_t i) { return {&vectors_[i * columns_], columns_}; }

 private:
  std::size_t columns_ = 0;
  std::vector<Vec3> vectors_;
};

// What a deviation along the path may cost at one place: a point that slides along the surface has not left
// it.
struct Slide {
  Vec3 tangent;     // of the path
  double slip = 0;  // sine of the largest angle between the tangent and the surface, round the section
  double bend = 0;  // the largest curvature of the surface along the path
};

// The exact surface, seen as a few vector-valued functions of t that are blended round the section with
// constant coefficients: for an affine section C, a W/2 and b H/2; otherwise the path of every control point.
class Channels {
 public:
  Channels(const FrameField& frames, const SizeProfile& sizes, const TubeSpec& spec, double twist, int pieces)
      : frames_(frames), sizes_(sizes), spec_(spec), twist_(twist), pieces_(pieces) {
    affine_ = is_affine(spec.section) || sizes.parameters().size() == 1;
    const SizeProfile::Values first = sizes.at(0.0).value;
    // A constant size needs no scaling: the outline of that size itself is swept.
    unit_ = make_outline(spec.section, SectionSize{first[0], first[1]}, pieces, !affine_);
    if (affine_)
      for (Vec2& p : unit_.points) p = p.array() / Eigen::Array2d(0.5 * first[0], 0.5 * first[1]);
    const std::vector<double> us = nurbs::divided(unit_.knots, unit_.degree, 2);
    nurbs::Curve outline{unit_.degree, unit_.knots, {}, {}};
    for (const Vec2& p : unit_.points) outline.points.emplace_back(p.x(), p.y(), 0.0);
    constexpr double between = 1.02;  // what lies between them reaches further by less than this
    round_.resize(static_cast<Eigen::Index>(us.size()), 2);
    for (Eigen::Index i = 0; i < round_.rows(); ++i)
      round_.row(i) =
          between * nurbs::evaluate(outline, us[static_cast<std::size_t>(i)]).head<2>().transpose();
    extent_ = std::sqrt(round_.square().rowwise().sum().maxCoeff());
    is_round_ = std::holds_alternative<Circle>(spec.section) && sizes.parameters().size() == 1;
    const Eigen::Array2d scale =
        affine_ ? Eigen::Array2d(0.5 * first[0], 0.5 * first[1]) : Eigen::Array2d::Ones();
    for (const Vec2& p : unit_.points) reach_ = std::max(reach_, (p.array() * scale).matrix().norm());
    reach_ /= std::max(first[0], first[1]);
  }

  [[nodiscard]] const Outline& outline() const { return unit_; }
  // Vectors of a row of values.
  [[nodiscard]] std::size_t width() const { return affine_ ? 3 : unit_.points.size() - 1; }

  // Exact values at t, as many as `width`; `slopes`, where wanted, get the derivatives.
  Slide sample(double t, std::span<Vec3> values, std::span<Vec3> slopes = {}) const {
    const Frame frame = frames_.at(t);
    const SizeProfile::Jet size = sizes_.at(t);
    double angle = size.value[2];
    if (twist_ != 0.0) angle += twist_ * frames_.length_at(t);
    const double c = std::cos(angle), s = std::sin(angle);
    const Vec3 a = c * frame.across + s * frame.up, b = -s * frame.across + c * frame.up;
    // a' and b' of a frame that turns at `rate` against the rotation-minimizing one.
    const double rate = size.slope[2] + twist_ * frame.speed + frame.turn_dt;
    Slide slide;
    slide.tangent = frame.tangent;
    const double w = 0.5 * size.value[0], h = 0.5 * size.value[1];
    const double reach = reach_ * std::max(size.value[0], size.value[1]);
    const double curvature = frame.tangent_dt.norm() / frame.speed;
    const double least_speed = frame.speed * std::max(1.0 - curvature * reach, 0.1);
    slide.bend = curvature * frame.speed / least_speed;
    if (!is_round_)
      slide.slip = std::min(
          1.0, (reach * std::abs(rate) + 0.5 * std::hypot(size.slope[0], size.slope[1])) / least_speed);
    const std::vector<Vec2> points = affine_ ? std::vector<Vec2>() : control_at(size.value);
    if (affine_) {
      values[0] = frame.position;
      values[1] = w * a;
      values[2] = h * b;
    } else {
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = frame.position + points[i].x() * a + points[i].y() * b;
    }
    if (slopes.empty()) return slide;
    const Vec3 a_dt = -frame.tangent_dt.dot(a) * frame.tangent + rate * b;
    const Vec3 b_dt = -frame.tangent_dt.dot(b) * frame.tangent - rate * a;
    const Vec3 c_dt = frame.speed * frame.tangent;
    if (affine_) {
      slopes[0] = c_dt;
      slopes[1] = w * a_dt + 0.5 * size.slope[0] * a;
      slopes[2] = h * b_dt + 0.5 * size.slope[1] * b;
      return slide;
    }
    const std::vector<Vec2> points_dt = control_slope(size);
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      const Vec2 &p = points[i], &q = points_dt[i];
      slopes[i] = c_dt + p.x() * a_dt + p.y() * b_dt + q.x() * a + q.y() * b;
    }
    return slide;
  }

  // The largest length that a row of deviations has anywhere round the section.
  [[nodiscard]] double largest(std::span<const Vec3> deviation) const {
    if (!affine_) return bound(deviation);
    const Vec3 &c = deviation[0], &a = deviation[1], &b = deviation[2];
    const auto x = round_.col(0), y = round_.col(1);
    return std::sqrt(((c.x() + x * a.x() + y * b.x()).square() + (c.y() + x * a.y() + y * b.y()).square() +
                      (c.z() + x * a.z() + y * b.z()).square())
                         .maxCoeff());
  }
  // No less, and sooner known.
  [[nodiscard]] double bound(std::span<const Vec3> deviation) const {
    if (affine_)
      return deviation[0].norm() +
             extent_ * std::sqrt(deviation[1].squaredNorm() + deviation[2].squaredNorm());
    // Round the section it is a convex blend of its values at the control points.
    double found = 0.0;
    for (const Vec3& at_point : deviation) found = std::max(found, at_point.squaredNorm());
    return std::sqrt(found);
  }

  // The control point of column i (the last column is the first) from a row of control values.
  [[nodiscard]] Vec3 blend(std::span<const Vec3> control, std::size_t i) const {
    if (!affine_) return control[i % control.size()];
    const Vec2& p = unit_.points[i];
    return control[0] + p.x() * control[1] + p.y() * control[2];
  }

  // Do sections of every size on the way have the same knots?
  [[nodiscard]] bool has_common_knots() const {
    if (affine_) return true;
    for (double t : sizes_.parameters()) {
      const SizeProfile::Values v = sizes_.at(t).value;
      if (make_outline(spec_.section, {v[0], v[1]}, pieces_, true).knots != unit_.knots) return false;
    }
    return true;
  }

 private:
  [[nodiscard]] std::vector<Vec2> control_at(const SizeProfile::Values& v) const {
    return make_outline(spec_.section, {v[0], v[1]}, pieces_, true).points;
  }
  // Central differences along the size's own slope: the control points are smooth functions of width and
  // height.
  [[nodiscard]] std::vector<Vec2> control_slope(const SizeProfile::Jet& size) const {
    const double step =
        1e-5 / (1.0 + std::abs(size.slope[0]) / size.value[0] + std::abs(size.slope[1]) / size.value[1]);
    SizeProfile::Values before = size.value, after = size.value;
    for (std::size_t c = 0; c < 2; ++c) {
      before[c] -= step * size.slope[c];
      after[c] += step * size.slope[c];
    }
    std::vector<Vec2> low = control_at(before), high = control_at(after);
    for (std::size_t i = 0; i < high.size(); ++i) high[i] = (high[i] - low[i]) / (2.0 * step);
    return high;
  }

  const FrameField& frames_;
  const SizeProfile& sizes_;
  const TubeSpec& spec_;
  double twist_;
  int pieces_;
  bool affine_ = true;
  bool is_round_ = false;  // a turn of the section does not move its surface
  double reach_ = 0;       // of the section's control points from the path, by its larger size
  Outline unit_;
  Eigen::ArrayX2d round_;  // points of it, two a span
  double extent_ = 0;      // their largest distance from the middle
};

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

// Of one stretch: solving takes their number's third power.
constexpr int most_spans = 16;

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
        if (!is_settled) fit(stretch, from, to);
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
  [[nodiscard]] const RowTable& control() const { return control_; }
  [[nodiscard]] const std::vector<double>& knots() const { return knots_; }

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

// Of so many pieces to a quarter.
double outline_error(const TubeSpec& spec, const SizeProfile& sizes, const SectionSize& size, int pieces) {
  const bool varying = sizes.parameters().size() > 1 && !is_affine(spec.section);
  return outline_error(spec.section, size, make_outline(spec.section, size, pieces, varying));
}

// How many pieces to a quarter give the smallest net: fewer leave less of the tolerance to the sections,
// whose number grows with the fourth root of its inverse.
Result<int> choose_pieces(const TubeSpec& spec, const SizeProfile& sizes) {
  if (is_exact(spec.section)) return 1;
  const bool varying = sizes.parameters().size() > 1;
  std::vector<SectionSize> all;
  for (double t : sizes.parameters()) {
    const SizeProfile::Values v = sizes.at(t).value;
    all.push_back({v[0], v[1]});
  }
  if (varying && is_affine(spec.section)) {  // every smaller size deviates less
    SectionSize largest;
    for (const SectionSize& s : all)
      largest = {std::max(largest.width, s.width), std::max(largest.height, s.height)};
    all = {largest};
  } else {  // no need to look at one size twice
    std::sort(all.begin(), all.end(), [](const SectionSize& a, const SectionSize& b) {
      return a.width != b.width ? a.width < b.width : a.height < b.height;
    });
    all.erase(std::unique(all.begin(), all.end()), all.end());
  }
  double best_cost = std::numeric_limits<double>::infinity();
  int best = 0, worse = 0;
  for (int pieces = 2; pieces <= 4096 && worse < 3; pieces += pieces < 64 ? 1 : pieces / 16) {
    double error = 0.0;
    for (const SectionSize& s : all) error = std::max(error, outline_error(spec, sizes, s, pieces));
    if (error > 0.95 * spec.tolerance) continue;
    const double cost = pieces * std::pow(1.0 - error / spec.tolerance, -0.25);
    if (cost < best_cost) {
      best_cost = cost;
      best = pieces;
    } else {
      ++worse;
    }
  }
  if (best == 0)
    return error(
        Kind::limit,
        fmt::format("the tolerance {:.3g} would need more than 16000 control points round the section",
                    spec.tolerance));
  return best;
}

// The ends of the stretches, and the spans that each of them has at least: samples have to see every turn, so
// none turns by more than a quarter.
struct Breaks {
  std::vector<double> at;
  std::vector<int> least;
  double rows = 2;  // of control points; no more breaks than for `most` of them
};
Breaks breaks_of(const CentreLine& path, const FrameField& frames, const SizeProfile& sizes, double twist,
                 const DecimalGrid& grid, double most) {
  std::vector<double> marks = nurbs::breakpoints(path.curve.knots, path.curve.degree);
  for (double t : sizes.parameters())
    if (t > 0.0 && t < 1.0) marks.push_back(t);
  std::sort(marks.begin(), marks.end());
  Breaks breaks;
  std::vector<double> ends;
  for (double t : marks)
    if (ends.empty() || t - ends.back() > 1e-9) ends.push_back(grid.rounded(t));
  ends.back() = 1.0;
  breaks.at = {ends.front()};
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const double from = ends[k], to = ends[k + 1];
    double turn = std::abs(sizes.at(to).value[2] - sizes.at(from).value[2]);
    if (twist != 0.0) turn += std::abs(twist) * (frames.length_at(to) - frames.length_at(from));
    turn += frames.turn_between(from, to);
    const double spans = std::max(1.0, std::ceil(turn / (pi / 2))), parts = std::ceil(spans / most_spans);
    breaks.rows += spans + parts;
    if (breaks.rows > most) return breaks;
    for (int i = 1; i <= static_cast<int>(parts); ++i) {
      breaks.at.push_back(i < parts ? grid.rounded(from + (to - from) * i / parts) : to);
      breaks.least.push_back(static_cast<int>(std::ceil(spans / parts)));
    }
  }
  return breaks;
}

// On a closed path the section has to come back to itself: whole turns only.
double whole_turns(double twist, const FrameField& frames, Body& body) {
  const double turns = twist * frames.length() / (2.0 * pi), whole = std::round(turns);
  if (std::abs(turns - whole) > 1e-9)
    body.messages.push_back(
        warning(Kind::geometry,
                fmt::format("yarn '{}' is closed: its twist of {:.4g} turns was brought to {} whole turns",
                            body.name, turns, whole))
            .of_yarn(body.name, body.place));
  return whole * 2.0 * pi / frames.length();
}

// sweep(), whose errors do not yet say of which yarn they are.
Status swept(Body& body, const CentreLine& path, const TubeSpec& spec) {
  std::vector<double> at;
  std::vector<SizeProfile::Values> rows;
  for (const SizeAtParameter& s : spec.sizes) {
    if (Status checked = check_section(spec.section, s.size); !checked) return checked;
    at.push_back(s.parameter);
    rows.push_back({s.size.width, s.size.height, s.angle});
  }
  // Rows that all say the same are one row.
  if (std::all_of(rows.begin(), rows.end(), [&](const auto& r) { return r == rows.front(); })) {
    at.resize(1);
    rows.resize(1);
  }
  const SizeProfile sizes(at, rows, path.closed);
  Result<FrameField> frames = FrameField::make(path.curve, spec.guide, path.closed, spec.twist != 0.0);
  if (!frames) return frames.error();
  const double twist = path.closed && spec.twist != 0.0 ? whole_turns(spec.twist, *frames, body) : spec.twist;
  Result<int> pieces = choose_pieces(spec, sizes);
  if (!pieces) return pieces.error();
  const Channels channels(*frames, sizes, spec, twist, *pieces);
  if (!channels.has_common_knots())
    return error(Kind::unsupported,
                 "a racetrack section that is wider than high in one place and higher than wide in another "
                 "has no common B-spline; use `power` or `ellipse`");
  double section_error = 0.0;
  for (const SizeAtParameter& s : spec.sizes)
    section_error = std::max(section_error, outline_error(spec, sizes, s.size, *pieces));
  const std::size_t columns = channels.outline().points.size();
  const std::size_t most = spec.max_control_points / columns;
  const auto too_many = [&] {
    return error(
        Kind::limit,
        fmt::format("yarn '{}' would need more than {} sections of {} control points to stay within the "
                    "tolerance of {:.3g}: raise the tolerance{}",
                    body.name, most, columns, spec.tolerance,
                    twist != 0.0 ? ", lower the twist, or drop `rotate`" : ", or split the yarn"));
  };
  // Knots of few digits move rows along the tube by less than a hundred-thousandth of the tolerance.
  double polygon = 0.0;
  for (std::size_t i = 1; i < path.curve.points.size(); ++i)
    polygon += (path.curve.points[i] - path.curve.points[i - 1]).norm();
  const DecimalGrid knot_grid = spec.grid.step() > 0.0
                                    ? DecimalGrid(1e-5 * spec.tolerance / std::max(polygon, spec.tolerance))
                                    : DecimalGrid();
  const Breaks breaks = breaks_of(path, *frames, sizes, twist, knot_grid, static_cast<double>(most));
  if (breaks.rows > static_cast<double>(most)) return too_many();
  StretchFit fit(channels, path, breaks.at, breaks.least, knot_grid);
  // A step's half by the rounding of points, another by that of the place that they are moved to.
  const double other_errors = section_error + 2.0 * spec.grid.reach();
  if (!fit.refine(spec.tolerance - other_errors, most)) return too_many();

  nurbs::Surface& surface = body.surface;
  surface = {};
  surface.degree_u = channels.outline().degree;
  surface.degree_v = 3;
  surface.knots_u = channels.outline().knots;
  surface.knots_v = fit.knots();
  surface.count_u = static_cast<int>(columns);
  surface.count_v = static_cast<int>(fit.control().rows());
  surface.points.reserve(columns * static_cast<std::size_t>(surface.count_v));
  // Rounded, an oblique end would no more be flat.
  const auto is_oblique = [&](double t) {
    return !path.closed && (frames->at(t).tangent.cwiseAbs().array() > 1e-12).count() > 1;
  };
  const std::size_t last = fit.control().rows() - 1;
  const bool keeps_first = is_oblique(0.0), keeps_last = is_oblique(1.0);
  for (std::size_t j = 0; j <= last; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      const Vec3 point = channels.blend(fit.control().row(j), i);
      const bool keeps = (j == 0 && keeps_first) || (j == last && keeps_last);
      surface.points.push_back(keeps ? point : spec.grid.rounded(point));
    }
  body.axis = path.curve;
  body.closed_along = path.closed;
  body.quarters = channels.outline().quarters;
  body.tube_error = other_errors + fit.error();
  return {};
}

}  // namespace

Status sweep(Body& body, const CentreLine& path, const TubeSpec& spec) {
  Status made = swept(body, path, spec);
  if (!made) return made.error().of_yarn(body.name, body.place);
  return made;
}

}  // namespace selvage::yarn
