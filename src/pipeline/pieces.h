// Garment pieces in the tables of `selvage info`.
#pragma once

#include <string>
#include <vector>

#include "core/units.h"
#include "fabric/piece.h"

namespace selvage::pipeline {

// One line a piece: outline, perimeter, area, and how far its curves pass from their fixed points.
std::string piece_table(const std::vector<fabric::PieceShape>& pieces, Unit file, Unit shown);

// For each curve of the piece: its shape, the error at each fixed point, and the control points by both
// methods.
std::string curve_tables(const fabric::PieceShape& piece, Unit file, Unit shown);

}  // namespace selvage::pipeline
