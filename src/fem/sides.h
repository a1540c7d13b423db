// The sides of elements at which regions end: for surfaces of contact, and of formats that carry them.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "fem/mesh.h"

namespace selvage::fem {

// Corners of an element's sides, counter-clockwise seen from outside; sides in Abaqus's order S1, S2, ..
// (also that of LS-DYNA's and ANSYS's manuals for the tetrahedron's), as indices of its nodes.
std::span<const ElementSide> element_sides(Mesh::Shape shape);
// The same of an element, which may be a wedge: its five sides, as of Abaqus's C3D6. Wedges of layers are
// numbered behind the elements.
std::span<const ElementSide> element_sides(const Mesh& mesh, std::size_t element);

// The nodes at the corners of a side.
ElementSide side_nodes(const Mesh& mesh, std::size_t element, std::size_t side);

// A side of an element of `region` that no other element of the region has.
struct OuterSide {
  static constexpr std::size_t outside = static_cast<std::size_t>(-1);
  std::size_t element = 0;
  std::size_t side = 0;  // index into element_sides(): Abaqus's S1 is 0
  std::size_t region = 0;
  std::size_t behind = outside;  // the region beyond it
  int face = -1;                 // 0..5, A..F: of the unit cell on which it lies; -1: none
  ElementSide nodes{};           // seen from out of the region
};

// All of them, in the order of the elements and their sides: an interface has one from each of its regions.
std::vector<OuterSide> outer_sides(const Mesh& mesh);

// The outward normal of a side with its area as length, of its corners.
Vec3 area_vector(const Mesh& mesh, const ElementSide& side);

}  // namespace selvage::fem
