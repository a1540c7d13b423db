// The frame that carries a section along a path: rotation-minimizing, by double reflection.
// Wang, Juettler, Zheng, Liu: Computation of Rotation Minimizing Frames, ACM TOG 27(1), 2008.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "nurbs/spline.h"

namespace selvage::yarn {

// Right-handed: tangent = across x up. The section's x axis lies along `across`, its y axis along `up`.
struct Frame {
  Vec3 position, tangent, across, up;
  double speed = 0;  // |dC/dt|
  Vec3 tangent_dt;   // dT/dt
};

class FrameField {
 public:
  // `up`: the wanted thickness direction at the start; unset: +z, or +y where the path starts within 6
  // degrees of z. closed: the closing angle is spread evenly over the length. needs_lengths: length_at() will
  // be called (closed paths always have it); it costs most of the work. Errors (geometry): an `up` within 6
  // degrees of the path's start, a path that stops or turns back at a point.
  static Result<FrameField> make(const nurbs::Curve& path, const std::optional<Vec3>& up, bool closed,
                                 bool needs_lengths = true);

  // The frame at any parameter; the same bits for the same parameter.
  [[nodiscard]] Frame at(double t) const;
  // Turning of the frame against the rotation-minimizing one, radians per unit of arc length (closed paths
  // only).
  [[nodiscard]] double spread_rate() const { return spread_rate_; }
  // Arc length from the start.
  [[nodiscard]] double length_at(double t) const;
  [[nodiscard]] double length() const { return nodes_.back().length; }

 private:
  struct Node {
    double t = 0, length = 0;
    Vec3 position, tangent, up;
  };
  const Node& node_before(double t) const;

  nurbs::Curve path_;
  std::vector<Node> nodes_;
  double spread_rate_ = 0;
};

}  // namespace selvage::yarn
