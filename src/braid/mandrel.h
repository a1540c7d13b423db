// The mandrel of a braid whose radius changes along its axis, or whose axis bends.
#pragma once

#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "yarn/frame.h"
#include "yarn/size_profile.h"

namespace selvage::fabric {

// The axis is the cubic through the rows (path chord), its frame turns about it as little as can be and
// begins as the tube's about the z axis does; the radius is a monotone cubic of the axis's length.
class Mandrel {
 public:
  // At least two rows, neighbours differ. Error (geometry), at the place: an axis that bends more tightly
  // than the radius there.
  static Result<Mandrel> make(const std::vector<MandrelRow>& rows, TextPlace place);

  [[nodiscard]] double length() const { return frames_.length(); }
  [[nodiscard]] bool is_straight() const { return is_straight_; }
  [[nodiscard]] Vec3 origin() const { return frames_.at(0.0).position; }
  [[nodiscard]] Vec3 direction() const { return frames_.at(0.0).tangent; }
  // At a length s along the axis.
  [[nodiscard]] double radius(double s) const { return radius_.at(s / length()).value[0]; }
  [[nodiscard]] double slope(double s) const {
    return radius_.at(s / length()).slope[0] / length();
  }  // of the radius
  [[nodiscard]] double curvature(double s) const;

  struct Place {
    Vec3 position, derivative;
    Vec3 out;  // unit: away from the axis
  };
  // What on a straight tube about z is `position` (z along the axis, its distance from z being `radius` and a
  // height over it), with a derivative by some parameter, on this mandrel: as far along its axis, as high
  // over its radius.
  [[nodiscard]] Place carried(const Vec3& position, const Vec3& derivative, double radius) const;

 private:
  Mandrel(yarn::FrameField frames, yarn::SizeProfile radius)
      : frames_(std::move(frames)), radius_(std::move(radius)) {}
  [[nodiscard]] yarn::Frame frame_at(double s) const;

  yarn::FrameField frames_;
  yarn::SizeProfile radius_;
  bool is_straight_ = true;
  std::vector<double> lengths_, parameters_;  // of the axis, where looking for a length begins
};

}  // namespace selvage::fabric
