#include "yarn/frame.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "nurbs/measure.h"

namespace selvage::yarn {

namespace {

constexpr double six_degrees = 6.0 / 180.0 * std::numbers::pi;
// Largest turning of the tangent between two nodes, radians: double reflection's error grows with its fourth
// power, and is 1e-7 radians over 50 loops of a jersey, a thousandth of what a section's tolerance notices.
constexpr double largest_turn = 0.06;

// The frame's `up` carried from one node to another point (two reflections). A chord up to `shortest` has no
// direction but that of rounding; over it, laying `up` across the tangent is right to the second order.
Vec3 reflected(const Vec3& up, const Vec3& from, const Vec3& from_tangent, const Vec3& to,
               const Vec3& to_tangent, double shortest) {
  const Vec3 v1 = to - from;
  const double c1 = v1.squaredNorm();
  if (c1 == 0.0) return up;
  if (c1 <= shortest * shortest) return (up - up.dot(to_tangent) * to_tangent).normalized();
  const Vec3 up_l = up - (2.0 / c1) * v1.dot(up) * v1;
  const Vec3 tangent_l = from_tangent - (2.0 / c1) * v1.dot(from_tangent) * v1;
  const Vec3 v2 = to_tangent - tangent_l;
  const double c2 = v2.squaredNorm();
  const Vec3 carried = c2 == 0.0 ? up_l : Vec3(up_l - (2.0 / c2) * v2.dot(up_l) * v2);
  // Rounding must not build up over a million nodes.
  return (carried - carried.dot(to_tangent) * to_tangent).normalized();
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Result<Vec3> first_up(const Vec3& tangent, const std::optional<Vec3>& wanted) {
  Vec3 up = Vec3::UnitZ();
  const auto is_along = [&](const Vec3& v) {
    const double angle = angle_between(tangent, v);
    return std::min(angle, std::numbers::pi - angle) < six_degrees;
  };
  if (wanted) {
    up = *wanted;
    if (is_along(up))
      return error(Kind::geometry, "`up` is within 6 degrees of the path's direction at its start");
  } else if (is_along(up)) {
    up = Vec3::UnitY();
  }
  return Vec3((up - up.dot(tangent) * tangent).normalized());
}

// The direction that a guide, a unit vector, asks of the frame at a place, and its derivative by t.
struct Wanted {
  Vec3 direction, slope;
};

Wanted wanted_at(const FrameGuide& guide, const Frame& frame) {
  if (guide.form != FrameGuide::Form::radial) return {*guide.direction, Vec3::Zero()};
  const Vec3 &axis = *guide.direction, from = frame.position - guide.origin,
             step = frame.speed * frame.tangent;
  return {from - from.dot(axis) * axis, step - step.dot(axis) * axis};
}

// Too near to the tangent to say anything?
bool is_idle(const FrameGuide& guide, const Frame& frame) {
  const Vec3 wanted = wanted_at(guide, frame).direction;
  const double angle = angle_between(frame.tangent, wanted);
  return !(wanted.norm() > 0.0) || std::min(angle, std::numbers::pi - angle) < six_degrees;
}

// Is the guide nowhere idle in a span, and stops the path nowhere? True only where a few looks tell: between
// two of them path and guide turn by less than they are apart.
bool holds_along(const FrameGuide& guide, const nurbs::Jets& path, double from, double to) {
  constexpr int looks = 8;
  constexpr double largest_step = 0.5;  // radians, which are hardly more than the chord
  Vec3 tangent = Vec3::Zero(), wanted = Vec3::Zero();
  for (int i = 0; i <= looks; ++i) {
    const nurbs::CurveJet jet = path.at(from + (to - from) * i / looks);
    Frame frame;
    frame.position = jet.position;
    frame.speed = jet.d1.norm();
    frame.tangent = jet.d1 / frame.speed;
    const Vec3 here = wanted_at(guide, frame).direction.normalized();
    const double step = i == 0 ? 0.0 : 1.02 * ((frame.tangent - tangent).norm() + (here - wanted).norm());
    // The sine is less than the angle.
    if (!(step < largest_step && frame.tangent.cross(here).norm() - step > six_degrees)) return false;
    tangent = frame.tangent;
    wanted = here;
  }
  return true;
}

}  // namespace

// A guide stands still (or moves) in space: its part across the tangent is the frame's, and what the
// tangent's own turning takes away from it is the turn about the tangent.
void FrameField::hold(Frame& frame) const {
  const Wanted wanted = wanted_at(guide_, frame);
  const double along = wanted.direction.dot(frame.tangent);
  const Vec3 part = wanted.direction - along * frame.tangent;
  const double length = part.norm();
  const auto sideways = [&](const Vec3& side) {
    return (wanted.slope.dot(side) - along * frame.tangent_dt.dot(side)) / length;
  };
  if (guide_.form == FrameGuide::Form::across) {
    frame.across = part / length;
    frame.up = frame.tangent.cross(frame.across);
    frame.turn_dt = sideways(frame.up);
  } else {
    frame.up = part / length;
    frame.across = frame.up.cross(frame.tangent);
    frame.turn_dt = -sideways(frame.across);
  }
}

Result<FrameField> FrameField::make(const nurbs::Curve& path, const FrameGuide& guide, bool closed,
                                    bool needs_lengths) {
  FrameField field(path);
  field.guide_ = guide;
  if (guide.direction) field.guide_.direction = guide.direction->normalized();
  for (const Vec3& point : path.points)
    field.shortest_chord_ = std::max(field.shortest_chord_, 1e-8 * point.cwiseAbs().maxCoeff());
  const bool is_free = guide.form == FrameGuide::Form::free;
  const auto node_at = [&](double t) {
    const nurbs::CurveJet jet = field.path_.at(t);
    Node node;
    node.t = t;
    node.position = jet.position;
    node.tangent = jet.d1.normalized();
    return node;
  };
  const auto stops = [](const Node& node) {
    return !node.tangent.allFinite() || node.tangent.squaredNorm() < 0.5;
  };
  Node first = node_at(path.first_parameter());
  const auto stopped = [](const Node& node) {
    return error(Kind::geometry, "the path stops or turns back on itself").at_point(node.position);
  };
  if (stops(first)) return stopped(first);
  if (is_free) {
    Result<Vec3> start = first_up(first.tangent, guide.direction);
    if (!start) return start.error();
    first.up = *start;
  }
  field.nodes_.push_back(first);
  const std::vector<double> breaks = nurbs::breakpoints(path.knots, path.degree);
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    if (!is_free && !needs_lengths && holds_along(field.guide_, field.path_, breaks[k], breaks[k + 1])) {
      field.nodes_.push_back(node_at(breaks[k + 1]));
      continue;
    }
    // Turning of the span, from a coarse look, decides its number of steps; a hidden turn is caught by
    // halving.
    double turning = 0.0;
    Vec3 previous = field.nodes_.back().tangent;
    constexpr int looks = 8;
    for (int i = 1; i <= looks; ++i) {
      const Node node = node_at(breaks[k] + (breaks[k + 1] - breaks[k]) * i / looks);
      if (stops(node)) return stopped(node);
      turning += angle_between(previous, node.tangent);
      previous = node.tangent;
    }
    const int steps = std::clamp(static_cast<int>(std::ceil(turning / largest_turn)), 1, 100000);
    for (int i = 1; i <= steps; ++i) {
      const double t = i == steps ? breaks[k + 1] : breaks[k] + (breaks[k + 1] - breaks[k]) * i / steps;
      Node node = node_at(t);
      const Node& before = field.nodes_.back();
      if (stops(node) || node.tangent.dot(before.tangent) < -0.5) return stopped(node);
      if (is_free) {
        node.up = reflected(before.up, before.position, before.tangent, node.position, node.tangent,
                            field.shortest_chord_);
      } else {
        Frame frame;
        frame.position = node.position;
        frame.tangent = node.tangent;
        if (is_idle(field.guide_, frame))
          return error(Kind::geometry,
                       guide.form == FrameGuide::Form::radial
                           ? "the path meets the axis about which its section is held"
                           : "the path runs within 6 degrees of the direction that holds its section")
              .at_point(node.position);
      }
      if ((closed && is_free) || needs_lengths)
        node.length = before.length + nurbs::arc_length(path, before.t, t);
      field.nodes_.push_back(node);
    }
  }
  if (closed && is_free) {
    // How far the carried frame has turned about the tangent when it comes back.
    const Node& last = field.nodes_.back();
    const Vec3& start_up = field.nodes_.front().up;
    const double closing = std::atan2(last.up.cross(start_up).dot(last.tangent), last.up.dot(start_up));
    field.spread_rate_ = closing / last.length;
  }
  return field;
}

const FrameField::Node& FrameField::node_before(double t) const {
  const auto after =
      std::upper_bound(nodes_.begin(), nodes_.end(), t, [](double v, const Node& n) { return v < n.t; });
  return after == nodes_.begin() ? *after : *std::prev(after);
}

double FrameField::length_at(double t) const {
  const Node& node = node_before(t);
  return t <= node.t ? node.length : node.length + nurbs::arc_length(path_.curve(), node.t, t);
}

double FrameField::turn_between(double from, double to) const {
  if (guide_.form == FrameGuide::Form::free)
    return spread_rate_ == 0.0 ? 0.0 : std::abs(spread_rate_) * (length_at(to) - length_at(from));
  constexpr int looks = 4;
  double turn = 0.0;
  for (int i = 0; i < looks; ++i)
    turn += std::abs(at(from + (to - from) * (i + 0.5) / looks).turn_dt) * (to - from) / looks;
  return turn;
}

Frame FrameField::at(double t) const {
  const nurbs::CurveJet jet = path_.at(t);
  Frame frame;
  frame.position = jet.position;
  frame.speed = jet.d1.norm();
  frame.tangent = jet.d1 / frame.speed;
  frame.tangent_dt = (jet.d2 - frame.tangent * jet.d2.dot(frame.tangent)) / frame.speed;
  if (guide_.form != FrameGuide::Form::free) {
    hold(frame);
    return frame;
  }
  frame.turn_dt = spread_rate_ * frame.speed;
  const Node& node = node_before(t);
  frame.up = t <= node.t ? node.up
                         : reflected(node.up, node.position, node.tangent, frame.position, frame.tangent,
                                     shortest_chord_);
  if (spread_rate_ != 0.0) {
    const double angle = spread_rate_ * length_at(t);
    frame.up = Eigen::AngleAxisd(angle, frame.tangent) * frame.up;
  }
  frame.across = frame.up.cross(frame.tangent);
  return frame;
}

}  // namespace selvage::yarn
