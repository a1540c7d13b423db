#include "surface_mesh/curved_edges.h"

#include <algorithm>
#include <cmath>

#include "cell/cut.h"
#include "fem/faces.h"
#include "fem/quality.h"
#include "nurbs/roots.h"

namespace selvage::fem {
namespace {

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

// Halves one step of every bad element, that which helps it most, until none is left; after three halvings
// edges are straight, and with all its edges straight an element is sound.
class Steps {
 public:
  Steps(Mesh& mesh, std::size_t corners, std::size_t count)
      : mesh_(mesh),
        corners_(corners),
        steps_(count, Vec3::Zero()),
        shares_(count, 1.0F),
        partner_(count, none) {}

  void move(std::size_t k, const Vec3& to, std::size_t region) {
    Vec3& node = mesh_.nodes[corners_ + k];
    steps_[k] = to - node;
    node = to;
    moved_.push_back(k);
    if (region != CurvedEdge::none) of_regions_.push_back({region, k});
  }
  void tie(std::size_t a, std::size_t b) {
    partner_[a] = b;
    partner_[b] = a;
  }
  void hold() {
    chords_.resize(steps_.size());
    for (const std::size_t k : moved_) chords_[k] = mesh_.nodes[corners_ + k] - steps_[k];
    for (std::size_t e = 0; e < mesh_.elements.size(); ++e)
      if (std::any_of(mesh_.elements[e].begin() + 4, mesh_.elements[e].end(),
                      [this](std::size_t node) { return !steps_[node - corners_].isZero(0); }))
        curved_elements_.push_back(e);
    std::vector<std::size_t> watched = curved_elements_;
    while (!watched.empty()) {
      std::erase_if(watched, [this](std::size_t e) { return is_sound(mesh_, e); });
      std::vector<std::size_t> touched;
      for (const std::size_t e : watched) {
        if (is_sound(mesh_, e)) continue;  // through another one's step
        const std::size_t k = best_to_halve(e);
        if (k == none) continue;
        halve(k);
        touched.push_back(k);
        if (partner_[k] == none) continue;
        halve(partner_[k]);
        touched.push_back(partner_[k]);
      }
      if (touched.empty()) break;
      watched = elements_at(touched);
    }
  }
  // All that may move for a region go on by the same share of their steps, as far as its volume takes: but
  // those at elements that would fold.
  void keep(std::span<const double> volumes) {
    constexpr int rounds = 4;
    std::sort(of_regions_.begin(), of_regions_.end());
    const std::vector<OfRegion> all = of_regions_;
    for (int round = 0; round < rounds; ++round) {
      for (auto first = of_regions_.begin(); first != of_regions_.end();) {
        const auto last = std::find_if(first, of_regions_.end(),
                                       [&](const OfRegion& other) { return other.first != first->first; });
        if (first->first < volumes.size() && volumes[first->first] > 0)
          stretch(first->first, {first, last}, volumes[first->first]);
        first = last;
      }
      std::vector<std::uint8_t> stays(steps_.size(), 0);
      bool is_kept = true;
      for (const std::size_t e : curved_elements_) {
        if (is_sound(mesh_, e)) continue;
        is_kept = false;
        for (std::size_t slot = 4; slot < 10; ++slot) stays[mesh_.elements[e][slot] - corners_] = 1;
      }
      if (is_kept) return;
      std::erase_if(of_regions_, [&](const OfRegion& one) {
        if (stays[one.second] != 0) place(one.second, 0);
        return stays[one.second] != 0;
      });
    }
    for (const auto& [region, k] : all) place(k, 0);
  }
  [[nodiscard]] MidsideNodes result() const {
    MidsideNodes result;
    for (const std::size_t k : moved_) {
      if (shares_[k] == 1.0F) continue;
      ++result.held;
      result.farthest = std::max(result.farthest, (1 - shares_[k]) * steps_[k].norm());
    }
    return result;
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  using OfRegion = std::pair<std::size_t, std::size_t>;  // a region, and one of the nodes

  void place(std::size_t k, double more) {
    if (!steps_[k].isZero(0)) mesh_.nodes[corners_ + k] = chords_[k] + steps_[k] * (shares_[k] * (1 + more));
  }
  void stretch(std::size_t r, std::span<const OfRegion> nodes, double wanted) {
    constexpr double most = 0.25, probe = 0.02, close = 1e-9;
    constexpr int rounds = 6;
    const Region& region = mesh_.regions[r];
    const auto lacking_at = [&](double more) {
      for (const auto& [number, k] : nodes) place(k, more);
      double volume = 0;
      for (std::size_t e = region.first_element; e < region.last_element; ++e) volume += volume_of(mesh_, e);
      return wanted - volume;
    };
    double before = 0, more = probe, lacked = lacking_at(before), lacks = lacking_at(more);
    for (int round = 0; round < rounds && std::abs(lacks) > close * wanted; ++round) {
      const double next = more - lacks * (more - before) / (lacks - lacked);
      if (!(std::abs(next) < most)) {
        lacking_at(0);
        return;
      }
      before = more;
      lacked = lacks;
      more = next;
      lacks = lacking_at(more);
    }
  }
  static float halved(float share) { return share > 0.2F ? share / 2 : 0.0F; }
  void halve(std::size_t k) {
    shares_[k] = halved(shares_[k]);
    mesh_.nodes[corners_ + k] = chords_[k] + steps_[k] * shares_[k];
  }
  // The midside node of an element whose half step leaves it soundest.
  [[nodiscard]] std::size_t best_to_halve(std::size_t e) const {
    std::array<Vec3, 10> nodes;
    for (std::size_t slot = 0; slot < 10; ++slot) nodes[slot] = mesh_.nodes[mesh_.elements[e][slot]];
    std::size_t best = none;
    double most = 0;
    for (std::size_t slot = 4; slot < 10; ++slot) {
      const std::size_t k = mesh_.elements[e][slot] - corners_;
      if (shares_[k] == 0 || steps_[k].isZero(0)) continue;
      const Vec3 full = nodes[slot];
      nodes[slot] = chords_[k] + steps_[k] * halved(shares_[k]);
      const double share = least_jacobian_share(nodes);
      nodes[slot] = full;
      if (best != none && share <= most) continue;
      best = k;
      most = share;
    }
    return best;
  }
  [[nodiscard]] std::vector<std::size_t> elements_at(const std::vector<std::size_t>& edges) const {
    std::vector<std::uint8_t> is_one(steps_.size(), 0);
    for (const std::size_t k : edges) is_one[k] = 1;
    std::vector<std::size_t> result;
    for (const std::size_t e : curved_elements_)
      if (std::any_of(mesh_.elements[e].begin() + 4, mesh_.elements[e].end(),
                      [&](std::size_t node) { return is_one[node - corners_] != 0; }))
        result.push_back(e);
    return result;
  }

  Mesh& mesh_;
  std::size_t corners_;
  std::vector<Vec3> steps_, chords_;  // where each node wants to be, as a step from the chord
  std::vector<float> shares_;         // of the step that is taken
  std::vector<std::size_t> partner_, moved_;
  std::vector<OfRegion> of_regions_;
  std::vector<std::size_t> curved_elements_;  // with such an edge
};

}  // namespace

Vec3 middle_on_surface(const yarn::Body& body, const SurfaceEnd& from, const SurfaceEnd& to) {
  const Vec2 way = cell::beside(body, from.parameters, to.parameters) - from.parameters;
  const Vec3 chord = to.at - from.at, middle = (from.at + to.at) / 2;
  const double length = chord.squaredNorm();
  nurbs::FalsePosition root{0, -0.5, 1, 0.5};
  Vec3 found = middle;
  for (int step = 0; step < 40; ++step) {
    const double share = root.crossing();
    found = cell::position(body, from.parameters + share * way);
    const double miss = (found - middle).dot(chord) / length;
    if (std::abs(miss) < 1e-6) break;
    root.take(share, miss);
  }
  return found;
}

std::optional<Vec3> middle_in_plane(const yarn::Body& body, const SurfaceEnd& from, const SurfaceEnd& to,
                                    const Vec3& normal) {
  const Vec2 end = cell::beside(body, from.parameters, to.parameters);
  const Vec3 chord = to.at - from.at, middle = (from.at + to.at) / 2;
  const double length = chord.norm(), plane = from.at.dot(normal);
  if (!(length > 0)) return std::nullopt;
  const Vec3 along = chord / length;
  Vec2 at = from.parameters + 0.5 * (end - from.parameters);
  for (int step = 0; step < 20; ++step) {
    const nurbs::SurfaceJet jet = cell::jet(body, at);
    Vec3 found = jet.position;
    const Vec2 miss(found.dot(normal) - plane, (found - middle).dot(along));
    if (miss.cwiseAbs().maxCoeff() < 1e-12 * length || (step == 19 && miss.norm() < 1e-8 * length)) {
      if ((found - middle).norm() > length / 2) return std::nullopt;
      found -= miss[0] * normal;
      return found;
    }
    Eigen::Matrix2d slope;
    slope << jet.du.dot(normal), jet.dv.dot(normal), jet.du.dot(along), jet.dv.dot(along);
    const Vec2 way = slope.partialPivLu().solve(miss);
    if (!way.allFinite()) return std::nullopt;
    at -= way;
  }
  return std::nullopt;
}

void sort_edges(std::vector<CurvedEdge>& edges) {
  std::stable_sort(edges.begin(), edges.end(),
                   [](const CurvedEdge& a, const CurvedEdge& b) { return a.key < b.key; });
  edges.erase(std::unique(edges.begin(), edges.end(),
                          [](const CurvedEdge& a, const CurvedEdge& b) { return a.key == b.key; }),
              edges.end());
}

MidsideNodes add_midside_nodes(Mesh& mesh, std::span<const CurvedEdge> curved,
                               std::span<const TiedEdges> tied, std::span<const double> volumes) {
  const std::size_t corners = mesh.nodes.size();
  const std::vector<std::uint64_t> keys = add_straight(mesh);
  const auto number = [&keys](std::uint64_t key) {
    const auto at = std::lower_bound(keys.begin(), keys.end(), key);
    return at == keys.end() || *at != key ? keys.size() : static_cast<std::size_t>(at - keys.begin());
  };
  Steps steps(mesh, corners, keys.size());
  for (const CurvedEdge& edge : curved)
    if (const std::size_t k = number(edge.key); k < keys.size()) steps.move(k, edge.middle, edge.region);
  for (const TiedEdges& pair : tied) {
    const std::size_t a = number(pair.a), b = number(pair.b);
    if (a < keys.size() && b < keys.size()) steps.tie(a, b);
  }
  steps.hold();
  steps.keep(volumes);
  return steps.result();
}

}  // namespace selvage::fem
