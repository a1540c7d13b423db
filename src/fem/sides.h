// The sides of elements at which regions end: for surfaces of contact, and of formats that carry them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "fem/mesh.h"

namespace selvage::fem {

// Corners of an element's sides, counter-clockwise seen from outside; sides in Abaqus's order S1, S2, ..
// (also that of LS-DYNA's and ANSYS's manuals for the tetrahedron's). Of a triangle the last entry repeats
// the third.
inline constexpr std::array<std::array<std::size_t, 4>, 4> tetrahedron_sides = {
    {{0, 2, 1, 1}, {0, 1, 3, 3}, {1, 2, 3, 3}, {2, 0, 3, 3}}};
inline constexpr std::array<std::array<std::size_t, 4>, 6> hexahedron_sides = {
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

// A side of an element of `region` that no other element of the region has.
struct OuterSide {
  static constexpr std::size_t outside = static_cast<std::size_t>(-1);
  std::size_t element = 0;
  std::size_t side = 0;  // index into the tables above: Abaqus's S1 is 0
  std::size_t region = 0;
  std::size_t behind = outside;        // the region beyond it
  int face = -1;                       // 0..5, A..F: of the unit cell on which it lies; -1: none
  std::array<std::size_t, 4> nodes{};  // corner nodes, counter-clockwise seen from out of the region
};

// All of them, in the order of the elements and their sides: an interface has one from each of its regions.
std::vector<OuterSide> outer_sides(const Mesh& mesh);

// The outward normal of a side with its area as length, of its corners.
Vec3 area_vector(const Mesh& mesh, const OuterSide& side);

}  // namespace selvage::fem
