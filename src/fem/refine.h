// Points put inside regions until their tetrahedra are neither too large nor too slender.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"
#include "fem/tet_complex.h"

namespace selvage::fem {

struct RefineOptions {
  double radius_edge = 1.4;  // largest ratio of circumradius to shortest edge wanted
  double max_volume = 0;     // of a tetrahedron; 0: no bound
};

// Delaunay refinement (Shewchuk, 14th Symp. Computational Geometry, 1998): a tetrahedron that is too large or
// too slender is given a point at its circumcentre, and those whose circumspheres hold the point are replaced
// by others round it (Bowyer, Watson, 1981). Walls stay as they are: no cavity crosses one, and a centre that
// is behind one, or so near to one that flat tetrahedra would stand on it, is left out. Cavities are cut back
// to what the point sees, so that all tetrahedra stay positive whatever was Delaunay before.
class Refiner {
 public:
  Refiner(TetComplex& complex, const RefineOptions& options) : complex_(complex), options_(options) {}

  // Returns the number of points put in.
  std::size_t run();

 private:
  struct Ball {
    Vec3 centre;
    double square = 0;       // of the radius
    std::uint32_t mark = 0;  // 2 walk_: outside of the cavity, 2 walk_ + 1: in it
    bool is_bad = false;     // the cell is to be split
    double clearance = 0;    // square of the distance that a point put there keeps from others
  };
  void measure(std::uint32_t cell);
  bool split(std::uint32_t cell);
  [[nodiscard]] std::uint32_t locate(std::uint32_t from, const Vec3& at) const;
  void grow(std::uint32_t start, const Vec3& at);
  bool cut_back(std::uint32_t start, const Vec3& at);
  [[nodiscard]] bool is_inside(std::uint32_t cell) const { return balls_[cell].mark == 2 * walk_ + 1; }
  [[nodiscard]] bool sees(const Vec3& at, std::uint32_t cell, std::size_t slot) const;
  [[nodiscard]] bool is_free(const Vec3& at, double least_square) const;

  TetComplex& complex_;
  RefineOptions options_;
  std::vector<Ball> balls_;  // round each cell
  std::vector<std::uint32_t> queue_, cavity_, added_;
  std::uint32_t walk_ = 0;
  std::vector<TetComplex::Side> sides_;
};

}  // namespace selvage::fem
