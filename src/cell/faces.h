// The faces of a box with the cut yarns in them: how its twelve edges are divided by the yarns' surfaces, and
// which regions of its faces belong to which yarn, or to what is left: the matrix.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "cell/cut.h"

namespace selvage::cell {

// Where an arc stands in a Cut.
struct ArcPlace {
  std::size_t piece = 0, border = 0, arc = 0;
};

// A point where edges of the box are divided: its own eight corners, and where yarns' surfaces cross them.
struct Corner {
  Vec3 at = Vec3::Zero();  // the two coordinates across the edge to the bit (a box corner: all three)
};

// Between two neighbouring corners of an edge of the box.
struct Segment {
  int edge = 0;
  std::size_t from = 0, to = 0;  // corners, in the direction of the axis
};

// One step of a region's outline.
struct Side {
  enum class Kind { arc, segment } kind = Kind::arc;
  ArcPlace arc;             // Kind::arc
  std::size_t segment = 0;  // Kind::segment: index into Division::segments
  bool backward = false;    // against the arc, or the segment
};
using Outline = std::vector<Side>;  // closed; the region on its left, seen from outside of the box

struct FaceRegion {
  int face = 0;
  static constexpr std::size_t matrix = static_cast<std::size_t>(-1);
  std::size_t body = matrix;      // index of the yarn
  std::vector<Outline> outlines;  // the outer one first, then holes
};

struct Division {
  std::vector<Corner> corners;  // the box's first: bit 0, 1, 2 of the number: high in x, y, z
  std::vector<Segment> segments;
  // The corners at the first and last point of each arc in a face of the box: [piece][border][arc]; `none`
  // where the arc is a border by itself, or its end lies inside the box (on a yarn's own end: not possible).
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  struct ArcEnds {
    std::size_t first = none, last = none;
  };
  std::vector<std::vector<std::vector<ArcEnds>>> ends;
  std::vector<FaceRegion> regions;  // face after face, yarns in their order, then the matrix
};

// Errors (geometry): yarns whose outlines cross in a face (they overlap), with their names and the place.
Result<Division> divide_faces(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut);

}  // namespace selvage::cell
