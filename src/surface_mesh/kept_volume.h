// Surfaces of straight triangles that enclose what the round ones do. Corners that stand on a yarn's surface
// make triangles that are inscribed in it, and a volume that is some percent too small; here they move
// outward until it is right.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/parallelepiped.h"
#include "surface_mesh/cell_surfaces.h"
#include "surface_mesh/curved_edges.h"
#include "yarn/body.h"

namespace selvage::fem {

// One triangle of what bounds the yarns.
struct YarnFacet {
  static constexpr std::uint32_t no_yarn = static_cast<std::uint32_t>(-1);  // of the box, beside the yarns
  Triangle corners{};  // counter-clockwise seen from outside the yarn
  std::uint32_t yarn = no_yarn;
  CellTriangles::Part part = CellTriangles::Part::side;
  double height = 0;  // of a side: the mean height of the yarn's surface above it
};

// The mean height of the yarn's surface above the triangle of three of its points (outward: as the triangle
// is seen counter-clockwise), from its places above the middles of the edges; exact where the surface is
// quadratic.
double mean_height(const yarn::Body& body, const std::array<SurfaceEnd, 3>& corners);

struct KeptVolume {
  std::span<const YarnFacet> facets;  // those of a yarn close it
  std::span<const double> volumes;    // wanted, one a yarn
  // Of each point the one that it moves with (itself, or its opposite over a periodic axis, to the bit);
  // empty: itself.
  std::span<const std::uint32_t> leaders{};
  std::optional<Parallelepiped> cell{};  // nothing leaves it
  // Of a gap that may be taken from each side, below 0.5: little where the gap is meshed.
  double gap_share = 0.05;
};

// Moves corners of the yarns' sides along the normal there: each by the mean height of the surface above the
// triangles at it, and all of a yarn by one more length that makes its volume the wanted one. Corners in a
// face of the cell or at an end stay in its plane; those that several yarns have in common keep to the first
// of the two lengths. Nothing moves farther than `gap_share` of the distance to another yarn, to a part of
// the same one across from it, or to a face of the cell, so that gaps stay open, nor so far that a triangle
// turns; what is missing there the rest of the yarn makes up for. Where there is not rest enough, a volume
// stays wrong. Returned: the largest error left, a share of the yarn's volume.
double keep_volumes(std::vector<Vec3>& points, const KeptVolume& surface);

// The same for the yarns of a dry fabric, between which nothing is meshed: where a tenth of the gaps is not
// room enough, as in a cloth that is jammed, most of them is taken.
double keep_dry_volumes(std::vector<Vec3>& points, std::span<const YarnFacet> facets,
                        std::span<const double> volumes);

}  // namespace selvage::fem
