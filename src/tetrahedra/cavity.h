// A new point in place of a bad tetrahedron and those round it.
#pragma once

#include <cstdint>
#include <vector>

#include "tetrahedra/point_place.h"
#include "tetrahedra/tet_complex.h"

namespace selvage::fem {

// A cavity grows from a bad tetrahedron over the worst of its sides while the tetrahedra between its sides
// and a new point in it get better; the point is moved to its best place (after Klingner and Shewchuk 2007).
class CavityInsertion {
 public:
  explicit CavityInsertion(TetComplex& complex) : complex_(complex) {}

  // Puts a point near the cell if that raises the smallest quality of the cells that it replaces; tries
  // places on its inner edges and its middle. `goal`: a quality that is good enough.
  bool improve(std::uint32_t cell, double goal, std::vector<std::uint32_t>& added);

 private:
  struct Side {
    TetFace corners;
    std::uint32_t cell;  // inside
    std::size_t slot;
    double quality;
  };
  struct Cavity {
    std::vector<std::uint32_t> cells;
    std::vector<Side> sides;
    Vec3 at = Vec3::Zero();
    double quality = inverted_quality;  // of the new cells
    double replaced = 1;                // of the old ones
  };
  bool start(const std::vector<std::uint32_t>& seed, const Vec3& at, Cavity& cavity) const;
  void add_sides(Cavity& cavity, std::uint32_t cell) const;
  bool add_cell(Cavity& cavity, std::uint32_t cell) const;
  [[nodiscard]] Vec3 middle_of(std::uint32_t cell) const;
  void grow(Cavity& cavity) const;
  void place(Cavity& cavity, double goal);
  void attempt(const std::vector<std::uint32_t>& seed, const Vec3& at, double goal, Cavity& best);

  TetComplex& complex_;
  PointPlace point_place_;
  std::vector<StarSide> star_;
  std::vector<Tetrahedron> new_cells_;
};

}  // namespace selvage::fem
