#include "fem/quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/cell_sides.h"
#include "fem/faces.h"
#include "fem/hexahedron.h"

namespace selvage::fem {
namespace {

// The determinant of dx / d(L1, L2, L3) at barycentric coordinates.
double jacobian(const std::array<Vec3, 10>& nodes, const std::array<double, 4>& at) {
  std::array<Vec3, 4> slope;
  for (std::size_t i = 0; i < 4; ++i) slope[i] = nodes[i] * (4 * at[i] - 1);
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = edge_ends[e];
    slope[a] += nodes[4 + e] * (4 * at[b]);
    slope[b] += nodes[4 + e] * (4 * at[a]);
  }
  return (slope[1] - slope[0]).cross(slope[2] - slope[0]).dot(slope[3] - slope[0]);
}

std::vector<std::array<double, 4>> places_to_look() {
  std::vector<std::array<double, 4>> result = {{0.25, 0.25, 0.25, 0.25}};
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<double, 4> corner{}, face{1. / 3, 1. / 3, 1. / 3, 1. / 3};
    corner[i] = 1;
    face[i] = 0;
    result.push_back(corner);
    result.push_back(face);
  }
  for (const auto& [a, b] : edge_ends) {
    std::array<double, 4> middle{};
    middle[a] = middle[b] = 0.5;
    result.push_back(middle);
  }
  return result;
}

// With order 1 only the corners are filled.
std::array<Vec3, 10> nodes_of(const Mesh& mesh, std::size_t element) {
  std::array<Vec3, 10> nodes;
  for (std::size_t k = 0; k < static_cast<std::size_t>(mesh.nodes_per_element()); ++k)
    nodes[k] = mesh.nodes[mesh.elements[element][k]];
  return nodes;
}

bool is_of_hexahedra(const Mesh& mesh, std::size_t element) {
  return mesh.shape == Mesh::Shape::hexahedron || element >= mesh.elements.size();
}

EightNodes eight_nodes_of(const Mesh& mesh, std::size_t element) {
  EightNodes nodes;
  if (element >= mesh.elements.size()) {
    constexpr std::array<std::size_t, 8> of_wedge = {0, 1, 2, 2, 3, 4, 5, 5};
    const auto& wedge = mesh.layers.wedges[element - mesh.elements.size()];
    for (std::size_t k = 0; k < nodes.size(); ++k) nodes[k] = mesh.nodes[wedge[of_wedge[k]]];
    return nodes;
  }
  for (std::size_t k = 0; k < nodes.size(); ++k) nodes[k] = mesh.nodes[mesh.elements[element][k]];
  return nodes;
}

double six_volumes(const std::array<Vec3, 10>& nodes) {
  return (nodes[1] - nodes[0]).cross(nodes[2] - nodes[0]).dot(nodes[3] - nodes[0]);
}

void add(Quality& quality, const ElementShape& shape) {
  quality.min_dihedral = std::min(quality.min_dihedral, shape.min_dihedral);
  quality.max_dihedral = std::max(quality.max_dihedral, shape.max_dihedral);
  quality.max_aspect = std::max(quality.max_aspect, shape.aspect);
  quality.min_scaled_jacobian = std::min(quality.min_scaled_jacobian, shape.scaled_jacobian);
}

}  // namespace

Vec3 middle_of(const Mesh& mesh, std::size_t element) {
  const auto corners = static_cast<std::size_t>(mesh.corners_per_element());
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < corners; ++k) sum += mesh.nodes[mesh.elements[element][k]];
  return sum / static_cast<double>(corners);
}

ElementShape shape_of(const std::array<Vec3, 4>& p) {
  ElementShape shape;
  const double six = (p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]);
  std::array<Vec3, 4> normals;  // of the face opposite to each corner, outward, as long as twice its area
  double largest_face = 0, longest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& f = opposite_sides[i];
    normals[i] = (p[f[1]] - p[f[0]]).cross(p[f[2]] - p[f[0]]);
    largest_face = std::max(largest_face, normals[i].norm());
  }
  shape.min_dihedral = 180;
  double largest_corner = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    double corner = 1;
    for (std::size_t j = 0; j < 4; ++j) {
      if (i == j) continue;
      const double length = (p[i] - p[j]).norm();
      corner *= length;
      longest = std::max(longest, length);
      const double outer = std::atan2(normals[i].cross(normals[j]).norm(), normals[i].dot(normals[j]));
      const double angle = 180 - outer * 180 / std::numbers::pi;
      shape.min_dihedral = std::min(shape.min_dihedral, angle);
      shape.max_dihedral = std::max(shape.max_dihedral, angle);
    }
    largest_corner = std::max(largest_corner, corner);
  }
  shape.scaled_jacobian = std::numbers::sqrt2 * six / largest_corner;
  // The smallest height stands on the largest face: six volumes over twice its area.
  shape.aspect = longest * largest_face / std::abs(six) * std::sqrt(2.0 / 3);
  return shape;
}

double least_jacobian_share(const std::array<Vec3, 10>& nodes) {
  static const std::vector<std::array<double, 4>> places = places_to_look();
  const double straight = six_volumes(nodes);
  double least = std::numeric_limits<double>::infinity();
  for (const auto& place : places) least = std::min(least, jacobian(nodes, place));
  return least / straight;
}

double quadratic_volume(const std::array<Vec3, 10>& nodes) {
  double sum = -0.8 * jacobian(nodes, {0.25, 0.25, 0.25, 0.25});
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<double, 4> at{1. / 6, 1. / 6, 1. / 6, 1. / 6};
    at[i] = 0.5;
    sum += 0.45 * jacobian(nodes, at);
  }
  return sum / 6;
}

ElementShape shape_of(const Mesh& mesh, std::size_t element) {
  if (is_of_hexahedra(mesh, element))
    return shape_of_hexahedron(eight_nodes_of(mesh, element),
                               element >= mesh.elements.size() || mesh.is_wedge(element));
  const std::array<Vec3, 10> nodes = nodes_of(mesh, element);
  ElementShape shape = shape_of({nodes[0], nodes[1], nodes[2], nodes[3]});
  if (mesh.order == 2) shape.scaled_jacobian *= least_jacobian_share(nodes);
  return shape;
}

double volume_of(const Mesh& mesh, std::size_t element) {
  if (is_of_hexahedra(mesh, element)) return volume_of_hexahedron(eight_nodes_of(mesh, element));
  const std::array<Vec3, 10> nodes = nodes_of(mesh, element);
  return mesh.order == 1 ? six_volumes(nodes) / 6 : quadratic_volume(nodes);
}

double first_percentile_angle(const Mesh& mesh) {
  if (mesh.elements.empty()) return 0;
  std::vector<double> angles(mesh.elements.size());
  for (std::size_t e = 0; e < angles.size(); ++e) angles[e] = shape_of(mesh, e).min_dihedral;
  const auto at = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 100);
  std::nth_element(angles.begin(), at, angles.end());
  return *at;
}

void measure(Mesh& mesh) {
  std::vector<BadElement> worst;
  auto worse = [](const BadElement& a, const BadElement& b) { return a.min_dihedral < b.min_dihedral; };
  mesh.quality = {};
  double jacobians = 0;
  for (Region& region : mesh.regions) {
    region.quality = {};
    region.volume = 0;
    double sum = 0;
    for (std::size_t e = region.first_element; e < region.last_element; ++e) {
      const ElementShape shape = shape_of(mesh, e);
      region.volume += volume_of(mesh, e);
      sum += shape.scaled_jacobian;
      for (Quality* quality : {&region.quality, &mesh.quality}) add(*quality, shape);
      worst.push_back({e, shape.min_dihedral, middle_of(mesh, e)});
      std::push_heap(worst.begin(), worst.end(), worse);  // the best of the worst on top
      if (worst.size() > 10) {
        std::pop_heap(worst.begin(), worst.end(), worse);
        worst.pop_back();
      }
    }
    region.quality.mean_scaled_jacobian =
        sum / static_cast<double>(region.last_element - region.first_element);
    jacobians += sum;
  }
  for (std::size_t w = 0; w < mesh.layers.wedges.size(); ++w)
    mesh.regions.front().volume += volume_of(mesh, mesh.elements.size() + w);
  mesh.quality.mean_scaled_jacobian =
      jacobians / static_cast<double>(std::max<std::size_t>(mesh.elements.size(), 1));
  std::sort(worst.begin(), worst.end(), worse);
  mesh.worst = std::move(worst);
}

}  // namespace selvage::fem
