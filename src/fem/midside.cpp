#include "fem/midside.h"

#include <algorithm>
#include <cmath>

#include "fem/faces.h"
#include "fem/quality.h"

namespace selvage::fem {
namespace {

std::uint64_t edge_key(std::uint64_t a, std::uint64_t b) {
  return std::min(a, b) << 32U | std::max(a, b);
}

// An edge of the boundary and its middle on the true surface.
struct CurvedEdge {
  std::uint64_t key;
  Vec3 middle;
};

// `b` on the same side of a closed line's joint as `a`: past its end, or before its start.
double beside(double a, double b, double range) {
  return std::abs(b - a) > range / 2 ? b + (b < a ? range : -range) : b;
}

// The point of the surface above the chord's middle, on the straight line of parameters between an edge's
// ends: where it is as far along the chord as the middle (regula falsi, Illinois form).
Vec3 side_middle(const SurfaceMesh& skin, const yarn::Body& body, std::uint32_t a, std::uint32_t b) {
  const nurbs::Surface& surface = body.surface;
  const double range_u = surface.last_u() - surface.first_u(), range_v = surface.last_v() - surface.first_v();
  const Vec2 from = skin.parameters[a];
  Vec2 to = skin.parameters[b];
  to.x() = beside(from.x(), to.x(), range_u);
  if (body.closed_along) to.y() = beside(from.y(), to.y(), range_v);
  const Vec3 chord = skin.points[b] - skin.points[a], middle = (skin.points[a] + skin.points[b]) / 2;
  const double length = chord.squaredNorm();
  auto point = [&](double share) {
    Vec2 at = from + share * (to - from);
    if (at.x() < surface.first_u()) at.x() += range_u;
    if (at.x() > surface.last_u()) at.x() -= range_u;
    if (at.y() < surface.first_v()) at.y() += range_v;
    if (at.y() > surface.last_v()) at.y() -= range_v;
    return nurbs::evaluate(surface, at.x(), at.y());
  };
  double low = 0, high = 1, low_miss = -0.5, high_miss = 0.5;
  Vec3 found = middle;
  for (int step = 0, side = 0; step < 40; ++step) {
    const double share = (low * high_miss - high * low_miss) / (high_miss - low_miss);
    found = point(share);
    const double miss = (found - middle).dot(chord) / length;
    if (std::abs(miss) < 1e-6) break;
    if (miss > 0) {
      high = share;
      high_miss = miss;
      if (side == 1) low_miss /= 2;
      side = 1;
    } else {
      low = share;
      low_miss = miss;
      if (side == -1) high_miss /= 2;
      side = -1;
    }
  }
  return found;
}

std::vector<CurvedEdge> curved_edges(const SurfaceMesh& skin, const yarn::Body& body) {
  std::vector<CurvedEdge> result;
  auto each_edge = [](std::span<const Triangle> triangles, auto use) {
    for (const Triangle& t : triangles)
      for (std::size_t k = 0; k < 3; ++k) use(t[k], t[(k + 1) % 3]);
  };
  // Each edge of the side is seen twice, once in each direction, but for those of the rims.
  each_edge(skin.side(), [&](std::uint32_t a, std::uint32_t b) {
    result.push_back({edge_key(a, b), side_middle(skin, body, a, b)});
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
  std::stable_sort(result.begin(), result.end(),
                   [](const CurvedEdge& a, const CurvedEdge& b) { return a.key < b.key; });
  result.erase(std::unique(result.begin(), result.end(),
                           [](const CurvedEdge& a, const CurvedEdge& b) { return a.key == b.key; }),
               result.end());
  return result;
}

// Numbers the edges in increasing order of their ends, appends straight middles, and returns the ends by
// number.
std::vector<std::uint64_t> add_straight(Mesh& mesh) {
  struct Use {
    std::uint64_t key;
    std::size_t element, slot;
  };
  std::vector<Use> uses;
  uses.reserve(6 * mesh.elements.size());
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (std::size_t k = 0; k < 6; ++k)
      uses.push_back(
          {edge_key(mesh.elements[e][edge_ends[k][0]], mesh.elements[e][edge_ends[k][1]]), e, 4 + k});
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) { return a.key < b.key; });
  std::vector<std::uint64_t> keys;
  for (const Use& use : uses) {
    if (keys.empty() || keys.back() != use.key) {
      keys.push_back(use.key);
      mesh.nodes.push_back((mesh.nodes[use.key >> 32U] + mesh.nodes[use.key & 0xffffffffU]) / 2);
    }
    mesh.elements[use.element][use.slot] = mesh.nodes.size() - 1;
  }
  mesh.order = 2;
  return keys;
}

bool is_sound(const Mesh& mesh, std::size_t element) {
  std::array<Vec3, 10> nodes;
  for (std::size_t k = 0; k < 10; ++k) nodes[k] = mesh.nodes[mesh.elements[element][k]];
  const double straight = shape_of({nodes[0], nodes[1], nodes[2], nodes[3]}).scaled_jacobian;
  return straight * least_jacobian_share(nodes) >= std::min(0.1, 0.9 * straight);
}

}  // namespace

std::size_t add_midside_nodes(Mesh& mesh, const SurfaceMesh& surface, const yarn::Body& body) {
  const std::size_t corners = mesh.nodes.size();
  const std::vector<std::uint64_t> keys = add_straight(mesh);
  // Where each midside node wants to be, as a step from the chord; the share of it that is taken.
  std::vector<Vec3> steps(keys.size(), Vec3::Zero());
  std::vector<float> shares(keys.size(), 1.0F);
  for (const CurvedEdge& edge : curved_edges(surface, body)) {
    const auto at = std::lower_bound(keys.begin(), keys.end(), edge.key);
    if (at == keys.end() || *at != edge.key) continue;
    const auto k = static_cast<std::size_t>(at - keys.begin());
    steps[k] = edge.middle - mesh.nodes[corners + k];
    mesh.nodes[corners + k] = edge.middle;
  }
  // Halve the steps of every bad element until none is left; after three halvings straight edges, which are
  // sound.
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<std::size_t> bad;
    for (std::size_t e = 0; e < mesh.elements.size(); ++e)
      if (!is_sound(mesh, e)) bad.push_back(e);
    for (const std::size_t e : bad)
      for (std::size_t slot = 4; slot < 10; ++slot) {
        const std::size_t k = mesh.elements[e][slot] - corners;
        if (shares[k] == 0 || steps[k].isZero(0)) continue;
        const Vec3 chord = mesh.nodes[corners + k] - steps[k] * shares[k];
        shares[k] = shares[k] > 0.2F ? shares[k] / 2 : 0.0F;
        mesh.nodes[corners + k] = chord + steps[k] * shares[k];
        changed = true;
      }
  }
  return static_cast<std::size_t>(
      std::count_if(shares.begin(), shares.end(), [](float share) { return share < 1.0F; }));
}

}  // namespace selvage::fem
