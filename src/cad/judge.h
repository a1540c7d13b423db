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

// Defects: edges of a solid that have no neighbour, or one that is farther than kernels sew; loops that are
// open, or leave the range of their surface, by more than that, or lie off it; faces without area; faces of a
// solid that look to the other side than those beside them, and solids of untrimmed faces that are inside
// out; the same face twice; knots out of order or repeated too often; weights that are not positive.
// Warnings: gaps above the tolerance that kernels sew; gaps and open edges of what is no solid; edges off
// their surface by more than ten times the tolerance; surfaces that are closed but for less than the
// tolerance. Each distance of an edge from its surface is one that the surface is proven to have at least
// (SurfaceSet::least_distance).
//
// The tolerance is the file's resolution, and at least a millionth of the part's size. Kernels sew up to
// more: here 0.02 mm, and at most a ten-thousandth of the model's size. OpenCASCADE's reader makes such edges
// tolerant (up to read.maxprecision.val, 1 mm); Creo joins by 0.0012 of the size. Checks of what the car
// makers exchange draw the line at 0.02 mm (VDA 4955 as ModelCHECK in Creo has it, position continuity) or
// 0.01 mm (CADdoctor's large edge face, face and curve gaps for Nissan). Sound files of the CAx-IF's test
// rounds need up to 0.0064 mm (the tolerances that OpenCASCADE gives their edges).
Measures judge(const Model& model, Findings& findings);

// What Creo, ANSYS, Abaqus/CAE, OpenCASCADE, SolidWorks and gmsh are known to stumble on, as warnings with
// the remedy; as notes where it is harmless. `is_iges`: the file has the entities of IGES, of which some
// systems ignore a few.
void judge_for_receivers(const Model& model, const Measures& measures, bool is_iges, Findings& findings);

// The absolute accuracy to set in Creo, in the model's unit: a hundredth of the shortest border, but at least
// twice the largest gap, rounded to 1, 2 or 5 times a power of ten. None where there is no border.
std::optional<double> absolute_accuracy(const Measures& measures);

}  // namespace selvage::cad
