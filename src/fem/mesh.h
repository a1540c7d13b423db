// Tetrahedra with what a solver needs to know of them. Lengths in mm, moduli in MPa, densities in tonne/mm3
// (Abaqus's consistent set mm, N, s, tonne), angles in degrees.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/vec.h"
#include "fabric/model.h"

namespace selvage::fem {

// Quality of a set of elements. Dihedral angles in degrees; aspect: longest edge over the smallest height
// times sqrt(2/3) (1 for the regular tetrahedron); scaled Jacobian: 1 for the regular tetrahedron, <= 0
// inverted.
struct Quality {
  double min_dihedral = 180, max_dihedral = 0;
  double max_aspect = 0;
  double min_scaled_jacobian = 1;
  double mean_scaled_jacobian = 0;
};

struct BadElement {
  std::size_t element = 0;  // index into Mesh::elements
  double min_dihedral = 0;
  Vec3 at = Vec3::Zero();
};

// One yarn's part of the mesh: elements [first_element, last_element) of Mesh::elements, nodes alike (yarns
// of a dry fabric share no nodes).
struct Region {
  std::string name;      // the yarn's
  std::string material;  // key of Mesh::materials, may be empty
  std::size_t first_element = 0, last_element = 0;
  std::size_t first_node = 0, last_node = 0;
  std::vector<std::size_t> start_nodes, end_nodes;  // on the end faces; empty for a ring
  // Boundary triangles (corner nodes only, outward): body, then start and end face.
  std::vector<std::array<std::size_t, 3>> side_faces, start_faces, end_faces;
  double volume = 0;        // of the elements
  double exact_volume = 0;  // of the B-spline yarn
  Quality quality;
};

struct Mesh {
  int order = 1;  // 1: four nodes; 2: ten
  std::vector<Vec3> nodes;
  // Node indices from 0. Order of a ten-node tetrahedron: corners 0-3 with positive volume
  // ((p1-p0) x (p2-p0)) . (p3-p0) > 0, then the midpoints of the edges 01 12 20 03 13 23 (Abaqus C3D10, VTK).
  std::vector<std::array<std::size_t, 10>> elements;  // entries 4-9 unused with order 1
  // Unit tangent of the yarn, and a unit vector across the section, in each element.
  std::vector<Vec3> along, across;
  std::vector<Region> regions;
  std::vector<fabric::Material> materials;
  std::string title;
  Quality quality;
  std::vector<BadElement> worst;  // at most ten, worst first

  [[nodiscard]] int nodes_per_element() const { return order == 1 ? 4 : 10; }
};

}  // namespace selvage::fem
