// Yarns and garment pieces in a CAD file, found by their geometry.
#pragma once

#include <vector>

#include "cad/model.h"
#include "core/diagnostics.h"

namespace selvage::cad {

struct FoundYarn {
  // Complete but for what yarn/finish.h finds of it (finish_as_sealed). Its name may be empty, or another's.
  yarn::Body body;
  bool was_solid = false;
};

// Takes the yarns out of the model, in file order. A yarn is a tube (cad/tube.h), alone as a ring, or with
// two faces whose borders are its end curves (cad/lid.h): a solid or shell of just these, a group of them, or
// any such surfaces of the file, loose or in groups, in any order, which are found by their places. End faces
// keep their control points; one that is neither patch, fan nor plane is replaced by one (a warning says so).
// A tube whose ends no face seals is a yarn with open ends where nothing else belongs to it, or where its
// group holds one or two faces besides (that do not fit: a warning; they stay as they are); one without any
// end face only where the file has no other surfaces, or has it on a yarn's level; none from whose open end
// another face goes on, as the rim of a vase from its walls. All else stays.
std::vector<FoundYarn> take_yarns(Model& model, Diagnostics& diagnostics);

// A plane outline of lines and cubics.
struct Outline {
  struct Side {
    std::string name;
    nurbs::Curve curve;  // over [0, 1], degree 1 or 3, without weights and inner knots
  };
  std::string name;
  std::vector<Side> sides;  // in order, each one's last point is the next one's first
  Origin origin;
};

// Takes the garment pieces out of the model: a face in z = 0 whose loop is of lines and cubics, each of which
// stands in the model as a curve of its own as well, number for number. Both are taken.
std::vector<Outline> take_outlines(Model& model);

}  // namespace selvage::cad
