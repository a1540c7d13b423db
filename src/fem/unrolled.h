// A piece of a yarn's surface unrolled into the plane of its parameters: cut open where it goes round.
#pragma once

#include "fem/cell_curves.h"
#include "fem/triangle_mesh.h"

namespace selvage::fem {

// Points of the plane may stand for the same node: where the piece was cut open.
struct Unrolled {
  PlanarRegion region;               // one domain, 0
  std::vector<std::uint32_t> owner;  // of each point of the region: its node, an index into `nodes`
  struct Node {
    Vec3 point;
    Vec2 parameters;
    std::uint32_t known = none;  // index into the cell's nodes; none: a new one
    bool is_fixed = true;        // else it may be moved, or taken away
  };
  static constexpr std::uint32_t none = static_cast<std::uint32_t>(-1);
  std::vector<Node> nodes;                                // fixed ones and others in any order
  std::vector<std::array<std::uint32_t, 2>> fixed_edges;  // nodes
};

// Errors (geometry): a piece that cannot be cut open.
Result<Unrolled> unroll(const CellShape& shape, const CellCurves& curves, std::size_t piece,
                        const SizeField& field, const CellNodes& nodes);

}  // namespace selvage::fem
