#include "surface_mesh/cell_size.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "fem/fibre.h"

namespace selvage::fem {

namespace {

constexpr double edges_per_extent = 4;  // to which the turn of a surface along an edge is meant

double volume_of(const Parallelepiped& cell) {
  return cell.box.isEmpty() ? 0.0 : cell.volume();
}

// The yarn's volume in the cell, by how much of its centre line is there.
double volume_inside(const yarn::Body& body, const Parallelepiped& cell) {
  constexpr int samples = 500;
  const double first = body.axis.first_parameter(), last = body.axis.last_parameter();
  int inside = 0;
  for (int k = 0; k < samples; ++k)
    inside += cell.contains(nurbs::evaluate(body.axis, first + (last - first) * (k + 0.5) / samples)) ? 1 : 0;
  return body.volume * inside / samples;
}

// So far apart that no more than some hundred thousand places are looked at on the yarns' surfaces.
double raster_step(std::span<const yarn::Body> bodies) {
  constexpr double most = 2e5;
  double area = 0;
  for (const yarn::Body& body : bodies) area += section_perimeter(body, body.surface.first_v()) * body.length;
  return std::sqrt(area / most);
}

}  // namespace

SizeRules cell_size_rules(std::span<const yarn::Body> bodies, std::span<const double> sizes, double coarsest,
                          double growth, double extent) {
  SizeRules rules;
  rules.growth = growth;
  rules.coarsest = std::max(*std::max_element(sizes.begin(), sizes.end()), coarsest);
  rules.smallest = least_edge_share * extent;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    SizeRules::Yarn yarn;
    yarn.largest = sizes[b];
    yarn.turn *= std::min(1.0, sizes[b] * edges_per_extent / yarn::narrowest_section(bodies[b]));
    rules.yarns.push_back(yarn);
  }
  return rules;
}

double estimate_tetrahedra(std::span<const yarn::Body> bodies, const Parallelepiped& cell,
                           std::span<const double> sizes, double coarsest, double growth, bool matrix,
                           int threads) {
  // Of the cube of the edge length, a tetrahedron on average: more than where all edges are as long (0.083
  // where yarns are far apart), less than what the one layer of them in a narrow gap has.
  constexpr double mean_share = 0.09;
  constexpr int samples = 50'000;
  const double extent = yarn::narrowest_section(bodies);
  SizeRules rules = cell_size_rules(bodies, sizes, coarsest, growth, extent);
  rules.raster = raster_step(bodies);
  const SizeField field = size_field(bodies, cell, rules, threads);
  // Places that fill the cell evenly: multiples of the powers of the root of r^4 = r + 1 (Roberts's
  // sequence).
  constexpr double root = 1.2207440846057596;
  const std::array<double, 3> steps = {1 / root, 1 / (root * root), 1 / (root * root * root)};
  double sum = 0;
  for (int k = 1; k <= samples; ++k) {
    Vec3 place;
    for (int axis = 0; axis < 3; ++axis) {
      const double share = std::fmod(0.5 + k * steps[static_cast<std::size_t>(axis)], 1.0);
      place[axis] = cell.box.min()[axis] + share * cell.box.sizes()[axis];
    }
    const double edge = field.at(cell.axes.place(place));
    sum += 1 / (edge * edge * edge);
  }
  double share = 1;
  if (!matrix) {
    double yarns = 0;
    for (const yarn::Body& body : bodies) yarns += std::max(volume_inside(body, cell), 1e-3 * body.volume);
    share = std::min(1.0, yarns / volume_of(cell));
  }
  return share * volume_of(cell) * sum / samples / mean_share;
}

}  // namespace selvage::fem
