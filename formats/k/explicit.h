// The explicit step: rigid grips and plates, contact, and what is recorded.
#pragma once

#include "core/text_buffer.h"
#include "fem/forming.h"

namespace selvage::formats::k {

// The numbers behind which those of rigid parts begin.
struct Taken {
  std::size_t nodes = 0, elements = 0, parts = 0, sections = 0, materials = 0, node_sets = 0;
};

// All that --deck explicit adds to yarns as solids, or as beams, whose contact is that of lines as well.
void write_forming(TextBuffer& text, const fem::Forming& forming, const Taken& taken, bool of_beams);

}  // namespace selvage::formats::k
