// From four nodes to ten.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/diagnostics.h"
#include "fem/cell_surfaces.h"
#include "fem/mesh.h"
#include "yarn/body.h"

namespace selvage::fem {

struct MidsideNodes {
  std::size_t held = 0;  // taken back toward their chord
  double farthest = 0;   // the longest way that one of them was taken back, in the mesh's unit
};

// The same as a note; `scale`: mm per unit of the mesh.
Message told_of(const MidsideNodes& nodes, double scale);

// What the midside nodes of a unit cell follow.
struct CellSurface {
  static constexpr std::size_t no_body = static_cast<std::size_t>(-1);
  std::span<const yarn::Body> bodies;
  // Of each node of the mesh (or of the first ones, those behind are inside): where it stands on a yarn's
  // surface; `body` no_body: on none.
  std::span<const SurfacePlace> places;
  double scale = 1;  // mm per file unit
  Box3 box{};        // the cell, mm
  std::array<bool, 3> periodic{};
  // End faces that are not flat: edges of their triangles (nodes of the mesh) are lifted to them.
  std::span<const CellTriangles::Cap> caps{};
  std::span<const Triangle> triangles{};
};

// Gives the corner-only elements of a unit cell (mm, regions filled) their six midside nodes, appended to the
// nodes, and sets order 2. Edges of sides between regions, or outside, whose corners stand on one yarn's
// surface are curved: their middles lie on it, those of edges in a face of the box exactly in that face, and
// those of opposite faces where the cell is periodic are the same to the bit. They are taken back toward the
// chord where a scaled Jacobian would fall below 0.1 (or 0.9 of the straight one where that is lower).
MidsideNodes add_midside_nodes(Mesh& mesh, const CellSurface& surface);

}  // namespace selvage::fem
