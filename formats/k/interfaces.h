// Where regions of a cell meet that share no nodes: cohesive elements, or surfaces that are tied.
#pragma once

#include "core/text_buffer.h"
#include "fem/mesh.h"
#include "fem/names.h"

namespace selvage::formats::k {

// Cohesive parts behind the `parts` that there are, of section 2, and their materials behind those of the
// mesh.
void write_cohesive_parts(TextBuffer& text, const fem::Mesh& mesh, const fem::DeckNames& names,
                          std::size_t parts);
void write_cohesive_materials(TextBuffer& text, const fem::Mesh& mesh);
// Pentahedra: bricks whose third and fourth, seventh and eighth nodes are one, so that the pairs of nodes
// that part are 1-5, 2-6, 3-7 as in every cohesive solid.
void write_cohesive_elements(TextBuffer& text, const fem::Mesh& mesh, std::size_t parts);
// Segments of both sides, NAME_Side and NAME_Facing, and what ties them. By penalty (_OFFSET): nodes that
// other constraints eliminate may be among them. Of a triangle of six nodes four segments, so that all are
// tied.
void write_tied_contact(TextBuffer& text, const fem::Mesh& mesh, const fem::DeckNames& names);

}  // namespace selvage::formats::k
