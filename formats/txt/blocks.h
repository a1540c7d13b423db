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

// points.cpp: a yarn's `points` and `helix`.
fabric::PointsFile read_points_file(Parser& p);
fabric::Helix read_helix(Parser& p);

// shape.cpp, too: rows `x y`, of a polygon's corners or a curve's points.
struct PointRows {
  std::string_view noun, what;  // "corner", "a corner"
  bool may_repeat = false;      // a point may equal the one before it
  bool is_spline = false;       // a row may have a weight, and `knots` may stand among them
  std::vector<Vec2> points{};
  std::vector<double> weights{};  // empty: none was given; else one a point
  std::vector<double> knots{};
  Spot last{};  // of the last row
  bool good = true;
};
// Up to the `end` of the block; false when a row is wrong, or the `end` missing.
bool read_points(Parser& p, std::string_view kind, std::string_view name, const Spot& opened,
                 PointRows& rows);

// thread.cpp, too: the block `outline`.
void read_outline(Parser& p, fabric::Fabric& fabric, std::string_view word);

// construction.cpp
std::string read_file_name(Parser& p, std::string_view what);
void read_weave(Parser& p, fabric::Fabric& fabric, std::string_view word);
void read_knit(Parser& p, fabric::Fabric& fabric, std::string_view word);
void read_warpknit(Parser& p, fabric::Fabric& fabric, std::string_view word);
void read_braid(Parser& p, fabric::Fabric& fabric, std::string_view word);

// piece.cpp
void read_piece(Parser& p, fabric::Fabric& fabric, std::string_view word);

// use.cpp
void read_use(Parser& p, fabric::Fabric& fabric, std::string_view word);
void read_repeats_of_cell(Parser& p, fabric::Cell& cell);
void read_vectors_of_cell(Parser& p, fabric::Cell& cell, const Spot& opened);
void read_margin_of_cell(Parser& p, fabric::Cell& cell, std::string_view word);

// reader.cpp
void read_block_of_yarns(Parser& p, fabric::Fabric& fabric, std::string_view word);
void read_edit(Parser& p, fabric::Fabric& fabric, std::string_view word);
void read_cell(Parser& p, fabric::Fabric& fabric, std::string_view word);

}  // namespace selvage::formats::txt
