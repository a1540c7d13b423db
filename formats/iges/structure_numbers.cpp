#include "formats/iges/structure_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "formats/iges/entities.h"
#include "nurbs/basis.h"
#include "nurbs/spline.h"

namespace selvage::formats::iges {

namespace {

// Rounding of coordinates of this size: closed, by the numbers.
constexpr double rounding = 1e-12;
// A surface that its flag says to be closed may leave this much of its size open.
constexpr double leave_open = 1e-9;

class Numbers {
 public:
  Numbers(const DirectoryEntry& entry, const Values& values, Findings& findings)
      : entry_(entry), values_(values), findings_(findings) {}

  std::vector<double> take(std::size_t count) {
    std::vector<double> values(count);
    for (double& value : values) value = take();
    return values;
  }
  double take() { return values_.real(at_++).value_or(0); }
  int integer() { return values_.integer(at_++).value_or(0); }
  std::vector<Vec3> points(std::size_t count) {
    std::vector<Vec3> points(count);
    for (Vec3& point : points)
      for (int k = 0; k < 3; ++k) point[k] = take();
    return points;
  }
  [[nodiscard]] std::size_t at() const { return at_; }

  void defect(const std::string& what, std::size_t value) {
    findings_.defect(entry_.name() + ": " + what, values_.spot(value).place());
    ++defects_;
  }
  // What a flag says wrongly of the numbers that follow it.
  void warning(const std::string& what, std::size_t value, double badness = 0) {
    findings_.warning(entry_.name() + ": " + what, values_.spot(value).place(), badness);
  }
  [[nodiscard]] bool is_sound() const { return defects_ == 0; }

  // Order and multiplicity; `first`: the index of the first knot among the values. Where one inside tears the
  // shape, `meets(i)` says whether the control points (rows of them) i and i + 1, at which the two pieces end
  // and begin, are the same: receivers join or divide it there.
  void check_knots(const std::vector<double>& knots, int degree, std::size_t first, std::string_view where,
                   const std::function<bool(std::size_t)>& meets) {
    for (std::size_t i = 1; i < knots.size(); ++i)
      if (!(knots[i] >= knots[i - 1])) {
        defect(fmt::format("knot {}{} is {} after {}", i + 1, where, knots[i], knots[i - 1]), first + i);
        return;
      }
    const auto most = static_cast<std::size_t>(degree);
    for (std::size_t i = 0; i < knots.size();) {
      std::size_t next = i;
      while (next < knots.size() && knots[next] == knots[i]) ++next;
      const bool is_end = i == 0 || next == knots.size();
      if (!is_end && next - i == most + 1 && meets(i - 1))
        warning(fmt::format("the knot {}{} is there {} times, at degree {}: two pieces that meet there",
                            knots[i], where, next - i, degree),
                first + i);
      else if (next - i > most + (is_end ? 1 : 0))
        defect(fmt::format("the knot {}{} is there {} times, at degree {}: {}", knots[i], where, next - i,
                           degree, is_end ? "a control point has no influence" : "the surface is torn"),
               first + i);
      i = next;
    }
  }
  void check_weights(const std::vector<double>& weights, bool polynomial, std::size_t first, std::size_t flag,
                     std::string_view name) {
    for (std::size_t i = 0; i < weights.size(); ++i)
      if (!(weights[i] > 0)) {
        defect(fmt::format("weight {} is {}", i + 1, weights[i]), first + i);
        return;
      }
    const auto [least, most] = std::minmax_element(weights.begin(), weights.end());
    if (polynomial && *least != *most)
      defect(fmt::format("{} says that it is polynomial, and its weights are {} to {}", name, *least, *most),
             flag);
  }
  void check_range(double first, double last, double low, double high, std::string_view where,
                   std::size_t value) {
    const double slack = rounding * std::max({1.0, std::abs(low), std::abs(high)});
    if (!(first < last)) return defect(fmt::format("the range{} is {} to {}", where, first, last), value);
    if (first >= low - slack && last <= high + slack) return;
    const std::string what =
        fmt::format("the range{} is {} to {}, and the knots allow {} to {}", where, first, last, low, high);
    // All of the knots can only mean all of the shape.
    const bool is_all = first <= low + slack && last >= high - slack;
    is_all ? warning(what, value) : defect(what, value);
  }

 private:
  const DirectoryEntry& entry_;
  const Values& values_;
  Findings& findings_;
  std::size_t at_ = 1;
  int defects_ = 0;
};

// Does what ends in one of these and begins in the other hang together? Readers join it over some
// resolutions.
bool meet(const Vec3& a, const Vec3& b, double resolution) {
  const double size = std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
  return (a - b).norm() <= std::max(rounding * size, std::min(10 * resolution, 1e-4 * size));
}

// The flags PROP1 and PROP4 (PROP2 and PROP5) against the largest distance of the two opposite borders.
// Warnings only: what they say follows from the numbers behind them, by which receivers go, and the standard
// has those of periodicity for information alone (IGES 5.3, 4.23).
void check_closed(Numbers& numbers, bool said, bool periodic, double gap, double size, double resolution,
                  std::string_view flag, std::string_view where, std::size_t value) {
  if (said && gap > std::max(leave_open * size, std::min(resolution, 1e-6 * size)))
    numbers.warning(
        fmt::format("{} says that it is closed{}, and its ends are {:.3g} apart", flag, where, gap), value,
        gap);
  else if (!said && gap <= rounding * size)
    numbers.warning(fmt::format("{} says that it is open{}, and it is closed", flag, where), value);
  if (periodic && gap > std::max(leave_open * size, resolution))
    numbers.warning(fmt::format("it is said to be periodic{}, and its ends are {:.3g} apart", where, gap),
                    value + 3, gap);
}

double largest_gap(const nurbs::Surface& surface, bool in_u, const std::array<double, 4>& range) {
  const std::vector<double> across =
      in_u ? nurbs::greville(surface.knots_v, surface.degree_v, surface.count_v)
           : nurbs::greville(surface.knots_u, surface.degree_u, surface.count_u);
  const std::vector<double> ends = in_u ? std::vector{range[0], range[1]} : std::vector{range[2], range[3]};
  std::vector<double> inside;
  inside.reserve(across.size());
  for (const double t : across) inside.push_back(std::clamp(t, range[in_u ? 2 : 0], range[in_u ? 3 : 1]));
  const std::vector<Vec3> points =
      in_u ? nurbs::evaluate_grid(surface, ends, inside) : nurbs::evaluate_grid(surface, inside, ends);
  double gap = 0;
  for (std::size_t i = 0; i < inside.size(); ++i)
    gap = std::max(gap, in_u ? (points[2 * i] - points[2 * i + 1]).norm()
                             : (points[i] - points[inside.size() + i]).norm());
  return gap;
}

void note_largest(const DirectoryEntry& entry, double size, Bounds& bounds) {
  if (entry.transformation != 0 || size <= bounds.largest_found) return;
  bounds.largest_found = size;
  bounds.largest_entity = entry.name();
}

}  // namespace

void check_curve(const DirectoryEntry& entry, const Values& values, Bounds& bounds, Findings& findings) {
  Numbers numbers(entry, values, findings);
  nurbs::Curve curve;
  const int last = numbers.integer();
  curve.degree = numbers.integer();
  if (curve.degree < 1 || last < curve.degree) {
    numbers.defect(fmt::format("degree {} with {} control points", curve.degree, last + 1), 2);
    return;
  }
  const auto count = static_cast<std::size_t>(last) + 1;
  const bool planar = numbers.integer() == 1, closed = numbers.integer() == 1,
             polynomial = numbers.integer() == 1, periodic = numbers.integer() == 1;
  const std::size_t knots = numbers.at();
  curve.knots = numbers.take(count + static_cast<std::size_t>(curve.degree) + 1);
  const std::size_t weights = numbers.at();
  curve.weights = numbers.take(count);
  curve.points = numbers.points(count);
  const std::size_t range = numbers.at();
  const double first = numbers.take(), end = numbers.take();
  const Vec3 normal = numbers.points(1)[0];
  numbers.check_knots(curve.knots, curve.degree, knots, "", [&](std::size_t i) {
    return i + 1 < count && meet(curve.points[i], curve.points[i + 1], bounds.resolution);
  });
  numbers.check_weights(curve.weights, polynomial, weights, 5, "PROP3");
  numbers.check_range(first, end, curve.first_parameter(), curve.last_parameter(), "", range);
  if (!numbers.is_sound() || curve.degree > nurbs::max_degree) return;
  const double size = largest_of(curve.points).value_or(0);
  const double gap = (nurbs::evaluate(curve, first) - nurbs::evaluate(curve, end)).norm();
  check_closed(numbers, closed, periodic, gap, size, entry.use == 5 ? 0 : bounds.resolution, "PROP2", "", 4);
  if (planar && normal.norm() > 0) {
    double low = INFINITY, high = -INFINITY;
    for (const Vec3& point : curve.points) {
      low = std::min(low, point.dot(normal.normalized()));
      high = std::max(high, point.dot(normal.normalized()));
    }
    if (high - low > std::max(1e-6 * size, bounds.resolution))
      numbers.warning(
          fmt::format("PROP1 says that it is planar, and it leaves its plane by {:.3g}", high - low), 3,
          high - low);
  }
  if (entry.use != 5 && entry.subordinate == 0) note_largest(entry, size, bounds);
}

void check_surface(const DirectoryEntry& entry, const Values& values, Bounds& bounds, Findings& findings) {
  Numbers numbers(entry, values, findings);
  nurbs::Surface surface;
  surface.count_u = numbers.integer() + 1;
  surface.count_v = numbers.integer() + 1;
  surface.degree_u = numbers.integer();
  surface.degree_v = numbers.integer();
  if (surface.degree_u < 1 || surface.degree_v < 1 || surface.count_u <= surface.degree_u ||
      surface.count_v <= surface.degree_v) {
    numbers.defect(fmt::format("degrees {} x {} with {} x {} control points", surface.degree_u,
                               surface.degree_v, surface.count_u, surface.count_v),
                   3);
    return;
  }
  std::array<bool, 5> flags{};
  for (bool& flag : flags) flag = numbers.integer() == 1;
  const std::size_t knots_u = numbers.at();
  surface.knots_u = numbers.take(static_cast<std::size_t>(surface.count_u + surface.degree_u) + 1);
  const std::size_t knots_v = numbers.at();
  surface.knots_v = numbers.take(static_cast<std::size_t>(surface.count_v + surface.degree_v) + 1);
  const auto count = static_cast<std::size_t>(surface.count_u) * static_cast<std::size_t>(surface.count_v);
  const std::size_t weights = numbers.at();
  surface.weights = numbers.take(count);
  surface.points = numbers.points(count);
  const std::size_t range_at = numbers.at();
  std::array<double, 4> range{};
  for (double& value : range) value = numbers.take();
  const auto rows_are_one = [&](bool in_u, std::size_t i) {
    const int at = static_cast<int>(i);
    if (at + 1 >= (in_u ? surface.count_u : surface.count_v)) return false;
    for (int k = 0; k < (in_u ? surface.count_v : surface.count_u); ++k) {
      const Vec3 &a = in_u ? surface.point(at, k) : surface.point(k, at),
                 &b = in_u ? surface.point(at + 1, k) : surface.point(k, at + 1);
      if (!meet(a, b, bounds.resolution)) return false;
    }
    return true;
  };
  numbers.check_knots(surface.knots_u, surface.degree_u, knots_u, " in u",
                      [&](std::size_t i) { return rows_are_one(true, i); });
  numbers.check_knots(surface.knots_v, surface.degree_v, knots_v, " in v",
                      [&](std::size_t i) { return rows_are_one(false, i); });
  numbers.check_weights(surface.weights, flags[2], weights, 7, "PROP3");
  note_largest(entry, largest_of(surface.points).value_or(0), bounds);
  if (!numbers.is_sound()) return;
  const double first_u = surface.first_u(), last_u = surface.last_u(), first_v = surface.first_v(),
               last_v = surface.last_v();
  const bool swapped = range != std::array{first_u, last_u, first_v, last_v} &&
                       range == std::array{first_u, first_v, last_u, last_v};
  if (swapped) {
    numbers.defect("the range is given as U0, V0, U1, V1; the standard has U0, U1, V0, V1", range_at);
    return;
  }
  numbers.check_range(range[0], range[1], first_u, last_u, " in u", range_at);
  numbers.check_range(range[2], range[3], first_v, last_v, " in v", range_at + 2);
  if (!numbers.is_sound() || std::max(surface.degree_u, surface.degree_v) > nurbs::max_degree) return;
  const double size = largest_of(surface.points).value_or(0);
  check_closed(numbers, flags[0], flags[3], largest_gap(surface, true, range), size, bounds.resolution,
               "PROP1", " in u", 5);
  check_closed(numbers, flags[1], flags[4], largest_gap(surface, false, range), size, bounds.resolution,
               "PROP2", " in v", 6);
}

void check_matrix(const DirectoryEntry& entry, const Values& values, Findings& findings) {
  Numbers numbers(entry, values, findings);
  Eigen::Matrix3d rotation;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rotation(row, column) = numbers.take();
    numbers.take();
  }
  const double determinant = rotation.determinant();
  if (std::abs(determinant) < 1e-9) {
    numbers.defect(fmt::format("it is singular: its determinant is {:.3g}", determinant), 1);
    return;
  }
  if (entry.form > 1) return;
  const double off = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (off > 1e-5)
    numbers.defect(fmt::format("it is no rotation: it scales or shears by {:.3g}", off), 1);
  else if ((determinant > 0) != (entry.form == 0))
    numbers.defect(fmt::format("form {} {} left-handed, and the determinant is {:.3g}", entry.form,
                               entry.form == 0 ? "is not" : "is", determinant),
                   1);
}

void check_color(const DirectoryEntry& entry, const Values& values, Findings& findings) {
  Numbers numbers(entry, values, findings);
  for (std::size_t i = 1; i <= 3; ++i) {
    const double percent = numbers.take();
    if (!(percent >= 0 && percent <= 100)) numbers.defect(fmt::format("a share of {} percent", percent), i);
  }
}

}  // namespace selvage::formats::iges
