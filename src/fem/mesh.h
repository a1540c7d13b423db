// Elements with what a solver needs to know of them. Lengths in mm, moduli in MPa, densities in tonne/mm3
// (Abaqus's consistent set mm, N, s, tonne), angles in degrees.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/parallelepiped.h"
#include "core/vec.h"
#include "fabric/model.h"
#include "fem/physics.h"

namespace selvage::fem {

// Quality of a set of elements. Dihedral angles in degrees; aspect: longest edge over the smallest height
// times sqrt(2/3) (1 for the regular tetrahedron), of hexahedra and wedges longest over shortest edge; scaled
// Jacobian: 1 for the regular tetrahedron (hexahedron, wedge), <= 0 inverted.
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

// How far the smallest dihedral angle that was wanted has been reached.
struct AngleTarget {
  double wanted = 0;          // degrees
  std::size_t below = 0;      // elements below it
  std::size_t in_wedges = 0;  // of these, where two triangles of the surface meet under a sharper angle
};

// Corner nodes of a side of an element, counter-clockwise seen from outside: three of a tetrahedron, whose
// third is repeated, or four of a hexahedron.
using ElementSide = std::array<std::size_t, 4>;

// One yarn's part of the mesh, or the matrix: elements [first_element, last_element) of Mesh::elements. Yarns
// of a dry fabric share no nodes, and theirs are [first_node, last_node); regions of a unit cell share those
// between them, and these two are 0.
struct Region {
  enum class Kind { yarn, matrix };
  Kind kind = Kind::yarn;
  std::string name;      // the yarn's, or "matrix"
  std::string material;  // key of Mesh::materials, may be empty
  std::size_t first_element = 0, last_element = 0;
  std::size_t first_node = 0, last_node = 0;
  std::vector<std::size_t> start_nodes, end_nodes;  // on the end faces; empty for a ring
  // The boundary: body, then start and end face. Of the matrix, and of what the faces of a unit cell cut,
  // there are none here.
  std::vector<ElementSide> side_faces, start_faces, end_faces;
  double volume = 0;        // of the elements
  double exact_volume = 0;  // of the B-spline yarn
  double length = 0;        // of a whole yarn's centre line; else 0
  Quality quality;
};

// A node of the yarns' surfaces: where it stands.
struct SurfacePlace {
  std::size_t body = 0;
  Vec2 parameters = Vec2::Zero();  // (u, v)
};

// The parallelepiped that a mesh fills: a unit cell. Nodes stand on its faces: those of a box to the bit,
// those of an oblique one to rounding (Parallelepiped::side_of).
struct UnitCell {
  // Its corners in the coordinates of its own axes, mm; x, y and z of a cell are along these axes.
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  ObliqueAxes axes;
  std::array<bool, 3> periodic{};  // x, y, z
  // Faces in the order A..F: x high, x low, y high, y low, z high, z low. Nodes without those on edges and
  // corners; where an axis is periodic, the k-th of its high face is opposite the k-th of its low one. With
  // order 2 midside nodes too.
  std::array<std::vector<std::size_t>, 6> face_nodes;
  // Without corners; number 4 a + k as in cell/cut.h. Where an axis across is periodic, the edges that face
  // each other over it have equally many, in the same order (increasing coordinate).
  std::array<std::vector<std::size_t>, 12> edge_nodes;
  std::array<std::size_t, 8> corners{};  // bit 0, 1, 2 of the number: high in x, y, z
  // Where regions share no nodes (Mesh::joining), each has a node in these sets that has a side in the face;
  // a region's other nodes in the corners, likewise numbered, are here.
  std::array<std::vector<std::size_t>, 8> more_corners;
  // The element sides on the faces, same order A..F; where an axis is periodic, the k-th opposite the k-th.
  std::array<std::vector<ElementSide>, 6> face_sides;

  [[nodiscard]] Parallelepiped shape() const { return {Box3(low, high), axes}; }
};

// One condition: sum of factor times displacement (of a cell that conducts: the potential) = 0. The first
// term's is the one that is eliminated.
struct Term {
  std::size_t node = 0;  // of Mesh::nodes; from Mesh::nodes.size() on: Mesh::drivers
  int direction = 0;     // 0, 1, 2: x, y, z; of a potential 0
  double factor = 0;
};
using Equation = std::vector<Term>;

// A node without a place in the mesh whose displacement along x is a strain (or a curvature, 1/mm) of the
// whole cell; the force on it is the stress times the cell's volume (plate: force, moment a length times its
// area; beam: force, moment times its length). Of a cell that conducts: whose potential is a mean gradient, a
// mm; the flux into it is the flux's density times the cell's volume.
struct Driver {
  std::string name;  // ConstraintsDriver0 .. 5: strains xx, yy, zz, xy, xz, yz (shear: engineering, gamma);
                     // of a plate 0, 1, 3, and CurvatureDriver0 .. 2: curvatures xx, yy, xy (twice); of a
                     // beam BeamDriver0 .. 3: strain, twist, curvatures; GradientDriver0 .. 2: gradients
  Vec3 at = Vec3::Zero();  // anywhere
};

// What is prescribed in one step: of each driver its value (none: free), and the temperature over the
// unstressed one.
struct LoadCase {
  std::string name;
  std::vector<std::optional<double>> drivers;
  double temperature = 0;  // K; of a cell that conducts it means nothing
};

// How regions of a unit cell hold together where they meet.
enum class Joining {
  bonded,    // they share nodes
  surfaces,  // each has nodes of its own: two surfaces that face each other
  cohesive   // so, and elements without thickness between them
};

// A triangle at which two regions meet, from both sides: equal places, in the same order, of different nodes.
// Seen from the second region the nodes go round counter-clockwise: the normal (p1 - p0) x (p2 - p0) points
// from the first region to the second. So `first` and then `second` are the nodes of a wedge without height.
struct FacingSides {
  struct Side {
    std::size_t element = 0, side = 0;   // index into element_sides() (fem/sides.h)
    std::array<std::size_t, 6> nodes{};  // corners; with order 2 the midpoints of the edges 01 12 20
  };
  Side first, second;
};

// Where two regions meet that share no nodes.
struct Interface {
  std::size_t first = 0, second = 0;  // of regions: a yarn, and a later yarn or the matrix
  std::size_t law = 0;                // index into Mesh::laws
  std::vector<FacingSides> sides;     // at least one
};

// Traction by opening, bilinear: stiffness up to the strength, then softening to the fracture energy (all of
// which fabric::Interface says the units of).
struct CohesiveLaw {
  std::string name;  // of both materials
  fabric::Interface::Pair stiffness;
  // Empty: nothing breaks.
  struct Fracture {
    fabric::Interface::Pair strength, energy;
  };
  std::optional<Fracture> fracture;
};

// A part of the boundary of a pore space (cell_problem/pores.h).
struct Patch {
  enum class Kind {
    wall,      // of one yarn
    periodic,  // a face of the cell that goes on as the opposite one
    open       // a face of the cell through which something may flow in or out
  };
  struct Side {
    // Index into element_sides() (fem/sides.h). Wedges of layers are numbered behind Mesh::elements.
    std::size_t element = 0, side = 0;
  };
  Kind kind = Kind::wall;
  std::string name;          // the yarn's; x_low, x_high; inlet_z, outlet_z (low and high)
  std::size_t opposite = 0;  // periodic: the patch whose k-th side is opposite the k-th
  std::vector<Side> sides;   // at least one
};

// Wedges along the walls of a pore space (cell_problem/layers.h).
struct WallLayers {
  int count = 0;  // one over another; 0: none
  std::vector<std::array<std::size_t, 6>>
      wedges;                       // as Abaqus's C3D6: the first three nodes on the wall's side
  std::vector<std::size_t> under;   // of each `count` of them the tetrahedron that they stand on
  double asked = 0, thickness = 0;  // of all together, mm: the means over the walls' nodes
  double thinned = 0;  // share of the walls' nodes at which they are less than half as thick as was asked
};

struct Mesh {
  enum class Shape { tetrahedron, hexahedron, beam };  // beam: of BeamModel (beams.h), two nodes
  Shape shape = Shape::tetrahedron;
  int order = 1;  // 1: corners; 2: ten nodes a tetrahedron
  std::vector<Vec3> nodes;
  // Node indices from 0. Order of a ten-node tetrahedron: corners 0-3 with positive volume
  // ((p1-p0) x (p2-p0)) . (p3-p0) > 0, then the midpoints of the edges 01 12 20 03 13 23 (Abaqus C3D10, VTK).
  // Of a hexahedron: four counter-clockwise seen from the other four, which stand over them (Abaqus C3D8,
  // VTK). A wedge is one whose third and seventh nodes are repeated (0 1 2 2, 4 5 6 6).
  std::vector<std::array<std::size_t, 10>> elements;  // the rest unused
  // Unit tangent of the yarn, and a unit vector across the section, in each element; x and y in the matrix.
  std::vector<Vec3> along, across;
  // Share of the section that is fibre, in each element: 0 in the matrix, NaN where nothing is known of a
  // yarn. Empty: not computed.
  std::vector<double> fibre_fraction;
  std::vector<Region> regions;
  std::vector<fabric::Material> materials;
  // Index into `materials` for each element; empty: by Region::material.
  std::vector<std::uint32_t> element_material;
  std::optional<UnitCell> cell;
  Joining joining = Joining::bonded;   // other ones: of a cell of tetrahedra
  std::vector<Interface> interfaces;   // by their regions; empty where all are bonded
  std::vector<CohesiveLaw> laws;       // of cohesive ones
  std::vector<Patch> patches;          // of a pore space, whose only region is named "pores"; else empty
  WallLayers layers;                   // of a pore space
  Physics physics = Physics::elastic;  // other ones: of a cell
  std::vector<Driver> drivers;
  std::vector<Equation> equations;
  std::vector<LoadCase> load_cases;
  std::string title;
  Quality quality;
  std::vector<BadElement> worst;  // at most ten, worst first
  std::optional<AngleTarget> angles;

  // Elements without thickness: one a pair of sides.
  [[nodiscard]] std::size_t cohesive_elements() const {
    std::size_t count = 0;
    if (joining == Joining::cohesive)
      for (const Interface& interface : interfaces) count += interface.sides.size();
    return count;
  }
  [[nodiscard]] int corners_per_element() const {
    return shape == Shape::beam ? 2 : shape == Shape::tetrahedron ? 4 : 8;
  }
  [[nodiscard]] int nodes_per_element() const {
    return shape == Shape::tetrahedron && order == 2 ? 10 : corners_per_element();
  }
  [[nodiscard]] std::span<const std::size_t> nodes_of(std::size_t element) const {
    return std::span(elements[element]).first(static_cast<std::size_t>(nodes_per_element()));
  }

  [[nodiscard]] bool is_wedge(std::size_t element) const {
    return shape == Shape::hexahedron && elements[element][2] == elements[element][3];
  }
  // Each node once: six of a wedge, three under the other three (Abaqus C3D6, VTK).
  [[nodiscard]] std::vector<std::size_t> different_nodes_of(std::size_t element) const {
    const auto& e = elements[element];
    if (is_wedge(element)) return {e[0], e[1], e[2], e[4], e[5], e[6]};
    const std::span<const std::size_t> all = nodes_of(element);
    return {all.begin(), all.end()};
  }
  [[nodiscard]] std::size_t count_wedges() const {
    std::size_t count = 0;
    for (std::size_t e = 0; e < elements.size(); ++e) count += is_wedge(e) ? 1 : 0;
    return count;
  }

  // The numbers of Term::node: nodes, then drivers.
  [[nodiscard]] std::size_t numbered() const { return nodes.size() + drivers.size(); }
  [[nodiscard]] std::size_t number_of_driver(std::size_t k) const { return nodes.size() + k; }
  [[nodiscard]] const Vec3& place(std::size_t number) const {
    return number < nodes.size() ? nodes[number] : drivers[number - nodes.size()].at;
  }
};

}  // namespace selvage::fem
