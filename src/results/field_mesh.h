// A mesh as it was read, with what was computed on it: to be looked at, not to be solved.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/vec.h"

namespace selvage::fem {

struct FieldMesh {
  enum class Shape : std::uint8_t { triangle, quadrilateral, tetrahedron, pyramid, wedge, hexahedron };
  // Corners alone, in VTK's order; midside nodes are left out.
  struct Element {
    Shape shape = Shape::tetrahedron;
    std::array<std::uint32_t, 8> corners{};  // indices of nodes; the rest unused
    std::uint32_t region = 0;
  };
  struct Field {
    std::string name;
    bool of_nodes = true;  // else of elements
    int components = 1;    // 6: xx yy zz xy yz zx
    std::vector<float> values;
    int step = 0;  // from 1, of `steps`; 0: of none
  };
  std::vector<Vec3> nodes;
  std::vector<Element> elements;
  std::vector<std::string> regions;
  std::vector<Field> fields;
  std::vector<std::string> steps;                   // what each set of results is of: "step 2", "strain xx"
  std::vector<long> node_numbers, element_numbers;  // of files that number them; else empty
};

// Is a region of this name the matrix of a unit cell, as this program's files call it?
bool is_matrix(const std::string& region);

std::size_t corner_count(FieldMesh::Shape shape);

// The triangles of the elements' sides that no other element of the same region has: the outsides of all
// regions, outward, those of a region together and in the order of the regions. Elements that are surfaces
// are their own outside.
struct Outside {
  std::vector<std::array<std::uint32_t, 3>> triangles;  // nodes
  std::vector<std::uint32_t> element;                   // of each triangle
  std::vector<std::uint8_t>
      inner;  // 1 to 3: its edge opposite of this corner cuts a side of four corners; else 0
};
Outside outside_of(const FieldMesh& mesh);

}  // namespace selvage::fem
