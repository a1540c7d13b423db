// The surface of a TexGen yarn as a B-spline grid: its sections, blended along its line.
//
// Round, points of the exact sections are interpolated (outline_points.h). Along, cubics have the exact
// places and slopes of these points at all nodes and sections, and at as many even parameters between them as
// keep what is halfway within `along_share` of the thinnest section. They meet in double knots, in triple
// ones where the line, its frame or its sections have a bend.
#pragma once

#include <optional>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "formats/tg3/section.h"
#include "formats/tg3/section_adjustment.h"
#include "formats/tg3/yarn_path.h"

namespace selvage::formats::tg3 {

inline constexpr double along_share = 1e-4;

// How the sections on both sides of a place are blended: in proportion to the share u of the way between
// them.
struct Blend {
  bool is_ramped = false;  // 3 u^2 - 2 u^3 of it
  bool is_polar = false;   // of radius and angle, not of x and y
};

// A piece of a span between two nodes, over which the share of the second section goes evenly from `u0` to
// `u1`.
struct BlendPiece {
  std::size_t span = 0;
  double t0 = 0, t1 = 1;         // of the span
  std::size_t from = 0, to = 0;  // sections, by their index
  double u0 = 0, u1 = 1;
};

struct YarnShape {
  YarnPath path;
  std::vector<Section> sections;   // one at least
  std::vector<BlendPiece> pieces;  // one behind the other, from the first node to the last
  Blend blend{};
  SectionAdjustments adjustments{};
  // How far the surface may be from the blended sections, half of it round and half of it along; 0: as near
  // as outline_points.h and along_share say.
  double tolerance = 0;
};

// One section everywhere.
std::vector<BlendPiece> constant_pieces(const YarnPath& path);
// Section i stands at the share positions[i] (0 .. 1, increasing) of the yarn's length; behind the last one
// the first follows, as if the yarn began anew.
std::vector<BlendPiece> pieces_of_positions(const YarnPath& path, const std::vector<double>& positions);

// The yarn from its first node to its last, open.
struct YarnUnit {
  fabric::Grid grid;
  double deviation = 0;  // from the blended sections, at most, as far as it was measured
  bool goes_on = false;  // its end is its beginning, shifted: units follow each other as one surface
};

// `shift`: from the first node to the last. Errors (limit): more control points than `most`.
Result<YarnUnit> surface_of(const YarnShape& shape, std::size_t most);

// `count` units one behind the other, of a unit that goes on.
fabric::Grid chained(const fabric::Grid& unit, const Vec3& shift, int count);

}  // namespace selvage::formats::tg3
