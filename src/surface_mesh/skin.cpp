#include "surface_mesh/skin.h"

#include <algorithm>

#include "cell/volume.h"
#include "core/groups.h"
#include "core/parallel.h"
#include "surface_mesh/cell_size.h"
#include "surface_mesh/crest_tips.h"
#include "yarn/in_axes.h"

namespace selvage::fem {

namespace {

// Of each node the least of those that are opposite each other.
std::vector<std::uint32_t> leaders_of(const CellCurves& curves, std::size_t nodes) {
  Groups groups(nodes);
  for (const auto& pairs : curves.opposite)
    for (const auto& [low, high] : pairs) groups.join(low, high);
  std::vector<std::uint32_t> leaders(nodes);
  for (std::size_t k = 0; k < nodes; ++k) leaders[k] = groups.of(k);
  return leaders;
}

// Nodes of nothing go: those on the box's edges where there is no matrix.
void drop_unused(Skin& skin) {
  constexpr std::uint32_t unused = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> number(skin.nodes.points.size(), unused);
  for (const Triangle& t : skin.surface.triangles)
    for (const std::uint32_t node : t) number[node] = 0;
  std::uint32_t count = 0;
  for (std::size_t k = 0; k < number.size(); ++k) {
    if (number[k] == unused) continue;
    skin.nodes.points[count] = skin.nodes.points[k];
    skin.nodes.places[count] = skin.nodes.places[k];
    const std::uint32_t leader = number[skin.leaders[k]];
    skin.leaders[count] = skin.leaders[k] < k && leader != unused ? leader : count;
    number[k] = count++;
  }
  skin.nodes.points.resize(count);
  skin.nodes.places.resize(count);
  skin.leaders.resize(count);
  for (Triangle& t : skin.surface.triangles)
    for (std::uint32_t& node : t) node = number[node];
}

}  // namespace

Result<Skin> make_skin(std::span<const yarn::Body> bodies, const Parallelepiped& cell, const SizeRules& rules,
                       const SkinOptions& options) {
  const auto step = [&](const char* name) {
    if (options.progress) options.progress(name);
  };
  step("cutting");
  const yarn::BodiesInAxes own(bodies, cell.axes);
  Result<cell::Cut> cut = cell::cut(own.list(), cell.box, options.tolerance);
  if (!cut) return cell::in_space(cut.error(), cell);
  Result<cell::Division> division = cell::divide_faces(own.list(), cell.box, *cut);
  if (!division) return cell::in_space(division.error(), cell);
  Skin skin;
  for (const Message& note : cut->notes) skin.notes.push_back(cell::in_space(note, cell));
  skin.volumes = cell::volumes_inside(own.list(), cell.box, *cut, *division);
  for (double& volume : skin.volumes) volume *= cell.axes.to_space().determinant();

  step("meshing surfaces");
  const CellShape shape{bodies, cell, options.periodic, *cut, *division, options.matrix};
  const CrestTips tips = find_crest_tips(shape, rules);
  const SizeField field = size_field(bodies, cell, rules, options.threads, tips.bounds);
  Result<CellCurves> curves = divide_curves(shape, tips, field, options.miss, skin.nodes);
  if (!curves) return curves.error();
  Result<CellTriangles> surface = mesh_surfaces(shape, *curves, field, options.threads, skin.nodes);
  if (!surface) return surface.error();
  skin.surface = std::move(*surface);
  skin.leaders = leaders_of(*curves, skin.nodes.points.size());
  drop_unused(skin);
  return skin;
}

Result<Skin> make_skin(const yarn::Body& body, double size) {
  const std::span<const yarn::Body> one(&body, 1);
  const double extent = yarn::narrowest_section(body);
  SizeRules rules = cell_size_rules(one, std::span(&size, 1), 0, usual_growth, extent);
  rules.gap_factor = 0;
  return make_skin(one, box_round(body), rules, {.tolerance = 1e-3 * extent});
}

std::vector<ElementSide>& faces_of(Region& region, CellTriangles::Part part) {
  return part == CellTriangles::Part::side    ? region.side_faces
         : part == CellTriangles::Part::start ? region.start_faces
                                              : region.end_faces;
}

Box3 box_round(const yarn::Body& body) {
  const Box3 box = yarn::bounds(body);
  const Vec3 room = Vec3::Constant(box.diagonal().norm());
  return {box.min() - room, box.max() + room};
}

std::vector<YarnFacet> facets_of(std::span<const yarn::Body> bodies, const Skin& skin, int threads) {
  std::vector<YarnFacet> facets(skin.surface.triangles.size());
  for_each_index(facets.size(), threads, [&](std::size_t k) {
    const Triangle& t = skin.surface.triangles[k];
    YarnFacet& facet = facets[k];
    facet.corners = t;
    if (skin.surface.sides[k].behind != CellTriangles::matrix) facet.yarn = skin.surface.sides[k].behind;
    facet.part = skin.surface.parts[k];
    if (facet.part != CellTriangles::Part::side) return;
    std::array<SurfaceEnd, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const SurfacePlace& place = skin.nodes.places[t[i]];
      if (place.body != facet.yarn) return;  // on an edge of the box, where yarns meet
      corners[i] = {place.parameters, skin.nodes.points[t[i]]};
    }
    facet.height = mean_height(bodies[facet.yarn], corners);
  });
  return facets;
}

}  // namespace selvage::fem
