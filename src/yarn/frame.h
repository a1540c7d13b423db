// The frame that carries a section along a path: rotation-minimizing, by double reflection (Wang, Juettler,
// Zheng, Liu: Computation of Rotation Minimizing Frames, ACM TOG 27(1), 2008), or held by what the fabric
// knows: the cloth's normal, the plane of the yarn, the mandrel of a braid.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "nurbs/jets.h"

namespace selvage::yarn {

// What holds the frame.
struct FrameGuide {
  enum class Form {
    free,    // rotation-minimizing; `direction`, where it is given, is `up` at the start
    up,      // `up` is `direction`, as near as the tangent lets it
    across,  // `across` is `direction`, as near as the tangent lets it: a path in a plane, with any slope
    radial   // `up` points away from the axis through `origin` along `direction`
  };
  Form form = Form::free;
  std::optional<Vec3> direction;  // any length but zero; required but for `free`
  Vec3 origin = Vec3::Zero();     // radial: a point of the axis
  bool operator==(const FrameGuide&) const = default;

  static FrameGuide free_from(const std::optional<Vec3>& up) { return {Form::free, up, Vec3::Zero()}; }
  static FrameGuide with_up(const Vec3& up) { return {Form::up, up, Vec3::Zero()}; }
  static FrameGuide with_across(const Vec3& across) { return {Form::across, across, Vec3::Zero()}; }
  static FrameGuide about_axis(const Vec3& origin, const Vec3& axis) { return {Form::radial, axis, origin}; }
};

// Right-handed: tangent = across x up. The section's x axis lies along `across`, its y axis along `up`.
struct Frame {
  Vec3 position, tangent, across, up;
  double speed = 0;  // |dC/dt|
  Vec3 tangent_dt;   // dT/dt
  double turn_dt =
      0;  // radians per unit of t by which it turns about the tangent, against the rotation-minimizing one
};

class FrameField {
 public:
  // A free guide without a direction starts with +z, or +y where the path starts within 6 degrees of z.
  // closed: the closing angle of a free frame is spread evenly over the length. needs_lengths: length_at()
  // will be called (free frames of closed paths always have it); it costs most of the work. Errors
  // (geometry): a guide within 6 degrees of where it says nothing (`up` along the path, ...), a path that
  // stops or turns back at a point.
  static Result<FrameField> make(const nurbs::Curve& path, const FrameGuide& guide, bool closed,
                                 bool needs_lengths = true);

  // The frame at any parameter; the same bits for the same parameter.
  [[nodiscard]] Frame at(double t) const;
  // About how far the frame turns about the tangent between two parameters, against the rotation-minimizing
  // one, radians (not signed).
  [[nodiscard]] double turn_between(double from, double to) const;
  // Arc length from the start.
  [[nodiscard]] double length_at(double t) const;
  [[nodiscard]] double length() const { return nodes_.back().length; }

 private:
  explicit FrameField(const nurbs::Curve& path) : path_(path) {}
  struct Node {
    double t = 0, length = 0;
    Vec3 position, tangent, up;
  };
  const Node& node_before(double t) const;
  void hold(Frame& frame) const;

  nurbs::Jets path_;
  FrameGuide guide_;         // of unit direction
  std::vector<Node> nodes_;  // of a held frame without lengths the path's knots may be enough
  double spread_rate_ = 0;
  double shortest_chord_ = 0;  // file units; up to there a chord's direction is rounding
};

}  // namespace selvage::yarn
