// What the report says of a mesh.
#pragma once

#include <optional>
#include <string>

#include "cell_problem/pores.h"
#include "core/diagnostics.h"
#include "fem/forming.h"
#include "fem/mesh.h"
#include "pipeline/report.h"
#include "structured/beams.h"
#include "structured/raster.h"

namespace selvage::pipeline {

// Of tetrahedra or hexahedra, of dry yarns or a unit cell; `estimate`: how many tetrahedra were expected.
Json mesh_json(const fem::Mesh& mesh, std::optional<double> estimate = {});

// Of yarns as beams, with their contacts.
Json beams_json(const fem::BeamModel& beams);
std::string beams_in_words(const fem::BeamModel& beams);

// Of an explicit step: what is done, and how many increments that takes.
Json forming_json(const fem::Forming& forming);
std::string forming_in_words(const fem::Forming& forming);

// Of tetrahedra: how many, and how sharp their angles are.
std::string tetrahedra_in_words(const fem::Mesh& mesh);
// Of a mesh that has interfaces.
std::string interfaces_in_words(const fem::Mesh& mesh);
// Of a pore space that has layers (Mesh::layers).
std::string layers_in_words(const fem::Mesh& mesh, Unit units);

// Of swept hexahedra: how many, and the worst.
std::string hexahedra_in_words(const fem::Mesh& mesh);

// How much of a unit cell is yarn and fibre, and how far the volumes of regions are from those of the
// B-spline yarns, the worst by name. Empty: nothing is known.
std::string volumes_in_words(const fem::Mesh& mesh);

// A volume that is wrong by more than a mesh of the usual size ever has.
std::optional<Message> wrong_volume(const fem::Mesh& mesh);

// Of a pore space: along which axes something can flow.
Json passages_json(const fem::Passages& passages);
std::string passages_in_words(const fem::Passages& passages);

// Axes along which nothing can flow, and pockets without a passage.
std::optional<Message> shut_pores(const fem::Mesh& mesh, const fem::Passages& passages);

// The same of fields on voxels.
Json raster_json(const fem::Raster& raster);
std::string raster_in_words(const fem::Raster& raster);

}  // namespace selvage::pipeline
