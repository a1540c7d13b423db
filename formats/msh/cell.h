// The file of a unit cell, and what it shares with that of dry yarns.
#pragma once

#include <string>

#include "core/text_buffer.h"
#include "formats/format.h"

namespace selvage::formats::msh {

// In double quotes; one inside becomes a single one.
std::string quoted(std::string name);

// The two corners of a box, each number followed by a blank.
void write_box(TextBuffer& text, const Box3& box);

// Node orders: Gmsh's ten-node tetrahedron has the midpoints of the edges 01 12 20 03 23 13: ours with the
// last two exchanged.
inline constexpr std::array<std::size_t, 10> node_order = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

// With $Entities down to points, and $Periodic.
Result<WriteFacts> write_cell(const fem::Mesh& mesh, OutputFile& output);

}  // namespace selvage::formats::msh
