#include "surface_mesh/cell_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "surface_mesh/crest_tips.h"
#include "surface_mesh/divided_line.h"

namespace selvage::fem {

namespace {

// A place on an arc by its length.
struct OnArc {
  double along = 0;
  std::optional<double> crest;  // the crest's u, as it goes on past the seam
  double first = 0;             // the edge beside it (CrestCrossing), 0: as the field has it
};

// A node of a chain is on a crest, and what it has of CrestCrossing.
struct Crossed {
  bool crest = false;
  double needle = 0;
};

class Divider {
 public:
  Divider(const CellShape& shape, const CrestTips& tips, const SizeField& field, double miss,
          CellNodes& nodes)
      : shape_(shape), tips_(tips), field_(field), miss_(miss), nodes_(nodes) {}

  Result<CellCurves> run();

 private:
  struct ArcEntry {  // the first of the division's edges, in their order
    const cell::Edge& edge;
    std::size_t body;
    Vec2 turn;  // what the parameters gain along an arc that is a border by itself
    cell::ArcCurve curve;
    const std::vector<CrestCrossing>& crossings;
    Chain& chain;
    std::size_t low = none;  // the arc that it is a copy of

    [[nodiscard]] int face() const { return edge.arc->face; }
    [[nodiscard]] Vec2 at(double along) const;
  };
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  void collect_arcs();
  [[nodiscard]] bool is_copy(int face) const {
    return face < cell::face_count && cell::is_high(face) &&
           shape_.periodic[static_cast<std::size_t>(cell::axis_of(face))];
  }
  // From the low face to the high one, and back.
  [[nodiscard]] Vec3 moved(const Vec3& point, int axis) const {
    return shape_.cell.with(point, axis, shape_.cell.box.max()[axis]);
  }
  [[nodiscard]] Vec3 moved_back(const Vec3& point, int axis) const {
    return shape_.cell.with(point, axis, shape_.cell.box.min()[axis]);
  }
  [[nodiscard]] Vec3 on_edge(int edge, double along) const {
    return shape_.cell.axes.place(cell::edge_point(shape_.cell.box, edge, along));
  }
  [[nodiscard]] double along_edge(std::uint32_t node, int axis) const {
    return shape_.cell.axes.own(nodes_.points[node])[axis];
  }
  // Of an edge of the box the parts, numbers of the division's edges, in the order along it.
  [[nodiscard]] std::size_t first_part(int edge) const { return parts_[static_cast<std::size_t>(edge)]; }
  [[nodiscard]] std::size_t part_count(int edge) const { return first_part(edge + 1) - first_part(edge); }
  // The edge of the box that this one is a copy of: its number is the smaller one, since bits of the number
  // say which sides are high.
  [[nodiscard]] int original(int edge) const {
    for (int bit = 0; bit < 2; ++bit)
      if (is_copied(edge, bit)) edge -= 1 << bit;
    return edge;
  }
  [[nodiscard]] bool is_copied(int edge, int bit) const {
    return (edge >> bit & 1) != 0 && shape_.periodic[static_cast<std::size_t>((edge / 4 + 1 + bit) % 3)];
  }

  Status find_copies();
  Status make_corners();
  void make_segments();
  void divide(ArcEntry& entry);
  Status copy(ArcEntry& entry);
  std::uint32_t add(ArcEntry& entry, const Vec3& point, const Vec2& q, const Crossed& crossed, bool is_last);
  static void close(ArcEntry& entry);
  [[nodiscard]] std::vector<OnArc> places(const ArcEntry& entry) const;
  [[nodiscard]] Message does_not_go_on(const ArcEntry& entry, double by, const Vec3& at) const;

  const CellShape& shape_;
  const CrestTips& tips_;
  const SizeField& field_;
  double miss_;
  CellNodes& nodes_;
  CellCurves curves_;
  std::vector<ArcEntry> arcs_;
  std::array<std::size_t, cell::edge_count + 1> parts_{};
  std::vector<std::uint32_t> corner_nodes_;
  std::vector<std::vector<double>> crests_;  // of each body
};

void Divider::collect_arcs() {
  const std::vector<cell::Edge>& edges = shape_.division.edges;
  curves_.chains.resize(edges.size());
  for (const cell::Piece& piece : shape_.cut.pieces)
    for (const cell::Border& border : piece.borders)
      for (const cell::Arc& arc : border.arcs) {
        const std::size_t k = arcs_.size();
        const yarn::Body& body = shape_.bodies[piece.body];
        arcs_.push_back({edges[k], piece.body,
                         Vec2(border.turns_u, border.turns_v).cwiseProduct(cell::periods(body)),
                         cell::ArcCurve(body, shape_.cell, arc), tips_.of_arcs[k], curves_.chains[k]});
      }
  for (std::size_t s = arcs_.size(); s < edges.size(); ++s)
    parts_[static_cast<std::size_t>(edges[s].box_edge) + 1] = s + 1;
  parts_.front() = arcs_.size();
  for (const yarn::Body& body : shape_.bodies) crests_.push_back(crests_of(body.surface));
}

Message Divider::does_not_go_on(const ArcEntry& entry, double by, const Vec3& at) const {
  return error(
             Kind::geometry,
             fmt::format(
                 "yarn '{}' goes through the {} face of the cell where no yarn goes through the opposite one"
                 "{}: the cell is no whole repeat there, or the yarns do not repeat",
                 shape_.bodies[entry.body].name, cell::name_of_face(entry.face()),
                 std::isfinite(by) ? fmt::format(" (it misses the nearest by {:.3g})", by) : std::string()))
      .of_yarn(shape_.bodies[entry.body].name, shape_.bodies[entry.body].place)
      .at_point(at);
}

// Which low arc each high one is the copy of: the nearest to some of its points.
Status Divider::find_copies() {
  std::vector<std::size_t> used(arcs_.size(), 0);
  for (ArcEntry& high : arcs_) {
    if (!is_copy(high.face())) continue;
    const int a = cell::axis_of(high.face());
    double best = std::numeric_limits<double>::infinity();
    Vec3 worst_at = high.curve.points().front();
    for (std::size_t k = 0; k < arcs_.size(); ++k) {
      const ArcEntry& low = arcs_[k];
      if (low.face() != high.face() - 1) continue;
      double farthest = 0;
      Vec3 farthest_at = worst_at;
      for (int i = 0; i <= 8; ++i) {
        const Vec3 here = high.curve.position(high.curve.at(high.curve.length() * i / 8));
        const double distance = low.curve.nearest(moved_back(here, a)).distance;
        if (distance > farthest) {
          farthest = distance;
          farthest_at = here;
        }
        if (farthest >= best) break;
      }
      if (farthest >= best) continue;
      best = farthest;
      worst_at = farthest_at;
      high.low = k;
    }
    if (!(best <= miss_)) return does_not_go_on(high, best, worst_at);
    const ArcEntry& low = arcs_[high.low];
    if (++used[high.low] > 1 || low.edge.is_border() != high.edge.is_border())
      return does_not_go_on(high, best, worst_at);
  }
  for (std::size_t k = 0; k < arcs_.size(); ++k) {
    const int face = arcs_[k].face();
    if (face < cell::face_count && is_copy(face + 1) && !cell::is_high(face) && used[k] == 0)
      return does_not_go_on(arcs_[k], std::numeric_limits<double>::infinity(),
                            arcs_[k].curve.points().front());
  }
  return {};
}

// Those on high faces of periodic axes are copies of the ones on the low edge.
Status Divider::make_corners() {
  const cell::Division& division = shape_.division;
  for (std::size_t c = 0; c < 8; ++c)
    corner_nodes_.push_back(nodes_.add(shape_.cell.axes.place(division.corners[c].at)));
  corner_nodes_.resize(division.corners.size());
  for (int edge = 0; edge < cell::edge_count; ++edge) {
    const int low = original(edge), a = edge / 4;
    const bool differs = part_count(edge) != part_count(low);
    for (std::size_t k = 0; k < part_count(edge); ++k) {
      const std::size_t corner = division.edges[first_part(edge) + k].to;
      const Vec3& at = division.corners[corner].at;
      const double along = differs ? 0 : division.corners[division.edges[first_part(low) + k].to].at[a];
      if (differs || std::abs(along - at[a]) > miss_)
        return error(Kind::geometry,
                     "yarns cross edges of the cell that face each other at different places: the cell is no "
                     "whole repeat there, or the yarns do not repeat")
            .at_point(shape_.cell.axes.place(at));
      if (corner >= 8) corner_nodes_[corner] = nodes_.add(on_edge(edge, along));
    }
  }
  return {};
}

void Divider::make_segments() {
  const auto chain = [&](std::size_t part) -> std::vector<std::uint32_t>& {
    return curves_.chains[part].nodes;
  };
  for (const bool copies : {false, true})
    for (std::size_t s = arcs_.size(); s < shape_.division.edges.size(); ++s) {
      const cell::Edge& part = shape_.division.edges[s];
      const int edge = part.box_edge, a = edge / 4, low = original(edge);
      if ((low != edge) != copies) continue;
      const std::size_t k = s - first_part(edge);
      const std::uint32_t from = corner_nodes_[part.from], to = corner_nodes_[part.to];
      const double start = along_edge(from, a);
      std::vector<double> places;
      if (copies) {
        for (const std::uint32_t node : chain(first_part(low) + k)) places.push_back(along_edge(node, a));
      } else {
        const auto wanted = [&](double along) { return field_.at(on_edge(edge, start + along)); };
        places = divided_line(along_edge(to, a) - start, wanted, 1);
        for (double& place : places) place += start;
      }
      chain(s).push_back(from);
      for (std::size_t i = 1; i + 1 < places.size(); ++i)
        chain(s).push_back(nodes_.add(on_edge(edge, places[i])));
      chain(s).push_back(to);
      // Which nodes are opposite each other.
      for (int bit = 0; bit < 2; ++bit)
        for (std::size_t i = 0; is_copied(edge, bit) && i < chain(s).size(); ++i)
          curves_.opposite[static_cast<std::size_t>((a + 1 + bit) % 3)]
                          [chain(first_part(edge - (1 << bit)) + k)[i]] = chain(s)[i];
    }
}

// An arc that is a border by itself begins at its first crest, and goes on past its end.
std::vector<OnArc> Divider::places(const ArcEntry& entry) const {
  std::vector<OnArc> breaks;
  for (const CrestCrossing& crossing : entry.crossings)
    breaks.push_back({crossing.along, crossing.crest, crossing.first});
  const double length = entry.curve.length();
  // Not nearer to an end, or to each other, than nothing.
  const double least = 1e-7 * length;
  std::vector<OnArc> kept;
  if (!entry.edge.is_border() || breaks.empty()) kept.push_back({0, {}});
  for (const OnArc& place : breaks) {
    if (kept.empty() || place.along - kept.back().along > least) {
      kept.push_back(place);
    } else if (!kept.back().crest) {
      kept.back().crest = place.crest;
      kept.back().first = place.first;
    }
  }
  const double end = entry.edge.is_border() ? kept.front().along + length : length;
  if (end - kept.back().along > least)
    kept.push_back({end, {}, entry.edge.is_border() ? kept.front().first : 0});
  else
    kept.back().along = end;
  std::vector<OnArc> result;
  const int spans = static_cast<int>(kept.size()) - 1;
  for (std::size_t k = 0; k + 1 < kept.size(); ++k) {
    const double from = kept[k].along;
    const auto wanted = [&](double along) { return field_.at(entry.curve.position(entry.at(from + along))); };
    result.push_back(kept[k]);
    for (const double along :
         divided_between(kept[k + 1].along - from, wanted, kept[k].first, kept[k + 1].first,
                         entry.edge.is_border() ? (8 + spans - 1) / spans : 1))
      result.push_back({from + along, {}});
  }
  result.push_back(kept.back());
  return result;
}

// Past the end of an arc that is a border by itself it goes on at its start.
Vec2 Divider::ArcEntry::at(double along) const {
  const double length = curve.length();
  if (!edge.is_border() || along <= length) return curve.at(along);
  return curve.at(std::min(along - length, length)) + turn;
}

// The next node of the chain: at the ends of an arc that is no border by itself, the corner's.
std::uint32_t Divider::add(ArcEntry& entry, const Vec3& point, const Vec2& q, const Crossed& crossed,
                           bool is_last) {
  const SurfacePlace place = shape_.place(entry.body, q);
  const bool is_first = entry.chain.nodes.empty();
  std::uint32_t node = 0;
  if (!entry.edge.is_border() && (is_first || is_last)) {
    node = corner_nodes_[is_first ? entry.edge.from : entry.edge.to];
    nodes_.places[node] = place;
  } else {
    node = nodes_.add(point, place);
  }
  entry.chain.nodes.push_back(node);
  entry.chain.parameters.push_back(q);
  entry.chain.on_crest.push_back(crossed.crest);
  entry.chain.needle.push_back(crossed.needle);
  return node;
}

// A border by itself ends where it begins.
void Divider::close(ArcEntry& entry) {
  Chain& chain = entry.chain;
  chain.nodes.push_back(chain.nodes.front());
  chain.parameters.push_back(chain.parameters.front() + entry.turn);
  chain.on_crest.push_back(chain.on_crest.front());
  chain.needle.push_back(chain.needle.front());
}

void Divider::divide(ArcEntry& entry) {
  std::vector<OnArc> parts = places(entry);
  const bool is_border = entry.edge.is_border();
  if (is_border) parts.pop_back();
  for (std::size_t k = 0; k < parts.size(); ++k) {
    Vec2 q = entry.at(parts[k].along);
    if (parts[k].crest) q.x() = *parts[k].crest;
    add(entry, entry.curve.position(q), q, {parts[k].crest.has_value(), parts[k].first},
        k + 1 == parts.size());
  }
  if (is_border) close(entry);
}

// The nodes of the low arc, moved; each with the parameters of the place nearest to it on the high arc.
Status Divider::copy(ArcEntry& entry) {
  const Chain& original = arcs_[entry.low].chain;
  const int a = cell::axis_of(entry.face());
  const bool is_border = entry.edge.is_border();
  struct Node {
    double along;
    std::uint32_t low;
    Crossed crossed;
    Vec3 point;
  };
  std::vector<Node> order;
  const std::size_t count = original.nodes.size() - (is_border ? 1 : 0);
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 point = moved(nodes_.points[original.nodes[k]], a);
    order.push_back({entry.curve.nearest(point).along,
                     original.nodes[k],
                     {original.on_crest[k], original.needle[k]},
                     point});
  }
  if (!is_border) {
    // Ends are ends; the way round is told by them.
    const Vec3 &start = entry.curve.points().front(), &end = entry.curve.points().back();
    if ((order.front().point - start).norm() + (order.back().point - end).norm() >
        (order.back().point - start).norm() + (order.front().point - end).norm())
      std::reverse(order.begin(), order.end());
    order.front().along = 0;
    order.back().along = entry.curve.length();
  } else {
    // Begin where the length does; they come in the order of the curve, one way or the other.
    const auto start = std::min_element(order.begin(), order.end(),
                                        [](const Node& x, const Node& y) { return x.along < y.along; });
    std::rotate(order.begin(), start, order.end());
    if (order.size() > 2 && order[1].along > order.back().along) std::reverse(order.begin() + 1, order.end());
  }
  const double period = cell::periods(shape_.bodies[entry.body]).x();
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k > 0 && !(order[k].along > order[k - 1].along))
      return does_not_go_on(entry, (miss_ > 0 ? std::numeric_limits<double>::infinity() : 0),
                            nodes_.points[order[k].low]);
    Vec2 q = entry.curve.at(order[k].along);
    if (order[k].crossed.crest && !crests_[entry.body].empty()) {
      double best = std::numeric_limits<double>::infinity();
      for (const double crest : crests_[entry.body]) {
        const double u = crest + period * std::round((q.x() - crest) / period);
        if (std::abs(u - q.x()) < std::abs(best - q.x())) best = u;
      }
      q.x() = best;
    }
    curves_.opposite[static_cast<std::size_t>(a)][order[k].low] =
        add(entry, order[k].point, q, order[k].crossed, k + 1 == order.size());
  }
  if (is_border) close(entry);
  return {};
}

Result<CellCurves> Divider::run() {
  collect_arcs();
  if (Status found = find_copies(); !found) return found.error();
  if (Status made = make_corners(); !made) return made.error();
  make_segments();
  for (ArcEntry& entry : arcs_)
    if (entry.low == none) divide(entry);
  for (ArcEntry& entry : arcs_)
    if (entry.low != none)
      if (Status made = copy(entry); !made) return made.error();
  return std::move(curves_);
}

}  // namespace

Result<CellCurves> divide_curves(const CellShape& shape, const CrestTips& tips, const SizeField& field,
                                 double miss, CellNodes& nodes) {
  return Divider(shape, tips, field, miss, nodes).run();
}

}  // namespace selvage::fem
