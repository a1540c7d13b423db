// A yarn's shape for a page: the same skin in several degrees of detail, of which the page shows one by
// distance, cut across the yarn at the same places in all of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::view::page {

// What stands between two cuts, at one degree of detail, as bytes (little-endian).
//
// Tube: a grid of `rows` x Level::columns points (columns run round the yarn, the last one stands where the
//   first does; view/skin.h), then, of each end that it has, the outline once more and its centre. First all
//   points, three unsigned 16-bit numbers each, which are (origin + number) * Shape::step; then all normals,
//   three signed bytes each, 127 for a length of 1. Of a twisted yarn (Shape::is_twisted) then one 32-bit
//   float a row, the turns of its fibres up to there: a fibre is where Level::around less that keeps its
//   value.
// Ribbon: `rows` points on the centre line, nine 32-bit floats each: the point, and half the section's width
//   and height as vectors across the line.
struct Part {
  std::size_t rows = 0;
  bool has_start = false, has_end = false;  // of tubes
  std::array<std::int32_t, 3> origin{};     // of tubes
  std::string bytes;
};

struct Level {
  bool is_tube = true;
  double chord = 0;  // how far it may be from the surface (tube) or the centre line (ribbon), file units
  std::size_t columns = 0;     // of tubes
  std::vector<double> around;  // of tubes: of each column, in turns
  std::vector<Part> parts;
  [[nodiscard]] std::size_t bytes() const;
};

// Coordinates are told from `centre`, in file units.
struct Shape {
  Vec3 centre = Vec3::Zero();
  double thickness = 0;  // of the narrowest section
  bool is_twisted = false;
  double step = 0;  // of the points of tubes: a five-hundredth of the thickness where that is enough
  std::vector<Level> levels;  // the finest first
  std::vector<Box3> boxes;    // of each part
};

// The chords of tubes as shares of the thickness, the finest first; ribbons follow.
inline constexpr std::array<double, 3> tube_chords = {1.0 / 250, 1.0 / 50, 1.0 / 8};
inline constexpr std::array<double, 3> ribbon_chords = {1.0 / 3, 4.0 / 3, 16.0 / 3};
inline constexpr std::size_t level_count = tube_chords.size() + ribbon_chords.size();

// `first_level` of level_count: finer ones are left out. Errors: as make_skin().
Result<Shape> make_shape(const yarn::Body& body, std::size_t first_level = 0);

}  // namespace selvage::view::page
