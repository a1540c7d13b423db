#include "weave/interlacing.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "yarn/arcs.h"

namespace selvage::fabric {

// The vector from one arc's centre to the other's is (p, h - D): its length is the hypotenuse of the straight
// and D.
std::optional<Bridge> find_bridge(double pitch, double height, double spread) {
  const double drop = spread - height;
  const double straight_squared = pitch * pitch + drop * drop - spread * spread;
  // A jammed bridge has no straight: what rounding leaves of it is none, not a piece too short to be swept.
  const double rounding = 1e-12 * spread * spread;
  if (!(pitch > 0.0) || straight_squared < -rounding) return std::nullopt;
  Bridge bridge;
  bridge.straight = straight_squared < rounding ? 0.0 : std::sqrt(straight_squared);
  bridge.angle = std::atan2(pitch, drop) - std::atan2(bridge.straight, spread);
  if (bridge.angle > 0.5 * std::numbers::pi + 1e-9) return std::nullopt;
  return bridge;
}

double smallest_pitch(double height, double spread) {
  return height >= spread ? spread : std::sqrt(height * (2.0 * spread - height));
}

double largest_height(double pitch, double spread) {
  if (pitch >= spread) return std::numeric_limits<double>::infinity();
  return pitch <= 0.0 ? 0.0 : spread - std::sqrt(spread * spread - pitch * pitch);
}

Obstacle obstacle_of(Bend bend, const yarn::SectionSize& other, double own_thickness, double clearance) {
  const double own = 0.5 * own_thickness + clearance;
  switch (bend) {
    case Bend::round:
      break;
    case Bend::lens:
      return {0.0, (other.width * other.width + other.height * other.height) / (4.0 * other.height) + own};
    case Bend::racetrack:
      if (other.width >= other.height) return {0.5 * (other.width - other.height), 0.5 * other.height + own};
      return {0.0, 0.5 * other.width + own};
  }
  return {0.0, 0.5 * other.height + own};
}

Result<yarn::CentreLine> bridge_passes(const std::vector<Pass>& passes, double s_from, double s_to,
                                       Vec3 (*place)(double s, double z, double across), double across) {
  yarn::ArcsAndSegments path(place(s_from, passes.front().z, across));
  for (std::size_t k = 0; k + 1 < passes.size(); ++k) {
    const Pass &a = passes[k], &b = passes[k + 1];
    const double rise = b.z - a.z;
    if (rise == 0.0) continue;
    const Obstacle &first = rise > 0.0 ? a.above : a.below, &last = rise > 0.0 ? b.below : b.above;
    const double flats = first.flat + last.flat, spread = first.radius + last.radius;
    const std::optional<Bridge> bridge = find_bridge(b.s - a.s - flats, std::abs(rise), spread);
    if (!bridge)
      return error(
          Kind::geometry,
          fmt::format(
              "no room to change sides: neighbours {:.6g} apart are crossed at heights that differ by "
              "{:.6g}; the smallest pitch is {:.6g}",
              b.s - a.s, std::abs(rise), flats + smallest_pitch(std::abs(rise), spread)));
    const double sign = rise > 0.0 ? 1.0 : -1.0, half = 0.5 * bridge->angle;
    const auto turned = [&](const Obstacle& arc, double s, double z, double along, double up) {
      return std::pair(place(s + along * arc.radius * std::tan(half), z, across),
                       place(s + along * arc.radius * std::sin(bridge->angle),
                             z + up * arc.radius * (1.0 - std::cos(bridge->angle)), across));
    };
    const double s_first = a.s + first.flat, s_last = b.s - last.flat;
    const auto [corner, lifted] = turned(first, s_first, a.z, 1.0, sign);
    const auto [last_corner, landing] = turned(last, s_last, b.z, -1.0, -sign);
    path.segment(place(s_first, a.z, across));
    path.arc(corner, lifted, half);
    if (bridge->straight > 0.0) path.segment(landing);
    path.arc(last_corner, place(s_last, b.z, across), half);
  }
  path.segment(place(s_to, passes.back().z, across));
  yarn::CentreLine line;
  line.curve = path.finish();
  line.parameters = {0.0};  // one size for the whole yarn
  return line;
}

}  // namespace selvage::fabric
