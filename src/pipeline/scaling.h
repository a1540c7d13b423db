// Lengths in another unit, for `--units`.
#pragma once

#include "cad/model.h"
#include "core/units.h"
#include "garment/piece.h"
#include "yarn/body.h"

namespace selvage::pipeline {

// `value`, a length in `from`, in `to`: at most two roundings, none when the units are the same (one when one
// of them is a decimal multiple of the other).
double converted(double value, Unit from, Unit to);

// Lengths of a file as they are shown, or written, in another unit.
struct Shown {
  Unit file = Unit::mm, unit = Unit::mm;
  [[nodiscard]] double length(double value) const { return converted(value, file, unit); }
  [[nodiscard]] double area(double value) const { return length(length(value)); }
  [[nodiscard]] double volume(double value) const { return length(area(value)); }
};

// The same yarn or piece in another unit: every length, area and volume of it, messages excepted. Equal
// numbers stay equal, so that seams and joints stay closed.
void convert_lengths(yarn::Body& body, Unit from, Unit to);
void convert_lengths(fabric::PieceShape& piece, Unit from, Unit to);
// Parameters (knots and curves in them) keep their numbers.
void convert_lengths(cad::Part& part, Unit from, Unit to);
void convert_lengths(cad::NamedCurve& curve, Unit from, Unit to);

}  // namespace selvage::pipeline
