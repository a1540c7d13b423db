#include "fabric/section_stack.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "core/wrapped.h"
#include "nurbs/interpolate.h"

namespace selvage::fabric {

namespace {

constexpr std::size_t fewest_round = 12, most_round = 64;

Vec3 middle_of(const std::vector<Vec3>& outline) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& point : outline) sum += point;
  return sum / static_cast<double>(outline.size());
}

// At even steps of its length, from its first point on.
std::vector<Vec3> resampled(const std::vector<Vec3>& outline, std::size_t count) {
  std::vector<double> lengths = {0.0};
  for (std::size_t i = 0; i < outline.size(); ++i)
    lengths.push_back(lengths.back() + (outline[(i + 1) % outline.size()] - outline[i]).norm());
  std::vector<Vec3> even;
  std::size_t edge = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double length = lengths.back() * static_cast<double>(k) / static_cast<double>(count);
    while (edge + 1 < outline.size() && lengths[edge + 1] <= length) ++edge;
    const double share = (length - lengths[edge]) / (lengths[edge + 1] - lengths[edge]);
    even.push_back(outline[edge] + share * (outline[(edge + 1) % outline.size()] - outline[edge]));
  }
  return even;
}

// The way of `other`'s points from those of `outline`, both told from their middles, squared.
double twist_of(const std::vector<Vec3>& outline, const std::vector<Vec3>& other, std::size_t first) {
  const Vec3 to_other = middle_of(other) - middle_of(outline);
  double sum = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i)
    sum += (other[(first + i) % other.size()] - outline[i] - to_other).squaredNorm();
  return sum;
}

// Turned over and begun anew so that it lies nearest to the one before.
std::vector<Vec3> aligned(const std::vector<Vec3>& before, std::vector<Vec3> outline) {
  std::vector<Vec3> best;
  double least = std::numeric_limits<double>::infinity();
  for (int way = 0; way < 2; ++way) {
    for (std::size_t first = 0; first < outline.size(); ++first) {
      const double twist = twist_of(before, outline, first);
      if (twist >= least) continue;
      least = twist;
      best = outline;
      std::rotate(best.begin(), best.begin() + static_cast<std::ptrdiff_t>(first), best.end());
    }
    std::reverse(outline.begin(), outline.end());
  }
  return best;
}

// Rows of control points of the closed uniform quadratic that goes through these rows in the middle of its
// spans.
Eigen::MatrixXd quadratic_round(Eigen::Index count, const Eigen::MatrixXd& data) {
  Eigen::MatrixXd blend = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    blend(i, wrapped(i - 1, count)) = 0.125;
    blend(i, i) = 0.75;
    blend(i, wrapped(i + 1, count)) = 0.125;
  }
  return blend.partialPivLu().solve(data);
}

}  // namespace

Result<Grid> grid_of_outlines(const MeasuredYarn& measured) {
  const auto refuse = [&](std::size_t point, std::string text) {
    return error(Kind::malformed, std::move(text)).placed(measured.places[point]).of_yarn(measured.name);
  };
  const std::size_t sections = measured.sections.size();
  if (sections < 2)
    return refuse(0, fmt::format("yarn '{}' has one section: a yarn has two at least", measured.name));
  std::vector<std::vector<Vec3>> outlines;
  std::size_t count = fewest_round;
  for (std::size_t k = 0; k < sections; ++k) {
    const std::size_t first = measured.sections[k];
    std::size_t last = k + 1 < sections ? measured.sections[k + 1] : measured.points.size();
    if (last - first > 3 && measured.points[first] == measured.points[last - 1]) --last;  // closed by hand
    if (last - first < 3)
      return refuse(first, fmt::format("section {} of yarn '{}' has {} points: an outline has three at least",
                                       k + 1, measured.name, last - first));
    for (std::size_t i = first; i < last; ++i)
      if (measured.points[i] == measured.points[i + 1 < last ? i + 1 : first])
        return refuse(i, "this point of the outline equals the one after it");
    outlines.emplace_back(measured.points.begin() + static_cast<std::ptrdiff_t>(first),
                          measured.points.begin() + static_cast<std::ptrdiff_t>(last));
    count = std::max(count, last - first);
  }
  count = std::min(count, most_round);
  std::vector<Vec3> middles;
  for (std::size_t k = 0; k < sections; ++k) {
    outlines[k] = resampled(outlines[k], count);
    if (k > 0) outlines[k] = aligned(outlines[k - 1], std::move(outlines[k]));
    middles.push_back(middle_of(outlines[k]));
    if (k > 0 && middles[k] == middles[k - 1])
      return refuse(measured.sections[k], "this section lies on the one before it");
  }
  const auto rows = static_cast<Eigen::Index>(sections), columns = static_cast<Eigen::Index>(count);
  Eigen::MatrixXd data(rows, 3 * columns);
  for (Eigen::Index k = 0; k < rows; ++k) {
    Eigen::MatrixXd round(columns, 3);
    for (Eigen::Index i = 0; i < columns; ++i)
      round.row(i) = outlines[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)].transpose();
    const Eigen::MatrixXd control = quadratic_round(columns, round);
    for (Eigen::Index i = 0; i < columns; ++i) data.block(k, 3 * i, 1, 3) = control.row(i);
  }
  Grid grid;
  grid.place = measured.places.front();
  const std::vector<double> along = nurbs::parameters(middles, nurbs::Parameterization::chord);
  // At the ends along the parabola through the nearest three sections.
  Eigen::RowVectorXd first(3 * columns), last(3 * columns);
  for (Eigen::Index i = 0; i < columns; ++i) {
    std::vector<Vec3> column;
    for (Eigen::Index k = 0; k < rows; ++k) column.emplace_back(data.block(k, 3 * i, 1, 3).transpose());
    first.segment(3 * i, 3) = nurbs::end_derivative(column, along, false).transpose();
    last.segment(3 * i, 3) = nurbs::end_derivative(column, along, true).transpose();
  }
  const Eigen::MatrixXd control = nurbs::interpolate_clamped(along, data, first, last);
  grid.sections = static_cast<int>(control.rows());
  grid.per_section = static_cast<int>(count);
  if (control.rows() == 4) grid.degree_along = 3;
  grid.knots_along = nurbs::clamped_knots(along);
  for (Eigen::Index k = 0; k < control.rows(); ++k)
    for (Eigen::Index i = 0; i < columns; ++i)
      grid.points.emplace_back(control.block(k, 3 * i, 1, 3).transpose());
  return grid;
}

}  // namespace selvage::fabric
