#include "yarn/tube.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "nurbs/basis.h"
#include "nurbs/interpolate.h"
#include "yarn/frame.h"
#include "yarn/size_profile.h"

namespace selvage::yarn {

namespace {

using std::numbers::pi;
using Row = Eigen::RowVectorXd;

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
  }

  [[nodiscard]] const Outline& outline() const { return unit_; }
  [[nodiscard]] Eigen::Index width() const {
    return affine_ ? 9 : 3 * static_cast<Eigen::Index>(unit_.points.size() - 1);
  }

  // Values at t; `slope`, where wanted, gets the derivatives.
  [[nodiscard]] Row at(double t, Row* slope = nullptr) const {
    const Frame frame = frames_.at(t);
    const SizeProfile::Jet size = sizes_.at(t);
    double angle = size.value[2];
    if (twist_ != 0.0) angle += twist_ * frames_.length_at(t);
    const double c = std::cos(angle), s = std::sin(angle);
    const Vec3 a = c * frame.across + s * frame.up, b = -s * frame.across + c * frame.up;
    // a' and b' of a frame that turns at `rate` against the rotation-minimizing one.
    const double rate = size.slope[2] + twist_ * frame.speed + frame.turn_dt;
    const Vec3 a_dt = -frame.tangent_dt.dot(a) * frame.tangent + rate * b;
    const Vec3 b_dt = -frame.tangent_dt.dot(b) * frame.tangent - rate * a;
    const Vec3 c_dt = frame.speed * frame.tangent;
    Row row(width());
    if (slope != nullptr) slope->resize(width());
    if (affine_) {
      const double w = 0.5 * size.value[0], h = 0.5 * size.value[1];
      row << frame.position.transpose(), (w * a).transpose(), (h * b).transpose();
      if (slope != nullptr)
        *slope << c_dt.transpose(), (w * a_dt + 0.5 * size.slope[0] * a).transpose(),
            (h * b_dt + 0.5 * size.slope[1] * b).transpose();
      return row;
    }
    const std::vector<Vec2> points = control_at(size.value);
    std::vector<Vec2> points_dt;
    if (slope != nullptr) points_dt = control_slope(size);
    for (Eigen::Index i = 0; 3 * i < width(); ++i) {
      const Vec2& p = points[static_cast<std::size_t>(i)];
      row.segment<3>(3 * i) = (frame.position + p.x() * a + p.y() * b).transpose();
      if (slope == nullptr) continue;
      const Vec2& q = points_dt[static_cast<std::size_t>(i)];
      slope->segment<3>(3 * i) = (c_dt + p.x() * a_dt + p.y() * b_dt + q.x() * a + q.y() * b).transpose();
    }
    return row;
  }

  // The largest length that a row of deviations has anywhere round the section.
  [[nodiscard]] double largest(const Row& deviation) const {
    double found = 0.0;
    if (affine_) {
      // Round the section it is a convex blend of its values at the control points.
      const Vec3 c = deviation.segment<3>(0), a = deviation.segment<3>(3), b = deviation.segment<3>(6);
      for (const Vec2& p : unit_.points) found = std::max(found, (c + p.x() * a + p.y() * b).squaredNorm());
    } else {
      for (Eigen::Index i = 0; 3 * i < width(); ++i)
        found = std::max(found, deviation.segment<3>(3 * i).squaredNorm());
    }
    return std::sqrt(found);
  }

  // The control point of column i (the last column is the first) from a row of control values.
  [[nodiscard]] Vec3 blend(const Eigen::Ref<const Row>& control, std::size_t i) const {
    if (!affine_)
      return control.segment<3>(3 * static_cast<Eigen::Index>(i % (unit_.points.size() - 1))).transpose();
    const Vec2& p = unit_.points[i];
    return (control.segment<3>(0) + p.x() * control.segment<3>(3) + p.y() * control.segment<3>(6))
        .transpose();
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
  Outline unit_;
};

// One span between neighbouring sections, with the exact values at samples inside, which outlive refits.
struct Span {
  double from = 0, to = 0;
  std::vector<Row> samples;
  double error = 0;
};

constexpr int samples_per_span = 7;  // at eighths

class AdaptiveFit {
 public:
  AdaptiveFit(const Channels& channels, bool closed, const std::vector<double>& breaks)
      : channels_(channels), closed_(closed) {
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) spans_.push_back(make_span(breaks[k], breaks[k + 1]));
    for (std::size_t k = 0; k < breaks.size(); ++k) sites_.push_back(channels_.at(breaks[k]));
  }

  // Halves spans until each is within `tolerance`; false when that would take more than `most` sections.
  bool refine(double tolerance, std::size_t most) {
    for (;;) {
      if (spans_.size() + 3 > most) return false;
      fit();
      measure();
      std::vector<Span> finer;
      std::vector<Row> sites;
      bool is_done = true;
      for (std::size_t k = 0; k < spans_.size(); ++k) {
        sites.push_back(sites_[k]);
        // An error of order four says how many halves it takes: one step a round keeps the count low.
        if (spans_[k].error <= tolerance) {
          finer.push_back(std::move(spans_[k]));
          continue;
        }
        is_done = false;
        const double middle = 0.5 * (spans_[k].from + spans_[k].to);
        if (!(middle > spans_[k].from && middle < spans_[k].to)) return false;
        finer.push_back(make_span(spans_[k].from, middle));
        finer.push_back(make_span(middle, spans_[k].to));
        sites.push_back(channels_.at(middle));
      }
      sites.push_back(sites_.back());
      spans_ = std::move(finer);
      sites_ = std::move(sites);
      if (is_done) return true;
    }
  }

  [[nodiscard]] double error() const {
    double largest = 0.0;
    for (const Span& span : spans_) largest = std::max(largest, span.error);
    return largest;
  }
  [[nodiscard]] const Eigen::MatrixXd& control() const { return control_; }
  [[nodiscard]] const std::vector<double>& knots() const { return knots_; }

 private:
  [[nodiscard]] Span make_span(double from, double to) const {
    Span span{from, to, {}, 0.0};
    for (int i = 1; i <= samples_per_span; ++i)
      span.samples.push_back(channels_.at(from + (to - from) * i / (samples_per_span + 1)));
    return span;
  }

  void fit() {
    std::vector<double> t = {spans_.front().from};
    for (const Span& span : spans_) t.push_back(span.to);
    const auto rows = static_cast<Eigen::Index>(closed_ ? sites_.size() - 1 : sites_.size());
    Eigen::MatrixXd data(rows, channels_.width());
    for (Eigen::Index i = 0; i < rows; ++i) data.row(i) = sites_[static_cast<std::size_t>(i)];
    knots_ = nurbs::clamped_knots(t);
    if (closed_) {
      control_ = nurbs::interpolate_periodic(t, data);
      return;
    }
    Row first, last;
    (void)channels_.at(t.front(), &first);
    (void)channels_.at(t.back(), &last);
    control_ = nurbs::interpolate_clamped(t, data, first, last);
  }

  // The largest sampled deviation of each span and what can hide between the samples: half the distance of
  // two samples holds at most an eighth of the second difference, taken twice for the change of curvature in
  // between.
  void measure() {
    const int count = static_cast<int>(control_.rows());
    std::vector<Row> deviations(samples_per_span + 2, Row::Zero(channels_.width()));
    for (Span& span : spans_) {
      double sampled = 0.0, hidden = 0.0;
      for (int i = 1; i <= samples_per_span; ++i) {
        const double t = span.from + (span.to - span.from) * i / (samples_per_span + 1);
        const int k = nurbs::find_span(knots_, 3, count, t);
        nurbs::BasisRow values{};
        nurbs::basis(knots_, 3, k, t, values);
        Row here = -span.samples[static_cast<std::size_t>(i - 1)];
        for (int j = 0; j <= 3; ++j) here += values[static_cast<std::size_t>(j)] * control_.row(k - 3 + j);
        sampled = std::max(sampled, channels_.largest(here));
        deviations[static_cast<std::size_t>(i)] = std::move(here);
      }
      for (std::size_t i = 1; i + 1 < deviations.size(); ++i)
        hidden = std::max(
            hidden, channels_.largest(deviations[i - 1] - 2.0 * deviations[i] + deviations[i + 1]) / 4.0);
      span.error = sampled + hidden;
    }
  }

  const Channels& channels_;
  bool closed_;
  std::vector<Span> spans_;
  std::vector<Row> sites_;  // exact values at the spans' ends
  std::vector<double> knots_;
  Eigen::MatrixXd control_;
};

// Of so many parabolas to a quarter.
double outline_error(const TubeSpec& spec, const SizeProfile& sizes, const SectionSize& size, int pieces) {
  const bool varying = sizes.parameters().size() > 1 && !is_affine(spec.section);
  return outline_error(spec.section, size, make_outline(spec.section, size, pieces, varying));
}

// How many parabolas to a quarter give the smallest net: fewer leave less of the tolerance to the sections,
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

// Sections must stand densely enough for samples to see every turn: no span turns by more than a quarter.
std::vector<double> first_breaks(const CentreLine& path, const FrameField& frames, const SizeProfile& sizes,
                                 double twist, std::size_t most) {
  std::vector<double> marks = nurbs::breakpoints(path.curve.knots, path.curve.degree);
  for (double t : sizes.parameters())
    if (t > 0.0 && t < 1.0) marks.push_back(t);
  std::sort(marks.begin(), marks.end());
  std::vector<double> distinct;
  for (double t : marks)
    if (distinct.empty() || t - distinct.back() > 1e-9) distinct.push_back(t);
  distinct.back() = 1.0;
  if (path.closed)  // a periodic cubic needs three sections
    while (distinct.size() < 4) {
      std::vector<double> halves;
      for (std::size_t k = 0; k + 1 < distinct.size(); ++k) {
        halves.push_back(distinct[k]);
        halves.push_back(0.5 * (distinct[k] + distinct[k + 1]));
      }
      halves.push_back(distinct.back());
      distinct = halves;
    }
  std::vector<double> breaks = {distinct.front()};
  for (std::size_t k = 0; k + 1 < distinct.size(); ++k) {
    const double from = distinct[k], to = distinct[k + 1];
    double turn = std::abs(sizes.at(to).value[2] - sizes.at(from).value[2]);
    if (twist != 0.0) turn += std::abs(twist) * (frames.length_at(to) - frames.length_at(from));
    turn += frames.turn_between(from, to);
    const double steps = std::max(1.0, std::ceil(turn / (pi / 2)));
    if (static_cast<double>(breaks.size()) + steps > static_cast<double>(most)) return {};
    for (int i = 1; i <= static_cast<int>(steps); ++i)
      breaks.push_back(i == static_cast<int>(steps) ? to : from + (to - from) * i / steps);
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
  const std::vector<double> breaks = first_breaks(path, *frames, sizes, twist, most);
  if (breaks.empty()) return too_many();
  AdaptiveFit fit(channels, path.closed, breaks);
  if (!fit.refine(spec.tolerance - section_error, most)) return too_many();

  nurbs::Surface& surface = body.surface;
  surface = {};
  surface.degree_u = channels.outline().degree;
  surface.degree_v = 3;
  surface.knots_u = channels.outline().knots;
  surface.knots_v = fit.knots();
  surface.count_u = static_cast<int>(columns);
  surface.count_v = static_cast<int>(fit.control().rows());
  surface.points.reserve(columns * static_cast<std::size_t>(surface.count_v));
  for (Eigen::Index j = 0; j < fit.control().rows(); ++j)
    for (std::size_t i = 0; i < columns; ++i)
      surface.points.push_back(channels.blend(fit.control().row(j), i));
  body.axis = path.curve;
  body.closed_along = path.closed;
  body.quarters = channels.outline().quarters;
  body.tube_error = section_error + fit.error();
  return {};
}

}  // namespace

Status sweep(Body& body, const CentreLine& path, const TubeSpec& spec) {
  Status made = swept(body, path, spec);
  if (!made) return made.error().of_yarn(body.name, body.place);
  return made;
}

}  // namespace selvage::yarn
