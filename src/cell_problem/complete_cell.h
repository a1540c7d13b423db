// What makes a mesh of a box a unit cell: which nodes and element sides lie on its faces, edges and corners,
// the conditions that tie opposite ones, and the load cases that give its stiffness and thermal expansion.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/diagnostics.h"
#include "core/parallelepiped.h"
#include "fem/mesh.h"

namespace selvage::fem {

// Fills Mesh::cell, drivers, equations and load_cases of a finished mesh (midside nodes and regions too), of
// either shape. `shape` in mm; strains and curvatures are along the axes of space, whatever the cell's own
// are.
//
// Periodic x, y, z (a block): the displacement is E x + what repeats, E the symmetric strain; periodic x, y
//   (a plate; z faces free): Kirchhoff's, u = (E + z K) (x, y), w = -(x, y) K (x, y) / 2 about the middle of
//   the cell, + what repeats; periodic along one axis a (a beam; all other faces free), with b and c across,
//   a b c right-handed, about the middle of the cell: the strain e + b kb + c kc and the twist k, u = (a (e +
//   b kb + c kc), -k a c - kb a^2 / 2, k a b - kc a^2 / 2), + what repeats (so that all stresses do). Each
//   node on a high side depends on the one on the low side (of edges and corners: on the lowest) and on the
//   drivers, and on nothing else; no node depends on one that depends. Some nodes are to be held:
//   cell_problem/supports.h.
// No periodic axis: every node of the faces is displaced by E x about the middle: an upper bound of the
//   stiffness.
// A cell that conducts (Mesh::physics) has one unknown a node, the potential: G x + what repeats, G the mean
//   gradient; of a plate, whose z faces let nothing through, along x and y. Without a periodic axis every
//   node of the faces has G x: an upper bound.
// Regions that share no nodes (Mesh::joining) are parted first: cell_problem/interfaces.h.
// A pore space (Mesh::patches) gets sets alone: nothing holds its nodes.
// Load cases: each driver's strain (curvature) 0.001 (1/mm) with the others zero, and 1 K with all of them
//   zero; of a cell that conducts each driver's gradient 1 a mm. None where parts of a plate or a block do
//   not hang together (yarns without a matrix): they would fly apart. Those of a beam may: its ends hold
//   each.
//
// Errors: internal (a node beside a face's plane), geometry (opposite faces do not match to 1e-12 of the
// size; a matrix whose parts do not hang together; a part of a beam that its ends do not hold), unsupported
// (periodic along x and z, or y and z; a beam that conducts).
Status complete_cell(Mesh& mesh, const Parallelepiped& shape, std::array<bool, 3> periodic);

// For each axis and node: the node opposite on the low side; no_node: it is not on the high side of the axis,
// or the axis is not periodic. `nodes`: how many there are.
std::array<std::vector<std::size_t>, 3> opposite_nodes(const UnitCell& cell, std::size_t nodes);

// No node there (UnitCell::corners).
inline constexpr std::size_t no_node = static_cast<std::size_t>(-1);

}  // namespace selvage::fem
