// The nodes of a unit cell's mesh on the curves in which its surfaces meet: where yarns' surfaces go through
// the faces of the box, where yarns end inside it, and the box's edges.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "cell/faces.h"
#include "core/diagnostics.h"
#include "fem/mesh.h"
#include "surface_mesh/size_field.h"
#include "yarn/body.h"

namespace selvage::fem {

constexpr std::size_t no_body = static_cast<std::size_t>(-1);

// The cell as it is cut and divided; everything outlives what is made of it.
struct CellShape {
  std::span<const yarn::Body> bodies;
  Parallelepiped cell;  // file units; cut and division are in its own coordinates
  std::array<bool, 3> periodic{};
  const cell::Cut& cut;
  const cell::Division& division;
  bool matrix = true;  // else there is nothing beside the yarns

  [[nodiscard]] SurfacePlace place(std::size_t body, const Vec2& parameters) const {
    return {body, cell::in_domain(bodies[body], parameters)};
  }
};

// Points of the mesh and, where they stand on a yarn's surface, where (`body` no_body: on none).
struct CellNodes {
  std::vector<Vec3> points;
  std::vector<SurfacePlace> places;

  std::uint32_t add(const Vec3& point, const SurfacePlace& place = {no_body, Vec2::Zero()}) {
    points.push_back(point);
    places.push_back(place);
    return static_cast<std::uint32_t>(points.size() - 1);
  }
};

// Nodes along an edge from its first point to its last; of an arc that is a border by itself they may begin
// anywhere, and the last is the first one, with its parameters a period on where the border goes round.
struct Chain {
  std::vector<std::uint32_t> nodes;
  // On an arc:
  std::vector<Vec2> parameters;  // u runs on past the seam
  std::vector<bool> on_crest;    // u is exactly a crest's
  std::vector<double> needle;    // of a yarn that ends there in one: its first edge (CrestCrossing), else 0
};

struct CrestTips;  // surface_mesh/crest_tips.h

struct CellCurves {
  std::vector<Chain> chains;  // of Division::edges
  // Of each periodic axis: the node on the high face opposite each node of curves on the low one.
  std::array<std::unordered_map<std::uint32_t, std::uint32_t>, 3> opposite;
};

// Divides the curves as the field has it; those in high faces of periodic axes are copies of the low ones'.
// Errors (geometry): yarns do not go on where they left on the opposite face, farther than `miss` (file
// units), with names and place.
Result<CellCurves> divide_curves(const CellShape& shape, const CrestTips& tips, const SizeField& field,
                                 double miss, CellNodes& nodes);

}  // namespace selvage::fem
