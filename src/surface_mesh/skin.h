// What bounds the regions of a mesh: the surfaces of yarns, whole or cut by a cell, and the cell's faces.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "surface_mesh/cell_surfaces.h"
#include "surface_mesh/kept_volume.h"
#include "yarn/body.h"

namespace selvage::fem {

struct SkinOptions {
  double tolerance = 0;  // of cell::cut(), file units, > 0
  // Opposite yarns in faces across periodic axes are as near as this, file units.
  double miss = 0;
  std::array<bool, 3> periodic{};
  bool matrix = false;  // there is one between the yarns
  int threads = 1;
  std::function<void(const char* step)> progress{};  // may be empty
};

struct Skin {
  CellNodes nodes;  // each is a corner of a triangle
  CellTriangles surface;
  // Of each node the first one of those that are opposite each other over periodic axes: mostly itself.
  std::vector<std::uint32_t> leaders;
  std::vector<double> volumes;  // of each body inside the box
  std::vector<Message> notes;
};

// Edges are about as long as `rules` has them. Sides are bodies' indices (CellTriangles::matrix,
// Sides::outside). Errors: what cell::cut, cell::divide_faces, divide_curves and mesh_surfaces say. The
// bodies outlive the skin.
Result<Skin> make_skin(std::span<const yarn::Body> bodies, const Parallelepiped& cell, const SizeRules& rules,
                       const SkinOptions& options);

// The skin of one whole yarn: edges of its surface at most `size`, file units, > 0. Gaps are left as they
// are.
Result<Skin> make_skin(const yarn::Body& body, double size);

// What keep_volumes() has to know of the triangles.
std::vector<YarnFacet> facets_of(std::span<const yarn::Body> bodies, const Skin& skin, int threads);

// Where a region keeps the triangles of this part of its yarn (not of the box).
std::vector<ElementSide>& faces_of(Region& region, CellTriangles::Part part);

// A box that a yarn lies in with room to spare: nothing cuts it.
Box3 box_round(const yarn::Body& body);

}  // namespace selvage::fem
