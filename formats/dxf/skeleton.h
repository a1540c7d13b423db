// The parts of an AC1015 file that every drawing has: header variables, tables, the blocks of model and paper
// space, the root dictionary.
#pragma once

#include <string>
#include <vector>

#include "core/units.h"
#include "formats/dxf/tags.h"
#include "nurbs/bezier.h"

namespace selvage::formats::dxf {

// Handles below this are the skeleton's own.
inline constexpr Handle first_free_handle = 0x100;
inline constexpr Handle model_space = 0x20;  // the block record that owns what is drawn

// Layers of the pattern trade (ASTM D6673, before it ANSI/AAMA-292).
namespace layer {
inline constexpr std::string_view boundary = "1";      // and the piece's text
inline constexpr std::string_view turn_points = "2";   // corners
inline constexpr std::string_view curve_points = "3";  // fixed points inside a curve
}  // namespace layer

struct Block {
  std::string name;
  Handle record = 0, begin = 0, end = 0, insert = 0;
  Tags entities;
};

// The whole file. `box`: of everything drawn; `next`: the first handle that is not used.
Tags drawing(const std::vector<Block>& blocks, const nurbs::Box2& box, Unit units, Handle next);

}  // namespace selvage::formats::dxf
