// The best tetrahedra round an edge: without it, or with fewer of them at it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tetrahedra/tet_complex.h"

namespace selvage::fem {

// Dynamic programming over the points round an edge (Klincsek 1980, as Shewchuk, "Two discrete optimization
// algorithms for the topological improvement of tetrahedral meshes", 2002, has it), extended to edges that
// stay: of the points round them some are cut off, which are joined to the edge's two ends only. So an edge
// in a wall can lose tetrahedra too.
class RingExchange {
 public:
  explicit RingExchange(TetComplex& complex) : complex_(complex) {}

  // Raises the smallest quality of the cells round an edge if it can; `added`: the new cells.
  bool improve(std::uint32_t cell, std::size_t edge, std::vector<std::uint32_t>& added);

 private:
  static constexpr std::size_t most = 10;  // cells round an edge
  using Table = std::array<std::array<double, most + 2>, most + 2>;

  [[nodiscard]] std::uint32_t corner(std::size_t k) const { return ring_.around[k % ring_.around.size()]; }
  double triangle_quality(std::size_t i, std::size_t j, std::size_t k);
  double at_edge(std::size_t i, std::size_t j);
  void cut_off_best();
  double best_chain(std::size_t start);
  void emit_fan(std::size_t i, std::size_t length);
  void emit_chain(std::size_t start);

  TetComplex& complex_;
  TetComplex::Ring ring_;
  double bound_ = 0;
  // Of the polygon of `length` steps from point i, closed by its chord: the best smallest quality of the
  // tetrahedra over its triangles, and where its triangle at the chord has its third corner.
  Table fan_{};
  std::array<std::array<std::uint8_t, most + 2>, most + 2> apex_{};
  std::array<std::uint8_t, most + 2> previous_{};
  std::array<std::array<std::array<double, most + 1>, most + 1>, most + 1> triangle_{};
  Table at_edge_{};
  std::vector<Tetrahedron> new_cells_;
};

}  // namespace selvage::fem
