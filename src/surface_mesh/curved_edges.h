// Midside nodes that follow a yarn's surface: for tetrahedra/midside.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "fem/edge_key.h"
#include "fem/mesh.h"
#include "yarn/body.h"

namespace selvage::fem {

struct MidsideNodes {
  std::size_t held = 0;  // taken back toward their chord
  double farthest = 0;   // mm: the longest way that one of them was taken back
};

// An edge of the boundary and where its middle is wanted.
struct CurvedEdge {
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::uint64_t key = 0;
  Vec3 middle = Vec3::Zero();
  std::size_t region = none;  // for whose volume the middle may go farther; none: it stays
};

// An edge's end on a yarn's surface, in file units.
struct SurfaceEnd {
  Vec2 parameters = Vec2::Zero();
  Vec3 at = Vec3::Zero();
};

// The point of the surface above the chord's middle, on the straight line of parameters between an edge's
// ends: where it is as far along the chord as the middle.
Vec3 middle_on_surface(const yarn::Body& body, const SurfaceEnd& from, const SurfaceEnd& to);

// The point of the surface in the plane across the chord's middle and in the plane of a face of a cell, on
// which both ends are; `normal` is the face's. Nothing where it is not found near the chord.
std::optional<Vec3> middle_in_plane(const yarn::Body& body, const SurfaceEnd& from, const SurfaceEnd& to,
                                    const Vec3& normal);

// Two edges whose middles are moved back alike.
struct TiedEdges {
  std::uint64_t a = 0, b = 0;  // keys
};

// Gives the corner-only elements of a mesh six midside nodes, in increasing order of their edges' keys, on
// the chords or where `curved` (increasing keys, each once) has them, and takes these back toward the chord
// where an element would fold; then all of a region's go a share of their ways farther, so that it has its
// volume (mm3, one a region; 0, or none at all: as it comes); see tetrahedra/midside.h.
MidsideNodes add_midside_nodes(Mesh& mesh, std::span<const CurvedEdge> curved,
                               std::span<const TiedEdges> tied, std::span<const double> volumes = {});

// Increasing keys; the first of equal ones stays.
void sort_edges(std::vector<CurvedEdge>& edges);

}  // namespace selvage::fem
