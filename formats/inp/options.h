// What the command line says of Abaqus and CalculiX decks alone.
#pragma once

#include <vector>

#include "core/option.h"

namespace selvage::formats::inp::option {

inline constexpr Option split_deck = {
    .name = "--split-deck",
    .help =
        "nodes, elements, sets and surfaces in a file of their own, NAME_mesh.inp, which NAME.inp includes"};

inline constexpr Option brick = {
    .name = "--brick",
    .help =
        "the element of swept hexahedra: reduced integration, full, or with incompatible modes, which "
        "bend rightly even where few lie over the thickness",
    .argument = Argument::one_of("C3D8R C3D8 C3D8I"),
    .preset = "C3D8R",
    .why = "is of swept hexahedra",
    .needs = "--elements"};

inline constexpr Option tetrahedron = {
    .name = "--tetrahedron",
    .help =
        "the element of tetrahedra with ten nodes: the usual one, or Abaqus's modified one, for contact, "
        "plasticity and large strains",
    .argument = Argument::one_of("C3D10 C3D10M"),
    .preset = "C3D10",
    .why = "asks for an element of ten nodes that Abaqus has and CalculiX has not",
    .needs = "--order",
    .not_with = "--voxel --physics --solver"};

inline constexpr Option solver = {
    .name = "--solver",
    .help =
        "whose way the sections of beams are said: abaqus has general ones, calculix takes ellipses and "
        "rectangles by two thicknesses (other sections become the ellipse with their second moments)",
    .argument = Argument::one_of("abaqus calculix"),
    .preset = "abaqus",
    .why = "is of beams",
    .needs = "--elements"};

inline std::vector<const Option*> all() {
  return {&split_deck, &brick, &tetrahedron, &solver};
}

}  // namespace selvage::formats::inp::option
