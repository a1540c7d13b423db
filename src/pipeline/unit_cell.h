// What a unit cell has to be before it is meshed or cut: everything that can be wrong with it is said here,
// with its place in the text, the yarn and the remedy.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "construction/build.h"
#include "fabric/model.h"
#include "pipeline/job.h"
#include "yarn/body.h"

namespace selvage::pipeline {

// The gap that constructions keep between their yarns where a cell is meshed or cut: --gap, or 5 % of the
// thinnest section; file units. 0: their own.
double gap_of_constructions(const Options& options, const fabric::Fabric& fabric);

// The message, said of the `cell` statement where it has no place in the text of its own.
Message at_cell(const fabric::Fabric& fabric, Message message);

// --matrix-material, where it is given and there is a cell. False: it was said that it is no material.
bool set_matrix_material(Job& job, fabric::Fabric& fabric);
// Is there a cell, with a matrix where one is wanted? False: it was said what is missing.
bool check_cell_text(Job& job, const fabric::Fabric& fabric, bool with_matrix);

// Sides of the cell along its periodic axes that are whole repeats of the yarns to a thousandth of one, but
// not to rounding, become so: the high face moves, and it is said. `fabric` is the builder's.
void snap_cell(Job& job, fabric::Fabric& fabric, const fabric::YarnBuilder& builder);

// Those that reach into the cell, in their order, the others dropped. Empty: it was said that there are none.
std::vector<yarn::Body> yarns_in_cell(Job& job, const fabric::Fabric& fabric, std::vector<yarn::Body> bodies);

// The axes along which the cell is periodic: those that its text names; where it names none, all along which
// its yarns repeat. None: the cell is no whole number of repeats, the yarns end, or elements know no cell
// that is periodic along these (cell_problem/cell_kind.h; along one only where that was said or the cloth has
// no other repeat; it was said).
std::optional<std::array<bool, 3>> periodic_axes(Job& job, const fabric::Fabric& fabric,
                                                 const fabric::YarnBuilder& builder,
                                                 std::span<const yarn::Body> bodies);

// No yarn touches or leaves through a free face: the top and the bottom of what is not periodic through the
// thickness, and of a beam all but its ends.
bool check_free_faces(Job& job, const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                      const std::array<bool, 3>& periodic);

// No yarn's surface runs along a face of the cell nearer than half a per cent of its thickness (without
// --force).
bool check_grazed_faces(Job& job, const fabric::Fabric& fabric, std::span<const yarn::Body> bodies);

// No two yarns overlap in the cell, or come nearer than 1 % of the thinner one; a warning where they come
// nearer than `wanted` (file units).
bool check_cell_gaps(Job& job, const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                     double wanted);

// The edge lengths in force, and about how many tetrahedra they make; both are said.
struct CellSize {
  std::vector<double> sizes;  // of each yarn, file units
  double coarsest = 0;        // away from them; 0: as on them
  double growth = 0;          // per length
  double tetrahedra = 0;
};
// None: too coarse for a yarn, too fine for any memory (without --force), or in the matrix finer than on the
// yarns.
std::optional<CellSize> check_cell_size(Job& job, const fabric::Fabric& fabric,
                                        std::span<const yarn::Body> bodies, int order, bool with_matrix);

}  // namespace selvage::pipeline
