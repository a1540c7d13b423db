// Lapping: how a guide bar of a warp knitting machine moves its guides from course to course.
//
// The spaces between the needles are counted from 0, rising in +x; needle n lies between the spaces n-1 and
// n. A lapping is a chain of overlaps, one a course, repeated without end: `a-b` carries the yarn over the
// hook of the needle between the neighbouring spaces a and b; `a-a` makes no overlap in that course
// (laid-in). Between two overlaps the guide goes from b to the next overlap's a behind the needles: the
// underlap. The chain closes: after its last overlap comes its first, so no bar drifts.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"

namespace selvage::fabric {

struct Overlap {
  int from = 0, to = 0;  // spaces
  [[nodiscard]] bool is_laid_in() const { return from == to; }
  // The needle that is wrapped; of a laid-in course the one to the left of the space.
  [[nodiscard]] int needle() const { return from > to ? from : to; }
  bool operator==(const Overlap&) const = default;
};

using Lapping = std::vector<Overlap>;  // one repeat, at least one overlap

// The highest space that a lapping may name: far beyond any machine's shog, far below where numbers end.
inline constexpr int highest_space = 9999;

// From the notation: overlaps separated by '/' or blanks, at the end perhaps "//". `place` is that of the
// text's first character (column 0: unknown); errors (malformed) point into the text.
Result<Lapping> parse_lapping(std::string_view text, TextPlace place);

// Any course of the endless chain, before its first one, too.
const Overlap& overlap_at(const Lapping& lapping, long long course);

// The lappings of a warp knit that is known by its name, front bar first; none: the name is unknown.
// Open: the same needles in the same courses, every lap an open one.
std::vector<std::string_view> classic_lappings(std::string_view name, Warpknit::Stitch stitch);

}  // namespace selvage::fabric
