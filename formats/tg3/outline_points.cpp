#include "formats/tg3/outline_points.h"

#include <algorithm>
#include <cmath>

#include "nurbs/interpolate.h"
#include "nurbs/spline.h"

namespace selvage::formats::tg3 {

namespace {

constexpr int fewest_round = 16, most_round = 256;  // points of a turn without corners
constexpr Eigen::Index fewest_of_an_arc = 4;        // spans: its slopes at both ends are those of five points

double brought_in(double t) {
  return t < 1 ? t : t - 1;
}

// The length of the sections' outlines up to t, all sections together and each as if it were as wide as high,
// and its inverse, from `start` once round.
class LengthTable {
 public:
  LengthTable(const std::vector<Section>& sections, std::vector<double> marks)
      : ts_{marks.front()}, lengths_{0.0} {
    std::vector<Vec2> scales;
    scales.reserve(sections.size());
    for (const Section& section : sections) scales.push_back(sizes_of(section).cwiseInverse());
    marks.push_back(marks.front() + 1);
    // Between their corners straight outlines have one pace.
    const int steps = std::ranges::all_of(sections, &Section::is_straight) ? 1 : 512;
    for (std::size_t k = 0; k + 1 < marks.size(); ++k)
      for (int i = 1; i <= steps; ++i) {
        // Fine beside the marks, where the outline of a power ellipse is fast.
        const double s = static_cast<double>(i) / steps;
        const double t = marks[k] + (marks[k + 1] - marks[k]) * s * s * (3 - 2 * s);
        double length = lengths_.back();
        for (std::size_t n = 0; n < sections.size(); ++n)
          length += (sections[n].point(brought_in(t)) - sections[n].point(brought_in(ts_.back())))
                        .cwiseProduct(scales[n])
                        .norm();
        ts_.push_back(t);
        lengths_.push_back(length);
      }
  }
  [[nodiscard]] double length_at(double t) const { return between(ts_, lengths_, t); }
  [[nodiscard]] double t_at(double length) const { return between(lengths_, ts_, length); }
  [[nodiscard]] double total() const { return lengths_.back(); }

 private:
  static double between(const std::vector<double>& xs, const std::vector<double>& ys, double x) {
    const auto above = std::upper_bound(xs.begin() + 1, xs.end() - 1, x);
    const auto i = static_cast<std::size_t>(above - xs.begin());
    const double step = xs[i] - xs[i - 1];
    return step > 0 ? ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / step : ys[i];
  }
  std::vector<double> ts_, lengths_;
};

}  // namespace

OutlinePoints::OutlinePoints(const std::vector<Section>& sections, double tolerance) {
  const std::size_t kept = sections.front().kept.size();
  is_straight_ = std::ranges::all_of(sections, &Section::is_straight);
  const bool is_kept =
      kept > 0 && std::ranges::all_of(sections, [&](const Section& one) { return one.kept.size() == kept; });
  if (is_kept) {
    take_kept(sections);
    if (tolerance > 0) leave_out_corners(tolerance);
    return;
  }
  double largest = 0;
  for (const Section& section : sections) largest = std::max(largest, sizes_of(section).maxCoeff());
  for (int per_turn = fewest_round; per_turn <= most_round; per_turn *= 2) {
    place(sections, per_turn);
    if (is_straight_) break;
    deviation_ = worst_error(sections);
    if (deviation_ <= std::max(round_share * largest, tolerance)) return;
  }
  if (is_straight_ && tolerance > 0) leave_out_corners(tolerance);
}

// The corners themselves, evenly.
void OutlinePoints::take_kept(const std::vector<Section>& sections) {
  for (const Section& section : sections) points_.push_back(section.kept);
  const std::size_t count = points_.front().size();
  for (std::size_t i = 0; i <= count; ++i)
    parameters_.push_back(static_cast<double>(i) / static_cast<double>(count));
  make_knots();
}

std::vector<double> OutlinePoints::section_parameters() const {
  if (ts_.empty()) return {parameters_.begin(), parameters_.end() - 1};  // of corners that are kept
  std::vector<double> ts;
  for (const double t : ts_) ts.push_back(brought_in(t));
  return ts;
}

void OutlinePoints::place(const std::vector<Section>& sections, int per_turn) {
  std::vector<const Section*> all;
  all.reserve(sections.size());
  for (const Section& section : sections) all.push_back(&section);
  const std::vector<double> corners = corners_of(all);
  const LengthTable table(sections, corners.empty() ? std::vector<double>{0, 0.25, 0.5, 0.75} : corners);
  arcs_.clear();
  parameters_.clear();
  ts_.clear();
  halfways_.clear();
  const auto add = [&](double length) {
    parameters_.push_back(length / table.total());
    ts_.push_back(table.t_at(length));
  };
  const std::size_t count = std::max<std::size_t>(corners.size(), 1);
  for (std::size_t k = 0; k < count; ++k) {
    const double from = corners.empty() ? 0 : table.length_at(corners[k]);
    const double to = k + 1 < count ? table.length_at(corners[k + 1]) : table.total();
    const double share = (to - from) / table.total();
    Eigen::Index spans = is_straight_ ? 1 : static_cast<Eigen::Index>(std::lround(per_turn * share));
    if (!is_straight_) spans = std::max(spans, fewest_of_an_arc);
    if (!corners.empty()) arcs_.push_back({static_cast<Eigen::Index>(ts_.size()), spans});
    for (Eigen::Index i = 0; i < spans; ++i) {
      add(from + (to - from) * static_cast<double>(i) / static_cast<double>(spans));
      halfways_.push_back(
          table.t_at(from + (to - from) * (static_cast<double>(i) + 0.5) / static_cast<double>(spans)));
    }
    if (!corners.empty()) ts_[static_cast<std::size_t>(arcs_.back().first)] = corners[k];
  }
  parameters_.push_back(1.0);
  points_.clear();
  for (const Section& section : sections) {
    std::vector<Vec2>& points = points_.emplace_back();
    for (const double t : ts_) points.push_back(section.point(brought_in(t)));
  }
  make_knots();
}

// Of the corners from `first` to `last` (which wraps round) those are kept that the algorithm of Ramer,
// Douglas and Peucker keeps: the farthest one from the chord, of any section, while it is too far.
void OutlinePoints::leave_out_corners(double tolerance) {
  const std::size_t count = points_.front().size();
  std::vector<bool> is_kept(count);
  const auto farthest = [&](std::size_t first, std::size_t last) {
    std::pair<double, std::size_t> worst = {0, first};
    for (const std::vector<Vec2>& points : points_) {
      const Vec2 from = points[first], chord = points[last % count] - from;
      for (std::size_t i = first + 1; i < last; ++i) {
        const Vec2 out = points[i] - from;
        const double along =
            chord.squaredNorm() > 0 ? std::clamp(out.dot(chord) / chord.squaredNorm(), 0.0, 1.0) : 0.0;
        worst = std::max(worst, {(out - along * chord).norm(), i});
      }
    }
    return worst;
  };
  std::vector<std::pair<std::size_t, std::size_t>> ranges = {{0, count}};
  std::size_t kept = 0;
  while (!ranges.empty()) {
    const auto [first, last] = ranges.back();
    ranges.pop_back();
    if (!is_kept[first]) ++kept;
    is_kept[first] = true;
    const auto [distance, at] = farthest(first, last);
    constexpr std::size_t fewest = 3;  // of a polygon
    if (at == first || (distance <= tolerance && kept + ranges.size() >= fewest)) {
      deviation_ = std::max(deviation_, distance);
      continue;
    }
    ranges.emplace_back(at, last);
    ranges.emplace_back(first, at);
  }
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_kept[i]) continue;
    for (std::vector<Vec2>& points : points_) points[next] = points[i];
    parameters_[next] = parameters_[i];
    if (!ts_.empty()) ts_[next] = ts_[i];
    ++next;
  }
  for (std::vector<Vec2>& points : points_) points.resize(next);
  parameters_[next] = parameters_.back();
  parameters_.resize(next + 1);
  if (!ts_.empty()) ts_.resize(next);
  knots_.clear();
  arcs_.clear();
  make_knots();
}

void OutlinePoints::make_knots() {
  const int degree = this->degree();
  knots_.assign(static_cast<std::size_t>(degree), 0.0);
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const auto arc = std::lower_bound(arcs_.begin(), arcs_.end(), static_cast<Eigen::Index>(i),
                                      [](const Arc& one, Eigen::Index at) { return one.first < at; });
    const bool is_joint = i > 0 && arc != arcs_.end() && arc->first == static_cast<Eigen::Index>(i);
    knots_.insert(knots_.end(), is_joint && degree > 1 ? 3 : 1, parameters_[i]);
  }
  knots_.insert(knots_.end(), static_cast<std::size_t>(degree), 1.0);
}

Eigen::MatrixXd OutlinePoints::controls(const Eigen::MatrixXd& data) const {
  const Eigen::Index count = data.rows();
  if (is_straight_) {
    Eigen::MatrixXd closed(count + 1, data.cols());
    closed << data, data.row(0);
    return closed;
  }
  if (arcs_.empty()) return nurbs::interpolate_periodic(parameters_, data);
  Eigen::MatrixXd all(count + 2 * static_cast<Eigen::Index>(arcs_.size()) + 1, data.cols());
  Eigen::Index done = 0;
  for (const Arc& arc : arcs_) {
    Eigen::MatrixXd rows(arc.spans + 1, data.cols());
    for (Eigen::Index i = 0; i <= arc.spans; ++i) rows.row(i) = data.row((arc.first + i) % count);
    const auto begin = parameters_.begin() + arc.first;
    const std::vector<double> parameters(begin, begin + arc.spans + 1);
    // Of the quartic through five even points, at the first of them.
    const auto slope = [&](Eigen::Index first, Eigen::Index step) -> Eigen::RowVectorXd {
      const auto row = [&](Eigen::Index i) { return rows.row(first + i * step); };
      const double h = static_cast<double>(step) * (parameters.back() - parameters.front()) /
                       static_cast<double>(arc.spans);
      return (-25 * row(0) + 48 * row(1) - 36 * row(2) + 16 * row(3) - 3 * row(4)) / (12 * h);
    };
    const Eigen::MatrixXd part =
        nurbs::interpolate_clamped(parameters, rows, slope(0, 1), slope(arc.spans, -1));
    all.middleRows(done, part.rows()) = part;
    done += part.rows() - 1;
  }
  return all;
}

double OutlinePoints::worst_error(const std::vector<Section>& sections) const {
  double worst = 0;
  for (std::size_t n = 0; n < sections.size(); ++n) {
    Eigen::MatrixXd data(static_cast<Eigen::Index>(ts_.size()), 2);
    for (std::size_t i = 0; i < ts_.size(); ++i)
      data.row(static_cast<Eigen::Index>(i)) = points_[n][i].transpose();
    const Eigen::MatrixXd control = controls(data);
    nurbs::Curve curve{degree(), knots_, {}, {}};
    for (Eigen::Index i = 0; i < control.rows(); ++i)
      curve.points.emplace_back(control(i, 0), control(i, 1), 0.0);
    for (std::size_t i = 0; i < ts_.size(); ++i) {
      const nurbs::CurveJet jet = nurbs::evaluate_jet(curve, (parameters_[i] + parameters_[i + 1]) / 2);
      const Vec2 miss = sections[n].point(brought_in(halfways_[i])) - jet.position.head<2>();
      // Across the curve: the two pass the outline at a pace of their own.
      const Vec2 along = jet.d1.head<2>().normalized();
      worst = std::max(worst, std::abs(along.x() * miss.y() - along.y() * miss.x()));
    }
  }
  return worst;
}

}  // namespace selvage::formats::tg3
