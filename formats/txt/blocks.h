// The readers of the file's statements, each in the file of its kind. Each stands behind its word; see
// parser.h.
#pragma once

#include <string_view>

#include "formats/txt/parser.h"

namespace selvage::formats::txt {

// thread.cpp
void read_thread(Parser& p, fabric::Fabric& fabric, std::string_view word);
void read_material(Parser& p, fabric::Fabric& fabric, std::string_view word);
// The statements of a thread, which a yarn may repeat.
const std::vector<Statement<fabric::Thread>>& thread_statements();

// yarn.cpp
void read_yarn(Parser& p, fabric::Fabric& fabric, std::string_view word);

// shape.cpp: what a yarn's `path` and `grid` open.
struct ShapeReading {
  bool good = false;    // no row was wrong
  Spot spot, last_row;  // of the statement, of the last row
};
fabric::Path read_path(Parser& p, ShapeReading& reading);
fabric::Grid read_grid(Parser& p, ShapeReading& reading);

// construction.cpp
void read_weave(Parser& p, fabric::Fabric& fabric, std::string_view word);
void read_knit(Parser& p, fabric::Fabric& fabric, std::string_view word);
void read_warpknit(Parser& p, fabric::Fabric& fabric, std::string_view word);
void read_braid(Parser& p, fabric::Fabric& fabric, std::string_view word);

// piece.cpp
void read_piece(Parser& p, fabric::Fabric& fabric, std::string_view word);

// reader.cpp
void read_edit(Parser& p, fabric::Fabric& fabric, std::string_view word);
void read_cell(Parser& p, fabric::Fabric& fabric, std::string_view word);

}  // namespace selvage::formats::txt
