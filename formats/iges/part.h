// Geometry of a CAD file that is no yarn: surfaces, faces with loops, solids and curves.
#pragma once

#include <cstdint>
#include <string_view>

#include "cad/model.h"
#include "formats/iges/entities.h"
#include "formats/iges/records.h"

namespace selvage::formats::iges {

// Why the part cannot be written; empty: it can. Numbers that are not finite, a loop of which neither all
// curves in space nor all curves in the parameters are known.
std::string_view fault_of(const cad::Part& part);

// Does a 186 say it all: every face with loops, every edge with an id that two uses share?
bool is_written_as_solid(const cad::Part& part);
// Of a solid, what it lacks for that; empty: nothing.
std::string_view why_no_solid(const cad::Part& part);

// Upper bound of the lines in each section.
std::int64_t most_values_of_part(const cad::Part& part);

// Colours by their 314.
class ColorSource {
 public:
  virtual ~ColorSource() = default;
  virtual int pointer(const std::optional<cad::Color>& color) = 0;  // 0 for none
};

// The faces as 128 or 144 and a 402 form 7 that holds them, or a 186; names as 406 form 15. A single face
// that has the part's own name, colour and level stands without a group, unless the part is in one. Returns
// the directory pointer of what stands for the part.
int write_part(Records& records, ColorSource& colors, const cad::Part& part);

// 126, with its name as above.
int write_free_curve(Records& records, ColorSource& colors, const cad::NamedCurve& curve);

}  // namespace selvage::formats::iges
