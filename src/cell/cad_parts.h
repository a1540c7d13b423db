// The CAD of a unit cell: yarns cut flush by the box's faces as solids, and what is left of the box as one
// more that shares its faces with theirs.
#pragma once

#include <span>
#include <vector>

#include "cad/model.h"
#include "cell/cut.h"

namespace selvage::cell {

inline constexpr std::string_view matrix_name = "matrix";

struct CadOptions {
  bool matrix = false;
  // How far edges may be from the surfaces that meet there, file units, > 0.
  double tolerance = 0;
};

// Solids, yarn after yarn, the matrix last. A yarn of which the box cuts out several solids is NAME.part1,
// NAME.part2, ... in a group of its name; a matrix that yarns part is matrix.part1, ... Faces in the box's
// are planes whose parameters are the two coordinates; the sides of yarns are B-splines, restricted to what
// is needed, none of which is closed round. Every edge has its curve in space and in the parameters, and an
// id that is the same in all solids; a face of the matrix on a yarn is the yarn's, reversed. Loops run
// counter-clockwise in the parameters.
//
// Errors (geometry), with the yarn and the place: of divide_faces(); a yarn closed along, or one that ends
// inside the box without an end face (style none) or in a fan (unsupported).
Result<std::vector<cad::Part>> cad_parts(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut,
                                         const CadOptions& options);

}  // namespace selvage::cell
