#include "weave/pucker_shape.h"

#include <cmath>
#include <numbers>

#include "core/wrapped.h"

namespace selvage::fabric {

namespace {

using std::numbers::pi;

}  // namespace

PuckerShape::Window PuckerShape::window(double y) const {
  const double period = (tight + slack) * pitch, width = (slack + 1) * pitch;
  const double first = (tight - 0.5) * pitch;  // the last tight warp's place
  const double within = y - first - period * std::floor((y - first) / period);
  if (within >= width) return {};
  const double u = pi * within / width, s = std::sin(u);
  return {s * s, 2.0 * s * std::cos(u) * pi / width};
}

double PuckerShape::height(const Vec3& flat) const {
  return amplitude * std::cos(2.0 * pi * flat.x() / wave) * window(flat.y()).value;
}

Vec3 PuckerShape::normal(const Vec3& flat) const {
  const double turn = 2.0 * pi * flat.x() / wave;
  const Window across = window(flat.y());
  return Vec3(amplitude * 2.0 * pi / wave * std::sin(turn) * across.value,
              -amplitude * std::cos(turn) * across.slope, 1.0)
      .normalized();
}

bool PuckerShape::is_slack(long long warp) const {
  return wrapped<long long>(warp, tight + slack) >= tight;
}

double PuckerShape::most_curvature() const {
  const double along = 2.0 * pi / wave, across = pi / ((slack + 1) * pitch);
  return amplitude * (along * along + 2.0 * across * across);
}

}  // namespace selvage::fabric
