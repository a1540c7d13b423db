#include "nurbs/analytic.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "nurbs/chain.h"
#include "nurbs/conic.h"
#include "nurbs/sweep.h"

namespace selvage::nurbs {

namespace {

using std::numbers::pi;
using Kind = Analytic::Kind;

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double angle_slack = 1e-6;

struct Span {
  double low = infinite, high = -infinite;

  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] double length() const { return high - low; }
};

// The values of one parameter along a loop, unwound where it is an angle.
struct Track {
  Span span;
  double first = 0, winding = 0;
  bool empty = true;
};

class Unwinder {
 public:
  explicit Unwinder(bool is_angle) : is_angle_(is_angle) {}
  void add(double value) {
    if (track_.empty) {
      track_.first = before_ = value;
      track_.empty = false;
    } else {
      before_ = next_to(value);
    }
    track_.span.add(before_);
  }
  // Back to the first point.
  Track close() {
    if (track_.empty) return track_;
    const double last = next_to(track_.first);
    track_.winding = last - track_.first;
    track_.span.add(last);
    return track_;
  }

 private:
  [[nodiscard]] double next_to(double value) const {
    return is_angle_ ? before_ + std::remainder(value - before_, 2 * pi) : value;
  }

  bool is_angle_;
  double before_ = 0;
  Track track_;
};

bool winds(const Track& track) {
  return std::abs(track.winding) > pi;
}

// All loops' values of an angle: a whole turn, or less.
Span angles(const std::vector<Track>& tracks) {
  Span all;
  for (const Track& track : tracks) {
    if (track.empty) continue;
    if (winds(track)) return {track.first, track.first + 2 * pi};
    if (track.span.length() >= 2 * pi - angle_slack) return {track.span.low, track.span.low + 2 * pi};
    // Next to what there is already.
    double shift = 0;
    if (all.high >= all.low)
      shift = std::round(((all.low + all.high) - (track.span.low + track.span.high)) / (4 * pi)) * 2 * pi;
    all.add(track.span.low + shift);
    all.add(track.span.high + shift);
  }
  // A seam alone: there and back along one meridian.
  const bool only_seam = all.length() >= 0 && all.length() < angle_slack;
  if (only_seam || all.length() >= 2 * pi - angle_slack) all.high = all.low + 2 * pi;
  return all;
}

}  // namespace

Analytic Analytic::placed(Kind kind, const Vec3& origin, const Vec3& axis, const Vec3& reference) {
  Analytic result;
  result.kind = kind;
  result.origin = origin;
  result.z = axis.normalized();
  Vec3 across = reference - reference.dot(result.z) * result.z;
  if (!(across.norm() > 1e-9 * reference.norm()) || reference.isZero(0)) across = result.z.unitOrthogonal();
  result.x = across.normalized();
  result.y = result.z.cross(result.x);
  return result;
}

Analytic::Range Analytic::whole() const {
  return kind == Kind::sphere ? Range{0, 2 * pi, -pi / 2, pi / 2} : Range{0, 2 * pi, 0, 2 * pi};
}

Surface Analytic::part(const Range& range) const {
  const auto [u0, u1, v0, v1] = range;
  if (kind == Kind::plane) return flat(origin, x, y, {u0, v0}, {u1, v1});
  const auto at = [&](double v) -> Vec3 {
    return origin + (radius + (kind == Kind::cone ? v * std::tan(half_angle) : 0)) * x + v * z;
  };
  Curve profile;
  if (kind == Kind::sphere)
    profile = elliptic_arc(origin, radius * x, radius * z, v0, v1);
  else if (kind == Kind::torus)
    profile = elliptic_arc(origin + radius * x, minor * x, minor * z, v0, v1);
  else
    profile = segment(at(v0), at(v1), v0, v1);
  // The profile stands at the angle 0.
  Surface surface = revolved(profile, origin, z, 0, u1 - u0);
  const double c = std::cos(u0), s = std::sin(u0);
  if (u0 != 0)
    for (Vec3& p : surface.points) {
      const Vec3 q = p - origin;
      const double a = q.dot(x), b = q.dot(y);
      p = origin + (c * a - s * b) * x + (s * a + c * b) * y + q.dot(z) * z;
    }
  for (double& knot : surface.knots_v) knot = knot == u1 - u0 ? u1 : knot + u0;
  return transposed(surface);
}

Vec3 Analytic::normal(double u, double v) const {
  Vec3 outwards = std::cos(u) * x + std::sin(u) * y;
  switch (kind) {
    case Kind::plane:
      return z;
    case Kind::cylinder:
      return outwards;
    case Kind::cone:
      return std::cos(half_angle) * outwards - std::sin(half_angle) * z;
    case Kind::sphere:
    case Kind::torus:
      break;
  }
  return std::cos(v) * outwards + std::sin(v) * z;
}

std::optional<Analytic> Analytic::at_distance(double distance) const {
  Analytic moved = *this;
  if (kind == Kind::plane)
    moved.origin += distance * z;
  else if (kind == Kind::torus)
    moved.minor += distance;
  else
    moved.radius += kind == Kind::cone ? distance / std::cos(half_angle) : distance;
  const bool is_whole = kind == Kind::plane || (kind == Kind::cone && moved.radius >= 0) ||
                        (kind == Kind::torus && moved.minor > 0 && moved.minor < radius) ||
                        ((kind == Kind::cylinder || kind == Kind::sphere) && moved.radius > 0);
  return is_whole ? std::optional(moved) : std::nullopt;
}

Vec2 Analytic::parameters(const Vec3& p) const {
  const Vec3 q = p - origin;
  const double a = q.dot(x), b = q.dot(y), h = q.dot(z);
  switch (kind) {
    case Kind::plane:
      return {a, b};
    case Kind::cylinder:
    case Kind::cone:
      return {std::atan2(b, a), h};
    case Kind::sphere:
      return {std::atan2(b, a), std::atan2(h, std::hypot(a, b))};
    case Kind::torus:
      return {std::atan2(b, a), std::atan2(h, std::hypot(a, b) - radius)};
  }
  return Vec2::Zero();
}

bool Analytic::is_on_axis(const Vec3& p) const {
  if (kind == Kind::plane) return false;
  const Vec3 q = p - origin;
  return std::hypot(q.dot(x), q.dot(y)) <= 1e-7 * std::max(q.norm(), radius);
}

std::optional<Analytic::Range> Analytic::bounded_by(const std::vector<std::vector<Vec3>>& loops) const {
  const bool angular_u = kind != Kind::plane, angular_v = kind == Kind::torus;
  std::vector<Track> us, vs;
  for (const std::vector<Vec3>& loop : loops) {
    Unwinder u(angular_u), v(angular_v);
    for (const Vec3& p : loop) {
      const Vec2 at = parameters(p);
      v.add(at.y());
      if (!is_on_axis(p)) u.add(at.x());
    }
    us.push_back(u.close());
    vs.push_back(v.close());
  }
  Span u, v;
  if (angular_u) {
    u = angles(us);
  } else {
    for (const Track& track : us) u.add(track.span.low), u.add(track.span.high);
  }
  if (angular_v) {
    v = angles(vs);
  } else {
    for (const Track& track : vs) v.add(track.span.low), v.add(track.span.high);
  }
  // Loops that go round the axis: what is bounded is above the one that goes counter-clockwise, and below
  // the other one.
  const Track *above = nullptr, *below = nullptr;
  for (std::size_t i = 0; i < us.size(); ++i)
    if (!us[i].empty && winds(us[i])) (us[i].winding > 0 ? above : below) = &vs[i];
  if (kind == Kind::sphere && (above == nullptr) != (below == nullptr)) {
    const bool has_pole = pi / 2 - std::max(v.high, -v.low) < angle_slack;
    if (!has_pole && above != nullptr) v.high = pi / 2;
    if (!has_pole && below != nullptr) v.low = -pi / 2;
  } else if (kind == Kind::torus && above != nullptr && below != nullptr) {
    v = {above->span.low, below->span.high};
    while (v.high <= v.low) v.high += 2 * pi;
    while (v.high > v.low + 2 * pi + angle_slack) v.high -= 2 * pi;
  } else if (kind == Kind::torus && (above != nullptr || below != nullptr) &&
             v.length() < 2 * pi - angle_slack) {
    v = {v.low, v.low + 2 * pi};
  } else if (kind == Kind::cone && (above == nullptr) != (below == nullptr)) {
    const double apex = -radius / std::tan(half_angle);  // below, where the cone opens upward
    v.add(apex);
  }
  if (kind == Kind::sphere) {
    if (v.high > pi / 2 - angle_slack) v.high = pi / 2;
    if (v.low < -pi / 2 + angle_slack) v.low = -pi / 2;
  }
  if (!(u.length() > 0) || !(v.length() > 0)) return std::nullopt;
  return Range{u.low, u.high, v.low, v.high};
}

Analytic::Range Analytic::widened(const Range& range) const {
  Range wide = range;
  const double du = 0.05 * (range.u1 - range.u0), dv = 0.05 * (range.v1 - range.v0);
  wide.u0 -= du;
  wide.u1 += du;
  wide.v0 -= dv;
  wide.v1 += dv;
  const auto turn = [](double& low, double& high, double first) {
    if (high - low > 2 * pi) low = first, high = first + 2 * pi;
  };
  if (kind != Kind::plane) turn(wide.u0, wide.u1, range.u0);
  if (kind == Kind::torus) turn(wide.v0, wide.v1, range.v0);
  if (kind == Kind::sphere) {
    wide.v0 = std::max(wide.v0, -pi / 2);
    wide.v1 = std::min(wide.v1, pi / 2);
  }
  if (kind == Kind::cone) {
    const double apex = -radius / std::tan(half_angle);
    if (range.v0 >= apex - 1e-9 * std::abs(apex)) wide.v0 = std::max(wide.v0, apex);
  }
  return wide;
}

}  // namespace selvage::nurbs
