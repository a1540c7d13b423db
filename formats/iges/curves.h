// What the readers of curves share with those of surfaces and boundaries.
#pragma once

#include <optional>
#include <vector>

#include "formats/iges/reading.h"

namespace selvage::formats::iges {

// A 100: center + cos(a) x + sin(a) y, a from `from` to `to`; `start` and `end` as in the file.
struct ArcFrame {
  Vec3 center, x, y, start, end;
  double from = 0, to = 0;
};
std::optional<ArcFrame> read_arc_frame(Reading& reading, const DirectoryEntry& entry, Parameters& in);

Vec3 read_point(Parameters& in);

bool is_point(const DirectoryEntry& entry);

// `pieces` + 1 increasing values.
std::optional<std::vector<double>> read_breaks(Parameters& in, std::size_t pieces);

// The curves that the entity at `pointer` is made of, in order: those of a 102 (and of 102s in it) one by
// one, any other one alone. Empty after by.fail() or by.give_up().
std::vector<nurbs::Curve> read_chain(Reading& reading, int pointer, Parameters& by);

// Some writers leave the curves of a composite in directions of their own: where they meet once some are
// turned round, they are, and that is told. Not for curves in parameters, which may leap over a seam.
void turn_to_meet(Reading& reading, const DirectoryEntry& entry, std::vector<nurbs::Curve>& pieces);

// The points of a loop's curves in space, dense enough to tell its way round an axis.
std::vector<Vec3> points_along(const cad::Loop& loop);
double size_of(const std::vector<Vec3>& points);  // the diagonal of their box
// Pieces that are farther apart than this are not joined.
double most_gap(const std::vector<Vec3>& points);
// A warning where `gap` is more than rounding.
void warn_of_gap(Reading& reading, const DirectoryEntry& entry, double gap, const std::vector<Vec3>& points);

}  // namespace selvage::formats::iges
