#include "fuzz/field_mesh.h"

#include <algorithm>
#include <cstdlib>

#include "pipeline/result_fields.h"
#include "results/solved_deck.h"

namespace selvage::fuzz {

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

void evaluate(fem::FieldMesh& mesh) {
  fem::add_along_fibre(mesh);
  for (const fem::FieldMesh::Element& element : mesh.elements) {
    require(element.region < mesh.regions.size());
    for (std::size_t i = 0; i < fem::corner_count(element.shape); ++i)
      require(element.corners[i] < mesh.nodes.size());
  }
  for (const fem::FieldMesh::Field& field : mesh.fields) {
    require(field.components > 0 && field.step >= 0 &&
            static_cast<std::size_t>(field.step) <= mesh.steps.size());
    require(field.values.size() == (field.of_nodes ? mesh.nodes.size() : mesh.elements.size()) *
                                       static_cast<std::size_t>(field.components));
  }
  require(mesh.node_numbers.empty() || mesh.node_numbers.size() == mesh.nodes.size());
  require(mesh.element_numbers.empty() || mesh.element_numbers.size() == mesh.elements.size());
  const fem::Outside outside = fem::outside_of(mesh);
  for (const auto& triangle : outside.triangles)
    require(*std::max_element(triangle.begin(), triangle.end()) < mesh.nodes.size());
  for (const fem::FieldMesh::Field& field : mesh.fields)
    for (const char* part : {"", ".x", ".xx", ".size", ".mises", ".fibre", ".0"})
      static_cast<void>(pipeline::values_of(mesh, field.name + part, field.step));
  static_cast<void>(pipeline::displacements_of(mesh, 0));
}

}  // namespace selvage::fuzz
