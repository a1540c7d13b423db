// Pictures of meshes that were read, with what was computed on them.
#pragma once

#include <string>

#include "pipeline/job.h"
#include "results/field_mesh.h"

namespace selvage::pipeline {

// As the command line asks for it, as a PNG file: regions by colours, or a field with its legend. What cannot
// be shown is an error, and said.
std::optional<std::string> draw_mesh(Job& job, fem::FieldMesh mesh);

}  // namespace selvage::pipeline
