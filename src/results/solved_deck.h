// What a deck says of the results that a solver has computed from it: enough to reckon its stresses from the
// displacements, each region by itself.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "results/field_mesh.h"

namespace selvage::fem {

using Stiffness = Eigen::Matrix<double, 6, 6>;  // xx yy zz xy yz zx, of stresses to engineering strains; MPa

struct SolvedDeck {
  struct Section {
    bool is_oriented = false;  // along fibres: the material's 1 is along, 2 across
    Stiffness stiffness = Stiffness::Zero();
    Vec3 expansion = Vec3::Zero();  // a kelvin, along 1, 2 and 3
  };
  struct Element {
    std::vector<long>
        nodes;  // as the solver orders them: 4 or 10 of a tetrahedron, 6 of a wedge, 8 of a hexahedron
    std::uint32_t region = 0, section = 0;
    Vec3 along = Vec3::UnitX(), across = Vec3::UnitY();  // unit, of sections that are oriented
  };
  struct Step {
    std::string title;   // the comment before it; may be empty
    double warming = 0;  // kelvin above the initial temperature
  };
  std::vector<std::string> regions;  // element sets that elements were given with: yarns and the matrix
  std::vector<Section> sections;
  std::unordered_map<long, Element> elements;
  std::vector<Step> steps;
};

// Makes results those of the deck: regions are its, with nodes of their own where they meet; steps are called
// as the deck calls them; fields `STRESS` and `TOSTRAIN` are reckoned anew from the displacements of each
// step, as strains times the section's stiffness, at the corners of tetrahedra with ten nodes and at the
// middles of other elements, and averaged at nodes over the elements of the region alone. (CalculiX's own are
// averages over both materials where two meet, which halves what a yarn's surface carries.) Adds the field
// `along` of nodes, unit vectors, not a number where there are no fibres. Errors: malformed: the results are
// those of another deck (an element that it has not, or with other nodes).
Status apply(const SolvedDeck& deck, FieldMesh& mesh);

// Gives regions that share nodes nodes of their own, with the same values.
void part_regions(FieldMesh& mesh);

inline constexpr std::string_view along_the_fibre = " along the fibre";  // behind a field's name

// Adds to each stress and strain the field of its component along the fibre, where there is a field `along`
// of nodes or elements: `STRESS along the fibre`. False: there is none.
bool add_along_fibre(FieldMesh& mesh);

}  // namespace selvage::fem
