// Points put inside regions until their tetrahedra are neither too large nor too slender.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "tetrahedra/tet_complex.h"

namespace selvage::fem {

// Of a tetrahedron where edges of about `edge` are wanted: between half of it and all of it, it is as large
// as the regular one (which has 0.118 of the cube over its edge) with edges of 1.07 to 1.35.
constexpr double largest_volume(double edge) {
  return 0.29 * edge * edge * edge;
}

struct RefineOptions {
  double radius_edge = 1.5;  // largest ratio of circumradius to shortest edge wanted, from 1
  double max_volume = 0;     // of a tetrahedron; 0: no bound
};

// Delaunay refinement (Shewchuk, 14th Symp. Computational Geometry, 1998): a tetrahedron that is too large or
// too slender is given a point at its circumcentre, and those whose circumspheres hold the point are replaced
// by others round it (Bowyer, Watson, 1981). Walls stay as they are: no cavity crosses one, and a centre that
// is behind one, or so near to one that flat tetrahedra would stand on it, is left out. Cavities are cut back
// to what the point sees, so that all tetrahedra stay positive whatever was Delaunay before.
//
// It ends: no point is ever lost, and no edge gets shorter than the shortest one at the beginning or, where a
// bound of volume asks for it, 0.74 / radius_edge of the edge of a cube of that volume (a tetrahedron of
// circumradius R has at most 0.52 R^3, and one that is only too large no edge below R / radius_edge, of which
// 0.6 is kept).
// With the least angle under which a point sees a side, each triangle that is made has at least a certain
// area, and each tetrahedron at least a certain volume, of which the region holds so many and no more.
class Refiner {
 public:
  Refiner(TetComplex& complex, const RefineOptions& options) : complex_(complex), options_(options) {}

  // Returns the number of points put in. The cells are not measured (TetComplex::measure_all).
  std::size_t run();

 private:
  struct Ball {
    Vec3 centre;
    double square = 0;       // of the radius
    std::uint32_t mark = 0;  // 2 walk_: outside of the cavity, 2 walk_ + 1: in it
    bool is_bad = false;     // the cell is to be split
    double clearance = 0;    // square of the distance that a point at the centre keeps from others
  };
  void measure(std::uint32_t cell);
  bool split(std::uint32_t cell);
  [[nodiscard]] std::uint32_t locate(std::uint32_t from, const Vec3& at) const;
  void grow(std::uint32_t start, const Vec3& at);
  bool keeps_points();
  bool cut_back(std::uint32_t start, const Vec3& at);
  [[nodiscard]] bool is_inside(std::uint32_t cell) const { return balls_[cell].mark == 2 * walk_ + 1; }
  [[nodiscard]] bool sees(const Vec3& at, std::uint32_t cell, std::size_t slot) const;
  [[nodiscard]] bool is_clear(const Vec3& at, std::uint32_t cell, std::size_t slot, double square) const;

  TetComplex& complex_;
  RefineOptions options_;
  std::vector<Ball> balls_;  // round each cell
  std::vector<std::uint32_t> queue_, cavity_, added_;
  std::vector<std::uint32_t> outer_;  // of each point: the last walk on whose cavity's sides it was
  std::uint32_t walk_ = 0;
  std::vector<TetComplex::Side> sides_;
};

}  // namespace selvage::fem
