#include "yarn/line_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "nurbs/basis.h"
#include "nurbs/measure.h"
#include "yarn/ends.h"

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

// The frame across the tangent, and the section's sizes.
void measure(const nurbs::Curve& section, LineSample& sample) {
  constexpr int extents = 8;
  const Vec3 first = nurbs::evaluate(section, section.first_parameter()) - sample.position;
  sample.side = first - first.dot(sample.tangent) * sample.tangent;
  // A yarn may run to a point: any direction across does there.
  sample.side = sample.side.squaredNorm() > 0.0 ? Vec3(sample.side.normalized())
                                                : Vec3(sample.tangent.unitOrthogonal());
  sample.up = sample.tangent.cross(sample.side);
  sample.radius = std::sqrt(std::abs(area_vector(section).dot(sample.tangent)) / std::numbers::pi);
  Eigen::AlignedBox2d box;
  const auto extend = [&](double u) {
    const Vec3 p = nurbs::evaluate(section, u) - sample.position;
    box.extend(Vec2(p.dot(sample.side), p.dot(sample.up)));
  };
  const std::vector<double> knots = nurbs::breakpoints(section.knots, section.degree);
  for (std::size_t k = 1; k < knots.size(); ++k)
    for (int i = 0; i < extents; ++i) extend(std::lerp(knots[k - 1], knots[k], 1.0 * i / extents));
  extend(knots.back());
  sample.width = box.sizes().x();
  sample.height = box.sizes().y();
}

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
    measure(nurbs::row_at(body.surface, t), sample);
    samples.push_back(sample);
  }
  return samples;
}

const std::vector<LineSample>& LineSampler::sample(const Body& body, double tolerance) {
  constexpr std::size_t most_kept = 200'000;
  const Vec3& start = body.axis.points.front();
  const auto known = body.shape > 0 ? known_.find(body.shape) : known_.end();
  if (known == known_.end()) {
    samples_ = line_samples(body, tolerance);
    if (body.shape > 0 && kept_ + samples_.size() <= most_kept) {
      kept_ += samples_.size();
      known_.try_emplace(body.shape, Known{start, samples_});
    }
    return samples_;
  }
  samples_ = known->second.samples;
  for (LineSample& sample : samples_) sample.position += start - known->second.start;
  return samples_;
}

}  // namespace selvage::yarn
