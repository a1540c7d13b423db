// The faces of a box with the cut yarns in them: how its twelve edges are divided by the yarns' surfaces, and
// which regions of its faces belong to which yarn, or to what is left: the matrix. Corners, edges and regions
// have one number each, by which CAD and meshes know them.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "cell/cut.h"

namespace selvage::cell {

// A point where edges of the box are divided: its own eight corners, and where yarns' surfaces cross them.
struct Corner {
  Vec3 at = Vec3::Zero();  // the two coordinates across the edge to the bit (a box corner: all three)
};

// Between two corners: an arc of a cut yarn, or a part of one of the box's edges.
struct Edge {
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  const Arc* arc = nullptr;            // null: of the box
  std::size_t piece = 0;               // of the cut, that the arc bounds
  int box_edge = 0;                    // else that it is a part of, in the direction of the axis
  std::size_t from = none, to = none;  // corners; none: an arc that is a border by itself
  [[nodiscard]] bool is_border() const { return from == none; }
};

// One step of a region's outline.
struct Side {
  std::size_t edge = 0;
  bool backward = false;
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
  std::vector<Edge> edges;      // the arcs in the order of the cut, then the parts of the box's edges
  std::vector<std::vector<std::size_t>>
      first_edges;                  // of each piece's borders: the others of a border follow
  std::vector<FaceRegion> regions;  // face after face, yarns in their order, then the matrix
};

// The cut outlives the result. Errors (geometry): yarns whose outlines cross in a face (they overlap), with
// their names and the place.
Result<Division> divide_faces(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut);

}  // namespace selvage::cell
