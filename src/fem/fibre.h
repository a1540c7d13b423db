// The fibres in the elements of a cell: which way they run, how much of the yarn they are, and how stiff that
// makes it.
#pragma once

#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "fem/mesh.h"
#include "yarn/body.h"

namespace selvage::fem {

// Of each element of a region the parameter (v) of the point of the yarn's centre line nearest to its middle.
// `known`: one a node of the mesh, its v where it stands on this yarn's surface, else NaN: places spread from
// there, so that another turn of the yarn nearby is not mistaken for this one. Every part of the region needs
// one such node. `unit`: length of the mesh's unit by the body's (1 when both are file units).
std::vector<double> parameters_along(const Mesh& mesh, const Region& region, const yarn::Body& body,
                                     std::span<const double> known, double unit);

// The same where a guess of each element's is known: `parameters` holds them, one an element of the region.
void settle_parameters(const Mesh& mesh, const Region& region, const yarn::Body& body,
                       std::span<double> parameters, double unit);

// Unit direction of a yarn's fibres at a place `off` its centre line (file units) whose unit tangent is
// `tangent`: the helix of Body::twist, inclined by atan(2 pi r twist) at a radius r; Z (positive) is
// right-handed.
Vec3 fibre_direction(const yarn::Body& body, const Vec3& tangent, const Vec3& off);

// Fills Mesh::along, across and fibre_fraction (resized where they are too short: x, y and 0, as in a matrix)
// of the region's elements. along: fibre_direction at the element's middle; across: from the centre
// line towards the section's seam (on a section with axes along its width), perpendicular to `along`, unit.
// `unit`: as above. The fraction is the yarn's fibre area (Body::fibre_area) by the area of its B-spline
// section there.
void add_fibres(Mesh& mesh, const Region& region, const yarn::Body& body, std::span<const double> parameters,
                double unit);

// Area across the centre line of the B-spline section at v, file units squared.
double section_area(const yarn::Body& body, double v);

// Length of the outline of the B-spline section at v, file units, to about 1e-4 of it.
double section_perimeter(const yarn::Body& body, double v);

// Constants of a yarn (transverse isotropic) of a share `fraction` of fibres in a matrix: C. C. Chamis,
// Simplified composite micromechanics equations for hygral, thermal and mechanical properties, NASA TM-83320
// (1983); nu23 follows from E2 and G23. Strengths where the fibres have some (those along them count) and the
// matrix all three: C. C. Chamis, Simplified composite micromechanics equations for strength, fracture
// toughness, impact resistance and environmental effects, NASA TM-83696 (1984); in compression along the
// least of crushed fibres, shear and microbuckling; in shear across half of the one in compression.
// Precondition: both have elastic constants, the matrix isotropic ones; 0 < fraction < 1.
fabric::Material chamis(const fabric::Material& fibre, const fabric::Material& matrix, double fraction);

// Gives each element of a yarn the constants of its own fibre fraction (rounded to hundredths: a material
// each, named NAME_vf062), taking its material's as those of the fibres. Warnings: yarns whose fraction is
// not known, or not between 0 and 1: they keep what they have; fibres with strengths in a matrix without:
// their yarns have none. Error (geometry): no matrix, or one that is
// not isotropic.
Status derive_yarn_stiffness(Mesh& mesh, Diagnostics& diagnostics);

}  // namespace selvage::fem
