#include "solid/gap_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>

#include "core/parallel.h"
#include "solid/tessellation.h"

namespace selvage::solid {

namespace {

constexpr double chord_share = 0.005;
// The chord of this length on a circle as thick as the yarn has a height of about chord_share.
constexpr double edge_share = 0.14;

contact::SkinMesh skin_mesh(const yarn::Body& body, Tessellation&& from) {
  contact::SkinMesh skin;
  skin.along.reserve(from.sites.size());
  for (const Vec2& site : from.sites) skin.along.push_back(site.y());
  // Vertices that only an end face has.
  for (std::size_t k = 0; k < from.triangles.size(); ++k)
    for (const std::uint32_t vertex : from.triangles[k])
      if (std::isnan(skin.along[vertex]))
        skin.along[vertex] = from.skin[k] == Skin::end ? body.surface.last_v() : body.surface.first_v();
  skin.vertices = std::move(from.vertices);
  skin.triangles = std::move(from.triangles);
  return skin;
}

}  // namespace

Result<GapMap> gap_map(std::span<const yarn::Body> bodies, const GapMapOptions& options) {
  GapMap map;
  map.skins.resize(bodies.size());
  std::vector<std::optional<Message>> failures(bodies.size());
  std::vector<double> extents(bodies.size(), std::numeric_limits<double>::infinity());
  std::atomic<std::size_t> triangles = 0;
  const auto is_too_much = [&] { return static_cast<double>(triangles.load()) > max_triangles; };
  for_each_index(bodies.size(), options.threads, [&](std::size_t b) {
    if (is_too_much()) return;
    const yarn::Body& body = bodies[b];
    if (!body.surface.is_empty()) extents[b] = yarn::narrowest_section(body);
    Result<Tessellation> skin = tessellate(body, chord_share * extents[b], edge_share * extents[b]);
    if (!skin) {
      failures[b] = skin.error();
      return;
    }
    triangles += skin->triangles.size();
    map.skins[b] = skin_mesh(body, std::move(*skin));
  });
  for (const std::optional<Message>& failure : failures)
    if (failure) return *failure;
  if (is_too_much())
    return error(Kind::limit, fmt::format("a gap map of these yarns needs more than {:.0e} triangles; take a "
                                          "smaller part of the fabric",
                                          max_triangles));
  for (const yarn::Body& body : bodies) map.names.push_back(body.name);
  contact::GapFieldOptions field;
  field.reach =
      options.reach > 0.0 || extents.empty() ? options.reach : 0.1 * *std::ranges::min_element(extents);
  field.threads = options.threads;
  field.progress = options.progress;
  map.gaps = contact::gap_field(bodies, map.skins, field);
  return map;
}

}  // namespace selvage::solid
