#include "yarn/line_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "nurbs/basis.h"
#include "nurbs/measure.h"

namespace selvage::yarn {

namespace {

constexpr int most_halvings = 16;

double distance_from_chord(const Vec3& p, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  const double square = along.squaredNorm();
  const double share = square > 0.0 ? std::clamp((p - from).dot(along) / square, 0.0, 1.0) : 0.0;
  return (p - from - share * along).norm();
}

// Appends the parameters after t0 up to t1.
void divide(const nurbs::Curve& axis, double tolerance, double t0, double t1, int halvings,
            std::vector<double>& parameters) {
  const Vec3 from = nurbs::evaluate(axis, t0), to = nurbs::evaluate(axis, t1);
  double farthest = 0.0;
  for (const double share : {0.25, 0.5, 0.75})
    farthest =
        std::max(farthest, distance_from_chord(nurbs::evaluate(axis, t0 + share * (t1 - t0)), from, to));
  if (halvings == most_halvings || farthest <= tolerance) return parameters.push_back(t1);
  const double middle = 0.5 * (t0 + t1);
  divide(axis, tolerance, t0, middle, halvings + 1, parameters);
  divide(axis, tolerance, middle, t1, halvings + 1, parameters);
}

// Of the section at one v.
class SectionAt {
 public:
  SectionAt(const nurbs::Surface& surface, double v) : surface_(surface), v_(v) {}

  // The frame across the tangent, and the section's sizes.
  void measure(LineSample& sample) {
    const std::vector<double> knots = nurbs::breakpoints(surface_.knots_u, surface_.degree_u);
    const Vec3 first = nurbs::evaluate(surface_, knots.front(), v_) - sample.position;
    sample.side = first - first.dot(sample.tangent) * sample.tangent;
    // A yarn may run to a point: any direction across does there.
    sample.side = sample.side.squaredNorm() > 0.0 ? Vec3(sample.side.normalized())
                                                  : Vec3(sample.tangent.unitOrthogonal());
    sample.up = sample.tangent.cross(sample.side);
    double area = 0.0;
    for (std::size_t k = 1; k < knots.size(); ++k) area += span(knots[k - 1], knots[k], sample);
    sample.radius = std::sqrt(std::abs(area) / std::numbers::pi);
    sample.width = box_.sizes().x();
    sample.height = box_.sizes().y();
  }

 private:
  // The area that a span sweeps as seen from the centre line (Green).
  double span(double u0, double u1, const LineSample& sample) {
    constexpr int extents = 8;
    const auto flat = [&](const Vec3& p) { return Vec2(p.dot(sample.side), p.dot(sample.up)); };
    for (int i = 0; i <= extents; ++i)
      box_.extend(flat(nurbs::evaluate(surface_, u0 + (u1 - u0) * i / extents, v_) - sample.position));
    const nurbs::GaussRule& rule = nurbs::gauss_rule(surface_.degree_u);
    double sum = 0.0;
    for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
      const nurbs::SurfaceJet jet =
          nurbs::evaluate_jet(surface_, 0.5 * (u0 + u1 + (u1 - u0) * rule.nodes[g]), v_);
      sum += rule.weights[g] * (jet.position - sample.position).cross(jet.du).dot(sample.tangent);
    }
    return 0.25 * (u1 - u0) * sum;
  }

  const nurbs::Surface& surface_;
  double v_;
  Eigen::AlignedBox2d box_;
};

}  // namespace

std::vector<LineSample> line_samples(const Body& body, double tolerance) {
  const std::vector<double> knots = nurbs::breakpoints(body.axis.knots, body.axis.degree);
  std::vector<double> parameters = {knots.front()};
  for (std::size_t k = 1; k < knots.size(); ++k)
    divide(body.axis, tolerance, knots[k - 1], knots[k], 0, parameters);
  std::vector<LineSample> samples;
  samples.reserve(parameters.size());
  for (const double t : parameters) {
    const nurbs::CurveJet jet = nurbs::evaluate_jet(body.axis, t);
    LineSample sample;
    sample.parameter = t;
    if (!samples.empty())
      sample.arc_length =
          samples.back().arc_length + nurbs::arc_length(body.axis, samples.back().parameter, t);
    sample.position = jet.position;
    const double speed = sample.speed = jet.d1.norm();
    sample.tangent = jet.d1.normalized();
    if (speed > 0.0) sample.curvature = jet.d1.cross(jet.d2).norm() / (speed * speed * speed);
    SectionAt(body.surface, t).measure(sample);
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace selvage::yarn
