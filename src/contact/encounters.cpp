#include "contact/encounters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <unordered_map>

#include "core/groups.h"
#include "core/parallel.h"
#include "core/wrapped.h"
#include "nurbs/patch.h"

namespace selvage::contact {

namespace {

// By how much the way along it is longer than the straight one: where a yarn turned less (an arc of 130
// degrees), it does not face itself, however far one looks.
constexpr double detour = 1.25;
// Pieces to either side that are alike too where a piece is: further away nothing is looked at.
constexpr std::int64_t pieces_beside = 2;
constexpr std::uint32_t nothing = std::numeric_limits<std::uint32_t>::max();

// What is looked up before two are compared: coordinates are rounded to steps, coarse enough that few that
// are alike are missed.
class Key {
 public:
  explicit Key(double step) : step_(step) {}
  void add(std::uint64_t number) {
    value_ ^= number;
    value_ *= 0x9e3779b97f4a7c15ULL;
    value_ ^= value_ >> 29U;
  }
  void add(const Vec3& way) {
    for (const double x : way)
      add(static_cast<std::uint64_t>(static_cast<std::int64_t>(std::round(x / step_))));
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  double step_;
  std::uint64_t value_ = 0;
};

// A key's step against the difference that makes two things unlike.
constexpr double coarseness = 1000.0;

// Numbers things that are alike.
class Kinds {
 public:
  // The number of the kind that is_same(its number) says it is; else `fresh`, which is kept for it.
  template <class IsSame>
  std::uint32_t find(const Key& key, std::uint32_t fresh, const IsSame& is_same) {
    std::vector<std::uint32_t>& alike = by_key_[key.value()];
    for (const std::uint32_t kind : alike)
      if (is_same(kind)) return kind;
    // Many that are nearly the same are each for itself: looking would cost more than it spares.
    constexpr std::size_t most = 16;
    if (alike.size() < most) alike.push_back(fresh);
    return fresh;
  }

 private:
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> by_key_;
};

bool is_near(const Vec3& a, const Vec3& b, double reach) {
  return (a - b).cwiseAbs().maxCoeff() <= reach;
}

Box3 moved(const Box3& box, const Vec3& by) {
  return {Vec3(box.min() + by), Vec3(box.max() + by)};
}

}  // namespace

PieceModel::PieceModel(std::span<const yarn::Body> bodies, int threads)
    : bodies_(bodies), threads_(threads), thinnest_(std::numeric_limits<double>::infinity()) {
  const std::vector<std::size_t> first = yarn::first_of_shape(bodies);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (first[b] == b) {
      shape_of_.push_back(static_cast<std::uint32_t>(shapes_.size()));
      shapes_.emplace_back().body = static_cast<std::uint32_t>(b);
    } else {
      shape_of_.push_back(shape_of_[first[b]]);
    }
    shifts_.push_back(bodies[b].at - bodies[first[b]].at);
  }
  std::vector<Box3> shape_boxes(shapes_.size());
  for_each_index(shapes_.size(), threads, [&](std::size_t k) {
    Shape& shape = shapes_[k];
    shape.cells = cells_of(bodies[shape.body]);
    shape.pieces = shape.cells.pieces;
    shape.thickness = shape.cells.thickness;
    shape.length = shape.cells.length;
    shape.touching = shape.cells.touching;
    std::vector<Box3> boxes;
    for (const Piece& piece : shape.pieces) {
      boxes.push_back(piece.box);
      shape_boxes[k].extend(piece.box);
      if (shape.cells.faces[shape.cells.cells[piece.first_cell].face].is_side) ++shape.side_pieces;
    }
    shape.tree = BoxTree(std::move(boxes));
  });
  for (const Shape& shape : shapes_)
    if (shape.thickness > 0.0) thinnest_ = std::min(thinnest_, shape.thickness);
  std::vector<Box3> boxes;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Box3& box = shape_boxes[shape_of_[b]];
    boxes.push_back(box.isEmpty() ? box : moved(box, shifts_[b]));
  }
  boxes_ = BoxTree(std::move(boxes));
  if (std::isfinite(thinnest_)) find_kinds();
}

Box3 PieceModel::box(std::size_t body, std::uint32_t piece) const {
  return moved(pieces(body)[piece].box, shifts_[body]);
}

Vec3 PieceModel::origin(std::size_t body, std::uint32_t piece) const {
  return pieces(body)[piece].box.min() + shifts_[body];
}

std::vector<BodyCells> PieceModel::take_cells(const std::vector<std::vector<bool>>& wanted) {
  std::vector<BodyCells> taken(bodies_.size());
  for_each_index(bodies_.size(), threads_, [&](std::size_t b) {
    if (wanted[b].empty()) return;
    Shape& shape = shapes_[shape_of_[b]];
    if (shape.body == b && !shape.cells.faces.empty())
      taken[b] = std::move(shape.cells);
    else
      taken[b] = cells_of(bodies_[b], wanted[b]);
  });
  for (Shape& shape : shapes_) shape.cells = {};
  return taken;
}

bool PieceModel::is_same(const Shape& s, const Piece& a, const Shape& t, const Piece& b) const {
  if (a.count != b.count) return false;
  const Vec3 way = b.box.min() - a.box.min();
  for (std::uint32_t k = 0; k < a.count; ++k) {
    const Cell &ca = s.cells.cells[a.first_cell + k], &cb = t.cells.cells[b.first_cell + k];
    const Face &fa = s.cells.faces[ca.face], &fb = t.cells.faces[cb.face];
    if (std::tuple(fa.is_side, fa.is_last, fa.inward, fa.round_u, fa.count_u) !=
        std::tuple(fb.is_side, fb.is_last, fb.inward, fb.round_u, fb.count_u))
      return false;
    if (!is_near(ca.box.min() + way, cb.box.min(), slack()) ||
        !is_near(ca.box.max() + way, cb.box.max(), slack()))
      return false;
    const nurbs::Patch pa = patch_of(*fa.surface, ca.low, ca.high),
                       pb = patch_of(*fb.surface, cb.low, cb.high);
    if (pa.count_u != pb.count_u || pa.count_v != pb.count_v || pa.weights.size() != pb.weights.size())
      return false;
    for (std::size_t m = 0; m < pa.points.size(); ++m)
      if (!is_near(pa.points[m] + way, pb.points[m], slack())) return false;
    constexpr double same_weight = 1e-9;
    for (std::size_t m = 0; m < pa.weights.size(); ++m)
      if (std::abs(pa.weights[m] - pb.weights[m]) > same_weight * std::abs(pb.weights[m])) return false;
  }
  return true;
}

void PieceModel::find_kinds() {
  // Of pieces alone.
  struct Example {
    std::uint32_t shape, piece;
  };
  std::vector<Example> examples;
  Kinds known;
  for (std::uint32_t s = 0; s < shapes_.size(); ++s) {
    Shape& shape = shapes_[s];
    for (std::uint32_t k = 0; k < shape.pieces.size(); ++k) {
      const Piece& piece = shape.pieces[k];
      Key key(coarseness * slack());
      key.add(piece.count);
      key.add(piece.box.sizes());
      for (const std::uint32_t cell : {piece.first_cell, piece.first_cell + piece.count / 3})
        key.add(shape.cells.cells[cell].box.center() - piece.box.min());
      const auto fresh = static_cast<std::uint32_t>(examples.size());
      const std::uint32_t kind = known.find(key, fresh, [&](std::uint32_t other) {
        const Shape& there = shapes_[examples[other].shape];
        return is_same(shape, piece, there, there.pieces[examples[other].piece]);
      });
      examples.push_back({s, k});
      shape.kinds.push_back(kind);
    }
  }
  // With those beside them.
  std::map<std::array<std::uint32_t, 2 * pieces_beside + 1>, std::uint32_t> surrounded;
  for (Shape& shape : shapes_) {
    const auto count = static_cast<std::int64_t>(shape.side_pieces);
    const bool is_ring = bodies_[shape.body].closed_along;
    // Past an end stands what seals it.
    const auto kind_at = [&](std::int64_t k) {
      if (is_ring) return shape.kinds[static_cast<std::size_t>(((k % count) + count) % count)];
      if (k >= 0 && k < count) return shape.kinds[static_cast<std::size_t>(k)];
      for (std::size_t e = shape.side_pieces; e < shape.pieces.size(); ++e)
        if ((k == -1 || k == count) &&
            shape.cells.faces[shape.cells.cells[shape.pieces[e].first_cell].face].is_last == (k == count))
          return shape.kinds[e];
      return nothing;
    };
    std::vector<std::uint32_t> kinds;
    for (std::size_t k = 0; k < shape.pieces.size(); ++k) {
      std::array<std::uint32_t, 2 * pieces_beside + 1> around{};
      auto middle = static_cast<std::int64_t>(k);
      if (middle >= count)
        middle = shape.cells.faces[shape.cells.cells[shape.pieces[k].first_cell].face].is_last ? count : -1;
      for (std::size_t i = 0; i < around.size(); ++i)
        around[i] = kind_at(middle + static_cast<std::int64_t>(i) - pieces_beside);
      kinds.push_back(
          surrounded.try_emplace(around, static_cast<std::uint32_t>(surrounded.size())).first->second);
    }
    shape.kinds = std::move(kinds);
  }
}

void PieceModel::add_needed(const Encounter& encounter, std::vector<std::vector<bool>>& wanted) const {
  // What has few is not worth choosing from.
  constexpr std::size_t few = 64;
  struct Range {
    std::uint32_t first = nothing, last = 0;
  };
  Range of_a, of_b;
  for (const PiecePair& pair : encounter.pairs) {
    of_a = {std::min(of_a.first, pair.a), std::max(of_a.last, pair.a)};
    of_b = {std::min(of_b.first, pair.b), std::max(of_b.last, pair.b)};
  }
  for (const auto& [body, range] : {std::pair(encounter.a, of_a), std::pair(encounter.b, of_b)}) {
    const Shape& there = shape(body);
    const std::size_t count = there.pieces.size(), sides = there.side_pieces;
    std::vector<bool>& pieces = wanted[body];
    pieces.resize(count, false);
    // An end face may be there for a place next to it; round a ring the range may be the shorter way or not.
    if (count <= few || bodies_[body].closed_along || encounter.pairs.empty()) {
      pieces.assign(count, true);
      continue;
    }
    for (std::size_t k = sides; k < count; ++k) pieces[k] = true;
    const std::size_t last = std::min<std::size_t>(range.last, sides - 1);
    for (std::size_t k = std::min<std::size_t>(range.first, last); k <= last; ++k) pieces[k] = true;
  }
}

std::vector<PiecePair> PieceModel::near_bodies(double reach) const {
  std::vector<PiecePair> pairs;
  boxes_.near_pairs(reach, [&](std::uint32_t a, std::uint32_t b) {
    if (!pieces(a).empty() && !pieces(b).empty()) pairs.push_back({a, b});
  });
  std::sort(pairs.begin(), pairs.end(),
            [](const PiecePair& x, const PiecePair& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  return pairs;
}

std::vector<Encounter> PieceModel::near_pieces(std::uint32_t a, std::uint32_t b, double reach,
                                               bool is_joined) const {
  thread_local std::vector<PiecePair> pairs;
  pairs.clear();
  const Shape &s = shape(a), &t = shape(b);
  if (a == b) {
    s.tree.near_pairs(reach, [&](std::uint32_t i, std::uint32_t j) {
      const Piece &p = s.pieces[i], &q = s.pieces[j];
      double way = std::abs(p.place - q.place);
      if (bodies_[a].closed_along) way = std::min(way, s.length - way);
      if (way > self_distance * std::max(p.width, q.width) &&
          way > detour * (p.box.center() - q.box.center()).norm())
        pairs.push_back({i, j});
    });
  } else {
    s.tree.near_pairs(t.tree, shifts_[b] - shifts_[a], reach, [&](std::uint32_t i, std::uint32_t j) {
      pairs.push_back({i, j});
    });
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const PiecePair& x, const PiecePair& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  std::vector<Encounter> encounters;
  if (!is_joined) {
    for (const PiecePair& pair : pairs) encounters.push_back({a, b, {pair}});
    return encounters;
  }
  Groups groups(pairs.size());
  thread_local std::unordered_map<std::uint32_t, std::size_t> last_of_b;
  last_of_b.clear();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (k > 0 && pairs[k].a == pairs[k - 1].a) groups.join(k, k - 1);
    const auto [known, is_new] = last_of_b.try_emplace(pairs[k].b, k);
    if (!is_new) groups.join(k, known->second);
  }
  std::vector<std::size_t> number(pairs.size());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const std::uint32_t group = groups.of(k);
    if (group == k) {
      number[k] = encounters.size();
      encounters.push_back({a, b, {}});
    }
    encounters[number[group]].pairs.push_back(pairs[k]);
  }
  return encounters;
}

Encounters PieceModel::encounters(double reach, bool is_joined,
                                  const std::function<bool(std::size_t, std::size_t)>& wanted) const {
  Encounters out;
  Kinds known;
  std::vector<std::uint32_t> numbers;  // of the kinds by what they were called when they were found
  const auto is_same = [&](const Encounter& x, const Encounter& y) {
    if (x.pairs.size() != y.pairs.size() || (x.a == x.b) != (y.a == y.b)) return false;
    const auto differ = [&](double here, double there) { return std::abs(here - there) > 10.0 * slack(); };
    if (differ(std::min(thickness(x.a), thickness(x.b)), std::min(thickness(y.a), thickness(y.b))) ||
        differ(std::max(touching(x.a), touching(x.b)), std::max(touching(y.a), touching(y.b))))
      return false;
    const Vec3 way = origin(y.a, y.pairs.front().a) - origin(x.a, x.pairs.front().a);
    const std::uint32_t more_a = y.pairs.front().a - x.pairs.front().a,
                        more_b = y.pairs.front().b - x.pairs.front().b;
    for (std::size_t k = 0; k < x.pairs.size(); ++k) {
      const PiecePair &p = x.pairs[k], &q = y.pairs[k];
      if (p.a + more_a != q.a || p.b + more_b != q.b || shape(x.a).kinds[p.a] != shape(y.a).kinds[q.a] ||
          shape(x.b).kinds[p.b] != shape(y.b).kinds[q.b] ||
          !is_near(origin(x.a, p.a) + way, origin(y.a, q.a), slack()) ||
          !is_near(origin(x.b, p.b) + way, origin(y.b, q.b), slack()))
        return false;
    }
    return true;
  };
  const auto take = [&](Encounter& encounter) {
    Key key(coarseness * slack());
    const PiecePair first = encounter.pairs.front();
    key.add(encounter.pairs.size());
    key.add(encounter.a == encounter.b ? 1U : 0U);
    key.add(shape(encounter.a).kinds[first.a]);
    key.add(shape(encounter.b).kinds[first.b]);
    key.add(origin(encounter.b, first.b) - origin(encounter.a, first.a));
    const auto fresh = static_cast<std::uint32_t>(out.kinds.size());
    const std::uint32_t kind =
        known.find(key, fresh, [&](std::uint32_t other) { return is_same(out.kinds[other], encounter); });
    out.places.push_back({kind, encounter.a, encounter.b, first});
    if (kind == fresh) out.kinds.push_back(std::move(encounter));
  };
  // Bodies with themselves: once a shape.
  std::vector<PiecePair> bodies;
  for (const Shape& shape : shapes_)
    if (!shape.pieces.empty() && wanted(shape.body, shape.body)) bodies.push_back({shape.body, shape.body});
  const std::size_t alone = bodies.size();
  for (const PiecePair& pair : near_bodies(reach))
    if (wanted(pair.a, pair.b)) bodies.push_back(pair);
  constexpr std::size_t block = 4096;
  std::vector<std::vector<Encounter>> found;
  for (std::size_t first = 0; first < bodies.size(); first += block) {
    found.assign(std::min(block, bodies.size() - first), {});
    for_each_index(found.size(), threads_, [&](std::size_t k) {
      found[k] = near_pieces(bodies[first + k].a, bodies[first + k].b, reach, is_joined);
    });
    for (std::size_t k = 0; k < found.size(); ++k)
      for (Encounter& encounter : found[k]) take(encounter);
  }
  // And for its other bodies.
  if (alone > 0) {
    std::vector<std::vector<EncounterPlace>> of_shape(shapes_.size());
    for (const EncounterPlace& place : out.places)
      if (place.a == place.b) of_shape[shape_of_[place.a]].push_back(place);
    for (std::uint32_t b = 0; b < bodies_.size(); ++b) {
      if (shape(b).body == b) continue;
      for (EncounterPlace place : of_shape[shape_of_[b]]) {
        place.a = place.b = b;
        out.places.push_back(place);
      }
    }
  }
  return out;
}

Encounter PieceModel::encounter_at(const Encounter& kind, const EncounterPlace& place) const {
  Encounter encounter{place.a, place.b, kind.pairs};
  for (PiecePair& pair : encounter.pairs) {
    pair.a += place.first.a - kind.pairs.front().a;
    pair.b += place.first.b - kind.pairs.front().b;
  }
  return encounter;
}

// `pieces`: by how many the place's stand farther along.
Vec2 PieceModel::moved_site(const Vec2& site, std::uint32_t from, std::uint32_t to,
                            std::int64_t pieces) const {
  const Shape &here = shape(from), &there = shape(to);
  const nurbs::Surface &s = bodies_[from].surface, &t = bodies_[to].surface;
  const auto count = [](const Shape& shape) { return static_cast<std::int64_t>(shape.side_pieces); };
  const bool is_ring = bodies_[from].closed_along;
  const double v = is_ring ? wrapped(site.y(), s.first_v(), s.last_v()) : site.y();
  const auto sides = std::span(here.pieces).first(here.side_pieces);
  const auto found = std::lower_bound(sides.begin(), sides.end() - 1, v,
                                      [](const Piece& piece, double value) { return piece.last_v < value; });
  std::int64_t k = found - sides.begin() + pieces;
  k = bodies_[to].closed_along ? ((k % count(there)) + count(there)) % count(there)
                               : std::clamp<std::int64_t>(k, 0, count(there) - 1);
  const Piece& other = there.pieces[static_cast<std::size_t>(k)];
  const double share = (v - found->first_v) / (found->last_v - found->first_v);
  const double moved = other.first_v + share * (other.last_v - other.first_v);
  return {site.x(), std::clamp(moved, t.first_v(), t.last_v())};
}

Contact PieceModel::placed(Contact contact, const Encounter& kind, const EncounterPlace& place) const {
  const PiecePair& own = kind.pairs.front();
  contact.a = place.a;
  contact.b = place.b;
  if (place.a == kind.a && place.b == kind.b && place.first.a == own.a && place.first.b == own.b)
    return contact;
  const Vec3 by = origin(place.a, place.first.a) - origin(kind.a, own.a);
  const auto move = [&](std::optional<Vec2>& site_a, std::optional<Vec2>& site_b) {
    if (site_a) site_a = moved_site(*site_a, kind.a, place.a, std::int64_t{place.first.a} - own.a);
    if (site_b) site_b = moved_site(*site_b, kind.b, place.b, std::int64_t{place.first.b} - own.b);
  };
  for (Vec3* p : {&contact.on_a, &contact.on_b, &contact.at}) *p += by;
  move(contact.site_a, contact.site_b);
  for (Minimum& spot : contact.spots) {
    spot.on_a += by;
    spot.on_b += by;
    move(spot.site_a, spot.site_b);
  }
  return contact;
}

}  // namespace selvage::contact
