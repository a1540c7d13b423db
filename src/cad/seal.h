// Does a face seal the end of a tube?
#pragma once

#include <array>
#include <optional>

#include "cad/model.h"
#include "yarn/body.h"

namespace selvage::cad {

// A face that may seal a tube: where its border is, without looking at the tube.
struct Cap {
  yarn::EndStyle style = yarn::EndStyle::none;
  nurbs::Surface surface;            // of a patch or a fan
  std::vector<nurbs::Curve> border;  // closed: the four sides of a patch, a fan's row, a loop's edges
  Vec3 middle = Vec3::Zero();        // of the border, roughly
  double size = 0;                   // of the border's box
};

// Nothing for a face that cannot be a cap: trimmed, but not flat, or with holes; closed without a pole.
std::optional<Cap> as_cap(const Face& face);

// The middle of a closed chain of curves, as in Cap: by length, within a few percent of its size.
Vec3 middle_of(const std::vector<nurbs::Curve>& border);

struct Fit {
  yarn::EndFace face;              // style and surface
  std::array<double, 4> quarters;  // of a patch: the parameters of its corners, knots of the outline
  bool exact = false;              // the sides run with the outline's parameter; else the end is made anew
};

// The cap as the end face of a tube whose end curve is `outline`; `tolerance`: largest distance of the border
// from it. Nothing where it does not fit.
std::optional<Fit> fit_cap(const Cap& cap, const nurbs::Curve& outline, double tolerance);

}  // namespace selvage::cad
