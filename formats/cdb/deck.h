// What archives of solids and of beams have in common.
#pragma once

#include <string_view>
#include <vector>

#include "core/text_buffer.h"
#include "fem/sections.h"
#include "formats/format.h"

namespace selvage::formats::cdb {

// A block of so many lines, the largest number being theirs, too.
void open_block(TextBuffer& text, std::string_view command, std::size_t count, std::string_view form);

// Nodes 1, 2, ..
void write_node_block(TextBuffer& text, const std::vector<Vec3>& places);

// The beginning of an element's line in EBLOCK; its nodes follow.
struct ElementHead {
  std::size_t material = 1, type = 1, section = 1, system = 0, nodes = 0, number = 1;
};
void write_element_head(TextBuffer& text, const ElementHead& head);

void write_component(TextBuffer& text, const fem::NamedSet& set, bool is_nodes);

// Yarns as BEAM188.
Result<WriteFacts> write_beams(const fem::BeamModel& beams, OutputFile& output,
                               const MeshFileOptions& options);

}  // namespace selvage::formats::cdb
