#include "contact/alike.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>

#include "core/bounds.h"
#include "core/box_tree.h"
#include "nurbs/basis.h"
#include "nurbs/patch.h"

namespace selvage::contact {

namespace {

using Pair = std::pair<std::size_t, std::size_t>;
using Steps = std::array<double, 3>;

// What two yarns are to each other: their kinds, and how the second one stands to the first.
using Position = std::tuple<std::size_t, std::size_t, Steps>;

// A patch of a surface, with the box and the middle normal of its control points.
struct Tile {
  nurbs::Patch patch;
  Box3 box;
  Vec3 normal;

  Tile(nurbs::Patch of, bool is_inward)
      : patch(std::move(of)), box(bounds_of(patch.points)), normal(nurbs::middle_normal(patch, is_inward)) {}
};

bool are_near(const Tile& a, const Tile& b, double reach) {
  if (a.box.squaredExteriorDistance(b.box) > reach * reach) return false;
  if (nurbs::slab_gap(a.patch, a.normal, b.patch, b.normal) > reach) return false;
  const double size_a = a.box.diagonal().norm(), size_b = b.box.diagonal().norm();
  if (std::max(size_a, size_b) < reach) return true;
  const Tile& larger = size_a > size_b ? a : b;
  const Tile& other = size_a > size_b ? b : a;
  const nurbs::Patch& p = larger.patch;
  const double round = (p.point(p.count_u - 1, 0) - p.point(0, 0)).norm(),
               along = (p.point(0, p.count_v - 1) - p.point(0, 0)).norm();
  for (const bool upper : {false, true})
    if (are_near(other, Tile(nurbs::half_of(p, round > along ? 0 : 1, upper), false), reach)) return true;
  return false;
}

// Of a yarn's surface between two knots along it.
struct Span {
  std::size_t yarn = 0;
  double from = 0, to = 0;
};

// Its tiles, one after the other round the yarn.
std::vector<Tile> tiles_of(const yarn::Body& body, const Span& span) {
  const nurbs::Surface& s = body.surface;
  const std::vector<double> us = nurbs::breakpoints(s.knots_u, s.degree_u);
  std::vector<Tile> tiles;
  for (std::size_t i = 0; i + 1 < us.size(); ++i)
    tiles.emplace_back(nurbs::patch_of(s, {us[i], span.from}, {us[i + 1], span.to}), body.inward);
  return tiles;
}

bool are_near(const std::vector<Tile>& a, const std::vector<Tile>& b, double reach) {
  return std::ranges::any_of(a, [&](const Tile& x) {
    return std::ranges::any_of(b, [&](const Tile& y) { return are_near(x, y, reach); });
  });
}

// Pairs a < b of yarns whose surfaces come nearer to each other than `reach`. Of pairs in one position the
// first is looked at.
template <class PositionOf>
std::vector<Pair> near_yarns(std::span<const yarn::Body> bodies, double reach,
                             const PositionOf& position_of) {
  std::vector<Span> spans;
  std::vector<Box3> boxes;
  for (std::size_t y = 0; y < bodies.size(); ++y) {
    const nurbs::Surface& s = bodies[y].surface;
    const std::vector<double> vs = nurbs::breakpoints(s.knots_v, s.degree_v);
    for (std::size_t k = 0; k + 1 < vs.size(); ++k) {
      const int last = nurbs::find_span(s.knots_v, s.degree_v, s.count_v, vs[k]);
      spans.push_back({y, vs[k], vs[k + 1]});
      boxes.emplace_back();
      for (int j = last - s.degree_v; j <= last; ++j)
        for (int i = 0; i < s.count_u; ++i) boxes.back().extend(s.point(i, j));
    }
  }
  struct Known {
    Pair first;
    bool is_near = false;
  };
  std::map<Position, Known> positions;
  std::map<Pair, Known*> candidates;
  BoxTree(std::move(boxes)).near_pairs(reach, [&](std::uint32_t i, std::uint32_t k) {
    const Pair pair(spans[i].yarn, spans[k].yarn);
    if (pair.first == pair.second) return;
    const auto [found, is_new] = candidates.try_emplace(pair, nullptr);
    if (is_new) found->second = &positions.try_emplace(position_of(pair), Known{pair}).first->second;
    Known& known = *found->second;
    if (known.is_near || known.first != pair) return;
    known.is_near =
        are_near(tiles_of(bodies[pair.first], spans[i]), tiles_of(bodies[pair.second], spans[k]), reach);
  });
  std::vector<Pair> pairs;
  for (const auto& [pair, known] : candidates)
    if (known->is_near) pairs.push_back(pair);
  return pairs;
}

// Numbers things by their values, from 0 in the order in which they come.
template <class Value>
class Numbering {
 public:
  std::size_t of(Value value) { return known_.try_emplace(std::move(value), known_.size()).first->second; }

 private:
  std::map<Value, std::size_t> known_;
};

}  // namespace

Alike find_alike(std::span<const yarn::Body> bodies, double reach, std::span<const std::size_t> marks) {
  const std::vector<std::size_t> shapes = yarn::first_of_shape(bodies);
  Numbering<Pair> by_shape;
  std::vector<std::size_t> shape_kinds;
  for (std::size_t y = 0; y < bodies.size(); ++y) shape_kinds.push_back(by_shape.of({shapes[y], marks[y]}));
  // Places are one where they differ by rounding only.
  const double step = 1e-6 * reach;
  const auto way = [&](const Pair& pair) {
    const Vec3 steps = ((bodies[pair.second].at - bodies[pair.first].at) / step).array().round();
    return Steps{steps.x(), steps.y(), steps.z()};
  };
  const std::vector<Pair> near = near_yarns(bodies, reach, [&](const Pair& pair) {
    return Position(shape_kinds[pair.first], shape_kinds[pair.second], way(pair));
  });
  using Neighbour = std::tuple<std::size_t, bool, Steps>;  // its kind, whether it comes later, where it is
  std::vector<std::vector<Neighbour>> around(bodies.size());
  for (const Pair& pair : near) {
    around[pair.first].emplace_back(shape_kinds[pair.second], true, way(pair));
    around[pair.second].emplace_back(shape_kinds[pair.first], false, way(pair));
  }
  Numbering<std::pair<std::size_t, std::vector<Neighbour>>> by_surroundings;
  std::map<std::size_t, std::size_t> firsts;
  Alike alike;
  for (std::size_t y = 0; y < bodies.size(); ++y) {
    std::sort(around[y].begin(), around[y].end());
    const std::size_t kind = by_surroundings.of({shape_kinds[y], std::move(around[y])});
    alike.first.push_back(firsts.try_emplace(kind, y).first->second);
    ++alike.neighbours[{alike.first[y], alike.first[y]}];
  }
  std::map<Position, Pair> known;
  for (const Pair& pair : near) {
    const Position position(alike.first[pair.first], alike.first[pair.second], way(pair));
    ++alike.neighbours[known.try_emplace(position, pair).first->second];
  }
  std::set<std::size_t> few;
  for (const auto& [pair, count] : alike.neighbours) few.insert({pair.first, pair.second});
  alike.few.assign(few.begin(), few.end());
  return alike;
}

}  // namespace selvage::contact
