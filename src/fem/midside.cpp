#include "fem/midside.h"

#include "fem/curved_edges.h"

namespace selvage::fem {
namespace {

std::vector<CurvedEdge> curved_edges(const SurfaceMesh& skin, const yarn::Body& body) {
  std::vector<CurvedEdge> result;
  auto each_edge = [](std::span<const Triangle> triangles, auto use) {
    for (const Triangle& t : triangles)
      for (std::size_t k = 0; k < 3; ++k) use(t[k], t[(k + 1) % 3]);
  };
  // Each edge of the side is seen twice, once in each direction, but for those of the rims.
  each_edge(skin.side(), [&](std::uint32_t a, std::uint32_t b) {
    result.push_back({edge_key(a, b), middle_on_surface(body, {skin.parameters[a], skin.points[a]},
                                                        {skin.parameters[b], skin.points[b]})});
  });
  auto add_cap = [&](std::span<const Triangle> triangles, const std::optional<EndCap>& cap) {
    each_edge(triangles, [&](std::uint32_t a, std::uint32_t b) {
      const Vec3 chord = (skin.points[a] + skin.points[b]) / 2;
      result.push_back({edge_key(a, b), cap->is_flat() ? chord : cap->lift(cap->project(chord))});
    });
  };
  add_cap(skin.start(), skin.start_cap);
  add_cap(skin.end(), skin.end_cap);
  // The side's come first: a rim's middle is the side's.
  sort_edges(result);
  return result;
}

}  // namespace

MidsideNodes add_midside_nodes(Mesh& mesh, const SurfaceMesh& surface, const yarn::Body& body) {
  return add_midside_nodes(mesh, curved_edges(surface, body), {});
}

}  // namespace selvage::fem
