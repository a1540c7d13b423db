#include "cell_problem/contact_surfaces.h"

#include <algorithm>
#include <set>

#include "core/box_tree.h"
#include "surface_mesh/triangle_distance.h"

namespace selvage::fem {
namespace {

using Corners = std::array<std::size_t, 3>;

// Whichever corner of a triangle is repeated.
ElementSide sorted(ElementSide side) {
  if (side[2] == side[3]) side[3] = *std::max_element(side.begin(), side.end());
  std::sort(side.begin(), side.end());
  return side;
}

std::vector<ContactSurface> surfaces_of(const Mesh& mesh) {
  std::vector<ContactSurface> surfaces(mesh.regions.size());
  std::set<ElementSide> ends;
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    surfaces[i].region = i;
    for (const auto* faces : {&mesh.regions[i].start_faces, &mesh.regions[i].end_faces})
      for (const ElementSide& face : *faces) ends.insert(sorted(face));
  }
  for (const OuterSide& side : outer_sides(mesh)) {
    if (side.face >= 0 || ends.contains(sorted(side.nodes))) continue;
    ContactSurface& surface = surfaces[side.region];
    surface.whole.push_back(side);
    const double up = area_vector(mesh, side.nodes).z();
    if (up > 0) surface.upper.push_back(side);
    if (up < 0) surface.lower.push_back(side);
  }
  return surfaces;
}

// Four volumes over the surface.
double thickness_of(const Mesh& mesh, const ContactSurface& surface) {
  double area = 0;
  for (const OuterSide& side : surface.whole) area += area_vector(mesh, side.nodes).norm();
  return area > 0 ? 4 * mesh.regions[surface.region].volume / area : 0;
}

// All surfaces as triangles, each with the index of its own.
struct Skins {
  std::vector<Corners> triangles;
  std::vector<std::size_t> surface;
};

Skins skins_of(const std::vector<ContactSurface>& surfaces) {
  Skins skins;
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    for (const OuterSide& side : surfaces[i].whole) {
      const auto& n = side.nodes;
      skins.triangles.push_back({n[0], n[1], n[2]});
      if (n[3] != n[2]) skins.triangles.push_back({n[0], n[2], n[3]});
      skins.surface.resize(skins.triangles.size(), i);
    }
  return skins;
}

// Each corner looks round itself in a tree of all triangles, so that the work goes with their number.
void find_pairs(const Mesh& mesh, ContactSurfaces& result) {
  constexpr double reach_share = 0.25;
  std::vector<double> reach;
  for (const ContactSurface& surface : result.surfaces)
    reach.push_back(reach_share * thickness_of(mesh, surface));
  const Skins skins = skins_of(result.surfaces);
  const BoxTree tree(boxes_of(mesh.nodes, skins.triangles));
  std::set<std::array<std::size_t, 2>> pairs;
  std::vector<bool> has_looked(mesh.nodes.size(), false);
  for (std::size_t t = 0; t < skins.triangles.size(); ++t)
    for (const std::size_t node : skins.triangles[t]) {
      if (has_looked[node]) continue;
      has_looked[node] = true;
      const std::size_t own = skins.surface[t];
      tree.near_point(mesh.nodes[node], reach[own], [&](std::uint32_t k) {
        const std::size_t other = skins.surface[k];
        const std::array<std::size_t, 2> pair = {std::min(own, other), std::max(own, other)};
        if (other == own || pairs.contains(pair)) return reach[own];
        const Corners& c = skins.triangles[k];
        ++result.distances;
        const Corners3 corners = {mesh.nodes[c[0]], mesh.nodes[c[1]], mesh.nodes[c[2]]};
        if ((nearest_on(corners, mesh.nodes[node]) - mesh.nodes[node]).norm() <
            std::min(reach[own], reach[other]))
          pairs.insert(pair);
        return reach[own];
      });
    }
  result.pairs.assign(pairs.begin(), pairs.end());
}

}  // namespace

ContactSurfaces contact_surfaces(const Mesh& mesh) {
  ContactSurfaces result;
  const bool has_matrix = std::any_of(mesh.regions.begin(), mesh.regions.end(), [](const Region& region) {
    return region.kind == Region::Kind::matrix;
  });
  if (has_matrix) return result;
  result.surfaces = surfaces_of(mesh);
  find_pairs(mesh, result);
  return result;
}

}  // namespace selvage::fem
