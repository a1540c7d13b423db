#include "fem/contact_surfaces.h"

#include <algorithm>
#include <map>
#include <set>

#include "contact/skin_distance.h"

namespace selvage::fem {
namespace {

using Corners = std::array<std::size_t, 3>;

Corners sorted(Corners corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

std::vector<ContactSurface> surfaces_of(const Mesh& mesh) {
  std::vector<ContactSurface> surfaces(mesh.regions.size());
  std::set<Corners> ends;
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    surfaces[i].region = i;
    for (const auto* faces : {&mesh.regions[i].start_faces, &mesh.regions[i].end_faces})
      for (const Corners& face : *faces) ends.insert(sorted(face));
  }
  for (const OuterSide& side : outer_sides(mesh)) {
    if (side.face >= 0 || ends.contains(sorted({side.nodes[0], side.nodes[1], side.nodes[2]}))) continue;
    ContactSurface& surface = surfaces[side.region];
    surface.whole.push_back(side);
    const double up = area_vector(mesh, side).z();
    if (up > 0) surface.upper.push_back(side);
    if (up < 0) surface.lower.push_back(side);
  }
  return surfaces;
}

// The surface as triangles, and the thickness behind it.
struct Skin {
  contact::SkinMesh triangles;
  double thickness = 0;
};

Skin skin_of(const Mesh& mesh, const ContactSurface& surface) {
  Skin skin;
  std::map<std::size_t, std::uint32_t> vertex;
  const auto number = [&](std::size_t node) {
    const auto [at, is_new] = vertex.emplace(node, static_cast<std::uint32_t>(vertex.size()));
    if (is_new) skin.triangles.vertices.push_back(mesh.nodes[node]);
    return at->second;
  };
  double area = 0;
  for (const OuterSide& side : surface.whole) {
    area += area_vector(mesh, side).norm();
    const auto& n = side.nodes;
    skin.triangles.triangles.push_back({number(n[0]), number(n[1]), number(n[2])});
    if (n[3] != n[2]) skin.triangles.triangles.push_back({number(n[0]), number(n[2]), number(n[3])});
  }
  skin.triangles.along.assign(skin.triangles.vertices.size(), 0);
  if (area > 0) skin.thickness = 4 * mesh.regions[surface.region].volume / area;
  return skin;
}

bool is_near(const contact::SkinMesh& skin, const contact::SkinDistance& other, double reach) {
  Box3 box = other.box();
  box.extend(Vec3(box.min() - Vec3::Constant(reach)));
  box.extend(Vec3(box.max() + Vec3::Constant(reach)));
  return std::any_of(skin.vertices.begin(), skin.vertices.end(), [&](const Vec3& vertex) {
    return box.contains(vertex) && other.at(vertex, reach).has_value();
  });
}

}  // namespace

ContactSurfaces contact_surfaces(const Mesh& mesh) {
  constexpr double reach_share = 0.25;
  ContactSurfaces result;
  const bool has_matrix = std::any_of(mesh.regions.begin(), mesh.regions.end(), [](const Region& region) {
    return region.kind == Region::Kind::matrix;
  });
  if (has_matrix) return result;
  result.surfaces = surfaces_of(mesh);
  std::vector<Skin> skins;
  for (const ContactSurface& surface : result.surfaces) skins.push_back(skin_of(mesh, surface));
  std::vector<contact::SkinDistance> distances;
  distances.reserve(skins.size());
  for (const Skin& skin : skins) distances.emplace_back(skin.triangles);
  for (std::size_t i = 0; i < skins.size(); ++i)
    for (std::size_t j = i + 1; j < skins.size(); ++j) {
      if (result.surfaces[i].whole.empty() || result.surfaces[j].whole.empty()) continue;
      const double reach = reach_share * std::min(skins[i].thickness, skins[j].thickness);
      if (is_near(skins[i].triangles, distances[j], reach) ||
          is_near(skins[j].triangles, distances[i], reach))
        result.pairs.push_back({i, j});
    }
  return result;
}

}  // namespace selvage::fem
