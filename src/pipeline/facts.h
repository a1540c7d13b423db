// Facts of yarns and pieces for the report and the tables.
#pragma once

#include <optional>

#include "core/units.h"
#include "garment/piece.h"
#include "pipeline/report.h"
#include "yarn/body.h"

namespace selvage::pipeline {

// Is it closed along, or do the joints of its end faces keep within the rounding of the coordinates?
bool is_closed(const yarn::Body& body);

// A yarn in the report; lengths of the body in `units`. `closed` as above, until a check says better.
Json yarn_json(const yarn::Body& body, const std::string& name, Unit units);

// A garment piece in the report; `with_table`: with the fixed points and control points of its curves.
Json piece_json(const fabric::PieceShape& piece, Unit units, bool with_table);

// The absolute accuracy to set in Creo, mm: a hundredth of the thinnest section, and at most a quarter of the
// smallest gap between two yarns (both mm), rounded down to 1, 2 or 5 times a power of ten. Below both, so
// that neither a section nor a gap vanishes; far above the rounding of the coordinates. None when there is no
// yarn.
std::optional<double> creo_accuracy(std::optional<double> thinnest, std::optional<double> min_gap);

}  // namespace selvage::pipeline
