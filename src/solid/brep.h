// Yarns as OpenCASCADE solids, garment pieces as its faces. Implemented in the module selvage_occt together
// with formats/step; this header shows no type of OpenCASCADE.
#pragma once

#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "garment/piece.h"
#include "yarn/body.h"

namespace selvage::solid {

struct BrepCheck {
  bool valid = false;    // BRepCheck_Analyzer on the solid
  int free_edges = 0;    // edges with one face
  double volume = 0;     // BRepGProp, file units^3
  double tolerance = 0;  // the largest tolerance of its vertices and edges
  std::vector<Message> defects;
};

// Builds each yarn's solid as STEP would write it and lets OpenCASCADE judge it.
Result<std::vector<BrepCheck>> check_breps(std::span<const yarn::Body> bodies);

struct FaceCheck {
  bool valid = false;  // BRepCheck_Analyzer on the face
  double area = 0;     // BRepGProp, file units^2
  std::vector<Message> defects;
};

// The same for pieces.
Result<std::vector<FaceCheck>> check_piece_faces(std::span<const fabric::PieceShape> pieces);

// What the module exports for this part, as `selvage_brep` (formats/step has a table of its own there).
struct BrepModule {
  const char* version;  // of OpenCASCADE
  Result<std::vector<BrepCheck>> (*check)(std::span<const yarn::Body> bodies);
  Result<std::vector<FaceCheck>> (*check_pieces)(std::span<const fabric::PieceShape> pieces);
};
Result<const BrepModule*> brep_module();

}  // namespace selvage::solid
