#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "fem/forming.h"
#include "fem/materials.h"
#include "fem/quality.h"
#include "fem/sections.h"
#include "fem/sides.h"

namespace selvage::fem {
namespace {

// Of a solid: its volume over its largest side, of tetrahedra three times that, which is the least height.
double length_of(const Mesh& mesh, std::size_t element) {
  if (mesh.shape == Mesh::Shape::beam)
    return (mesh.nodes[mesh.elements[element][1]] - mesh.nodes[mesh.elements[element][0]]).norm();
  double largest = 0;
  for (std::size_t side = 0; side < element_sides(mesh, element).size(); ++side)
    largest = std::max(largest, area_vector(mesh, side_nodes(mesh, element, side)).norm());
  const double height = volume_of(mesh, element) / largest;
  if (mesh.shape == Mesh::Shape::hexahedron) return height;
  return mesh.order == 2 ? 1.5 * height : 3 * height;
}

}  // namespace

double wave_speed(const fabric::Material& material, bool in_beams) {
  const Orthotropic c = orthotropic(material);
  if (in_beams) return std::sqrt(c.e1 / *c.density);
  Eigen::Matrix3d compliance;
  compliance << 1 / c.e1, -c.nu12 / c.e1, -c.nu13 / c.e1,  //
      -c.nu12 / c.e1, 1 / c.e2, -c.nu23 / c.e2,            //
      -c.nu13 / c.e1, -c.nu23 / c.e2, 1 / c.e3;
  const double stiffest = compliance.inverse().diagonal().maxCoeff();
  return std::sqrt(std::max({stiffest, c.g12, c.g13, c.g23}) / *c.density);
}

StableIncrement stable_increment(const Mesh& mesh) {
  StableIncrement found;
  for (const Region& region : mesh.regions) {
    const std::size_t of_all = material_of(mesh, region);
    for (std::size_t e = region.first_element; e < region.last_element; ++e) {
      const std::size_t material = mesh.element_material.empty() ? of_all : mesh.element_material[e];
      const double speed = wave_speed(mesh.materials[material], mesh.shape == Mesh::Shape::beam);
      const double length = length_of(mesh, e);
      if (found.time == 0 || length / speed < found.time) found = {length / speed, e, length, speed};
    }
  }
  return found;
}

}  // namespace selvage::fem
