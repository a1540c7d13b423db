#include "cad/natural_border.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "cad/sampled_curve.h"
#include "nurbs/divided.h"
#include "nurbs/turn.h"

namespace selvage::cad {

namespace {

constexpr double flat_tolerance = 1e-6;      // of the parameters' range
constexpr double coverage_slack = 0.01;      // of a side: a closed chain covers it a whole number of times
constexpr std::size_t most_tests = 400'000;  // distances a side and edge

std::vector<double> sample_parameters(const std::vector<double>& knots, int degree, int least) {
  return nurbs::divided(knots, degree, degree == 1 ? 1 : 4, least);
}

// One side of the surface: u or v is fixed.
class Side {
 public:
  Side(const nurbs::Surface& surface, bool along_u, bool last) : surface_(&surface), along_u_(along_u) {
    fixed_ = along_u ? (last ? surface.last_v() : surface.first_v())
                     : (last ? surface.last_u() : surface.first_u());
    parameters_ = along_u ? sample_parameters(surface.knots_u, surface.degree_u, 16)
                          : sample_parameters(surface.knots_v, surface.degree_v, 16);
    points_ = along_u ? nurbs::evaluate_grid(surface, parameters_, {fixed_})
                      : nurbs::evaluate_grid(surface, {fixed_}, parameters_);
    length_ = nurbs::length_of(points_);
  }

  [[nodiscard]] bool along_u() const { return along_u_; }
  [[nodiscard]] double fixed() const { return fixed_; }
  [[nodiscard]] double first() const { return parameters_.front(); }
  [[nodiscard]] double last() const { return parameters_.back(); }
  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }
  [[nodiscard]] bool is_closed(double tolerance) const {
    return (points_.front() - points_.back()).norm() <= tolerance;
  }

  // Any place within `enough` will do.
  [[nodiscard]] NearestOnCurve nearest(const Vec3& p, double enough) const {
    return nearest_on(parameters_, points_, p, enough, [&](double t) -> nurbs::CurveJet {
      const nurbs::SurfaceJet jet =
          along_u_ ? nurbs::evaluate_jet(*surface_, t, fixed_) : nurbs::evaluate_jet(*surface_, fixed_, t);
      return {jet.position, along_u_ ? jet.du : jet.dv, Vec3::Zero()};
    });
  }

 private:
  const nurbs::Surface* surface_;
  bool along_u_;
  double fixed_ = 0;
  std::vector<double> parameters_;
  std::vector<Vec3> points_;
  double length_ = 0;
};

// How often the edges run along a side, in shares of it: all of them, and with signs.
struct Coverage {
  double all = 0, directed = 0;

  void add(double share) {
    all += std::abs(share);
    directed += share;
  }
};

std::optional<double> share_by_flat(const Side& side, const nurbs::Curve& flat,
                                    const nurbs::Surface& surface) {
  const int across = side.along_u() ? 1 : 0;
  const double width =
      side.along_u() ? surface.last_v() - surface.first_v() : surface.last_u() - surface.first_u();
  const double length = side.last() - side.first();
  for (const Vec3& p : flat.points) {
    if (std::abs(p[across] - side.fixed()) > flat_tolerance * width) return std::nullopt;
    if (p[1 - across] < side.first() - flat_tolerance * length ||
        p[1 - across] > side.last() + flat_tolerance * length)
      return std::nullopt;
  }
  const Vec3 from = nurbs::evaluate(flat, flat.first_parameter()),
             to = nurbs::evaluate(flat, flat.last_parameter());
  return (to[1 - across] - from[1 - across]) / length;
}

// Nothing where the curve leaves the side, or does not run along it in one direction.
std::optional<double> share_in_space(const Side& side, const std::vector<Vec3>& points, double tolerance) {
  const double period = side.last() - side.first();
  const bool closed = side.is_closed(tolerance);
  const double slack = 1e-6 * period + period * tolerance / side.length();
  const std::size_t stride = std::max<std::size_t>(1, points.size() * side.points().size() / most_tests);
  double sum = 0, before = 0, sign = 0;
  for (std::size_t i = 0; i < points.size();
       i = i + 1 == points.size() ? i + 1 : std::min(i + stride, points.size() - 1)) {
    const NearestOnCurve foot = side.nearest(points[i], tolerance);
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

class Border {
 public:
  Border(const nurbs::Surface& surface, double tolerance)
      : surface_(surface),
        tolerance_(tolerance),
        sides_{Side(surface, true, false), Side(surface, false, true), Side(surface, true, true),
               Side(surface, false, false)} {}

  // False where it leaves the border.
  bool add(const Edge& edge) {
    if (!edge.flat.points.empty())
      for (std::size_t i = 0; i < 4; ++i)
        if (const auto share = share_by_flat(sides_[i], edge.flat, surface_)) {
          coverage_[i].add(*share);
          return true;
        }
    if (edge.curve.points.empty()) return edge.flat.points.empty();  // a pole
    const std::vector<double> parameters =
        sample_parameters(edge.curve.knots, edge.curve.degree, edge.curve.degree == 1 ? 2 : 12);
    std::vector<Vec3> points;
    points.reserve(parameters.size());
    for (const double t : parameters) points.push_back(nurbs::evaluate(edge.curve, t));
    if (nurbs::length_of(points) <= tolerance_) return true;
    for (std::size_t i = 0; i < 4; ++i) {
      if (sides_[i].length() <= tolerance_) continue;
      if (const auto share = share_in_space(sides_[i], points, tolerance_)) {
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
        if (sides_[side].length() > tolerance_ &&
            !(is_near(coverage_[side].all, 1) && is_near(std::abs(coverage_[side].directed), 1)))
          return false;
    }
    return true;
  }

 private:
  // Do the opposite sides i and i + 2 coincide?
  [[nodiscard]] bool is_seam(std::size_t i) const {
    const std::vector<Vec3>&a = sides_[i].points(), &b = sides_[i + 2].points();
    for (std::size_t k = 0; k < a.size(); ++k)
      if ((a[k] - b[k]).norm() > tolerance_) return false;
    return sides_[i].length() > tolerance_;
  }

  const nurbs::Surface& surface_;
  double tolerance_;
  std::array<Side, 4> sides_;  // round the domain: first v, last u, last v, first u
  std::array<Coverage, 4> coverage_{};
};

nurbs::Curve flat_line(const Vec3& from, const Vec3& to, double t0, double t1) {
  return {.degree = 1, .knots = {t0, t0, t1, t1}, .points = {from, to}, .weights = {}};
}

}  // namespace

double border_tolerance(const Face& face, double resolution) {
  Box3 box;
  for (const Vec3& p : face.surface.points) box.extend(p);
  const double size = box.sizes().norm();
  return std::clamp(resolution, 1e-7 * size, 1e-5 * size);
}

bool has_natural_border(const Face& face, double tolerance) {
  if (face.loops.empty()) return true;
  Border border(face.surface, tolerance);
  for (const Loop& loop : face.loops)
    for (const Edge& edge : loop.edges)
      if (!border.add(edge)) return false;
  return border.is_covered();
}

bool drop_natural_border(Face& face, double tolerance) {
  if (!has_natural_border(face, tolerance)) return false;
  face.loops.clear();
  return true;
}

Loop natural_border(const nurbs::Surface& given, double tolerance) {
  const nurbs::Surface surface = nurbs::clamped(given);
  const double u0 = surface.first_u(), u1 = surface.last_u(), v0 = surface.first_v(), v1 = surface.last_v();
  const std::array<Vec3, 4> corners = {Vec3(u0, v0, 0), Vec3(u1, v0, 0), Vec3(u1, v1, 0), Vec3(u0, v1, 0)};
  Loop loop;
  for (std::size_t i = 0; i < 4; ++i) {
    const bool along_u = i % 2 == 0, last = i == 1 || i == 2;
    Edge edge;
    edge.curve = along_u ? nurbs::boundary_row(surface, last) : nurbs::boundary_column(surface, last);
    if (i >= 2) edge.curve = nurbs::reversed(edge.curve);
    edge.flat = flat_line(corners[i], corners[(i + 1) % 4], edge.curve.first_parameter(),
                          edge.curve.last_parameter());
    if (Side(surface, along_u, last).length() <= tolerance) edge.curve = {};
    loop.edges.push_back(std::move(edge));
  }
  return loop;
}

}  // namespace selvage::cad
