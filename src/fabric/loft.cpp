#include "fabric/loft.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/plane.h"
#include "fabric/yarn_spec.h"
#include "nurbs/interpolate.h"
#include "yarn/frame.h"

namespace selvage::fabric {

namespace {

constexpr std::size_t most_points = 10'000'000;

// The section of a row, before it is placed.
struct Section {
  std::vector<Vec2> points;
  double weight = 1;
};

Section between(const Section& a, const Section& b, double share) {
  Section out = a;
  for (std::size_t i = 0; i < out.points.size(); ++i)
    out.points[i] = (1.0 - share) * a.points[i] + share * b.points[i];
  out.weight = (1.0 - share) * a.weight + share * b.weight;
  return out;
}

class Loft {
 public:
  Loft(const Fabric& fabric, const Yarn& yarn)
      : fabric_(fabric), yarn_(yarn), path_(std::get<Path>(yarn.shape)) {}

  Result<Grid> grid() {
    using Form = yarn::PathForm;
    if (path_.form != Form::chord && path_.form != Form::uniform && path_.form != Form::centripetal)
      return error(
                 Kind::malformed,
                 "outlines stand at data points: 'path chord', 'uniform' or 'centripetal' goes through them")
          .placed(path_.place);
    Result<yarn::PathRows> rows = path_rows_of(fabric_, yarn_, resolved_thread(fabric_, yarn_));
    if (!rows) return rows.error();
    Result<yarn::CentreLine> line = yarn::make_centre_line(*rows);
    if (!line) return line.error().placed(path_.place);
    line_ = std::move(*line);
    Result<yarn::FrameField> frames =
        yarn::FrameField::make(line_.curve, yarn::FrameGuide::free_from(yarn_.up), yarn_.closed, false);
    if (!frames) return frames.error().placed(path_.place);
    if (Status found = find_sections(); !found) return found.error();
    if (sections_.size() * round_ > most_points)
      return error(Kind::limit,
                   fmt::format("a yarn of {} rows with outlines of {} points is too large: at most "
                               "{} control points are made",
                               sections_.size(), round_, most_points))
          .placed(path_.place);
    place_sections(*frames);
    return interpolated();
  }

 private:
  Result<Section> section_at(const OutlineAt& at) const {
    const Outline* from = find_named(fabric_.outlines, at.from);
    const Outline* to = at.to.empty() ? from : find_named(fabric_.outlines, at.to);
    if (from == nullptr || to == nullptr) return error(Kind::malformed, "unknown outline").placed(at.place);
    for (const Outline* outline : {from, to})
      if (outline->points.size() != round_)
        return error(Kind::malformed,
                     fmt::format("outline '{}' has {} points, and the first one of this yarn has {}: control "
                                 "points go from outline to outline, so give all as many",
                                 outline->name, outline->points.size(), round_))
            .placed(at.place);
    Section section =
        between({counter_clockwise(from->points), 1.0}, {counter_clockwise(to->points), 1.0}, at.share);
    section.weight = at.weight;
    return section;
  }

  // The first point stays the first.
  static std::vector<Vec2> counter_clockwise(std::vector<Vec2> points) {
    if (twice_area(points) < 0.0) std::reverse(points.begin() + 1, points.end());
    return points;
  }

  Status find_sections() {
    const auto given = [&](std::size_t i) {
      return i < path_.outlines.size() && path_.outlines[i].has_value();
    };
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < path_.points.size(); ++i)
      if (given(i)) rows.push_back(i);
    round_ = find_named(fabric_.outlines, path_.outlines[rows.front()]->from)->points.size();
    sections_.resize(path_.points.size());
    for (const std::size_t i : rows) {
      Result<Section> section = section_at(*path_.outlines[i]);
      if (!section) return section.error();
      sections_[i] = std::move(*section);
    }
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      if (given(i)) continue;
      const auto next = std::ranges::upper_bound(rows, i);
      const std::size_t after = next == rows.end() ? rows.back() : *next,
                        before = next == rows.begin() ? rows.front() : *(next - 1);
      const double from = line_.parameters[before], to = line_.parameters[after];
      sections_[i] = between(sections_[before], sections_[after],
                             to > from ? (line_.parameters[i] - from) / (to - from) : 0.0);
    }
    return {};
  }

  // In space: each row's size, its angle, its frame.
  void place_sections(const yarn::FrameField& frames) {
    for (std::size_t i = 0; i < sections_.size(); ++i) {
      Eigen::Array2d scale(1.0, 1.0);
      double angle = 0.0;
      if (i < path_.sizes.size() && path_.sizes[i]) {
        Eigen::AlignedBox2d box;
        for (const Vec2& p : sections_[i].points) box.extend(p);
        scale = Eigen::Array2d(path_.sizes[i]->width, path_.sizes[i]->height) / box.sizes().array();
        angle = path_.sizes[i]->angle.value_or(0.0) * std::numbers::pi / 180.0;
      }
      const yarn::Frame frame = frames.at(line_.parameters[i]);
      const double c = std::cos(angle), s = std::sin(angle);
      const Vec3 a = c * frame.across + s * frame.up, b = -s * frame.across + c * frame.up;
      std::vector<Vec3>& placed = placed_.emplace_back();
      for (const Vec2& p : sections_[i].points)
        placed.push_back(path_.points[i] + scale.x() * p.x() * a + scale.y() * p.y() * b);
    }
  }

  // One row of data a section: all control points, times the weight, and the weight.
  [[nodiscard]] Eigen::MatrixXd data() const {
    Eigen::MatrixXd out(static_cast<Eigen::Index>(placed_.size()), static_cast<Eigen::Index>(3 * round_ + 1));
    for (std::size_t i = 0; i < placed_.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      for (std::size_t k = 0; k < round_; ++k)
        out.row(row).segment<3>(static_cast<Eigen::Index>(3 * k)) =
            sections_[i].weight * placed_[i][k].transpose();
      out(row, out.cols() - 1) = sections_[i].weight;
    }
    return out;
  }

  // At an end: the centre line's own derivative, and for what is round it that of parabolas.
  [[nodiscard]] Eigen::RowVectorXd derivative(bool last) const {
    const std::size_t end = last ? placed_.size() - 1 : 0;
    const Vec3 of_line = nurbs::evaluate_jet(line_.curve, last ? 1.0 : 0.0).d1;
    const auto parabola = [&](const auto& value) {
      std::vector<Vec3> values;
      for (std::size_t i = 0; i < placed_.size(); ++i) values.push_back(value(i));
      return nurbs::end_derivative(values, line_.parameters, last);
    };
    const double weight = sections_[end].weight;
    const double of_weight = parabola([&](std::size_t i) { return Vec3(sections_[i].weight, 0, 0); }).x();
    Eigen::RowVectorXd row(static_cast<Eigen::Index>(3 * round_ + 1));
    for (std::size_t k = 0; k < round_; ++k) {
      const Vec3 of_offset = parabola([&](std::size_t i) { return Vec3(placed_[i][k] - path_.points[i]); });
      row.segment<3>(static_cast<Eigen::Index>(3 * k)) =
          (weight * (of_line + of_offset) + of_weight * placed_[end][k]).transpose();
    }
    row(row.cols() - 1) = of_weight;
    return row;
  }

  Result<Grid> interpolated() const {
    std::vector<double> parameters = line_.parameters;
    if (yarn_.closed) parameters.push_back(1.0);
    const Eigen::MatrixXd rows =
        yarn_.closed ? nurbs::interpolate_periodic(parameters, data())
                     : nurbs::interpolate_clamped(parameters, data(), derivative(false), derivative(true));
    Grid grid;
    grid.place = path_.place;
    grid.closed_along = yarn_.closed;
    grid.sections = static_cast<int>(rows.rows());
    grid.per_section = static_cast<int>(round_);
    grid.degree_along = 3;
    grid.knots_along = nurbs::clamped_knots(parameters);
    const bool is_rational =
        std::ranges::any_of(sections_, [](const Section& section) { return section.weight != 1.0; });
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      const double weight = is_rational ? rows(i, rows.cols() - 1) : 1.0;
      if (!(weight > 0.0))
        return error(Kind::geometry,
                     fmt::format("the weights differ so much from row to row that one between them becomes "
                                 "{:.3g}: bring them nearer to each other",
                                 weight))
            .placed(path_.place);
      for (std::size_t k = 0; k < round_; ++k) {
        grid.points.emplace_back(rows.row(i).segment<3>(static_cast<Eigen::Index>(3 * k)).transpose() /
                                 weight);
        if (is_rational) grid.weights.push_back(weight);
      }
    }
    return grid;
  }

  const Fabric& fabric_;
  const Yarn& yarn_;
  const Path& path_;
  yarn::CentreLine line_;
  std::size_t round_ = 0;  // control points round each section
  std::vector<Section> sections_;
  std::vector<std::vector<Vec3>> placed_;
};

}  // namespace

void loft(Fabric& fabric, Diagnostics& diagnostics) {
  for (Item& item : fabric.items) {
    auto* yarn = std::get_if<Yarn>(&item);
    const auto* path = yarn != nullptr ? std::get_if<Path>(&yarn->shape) : nullptr;
    if (path == nullptr || path->outlines.empty()) continue;
    Result<Grid> grid = Loft(fabric, *yarn).grid();
    if (!grid) {
      diagnostics.add(grid.error().placed(yarn->place, fabric.file));
      continue;
    }
    yarn->shape = std::move(*grid);
    yarn->tangent_start = yarn->tangent_end = std::nullopt;
    yarn->up = std::nullopt;
  }
}

}  // namespace selvage::fabric
