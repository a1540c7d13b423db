#include "fabric/spine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/plane.h"
#include "nurbs/interpolate.h"
#include "nurbs/roots.h"

namespace selvage::fabric {

namespace {

using std::numbers::pi;
// A helix through this many points a turn is 4e-5 of its radius away from the cubic through them at most.
constexpr double points_a_turn = 20.0;
constexpr double bend_between_points = 0.12;  // radians
constexpr std::size_t most_stations = 5'000'000;
constexpr double tightest = 0.9;  // curvature times reach

// How far the tangent turns over a span, radians.
double bend_of(const yarn::FrameField& field, double from, double to) {
  constexpr int looks = 8;
  double bend = 0.0;
  Vec3 before = field.at(from).tangent;
  for (int i = 1; i <= looks; ++i) {
    const Vec3 tangent = field.at(from + (to - from) * i / looks).tangent;
    bend += std::atan2(before.cross(tangent).norm(), before.dot(tangent));
    before = tangent;
  }
  return bend;
}

// The place's direction about the tangent after `angle`.
struct Turned {
  Vec3 out, round;  // not unit: of the place's distance
};
Turned turned(const yarn::Frame& frame, const Vec2& place, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const double x = c * place.x() - s * place.y(), y = s * place.x() + c * place.y();
  return {x * frame.across + y * frame.up, -y * frame.across + x * frame.up};
}

// The least distance of two helices about one axis, as seen from the first: the minimum over the height of
// |p1 - (p2 turned by rate * height)|^2 + height^2, convex while r1 r2 rate^2 < 1.
double helix_distance(const Vec2& a, const Vec2& b, double rate) {
  const double radii = a.squaredNorm() + b.squaredNorm();
  const double dot = a.dot(b), turn = cross(a, b);
  double height = 0.0;
  for (int i = 0; i < 12; ++i) {
    const double c = std::cos(rate * height), s = std::sin(rate * height);
    const double along = dot * c - turn * s, side = dot * s + turn * c;  // -d(along)/d(angle)
    const double step = (rate * side + height) / (rate * rate * along + 1.0);
    height -= step;
    if (std::abs(step) < 1e-14 * std::sqrt(radii)) break;
  }
  const double along = dot * std::cos(rate * height) - turn * std::sin(rate * height);
  return std::sqrt(std::max(radii - 2.0 * along + height * height, 0.0));
}

}  // namespace

Result<Spine> make_spine(const yarn::CentreLine& line, const yarn::FrameGuide& guide, double turning,
                         double reach) {
  const Result<yarn::FrameField> field = yarn::FrameField::make(line.curve, guide, line.closed);
  if (!field) return field.error();
  Spine spine;
  spine.closed = line.closed;
  spine.turning = turning;
  if (line.closed)
    spine.turning = 2.0 * pi * std::round(turning * field->length() / (2.0 * pi)) / field->length();
  const auto add = [&](double t) {
    spine.frames.push_back(field->at(t));
    spine.parameters.push_back(t);
    spine.lengths.push_back(field->length_at(t));
  };
  const std::vector<double> breaks = nurbs::breakpoints(line.curve.knots, line.curve.degree);
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double from = breaks[k], to = breaks[k + 1];
    const double turn = std::abs(spine.turning) * (field->length_at(to) - field->length_at(from)) +
                        field->turn_between(from, to);
    const double bend = bend_of(*field, from, to);
    double steps = std::max({turn / (2.0 * pi) * points_a_turn, bend / bend_between_points, 1.0});
    if (bend > 1e-6) steps = std::max(steps, 3.0);
    if (static_cast<double>(spine.frames.size()) + steps > static_cast<double>(most_stations))
      return error(Kind::limit,
                   fmt::format("so much twist needs more than {} points along the yarn", most_stations));
    const int count = static_cast<int>(std::ceil(steps));
    for (int i = 0; i < count; ++i) add(from + (to - from) * i / count);
  }
  add(breaks.back());
  for (const yarn::Frame& frame : spine.frames) {
    const double tightness = frame.tangent_dt.norm() / frame.speed * reach;
    if (tightness > tightest)
      return error(Kind::geometry, fmt::format("the path bends with a radius of {:.3g}: too tight to lay "
                                               "parts about it at distances up to {:.3g}",
                                               reach / tightness, reach))
          .at_point(frame.position);
    const double rate = std::abs(spine.turning + frame.turn_dt / frame.speed);
    spine.inclination = std::max(spine.inclination, rate * reach / (1.0 - tightness));
  }
  return spine;
}

yarn::CentreLine strand_of(const Spine& spine, const Vec2& place) {
  std::vector<Vec3> points;
  points.reserve(spine.frames.size());
  for (std::size_t i = 0; i < spine.frames.size(); ++i)
    points.push_back(spine.frames[i].position +
                     turned(spine.frames[i], place, spine.turning * spine.lengths[i]).out);
  const auto derivative = [&](std::size_t i) {
    const yarn::Frame& frame = spine.frames[i];
    const Turned at = turned(frame, place, spine.turning * spine.lengths[i]);
    return Vec3(frame.speed * frame.tangent - frame.tangent_dt.dot(at.out) * frame.tangent +
                (spine.turning * frame.speed + frame.turn_dt) * at.round);
  };
  yarn::CentreLine line;
  line.closed = spine.closed;
  line.parameters = spine.parameters;
  if (spine.closed) {
    points.pop_back();
    line.curve = nurbs::interpolate_closed(points, spine.parameters);
    line.parameters.pop_back();
  } else {
    line.curve =
        nurbs::interpolate(points, spine.parameters, derivative(0), derivative(spine.frames.size() - 1));
  }
  return line;
}

Vec3 outward(const Spine& spine, const Vec2& place) {
  const yarn::Frame& frame = spine.frames.front();
  const Vec3 out = place.x() * frame.across + place.y() * frame.up;
  return out.norm() > 0.0 ? out.normalized() : frame.up;
}

Vec2 place_of(const DiscPacking& packing, std::size_t disc, double reach, double diameter) {
  if (packing.centres.size() == 1) return Vec2::Zero();
  return packing.centres[disc] * ((reach - 0.5 * diameter) / (1.0 - packing.radius));
}

double largest_diameter(const DiscPacking& packing, double reach, double inclination, bool scaled) {
  const double unit = scaled ? reach : 1.0;
  double high = 2.0 * packing.radius * unit;
  if (packing.centres.size() == 1) return high;
  const double rate = inclination / reach;
  // Who can come near at all: turning brings two lines nearer by at most `inclination` for each unit of
  // height.
  const double cut = 2.0 * packing.radius * (1.0 + inclination) * 1.05;
  std::vector<Vec2> sorted = packing.centres;
  std::sort(sorted.begin(), sorted.end(), [](const Vec2& a, const Vec2& b) { return a.x() < b.x(); });
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < sorted.size(); ++i)
    for (std::size_t j = i + 1; j < sorted.size() && sorted[j].x() - sorted[i].x() < cut; ++j)
      if ((sorted[j] - sorted[i]).norm() < cut) pairs.emplace_back(i, j);
  const auto fits = [&](double diameter) {
    const double scale = scaled ? (reach - 0.5 * diameter) / (1.0 - packing.radius) : 1.0;
    return std::all_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
      const Vec2 a = scale * sorted[pair.first], b = scale * sorted[pair.second];
      return helix_distance(a, b, rate) >= diameter * (1.0 - 1e-12);
    });
  };
  if (fits(high)) return high;
  double low = 0.0;
  nurbs::halve_between(low, high, 40, fits);
  return low;
}

}  // namespace selvage::fabric
