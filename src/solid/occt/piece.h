// A garment piece as an OpenCASCADE face. Internal to the module selvage_occt.
#pragma once

#include <TopoDS_Shape.hxx>
#include <span>
#include <vector>

#include "garment/piece.h"
#include "solid/brep.h"

namespace selvage::solid::occt {

// An open shell of one face in the plane z = 0, its normal +z; one edge a line or curve, neighbours share
// their vertex. All lengths are multiplied by `scale`. Exceptions: Standard_Failure.
TopoDS_Shape build_piece(const fabric::PieceShape& piece, double scale);

// The function of solid/brep.h.
Result<std::vector<FaceCheck>> check_pieces(std::span<const fabric::PieceShape> pieces);

// The same of one piece.
FaceCheck check_piece(const fabric::PieceShape& piece);

}  // namespace selvage::solid::occt
