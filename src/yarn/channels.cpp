#include "yarn/channels.h"

#include <algorithm>

#include "nurbs/divided.h"

namespace selvage::yarn {

Channels::Channels(const FrameField& frames, const SizeProfile& sizes, const TubeSpec& spec, double twist,
                   int pieces)
    : frames_(frames), sizes_(sizes), spec_(spec), twist_(twist), pieces_(pieces) {
  affine_ = is_affine(spec.section) || sizes.parameters().size() == 1;
  const SizeProfile::Values first = sizes.at(0.0).value;
  // A constant size needs no scaling: the outline of that size itself is swept.
  unit_ = make_outline(spec.section, SectionSize{first[0], first[1]}, pieces, !affine_);
  if (affine_)
    for (Vec2& p : unit_.points) p = p.array() / Eigen::Array2d(0.5 * first[0], 0.5 * first[1]);
  const std::vector<double> us = nurbs::divided(unit_.knots, unit_.degree, 2);
  nurbs::Curve outline{unit_.degree, unit_.knots, {}, {}};
  for (const Vec2& p : unit_.points) outline.points.emplace_back(p.x(), p.y(), 0.0);
  constexpr double between = 1.02;  // what lies between them reaches further by less than this
  round_.resize(static_cast<Eigen::Index>(us.size()), 2);
  for (Eigen::Index i = 0; i < round_.rows(); ++i)
    round_.row(i) = between * nurbs::evaluate(outline, us[static_cast<std::size_t>(i)]).head<2>().transpose();
  extent_ = std::sqrt(round_.square().rowwise().sum().maxCoeff());
  is_round_ = std::holds_alternative<Circle>(spec.section) && sizes.parameters().size() == 1;
  const Eigen::Array2d scale =
      affine_ ? Eigen::Array2d(0.5 * first[0], 0.5 * first[1]) : Eigen::Array2d::Ones();
  for (const Vec2& p : unit_.points) reach_ = std::max(reach_, (p.array() * scale).matrix().norm());
  reach_ /= std::max(first[0], first[1]);
}

Slide Channels::sample(double t, std::span<Vec3> values, std::span<Vec3> slopes) const {
  const Frame frame = frames_.at(t);
  const SizeProfile::Jet size = sizes_.at(t);
  double angle = size.value[2];
  if (twist_ != 0.0) angle += twist_ * frames_.length_at(t);
  const double c = std::cos(angle), s = std::sin(angle);
  const Vec3 a = c * frame.across + s * frame.up, b = -s * frame.across + c * frame.up;
  // a' and b' of a frame that turns at `rate` against the rotation-minimizing one.
  const double rate = size.slope[2] + twist_ * frame.speed + frame.turn_dt;
  Slide slide;
  slide.tangent = frame.tangent;
  const double w = 0.5 * size.value[0], h = 0.5 * size.value[1];
  const double reach = reach_ * std::max(size.value[0], size.value[1]);
  const double curvature = frame.tangent_dt.norm() / frame.speed;
  const double least_speed = frame.speed * std::max(1.0 - curvature * reach, 0.1);
  slide.bend = curvature * frame.speed / least_speed;
  if (!is_round_)
    slide.slip = std::min(
        1.0, (reach * std::abs(rate) + 0.5 * std::hypot(size.slope[0], size.slope[1])) / least_speed);
  const std::vector<Vec2> points = affine_ ? std::vector<Vec2>() : control_at(size.value);
  if (affine_) {
    values[0] = frame.position;
    values[1] = w * a;
    values[2] = h * b;
  } else {
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = frame.position + points[i].x() * a + points[i].y() * b;
  }
  if (slopes.empty()) return slide;
  const Vec3 a_dt = -frame.tangent_dt.dot(a) * frame.tangent + rate * b;
  const Vec3 b_dt = -frame.tangent_dt.dot(b) * frame.tangent - rate * a;
  const Vec3 c_dt = frame.speed * frame.tangent;
  if (affine_) {
    slopes[0] = c_dt;
    slopes[1] = w * a_dt + 0.5 * size.slope[0] * a;
    slopes[2] = h * b_dt + 0.5 * size.slope[1] * b;
    return slide;
  }
  const std::vector<Vec2> points_dt = control_slope(size);
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    const Vec2 &p = points[i], &q = points_dt[i];
    slopes[i] = c_dt + p.x() * a_dt + p.y() * b_dt + q.x() * a + q.y() * b;
  }
  return slide;
}

double Channels::largest(std::span<const Vec3> deviation) const {
  if (!affine_) return bound(deviation);
  const Vec3 &c = deviation[0], &a = deviation[1], &b = deviation[2];
  const auto x = round_.col(0), y = round_.col(1);
  return std::sqrt(((c.x() + x * a.x() + y * b.x()).square() + (c.y() + x * a.y() + y * b.y()).square() +
                    (c.z() + x * a.z() + y * b.z()).square())
                       .maxCoeff());
}

bool Channels::has_common_knots() const {
  if (affine_) return true;
  for (double t : sizes_.parameters()) {
    const SizeProfile::Values v = sizes_.at(t).value;
    if (make_outline(spec_.section, {v[0], v[1]}, pieces_, true).knots != unit_.knots) return false;
  }
  return true;
}

std::vector<Vec2> Channels::control_at(const SizeProfile::Values& v) const {
  return make_outline(spec_.section, {v[0], v[1]}, pieces_, true).points;
}

// Central differences along the size's own slope: the control points are smooth functions of width and
// height.
std::vector<Vec2> Channels::control_slope(const SizeProfile::Jet& size) const {
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

}  // namespace selvage::yarn
