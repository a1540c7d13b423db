// What decks of solids and of beams have in common.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "core/text_buffer.h"
#include "formats/format.h"

namespace selvage::formats::k {

// A real number for a column: as many digits as go in, one blank before it. A shorter exponent leaves room
// for a digit more.
std::string real(double value, std::size_t width);

// Columns, and the end of the line.
void put_reals(TextBuffer& text, std::initializer_list<double> values, std::size_t width = 10);
void put_integers(TextBuffer& text, std::initializer_list<std::size_t> values);

// With those of drivers.
void write_nodes(TextBuffer& text, const fem::Mesh& mesh);

// *KEYWORD_TITLE with a name, a number, and numbers from 1 on.
void write_list(TextBuffer& text, std::string_view keyword, std::size_t number, std::string_view name,
                const std::vector<std::size_t>& members);

// All load cases of a unit cell by *CASE; nothing where it has none.
void write_cell_loading(TextBuffer& text, const fem::Mesh& mesh);

// Yarns as beams of their resultants.
Result<WriteFacts> write_beams(const fem::BeamModel& beams, OutputFile& output,
                               const MeshFileOptions& options);

}  // namespace selvage::formats::k
