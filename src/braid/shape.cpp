#include "braid/shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/wrapped.h"

namespace selvage::fabric {

namespace {

// Steps from a strip's edge over which a braider turns: the rest of the leg to the last crossing is straight.
constexpr double turning = 0.8;

struct Slope {
  double value = 0, derivative = 0;
};

// From 0 to 1 with vanishing first and second derivatives at both ends.
Slope smooth(double q) {
  if (q <= 0.0) return {0.0, 0.0};
  if (q >= 1.0) return {1.0, 0.0};
  return {q * q * q * (10.0 + q * (6.0 * q - 15.0)), 30.0 * q * q * (1.0 - q) * (1.0 - q)};
}

// The offset through the thickness, in amplitudes.
Slope offset(const BraidShape& shape, const Braider& braider, double t) {
  const double below = std::floor(t);
  auto first = static_cast<std::int64_t>(below), last = first + 1;
  if (braid_state(shape, braider, first) == 0) --first;  // across a turn from crossing to crossing
  if (braid_state(shape, braider, last) == 0) ++last;
  const int from = braid_state(shape, braider, first), to = braid_state(shape, braider, last);
  const double length = static_cast<double>(last - first) - 2.0 * shape.plateau;
  const Slope blend = smooth((t - static_cast<double>(first) - shape.plateau) / length);
  return {from + (to - from) * blend.value, (to - from) * blend.derivative / length};
}

// Way across the strip, in columns: there and back, rounded at both edges. `t` in steps on that way.
Slope zigzag(const BraidShape& shape, double t) {
  const double n = shape.carriers;
  t -= 2.0 * n * std::floor(t / (2.0 * n));
  const bool back = t > n;
  if (back) t = 2.0 * n - t;
  const double sign = back ? -1.0 : 1.0;
  const double edge = std::min(t, n - t);  // steps from the nearer edge
  if (edge >= turning) return {t, sign};
  // The circle that touches both legs: centre on the line through the corner, across the strip.
  const double slope = shape.column / shape.step;  // tan(angle)
  const double r = turn_radius(shape) / shape.step, x = edge;
  const double lift = r * std::hypot(1.0, slope) - std::sqrt(r * r - x * x);  // from the corner inward
  const double value = lift / slope, derivative = x / std::sqrt(r * r - x * x) / slope;
  return t < n - t ? Slope{value, sign * derivative} : Slope{n - value, sign * derivative};
}

}  // namespace

bool BraidShape::is_over(std::int64_t column_number) const {
  const std::int64_t period = std::int64_t{over} + under;
  return wrapped(column_number - (flat ? 1 : 0), period) < over;
}

int braid_state(const BraidShape& shape, const Braider& braider, std::int64_t k) {
  if (!shape.flat) {
    const bool on_top = shape.is_over(braider.start + braider.direction * k);
    return on_top ? braider.direction : -braider.direction;
  }
  const std::int64_t n = shape.carriers;
  const std::int64_t way = wrapped(braider.start + k, 2 * n);
  if (way % n == 0) return 0;
  const bool back = way > n;
  return shape.is_over(back ? 2 * n - way : way) != back ? 1 : -1;
}

Vec2 unit_at(std::int64_t k, std::int64_t n) {
  k = wrapped(k, n);
  std::int64_t eighth = 8 * k / n;
  // Within the first eighth of a turn, counted from the nearest axis.
  const bool backward = eighth % 2 == 1;
  const std::int64_t quarter = eighth / 2 + (backward ? 1 : 0);
  const std::int64_t rest = backward ? quarter * n - 4 * k : 4 * k - quarter * n;  // of 4 n
  const double angle = 0.5 * std::numbers::pi * static_cast<double>(rest) / static_cast<double>(n);
  Vec2 near(std::cos(angle), backward ? -std::sin(angle) : std::sin(angle));
  switch (quarter % 4) {
    case 0:
      return near;
    case 1:
      return {-near.y(), near.x()};
    case 2:
      return -near;
    default:
      return {near.y(), -near.x()};
  }
}

// The arc stays r (1 / cos(angle) - 1) away from the corner, with r = turning step / sin(angle).
double strip_columns(const BraidShape& shape, double angle) {
  return shape.carriers - 2.0 * turning / (1.0 + std::cos(angle / 180.0 * std::numbers::pi));
}

double turn_radius(const BraidShape& shape) {
  const double sine = shape.column / std::hypot(shape.column, shape.step);
  return turning * shape.step / sine;
}

BraidPoint braid_point(const BraidShape& shape, const Braider& braider, double t) {
  const double along = (t + 0.5) * shape.step;
  const Slope lift = offset(shape, braider, t);
  const double height = shape.amplitude * lift.value, climb = shape.amplitude * lift.derivative;
  if (shape.flat) {
    const Slope across = zigzag(shape, static_cast<double>(braider.start) + t);
    return {Vec3(along, shape.column * (across.value - 0.5 * shape.carriers), height),
            Vec3(shape.step, shape.column * across.derivative, climb)};
  }
  if (shape.planar)
    return {
        Vec3(along, shape.level_place(static_cast<double>(braider.start) + braider.direction * t), height),
        Vec3(shape.step, shape.column * braider.direction, climb)};
  const double turn = 2.0 * std::numbers::pi / shape.carriers;  // a column
  const double angle = turn * (static_cast<double>(braider.start) + braider.direction * t);
  const double r = shape.radius + height, rate = turn * braider.direction;
  const double c = std::cos(angle), s = std::sin(angle);
  return {Vec3(r * c, r * s, along), Vec3(climb * c - r * rate * s, climb * s + r * rate * c, shape.step)};
}

}  // namespace selvage::fabric
