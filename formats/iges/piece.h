// A garment piece: its outline as curves (126) and its inside as a trimmed plane (144).
#pragma once

#include "formats/iges/entities.h"
#include "garment/piece.h"

namespace selvage::formats::iges {

// Writes the 144 (on a plane as a bilinear 128, bounded by a 142 whose two curves, in the plane's parameters
// and in space, are 102s of one 126 an edge), then for each edge an independent 126 of its own name, and the
// 402 form 7 that holds them all. The plane's parameters are x and y themselves. `common.name` is the 406
// form 15 of the piece. Returns the pointer of the 402.
int write_piece(Records& records, const Common& common, const fabric::PieceShape& piece);

// The plane z = 0 over the piece's box and a little more.
nurbs::Surface plane_of(const fabric::PieceShape& piece);

// How many entities write_piece writes for this piece.
int entities_of_piece(const fabric::PieceShape& piece);

}  // namespace selvage::formats::iges
