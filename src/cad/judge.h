// Is the geometry of a CAD file sound? And what of it would a receiving system stumble on?
#pragma once

#include <optional>
#include <string>

#include "cad/model.h"
#include "core/findings.h"

namespace selvage::cad {

// Measures of a model, in its unit.
struct Measures {
  std::size_t faces = 0, borders = 0;
  std::size_t open_borders = 0;  // of solids and of parts with several faces: no other face beside them
  std::size_t poles = 0;         // borders of untrimmed faces that are one point
  Origin first_pole;             // of the face that has the first of them
  double size = 0;               // largest side of the box round everything
  double tolerance = 0;          // up to which edges count as joined: see judge()
  double largest_gap = 0;        // between edges that are neighbours
  std::optional<Vec3> gap_at;
  std::string gap_entity;
  // Of a point of a border with another border, and of a face with a face: the work that was done.
  std::size_t comparisons = 0;
  double shortest_border = 0;  // that is no pole; 0: there is none
  TextPlace shortest_place;
  std::string shortest_entity;
  std::optional<double> least_area, largest_area;  // of untrimmed faces
  std::string least_area_entity;
  TextPlace least_area_place;
  int largest_degree = 0;
  double least_weight = 1;
};

// Defects: edges of a solid that have no neighbour, or one that is farther than the tolerance; loops that are
// not closed, leave the range of their surface, or lie off it; faces without area; the same face twice; knots
// out of order or repeated too often; weights that are not positive. In what is no solid, gaps and open edges
// are warnings. Warnings: surfaces that are closed but for less than the tolerance. The tolerance is the
// file's resolution, and at least a millionth of the part's size.
Measures judge(const Model& model, Findings& findings);

// What Creo, ANSYS, Abaqus/CAE, OpenCASCADE, SolidWorks and gmsh are known to stumble on, as warnings with
// the remedy; as notes where it is harmless. `is_iges`: the file has the entities of IGES, of which some
// systems ignore a few.
void judge_for_receivers(const Model& model, const Measures& measures, bool is_iges, Findings& findings);

// The absolute accuracy to set in Creo, in the model's unit: a hundredth of the shortest border, but at least
// twice the largest gap, rounded to 1, 2 or 5 times a power of ten. None where there is no border.
std::optional<double> absolute_accuracy(const Measures& measures);

}  // namespace selvage::cad
