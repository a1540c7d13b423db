// How a yarn's section is divided into quadrilaterals, and triangles at its tips: the same all along the
// yarn, so that each becomes a column of hexahedra or wedges.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::fem {

struct SectionPattern {
  // Parameters of the nodes on the outline, first u <= value < last u; one after the other the way the
  // surface runs round, the first anywhere.
  std::vector<double> ring;
  // Of each node inside the shares that nodes on the outline have in its place; they sum to one. What moves
  // the section moves its inside alike.
  using Shares = std::vector<std::pair<std::size_t, double>>;  // index into `ring`, share
  std::vector<Shares> inside;
  // Nodes of each piece, those inside behind those on the outline, the way the ring runs round; of a triangle
  // the third is repeated.
  std::vector<std::array<std::size_t, 4>> pieces;

  [[nodiscard]] std::size_t size() const { return ring.size() + inside.size(); }
  // The places of the inner nodes, from those on the outline.
  [[nodiscard]] std::vector<Vec3> fill(std::span<const Vec3> outline) const;
};

// The best of a few patterns, by the worst corner that it has in sections all along the yarn:
//   columns: across the width from tip to tip, where they end in triangles; where two tips are sharp always,
//     else where the others are much worse, for wedges are stiff;
//   ring: a block of squares with one layer round it;
//   block: squares alone, where the section has four sharp corners.
// Pieces are about `size` (file units, > 0) through the thickness and up to two and a half times that along
// the width; where sharp tips end in triangles, no more than two of them lie over one another. Nodes inside a
// ring or block are the means of their neighbours: W. T. Tutte, How to draw a graph, Proc. London Math. Soc.
// 13 (1963); in a convex outline no piece folds.
SectionPattern section_pattern(const yarn::Body& body, double size);

}  // namespace selvage::fem
