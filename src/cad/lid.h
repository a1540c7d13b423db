// What seals the end of a tube.
#pragma once

#include <array>
#include <optional>

#include "cad/model.h"
#include "cad/sampled_curve.h"

namespace selvage::cad {

// One end of a tube, as faces are compared with it.
class TubeEnd {
 public:
  TubeEnd(const yarn::Body& body, bool last, double tolerance);
  // The samples refer to the outline.
  TubeEnd(const TubeEnd&) = delete;
  TubeEnd& operator=(const TubeEnd&) = delete;

  [[nodiscard]] const nurbs::Curve& outline() const { return outline_; }
  [[nodiscard]] const SampledCurve& samples() const { return samples_; }
  [[nodiscard]] double tolerance() const { return tolerance_; }
  // The parameter of the outline where `p` is, preferably a knot (or where a corner stands by itself);
  // nothing when it is not on the outline.
  [[nodiscard]] std::optional<double> parameter_of(const Vec3& p) const;
  [[nodiscard]] double first_u() const { return outline_.first_parameter(); }

 private:
  nurbs::Curve outline_;
  SampledCurve samples_;
  std::array<double, 4> usual_;  // where corners stand by themselves
  double tolerance_;
};

struct Lid {
  // Of style patch, fan or planar where the face is what yarn/body.h means by that, its surface turned and
  // transposed as that asks for; `none`: its border is the outline, but it is something else.
  yarn::EndFace face;
  std::array<double, 4> quarters{};  // patch: where its corners stand
  double gap = 0;                    // largest distance of what has to meet
};

// Does the face (clamped) seal this end? Its border is the outline, all of it, within the tolerance.
std::optional<Lid> lid_of(const Face& face, const TubeEnd& end);

}  // namespace selvage::cad
