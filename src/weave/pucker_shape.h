// Seersucker: stripes of slack warps that stand out of the cloth in waves.
#pragma once

#include "core/vec.h"

namespace selvage::fabric {

// The cloth's middle surface z = amplitude cos(2 pi x / wave) sin^2(pi u) over a stripe of slack warps, u
// from 0 at the last tight warp before it to 1 at the first one after it; 0 elsewhere. Warps lie at (i + 1/2)
// pitch, i from 0, in every period tight ones first. Lengths in file units.
struct PuckerShape {
  double wave = 1, amplitude = 0;
  double lift = 1;  // of heights over the middle surface: yarns that cross askew need more room
  double pitch = 1;
  int tight = 1, slack = 1;

  // A place of the flat cloth, z over its middle surface, on the puckered one: as far along its normal.
  [[nodiscard]] Vec3 carried(const Vec3& flat) const {
    return Vec3(flat.x(), flat.y(), height(flat)) + lift * flat.z() * normal(flat);
  }
  [[nodiscard]] Vec3 normal(const Vec3& flat) const;
  [[nodiscard]] bool is_slack(long long warp) const;
  // The largest curvature of the surface, at most.
  [[nodiscard]] double most_curvature() const;

 private:
  struct Window {
    double value = 0, slope = 0;  // by y
  };
  [[nodiscard]] Window window(double y) const;
  [[nodiscard]] double height(const Vec3& flat) const;
};

}  // namespace selvage::fabric
