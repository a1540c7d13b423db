// The file of a unit cell, and what it shares with that of dry yarns.
#pragma once

#include <string>
#include <vector>

#include "core/text_buffer.h"
#include "formats/format.h"

namespace selvage::formats::msh {

// In double quotes; one inside becomes a single one.
std::string quoted(std::string name);

// The two corners of a box, each number followed by a blank.
void write_box(TextBuffer& text, const Box3& box);

// One line of $PhysicalNames for each region.
void write_region_names(TextBuffer& text, const fem::Mesh& mesh);

// The line of a volume in $Entities: its tag, its box, the surfaces around it with the signs of their sides.
void write_volume(TextBuffer& text, std::size_t tag, const Box3& box, const std::vector<std::string>& around);

// A block of $Nodes.
template <class Nodes>
void write_node_block(TextBuffer& text, const fem::Mesh& mesh, std::size_t dimension, std::size_t tag,
                      const Nodes& nodes) {
  text << dimension << ' ' << tag << " 0 " << nodes.size() << '\n';
  for (const std::size_t node : nodes) text << node + 1 << '\n';
  for (const std::size_t node : nodes) {
    const Vec3& p = mesh.nodes[node];
    text << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
  }
}

// The blocks of $Elements that are the regions' own; `number` is that of the last element before.
void write_volume_elements(TextBuffer& text, const fem::Mesh& mesh, std::size_t number);

// With $Entities down to points, and $Periodic.
Result<WriteFacts> write_cell(const fem::Mesh& mesh, OutputFile& output);

}  // namespace selvage::formats::msh
