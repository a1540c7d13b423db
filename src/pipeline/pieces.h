// Garment pieces in the tables of `selvage info`, and in `selvage check`.
#pragma once

#include <string>
#include <vector>

#include "core/units.h"
#include "garment/piece.h"
#include "pipeline/job.h"
#include "solid/brep.h"

namespace selvage::pipeline {

// One line a piece: outline, perimeter, area, and how far its curves pass from their fixed points.
std::string piece_table(const std::vector<fabric::PieceShape>& pieces, const Shown& shown);

// For each curve of the piece: its shape, the error at each fixed point, and the control points by both
// methods.
std::string curve_tables(const fabric::PieceShape& piece, const Shown& shown);

// What `check` found: every piece whose outline is closed and does not cross itself, with OpenCASCADE's
// verdict on its face.
struct PieceFindings {
  std::vector<fabric::PieceShape> shapes;
  std::vector<solid::FaceCheck> faces;
  std::size_t defects = 0;  // all were said
};
// Nothing when OpenCASCADE could not be asked (it was said why).
std::optional<PieceFindings> examine_pieces(Job& job, const fabric::Fabric& fabric);
std::string face_table(const PieceFindings& found, const Shown& shown);

}  // namespace selvage::pipeline
