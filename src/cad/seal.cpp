#include "cad/seal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cad/tube.h"

namespace selvage::cad {

namespace {

using yarn::EndStyle;

nurbs::Curve first_column(const nurbs::Surface& surface) {
  return nurbs::boundary_row(transposed(surface), false);
}
nurbs::Curve last_column(const nurbs::Surface& surface) {
  return nurbs::boundary_row(transposed(surface), true);
}

// Round the patch: v = first, u = last, v = last backwards, u = first backwards.
std::vector<nurbs::Curve> sides_of(const nurbs::Surface& patch) {
  return {nurbs::boundary_row(patch, false), last_column(patch),
          nurbs::reversed(nurbs::boundary_row(patch, true)), nurbs::reversed(first_column(patch))};
}

double parameter_at(const nurbs::Curve& curve, double share) {
  return curve.first_parameter() + share * (curve.last_parameter() - curve.first_parameter());
}

bool is_flat(const nurbs::Surface& surface) {
  const double size = extent(surface.points);
  Vec3 normal = Vec3::Zero();
  for (int j = 0; j + 1 < surface.count_v; ++j)
    for (int i = 0; i + 1 < surface.count_u; ++i)
      normal += (surface.point(i + 1, j) - surface.point(i, j))
                    .cross(surface.point(i, j + 1) - surface.point(i, j));
  if (!(normal.norm() > 0)) return false;
  normal.normalize();
  return std::all_of(surface.points.begin(), surface.points.end(), [&](const Vec3& p) {
    return std::abs((p - surface.points.front()).dot(normal)) <= 1e-7 * size;
  });
}

void measure_border(Cap& cap) {
  cap.middle = middle_of(cap.border);
  Box3 box;
  for (const nurbs::Curve& side : cap.border)
    for (const Vec3& p : side.points) box.extend(p);
  cap.size = box.sizes().maxCoeff();
}

// A closed curve, ready to be asked for its parameter nearest to a point.
class Locator {
 public:
  explicit Locator(const nurbs::Curve& curve) : curve_(curve) {
    const std::vector<double> breaks = nurbs::breakpoints(curve.knots, curve.degree);
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
      for (int i = 0; i < samples; ++i)
        parameters_.push_back(breaks[k] + (breaks[k + 1] - breaks[k]) * i / samples);
    parameters_.push_back(breaks.back());
    for (const double t : parameters_) points_.push_back(nurbs::evaluate(curve, t));
  }

  struct Hit {
    double parameter = 0, distance = 0;
  };
  [[nodiscard]] Hit nearest(const Vec3& p) const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points_.size(); ++i)
      if ((points_[i] - p).squaredNorm() < (points_[best] - p).squaredNorm()) best = i;
    double low = parameters_[best == 0 ? 0 : best - 1];
    double high = parameters_[std::min(best + 1, parameters_.size() - 1)];
    double t = parameters_[best];
    for (int step = 0; step < 20; ++step) {  // Newton on the squared distance, kept in its bracket
      const nurbs::CurveJet jet = nurbs::evaluate_jet(curve_, t);
      const Vec3 off = jet.position - p;
      const double slope = off.dot(jet.d1), bend = jet.d1.squaredNorm() + off.dot(jet.d2);
      if (slope > 0) high = t;
      if (slope < 0) low = t;
      double next = bend > 0 ? t - slope / bend : 0.5 * (low + high);
      if (!(next >= low && next <= high)) next = 0.5 * (low + high);
      if (next == t) break;
      t = next;
    }
    const double found = (nurbs::evaluate(curve_, t) - p).norm(), sample = (points_[best] - p).norm();
    return found <= sample ? Hit{t, found} : Hit{parameters_[best], sample};
  }

 private:
  static constexpr int samples = 4;
  const nurbs::Curve& curve_;
  std::vector<double> parameters_;
  std::vector<Vec3> points_;
};

// The knot of the curve that is this parameter but for rounding; else the parameter.
double snapped(const nurbs::Curve& curve, double t) {
  const auto next = std::lower_bound(curve.knots.begin(), curve.knots.end(), t);
  const double range = curve.last_parameter() - curve.first_parameter();
  double best = t, distance = 1e-6 * range;
  for (const auto at : {next, next == curve.knots.begin() ? next : next - 1}) {
    if (at == curve.knots.end() || std::abs(*at - t) >= distance) continue;
    distance = std::abs(*at - t);
    best = *at;
  }
  return best;
}

bool is_knot(const nurbs::Curve& curve, double t) {
  return std::binary_search(curve.knots.begin(), curve.knots.end(), t);
}

// Does `side` run along `outline` between two of its parameters, in its speed?
bool runs_along(const nurbs::Curve& side, const nurbs::Curve& outline, double from, double to,
                double tolerance) {
  constexpr int steps = 8;
  for (int k = 0; k <= steps; ++k) {
    const double share = static_cast<double>(k) / steps;
    if ((nurbs::evaluate(side, parameter_at(side, share)) -
         nurbs::evaluate(outline, from + share * (to - from)))
            .norm() > tolerance)
      return false;
  }
  return true;
}

// The border lies on the outline, and passes it all.
bool lies_on(const std::vector<nurbs::Curve>& border, const nurbs::Curve& outline, double tolerance) {
  const Locator locator(outline);
  constexpr int steps = 16;
  std::vector<double> hits;
  for (const nurbs::Curve& side : border)
    for (int k = 0; k < steps; ++k) {
      const auto hit =
          locator.nearest(nurbs::evaluate(side, parameter_at(side, static_cast<double>(k) / steps)));
      if (hit.distance > tolerance) return false;
      hits.push_back(hit.parameter);
    }
  std::sort(hits.begin(), hits.end());
  const double range = outline.last_parameter() - outline.first_parameter();
  double gap = hits.front() + range - hits.back();  // across the seam
  for (std::size_t i = 1; i < hits.size(); ++i) gap = std::max(gap, hits[i] - hits[i - 1]);
  return gap < 0.3 * range;
}

// The patch turned and mirrored so that its first corner is at the outline's start and its first side runs
// with the outline.
std::optional<Fit> fit_patch(const Cap& cap, const nurbs::Curve& outline, double tolerance) {
  const double first = outline.first_parameter(), last = outline.last_parameter();
  const Locator locator(outline);
  nurbs::Surface patch = cap.surface;
  for (int mirrored = 0; mirrored < 2; ++mirrored) {
    for (int turn = 0; turn < 4; ++turn) {
      const std::vector<nurbs::Curve> sides = sides_of(patch);
      if ((sides[0].points.front() - outline.points.front()).norm() <= tolerance) {
        Fit fit;
        fit.quarters[0] = first;
        bool fits = true;
        for (std::size_t k = 1; k < 4; ++k) {
          const auto hit = locator.nearest(sides[k].points.front());
          fit.quarters[k] = snapped(outline, hit.parameter);
          fits = fits && hit.distance <= tolerance && fit.quarters[k] > fit.quarters[k - 1] &&
                 is_knot(outline, fit.quarters[k]);
        }
        for (std::size_t k = 0; k < 4 && fits; ++k)
          fits =
              runs_along(sides[k], outline, fit.quarters[k], k == 3 ? last : fit.quarters[k + 1], tolerance);
        if (fits) {
          fit.exact = true;
          fit.face.style = EndStyle::patch;
          fit.face.surface = std::move(patch);
          return fit;
        }
      }
      patch = reversed_v(transposed(patch));  // a quarter turn
    }
    patch = transposed(patch);
  }
  return std::nullopt;
}

std::optional<Fit> fit_fan(const Cap& cap, const nurbs::Curve& outline, double tolerance) {
  nurbs::Surface fan = cap.surface;
  for (int mirrored = 0; mirrored < 2; ++mirrored) {
    if (runs_along(nurbs::boundary_row(fan, false), outline, outline.first_parameter(),
                   outline.last_parameter(), tolerance)) {
      Fit fit;
      fit.exact = true;
      fit.face.style = EndStyle::fan;
      fit.face.surface = std::move(fan);
      return fit;
    }
    fan = reversed_u(fan);
  }
  return std::nullopt;
}

}  // namespace

Vec3 middle_of(const std::vector<nurbs::Curve>& border) {
  Vec3 sum = Vec3::Zero();
  double length = 0;
  for (const nurbs::Curve& side : border) {
    const std::vector<double> breaks = nurbs::breakpoints(side.knots, side.degree);
    Vec3 previous = nurbs::evaluate(side, breaks.front());
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
      for (const double share : {0.5, 1.0}) {
        const Vec3 p = nurbs::evaluate(side, breaks[k] + share * (breaks[k + 1] - breaks[k]));
        const double step = (p - previous).norm();
        sum += 0.5 * step * (p + previous);
        length += step;
        previous = p;
      }
  }
  return length > 0 ? Vec3(sum / length) : Vec3::Zero();
}

std::optional<Cap> as_cap(const Face& face) {
  Cap cap;
  if (!face.loops.empty()) {
    if (face.loops.size() != 1 || !is_flat(face.surface)) return std::nullopt;
    for (const Edge& edge : face.loops.front().edges) {
      if (edge.curve.points.empty()) return std::nullopt;
      cap.border.push_back(edge.curve);
    }
    cap.style = EndStyle::planar;
  } else if (std::optional<nurbs::Surface> fan = as_fan(face.surface)) {
    cap.style = EndStyle::fan;
    cap.surface = std::move(*fan);
    cap.border = {nurbs::boundary_row(cap.surface, false)};
  } else {
    cap.style = EndStyle::patch;
    cap.surface = clamped(face.surface);
    cap.border = sides_of(cap.surface);
  }
  if (cap.border.empty()) return std::nullopt;
  measure_border(cap);
  return cap;
}

std::optional<Fit> fit_cap(const Cap& cap, const nurbs::Curve& outline, double tolerance) {
  std::optional<Fit> fit;
  if (cap.style == EndStyle::patch) fit = fit_patch(cap, outline, tolerance);
  if (cap.style == EndStyle::fan) fit = fit_fan(cap, outline, tolerance);
  if (fit) return fit;
  if (!lies_on(cap.border, outline, tolerance)) return std::nullopt;
  fit = Fit{};
  fit->face.style = cap.style;
  fit->exact = cap.style == EndStyle::planar;
  return fit;
}

}  // namespace selvage::cad
