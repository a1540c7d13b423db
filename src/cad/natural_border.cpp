#include "cad/natural_border.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "cad/edges.h"
#include "cad/sampled_curve.h"
#include "nurbs/divided.h"
#include "nurbs/turn.h"

namespace selvage::cad {

namespace {

constexpr double flat_tolerance = 1e-6;      // of the parameters' range
constexpr double coverage_slack = 0.01;      // of a side: a closed chain covers it a whole number of times
constexpr std::size_t most_tests = 400'000;  // distances a side and edge

std::vector<double> sample_parameters(const nurbs::Curve& curve, int least) {
  return nurbs::divided(curve.knots, curve.degree, curve.degree == 1 ? 1 : 4, least);
}

// One side of the surface: u or v is fixed.
struct BorderSide {
  BorderSide(nurbs::Curve side, bool is_along_u, double at)
      : curve(std::move(side)),
        along_u(is_along_u),
        fixed(at),
        samples(curve, sample_parameters(curve, 16)) {}
  // The samples refer to the curve.
  BorderSide(const BorderSide&) = delete;
  BorderSide& operator=(const BorderSide&) = delete;

  [[nodiscard]] double first() const { return samples.parameters.front(); }
  [[nodiscard]] double last() const { return samples.parameters.back(); }
  [[nodiscard]] bool is_closed(double tolerance) const {
    return (samples.points.front() - samples.points.back()).norm() <= tolerance;
  }

  nurbs::Curve curve;
  bool along_u;
  double fixed;
  SampledCurve samples;
  double length = samples.length();
};

// How often the edges run along a side, in shares of it: all of them, and with signs.
struct Coverage {
  double all = 0, directed = 0;

  void add(double share) {
    all += std::abs(share);
    directed += share;
  }
};

std::optional<double> share_by_flat(const BorderSide& side, const nurbs::Curve& flat,
                                    const nurbs::Surface& surface) {
  const int across = side.along_u ? 1 : 0;
  const double width =
      side.along_u ? surface.last_v() - surface.first_v() : surface.last_u() - surface.first_u();
  const double length = side.last() - side.first();
  for (const Vec3& p : flat.points) {
    if (std::abs(p[across] - side.fixed) > flat_tolerance * width) return std::nullopt;
    if (p[1 - across] < side.first() - flat_tolerance * length ||
        p[1 - across] > side.last() + flat_tolerance * length)
      return std::nullopt;
  }
  return (at_share(flat, 1) - at_share(flat, 0))[1 - across] / length;
}

// Nothing where the curve leaves the side, or does not run along it in one direction.
std::optional<double> share_in_space(const BorderSide& side, const std::vector<Vec3>& points,
                                     double tolerance) {
  const double period = side.last() - side.first();
  const bool closed = side.is_closed(tolerance);
  const double slack = 1e-6 * period + period * tolerance / side.length;
  const std::size_t stride =
      std::max<std::size_t>(1, points.size() * side.samples.points.size() / most_tests);
  double sum = 0, before = 0, sign = 0;
  for (std::size_t i = 0; i < points.size();
       i = i + 1 == points.size() ? i + 1 : std::min(i + stride, points.size() - 1)) {
    const NearestOnCurve foot = side.samples.nearest(points[i], tolerance);
    if (foot.distance > tolerance) return std::nullopt;
    if (i > 0) {
      double step = foot.parameter - before;
      if (closed && step > period / 2) step -= period;
      if (closed && step < -period / 2) step += period;
      if (std::abs(step) > slack) {
        if (sign * step < 0) return std::nullopt;
        sign = step;
      }
      sum += step;
    }
    before = foot.parameter;
  }
  return sum / period;
}

bool is_near(double value, double wanted) {
  return std::abs(value - wanted) <= coverage_slack;
}

class NaturalBorder {
 public:
  NaturalBorder(const nurbs::Surface& surface, double tolerance)
      : NaturalBorder(surface, tolerance, sides_of(surface)) {}

  // False where it leaves the border.
  bool add(const Edge& edge) {
    if (!edge.flat.points.empty())
      for (std::size_t i = 0; i < 4; ++i)
        if (const auto share = share_by_flat(sides_[i], edge.flat, surface_)) {
          coverage_[i].add(*share);
          return true;
        }
    if (edge.curve.points.empty()) return edge.flat.points.empty();  // a pole
    const SampledCurve samples(edge.curve, sample_parameters(edge.curve, edge.curve.degree == 1 ? 2 : 12));
    if (samples.length() <= tolerance_) return true;
    for (std::size_t i = 0; i < 4; ++i) {
      if (sides_[i].length <= tolerance_) continue;
      if (const auto share = share_in_space(sides_[i], samples.points, tolerance_)) {
        coverage_[i].add(*share);
        return true;
      }
    }
    return false;
  }

  [[nodiscard]] bool is_covered() const {
    for (std::size_t i = 0; i < 2; ++i) {
      if (is_seam(i)) {
        const double all = coverage_[i].all + coverage_[i + 2].all;
        const double directed = coverage_[i].directed + coverage_[i + 2].directed;
        if (!is_near(all, 0) && !(is_near(all, 2) && is_near(directed, 0))) return false;
        continue;
      }
      for (const std::size_t side : {i, i + 2})
        if (sides_[side].length > tolerance_ &&
            !(is_near(coverage_[side].all, 1) && is_near(std::abs(coverage_[side].directed), 1)))
          return false;
    }
    return true;
  }

 private:
  // `sides` as of sides_of().
  NaturalBorder(const nurbs::Surface& surface, double tolerance, std::array<nurbs::Curve, 4> sides)
      : surface_(surface),
        tolerance_(tolerance),
        sides_{BorderSide(std::move(sides[2]), true, surface.first_v()),
               BorderSide(std::move(sides[1]), false, surface.last_u()),
               BorderSide(std::move(sides[3]), true, surface.last_v()),
               BorderSide(std::move(sides[0]), false, surface.first_u())} {}
  // Do the opposite sides i and i + 2 coincide?
  [[nodiscard]] bool is_seam(std::size_t i) const {
    return sides_[i].length > tolerance_ &&
           largest_difference(sides_[i].samples.points, sides_[i + 2].samples.points) <= tolerance_;
  }

  const nurbs::Surface& surface_;
  double tolerance_;
  std::array<BorderSide, 4> sides_;  // round the domain: first v, last u, last v, first u
  std::array<Coverage, 4> coverage_{};
};

}  // namespace

double border_tolerance(const Face& face, double resolution) {
  const double size = box_of(face.surface.points).sizes().norm();
  return std::clamp(resolution, 1e-7 * size, 1e-5 * size);
}

bool has_natural_border(const Face& face, double tolerance) {
  if (face.loops.empty()) return true;
  NaturalBorder border(face.surface, tolerance);
  for (const Edge& edge : edges_of(face))
    if (!border.add(edge)) return false;
  return border.is_covered();
}

bool drop_natural_border(Face& face, double tolerance) {
  if (!has_natural_border(face, tolerance)) return false;
  if (!face.loops.empty()) face.border = std::exchange(face.loops, {});
  return true;
}

Loop natural_border(const nurbs::Surface& given, double tolerance) {
  const nurbs::Surface surface = nurbs::clamped(given);
  const double u0 = surface.first_u(), u1 = surface.last_u(), v0 = surface.first_v(), v1 = surface.last_v();
  const std::array<Vec3, 4> corners = {Vec3(u0, v0, 0), Vec3(u1, v0, 0), Vec3(u1, v1, 0), Vec3(u0, v1, 0)};
  std::array<nurbs::Curve, 4> sides = nurbs::boundary_round(surface);
  Loop loop;
  for (std::size_t i = 0; i < 4; ++i) {
    Edge& edge = loop.edges.emplace_back();
    edge.flat = nurbs::segment(corners[i], corners[(i + 1) % 4], sides[i].first_parameter(),
                               sides[i].last_parameter());
    if (SampledCurve(sides[i]).length() > tolerance) edge.curve = std::move(sides[i]);
  }
  return loop;
}

}  // namespace selvage::cad
