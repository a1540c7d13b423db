// Which values of a mesh's results a picture shows.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "results/field_mesh.h"

namespace selvage::pipeline {

struct ShownValues {
  std::vector<float> values;  // of nodes or elements
  bool of_nodes = true;
  std::string title;  // "stress along the fibre, MPa", with its step where there are several
};

// `step`: from 1, of FieldMesh::steps; 0: the last. Error (unsupported): there is none of this number.
Result<int> step_of(const fem::FieldMesh& mesh, int step);

// `wanted`: a field as the file calls it, or one of displacement, stress, strain, temperature, flux, force,
// in any case; then perhaps a part: `.x`, `.xx`, `.size`, `.mises`, `.fibre`, a number from 0. Without a part
// of vectors the size, of tensors the equivalent of von Mises. Errors (unsupported): there is no such field
// or part, with those that there are.
Result<ShownValues> values_of(const fem::FieldMesh& mesh, std::string_view wanted, int step);

// The displacements of a step; null: there are none.
const fem::FieldMesh::Field* displacements_of(const fem::FieldMesh& mesh, int step);

}  // namespace selvage::pipeline
