// The small sections of an IGES file: start, global and terminate.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/units.h"
#include "formats/format.h"

namespace selvage::formats::iges {

// `text` in the characters that IGES strings may hold: every other character, of whatever length in UTF-8,
// becomes '_'.
std::string ascii(std::string_view text);

// What the start and global sections say.
struct Header {
  std::string title;      // of the fabric, may be empty
  std::string file_name;  // without folders
  Unit units = Unit::mm;
  std::string time;                // YYYYMMDD.HHNNSS
  double resolution = 1e-6;        // parameter 19, file units
  double largest = 0;              // parameter 20: no coordinate is larger in magnitude
  std::optional<PartMark> part{};  // of a fabric in several files
};

// The lines of both sections. Their number does not depend on `resolution`, `largest` and `part`, so that
// these can be put in at the end.
struct HeaderText {
  std::string bytes;
  int start_lines = 0, global_lines = 0;
};
HeaderText header_text(const Header& header);

// A set has no more files: their numbers fit into the first line, and nobody has so many by intent.
inline constexpr int most_files = 99'999;

// What the first line of a file says of the set that it is part of.
std::optional<PartMark> part_mark(std::string_view head);

std::string terminate_text(const HeaderText& header, std::int64_t directory_lines,
                           std::int64_t parameter_lines);

// Parameter 19, the distance below which a receiving system counts two points as one ("minimum user-intended
// resolution"). `smallest_size` is the smallest yarn thickness, `largest` the largest coordinate; file units.
//
// The numbers themselves are exact to one part in 2^53, but to say so would do harm: OpenCASCADE takes the
// figure as its tolerance when it is above 1e-8, and falls back to 1e-4 (of whatever unit) when it is not;
// ANSYS and others merge with it. What the file resolves is the yarn: so it is the power of ten at or below
// 1e-5 of the smallest thickness (a thousandth of the smallest gap between yarns that can be meshed, a
// hundredth of the usual tolerance of tubes), but never less than the rounding of the largest coordinate, and
// no less than 1e-7 where that is still below 1e-3 of a yarn. Faces of other files may meet no better than
// `known`, the resolution of theirs, which stands then as far as it is below a hundredth of the smallest
// size.
double resolution_for(double smallest_size, double largest, double known = 0);

}  // namespace selvage::formats::iges
