// Where regions of a cell meet that share no nodes: cohesive elements, or surfaces and bonded contact.
#pragma once

#include "core/text_buffer.h"
#include "fem/mesh.h"
#include "fem/names.h"
#include "fem/sections.h"

namespace selvage::formats::cdb {

// 1: solids, 2: drivers, ..
inline constexpr std::size_t cohesive_type = 3;

// "INTER205", of order 2 "INTER204"; the element types (ET) of interfaces.
int cohesive_element(const fem::Mesh& mesh);
void write_interface_types(TextBuffer& text, const fem::Mesh& mesh);

// Lines of EBLOCK, with the numbers behind those of elements and drivers. A wedge is a brick whose third and
// fourth node are one; INTER204 may be one for tetrahedra of ten nodes (Element Reference: K=L=S, O=P=W).
void write_cohesive_elements(TextBuffer& text, const fem::Mesh& mesh);
// Components: of elements NAME_Cohesive; of nodes NAME_Side and NAME_Facing.
void write_interface_components(TextBuffer& text, const fem::Mesh& mesh, const fem::DeckNames& names);
// Materials behind those of the mesh: TB,CZM, bilinear.
void write_cohesive_materials(TextBuffer& text, const fem::Mesh& mesh);
// Contact elements over the surfaces, which ANSYS makes itself (ESURF), always bonded. By penalty: nodes that
// equations eliminate may be among them.
void write_bonded_contact(TextBuffer& text, const fem::Mesh& mesh, const fem::DeckNames& names);

}  // namespace selvage::formats::cdb
