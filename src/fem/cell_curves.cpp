#include "fem/cell_curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "fem/divided_line.h"

namespace selvage::fem {

namespace {

// A place on an arc by its length.
struct OnArc {
  double along = 0;
  std::optional<double> crest;  // the crest's u, as it goes on past the seam
};

// Nearest place on the polygon of an arc's kept points.
struct Polygon {
  std::vector<Vec3> points;
  const std::vector<double>* lengths;

  struct Foot {
    double along = 0, distance = std::numeric_limits<double>::infinity();
  };
  [[nodiscard]] Foot nearest(const Vec3& p) const {
    Foot best;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const Vec3 way = points[k + 1] - points[k];
      const double square = way.squaredNorm();
      const double share = square > 0 ? std::clamp((p - points[k]).dot(way) / square, 0.0, 1.0) : 0;
      const double distance = (points[k] + share * way - p).norm();
      if (distance < best.distance)
        best = {(*lengths)[k] + share * ((*lengths)[k + 1] - (*lengths)[k]), distance};
    }
    return best;
  }
};

class Divider {
 public:
  Divider(const CellShape& shape, const SizeField& field, double miss, CellNodes& nodes)
      : shape_(shape), field_(field), miss_(miss), nodes_(nodes) {}

  Result<CellCurves> run();

 private:
  struct ArcEntry {
    const cell::Arc* arc;
    const cell::Border* border;
    std::size_t body;
    bool is_border;  // by itself
    cell::ArcCurve curve;
    Polygon polygon;
    std::size_t low = none;  // the arc that it is a copy of
  };
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  void collect_arcs();
  [[nodiscard]] bool is_copy(int face) const {
    return face < cell::face_count && cell::is_high(face) && shape_.periodic[axis(face)];
  }
  [[nodiscard]] static std::size_t axis(int face) { return static_cast<std::size_t>(cell::axis_of(face)); }
  [[nodiscard]] Vec3 moved(Vec3 point, int axis) const {  // from the low face to the high one
    point[axis] = shape_.box.max()[axis];
    return point;
  }
  // Arcs are the first of the edges.
  [[nodiscard]] std::size_t number(const ArcEntry& entry) const {
    return static_cast<std::size_t>(&entry - arcs_.data());
  }
  [[nodiscard]] const cell::Edge& edge(const ArcEntry& entry) const {
    return shape_.division.edges[number(entry)];
  }
  Chain& chain(const ArcEntry& entry) { return curves_.chains[number(entry)]; }

  Status find_copies();
  Status make_corners();
  Status make_segments();
  void divide(ArcEntry& entry);
  Status copy(ArcEntry& entry);
  // What the parameters gain along an arc that is a border by itself.
  [[nodiscard]] Vec2 turn_of(const ArcEntry& entry) const {
    const nurbs::Surface& surface = shape_.bodies[entry.body].surface;
    return {entry.border->turns_u * (surface.last_u() - surface.first_u()),
            entry.border->turns_v * (surface.last_v() - surface.first_v())};
  }
  [[nodiscard]] Vec2 place_at(const ArcEntry& entry, double along) const;
  [[nodiscard]] std::vector<OnArc> places(const ArcEntry& entry) const;
  [[nodiscard]] std::vector<OnArc> crest_places(const ArcEntry& entry) const;
  [[nodiscard]] Message does_not_go_on(const ArcEntry& entry, double by, const Vec3& at) const;

  const CellShape& shape_;
  const SizeField& field_;
  double miss_;
  CellNodes& nodes_;
  CellCurves curves_;
  std::vector<ArcEntry> arcs_;
  std::vector<std::uint32_t> corner_nodes_;
  std::vector<std::vector<double>> crests_;  // of each body
};

void Divider::collect_arcs() {
  curves_.chains.resize(shape_.division.edges.size());
  for (const cell::Piece& piece : shape_.cut.pieces)
    for (const cell::Border& border : piece.borders)
      for (const cell::Arc& arc : border.arcs)
        arcs_.push_back({&arc,
                         &border,
                         piece.body,
                         border.arcs.size() == 1,
                         cell::ArcCurve(shape_.bodies[piece.body], shape_.box, arc),
                         {},
                         none});
  for (ArcEntry& entry : arcs_) {
    entry.polygon.lengths = &entry.curve.lengths();
    for (const Vec2& q : entry.arc->parameters) entry.polygon.points.push_back(entry.curve.position(q));
  }
  for (const yarn::Body& body : shape_.bodies) crests_.push_back(crests_of(body.surface));
}

Message Divider::does_not_go_on(const ArcEntry& entry, double by, const Vec3& at) const {
  const int face = entry.arc->face;
  Message message = error(
      Kind::geometry,
      fmt::format("yarn '{}' goes through the {} face of the cell where no yarn goes through the opposite one"
                  "{}: the cell is no whole repeat there, or the yarns do not repeat",
                  shape_.bodies[entry.body].name, cell::name_of_face(face),
                  std::isfinite(by) ? fmt::format(" (it misses the nearest by {:.3g})", by) : std::string()));
  message.yarn = shape_.bodies[entry.body].name;
  message.place = shape_.bodies[entry.body].place;
  message.at = at;
  return message;
}

// Which low arc each high one is the copy of: the nearest to some of its points.
Status Divider::find_copies() {
  std::vector<std::size_t> used(arcs_.size(), 0);
  for (ArcEntry& high : arcs_) {
    if (!is_copy(high.arc->face)) continue;
    const int a = cell::axis_of(high.arc->face);
    double best = std::numeric_limits<double>::infinity();
    Vec3 worst_at = high.polygon.points.front();
    for (std::size_t k = 0; k < arcs_.size(); ++k) {
      const ArcEntry& low = arcs_[k];
      if (low.arc->face != high.arc->face - 1) continue;
      double farthest = 0;
      Vec3 farthest_at = worst_at;
      for (int i = 0; i <= 8; ++i) {
        Vec3 point = high.curve.position(high.curve.at(high.curve.length() * i / 8));
        const Vec3 here = point;
        point[a] = shape_.box.min()[a];
        const double distance = low.polygon.nearest(point).distance;
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
    if (++used[high.low] > 1 || low.is_border != high.is_border) return does_not_go_on(high, best, worst_at);
  }
  for (std::size_t k = 0; k < arcs_.size(); ++k) {
    const int face = arcs_[k].arc->face;
    if (face < cell::face_count && is_copy(face + 1) && !cell::is_high(face) && used[k] == 0)
      return does_not_go_on(arcs_[k], std::numeric_limits<double>::infinity(),
                            arcs_[k].polygon.points.front());
  }
  return {};
}

// Corners and segments of each edge in the order along it; those on high faces of periodic axes are copies of
// the ones on the low edge.
Status Divider::make_corners() {
  const cell::Division& division = shape_.division;
  corner_nodes_.assign(division.corners.size(), 0);
  std::vector<bool> made(division.corners.size(), false);
  const auto make = [&](std::size_t c, const Vec3& at) {
    if (made[c]) return;
    made[c] = true;
    corner_nodes_[c] = nodes_.add(at, {no_body, Vec2::Zero()});
  };
  for (std::size_t c = 0; c < 8; ++c) make(c, division.corners[c].at);
  std::array<std::vector<std::size_t>, cell::edge_count> on_edge;
  for (const cell::Edge& e : division.edges)
    if (e.arc == nullptr) on_edge[static_cast<std::size_t>(e.box_edge)].push_back(e.to);
  for (int edge = 0; edge < cell::edge_count; ++edge) {
    auto& corners = on_edge[static_cast<std::size_t>(edge)];
    std::sort(corners.begin(), corners.end(), [&](std::size_t a, std::size_t b) {
      return division.corners[a].at[edge / 4] < division.corners[b].at[edge / 4];
    });
  }
  for (int edge = 0; edge < cell::edge_count; ++edge) {
    // The edge that it is a copy of has a smaller number: bits of the number say which sides are high.
    int master = edge;
    for (int bit = 0; bit < 2; ++bit)
      if ((edge >> bit & 1) != 0 && shape_.periodic[static_cast<std::size_t>((edge / 4 + 1 + bit) % 3)])
        master -= 1 << bit;
    const auto &here = on_edge[static_cast<std::size_t>(edge)],
               &there = on_edge[static_cast<std::size_t>(master)];
    for (std::size_t k = 0; k < here.size(); ++k) {
      const Vec3& at = division.corners[here[k]].at;
      const double along = here.size() == there.size() ? division.corners[there[k]].at[edge / 4] : 0;
      if (here.size() != there.size() || std::abs(along - at[edge / 4]) > miss_) {
        Message message = error(Kind::geometry,
                                "yarns cross edges of the cell that face each other at different places: the "
                                "cell is no whole repeat there, or the yarns do not repeat");
        message.at = at;
        return message;
      }
      make(here[k], cell::edge_point(shape_.box, edge, along));
    }
  }
  return {};
}

Status Divider::make_segments() {
  const std::vector<cell::Edge>& edges = shape_.division.edges;
  const auto find = [&](int edge, double from) {
    std::size_t best = none;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t s = arcs_.size(); s < edges.size(); ++s) {
      if (edges[s].box_edge != edge) continue;
      const double off = std::abs(nodes_.points[corner_nodes_[edges[s].from]][edge / 4] - from);
      if (off < least) {
        least = off;
        best = s;
      }
    }
    return best;
  };
  for (const int pass : {0, 1})
    for (std::size_t s = arcs_.size(); s < edges.size(); ++s) {
      const int edge = edges[s].box_edge, a = edge / 4;
      int master = edge;
      for (int bit = 0; bit < 2; ++bit)
        if ((edge >> bit & 1) != 0 && shape_.periodic[static_cast<std::size_t>((a + 1 + bit) % 3)])
          master -= 1 << bit;
      if ((master == edge) != (pass == 0)) continue;
      std::vector<std::uint32_t>& chain = curves_.chains[s].nodes;
      const std::uint32_t from = corner_nodes_[edges[s].from], to = corner_nodes_[edges[s].to];
      chain.push_back(from);
      const double start = nodes_.points[from][a];
      if (master == edge) {
        const double length = nodes_.points[to][a] - start;
        const auto at = [&](double along) { return cell::edge_point(shape_.box, edge, start + along); };
        const std::vector<double> parts = divided_line(
            length, [&](double along) { return field_.at(at(along)); }, 1);
        for (std::size_t k = 1; k + 1 < parts.size(); ++k)
          chain.push_back(nodes_.add(at(parts[k]), {no_body, Vec2::Zero()}));
      } else {
        const std::vector<std::uint32_t>& original = curves_.chains[find(master, start)].nodes;
        for (std::size_t k = 1; k + 1 < original.size(); ++k)
          chain.push_back(nodes_.add(cell::edge_point(shape_.box, edge, nodes_.points[original[k]][a]),
                                     {no_body, Vec2::Zero()}));
      }
      chain.push_back(to);
    }
  // Which nodes are opposite each other, axis by axis.
  for (std::size_t s = arcs_.size(); s < edges.size(); ++s) {
    const std::vector<std::uint32_t>& here = curves_.chains[s].nodes;
    const int edge = edges[s].box_edge, a = edge / 4;
    for (int bit = 0; bit < 2; ++bit) {
      const auto across = static_cast<std::size_t>((a + 1 + bit) % 3);
      if ((edge >> bit & 1) == 0 || !shape_.periodic[across]) continue;
      const std::vector<std::uint32_t>& low =
          curves_.chains[find(edge - (1 << bit), nodes_.points[here.front()][a])].nodes;
      for (std::size_t k = 0; k < here.size(); ++k) curves_.opposite[across][low[k]] = here[k];
    }
  }
  return {};
}

// Where the arc crosses the crests of its yarn.
std::vector<OnArc> Divider::crest_places(const ArcEntry& entry) const {
  const nurbs::Surface& surface = shape_.bodies[entry.body].surface;
  const double first = surface.first_u(), period = surface.last_u() - first;
  const std::vector<Vec2>& q = entry.arc->parameters;
  const std::vector<double>& lengths = entry.curve.lengths();
  std::vector<OnArc> result;
  for (std::size_t k = 0; k + 1 < q.size(); ++k)
    for (const double crest : crests_[entry.body]) {
      const double low = std::min(q[k].x(), q[k + 1].x()), high = std::max(q[k].x(), q[k + 1].x());
      const auto first_turn = static_cast<long>(std::ceil((low - crest) / period)),
                 last_turn = static_cast<long>(std::floor((high - crest) / period));
      for (long turn = first_turn; turn <= last_turn; ++turn) {
        const double u = crest + period * static_cast<double>(turn);
        // Each kept point belongs to the step behind it, the last to the one before it.
        if (u == q[k + 1].x() && k + 2 < q.size()) continue;
        double from = lengths[k], to = lengths[k + 1];
        const bool rising = q[k + 1].x() > q[k].x();
        if (u == q[k].x()) to = from;
        if (u == q[k + 1].x()) from = to;
        for (int step = 0; step < 60 && to - from > 1e-15 * lengths.back(); ++step) {
          const double middle = (from + to) / 2;
          ((entry.curve.at(middle).x() < u) == rising ? from : to) = middle;
        }
        result.push_back({(from + to) / 2, u});
      }
    }
  std::sort(result.begin(), result.end(), [](const OnArc& a, const OnArc& b) { return a.along < b.along; });
  return result;
}

// An arc that is a border by itself begins at its first crest, and goes on past its end.
std::vector<OnArc> Divider::places(const ArcEntry& entry) const {
  const std::vector<OnArc> breaks = crest_places(entry);
  const double length = entry.curve.length();
  // Not nearer to an end, or to each other, than nothing.
  const double least = 1e-7 * length;
  std::vector<OnArc> kept;
  if (!entry.is_border || breaks.empty()) kept.push_back({0, {}});
  for (const OnArc& place : breaks) {
    if (kept.empty() || place.along - kept.back().along > least)
      kept.push_back(place);
    else if (!kept.back().crest)
      kept.back().crest = place.crest;
  }
  const double end = entry.is_border ? kept.front().along + length : length;
  if (end - kept.back().along > least)
    kept.push_back({end, {}});
  else
    kept.back().along = end;
  std::vector<OnArc> result;
  const int spans = static_cast<int>(kept.size()) - 1;
  for (std::size_t k = 0; k + 1 < kept.size(); ++k) {
    const double from = kept[k].along;
    const auto wanted = [&](double along) {
      return field_.at(entry.curve.position(place_at(entry, from + along)));
    };
    const std::vector<double> parts =
        divided_line(kept[k + 1].along - from, wanted, entry.is_border ? (8 + spans - 1) / spans : 1);
    for (std::size_t i = 0; i + 1 < parts.size(); ++i)
      result.push_back({from + parts[i], i == 0 ? kept[k].crest : std::nullopt});
  }
  result.push_back(kept.back());
  return result;
}

// Past the end of an arc that is a border by itself it goes on at its start.
Vec2 Divider::place_at(const ArcEntry& entry, double along) const {
  const double length = entry.curve.length();
  if (!entry.is_border || along <= length) return entry.curve.at(along);
  return entry.curve.at(std::min(along - length, length)) + turn_of(entry);
}

void Divider::divide(ArcEntry& entry) {
  Chain& made = chain(entry);
  const std::vector<OnArc> parts = places(entry);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    const bool first = k == 0, last = k + 1 == parts.size();
    Vec2 q = place_at(entry, parts[k].along);
    if (parts[k].crest) q.x() = *parts[k].crest;
    if (entry.is_border && last) q = made.parameters.front() + turn_of(entry);
    const SurfacePlace place{entry.body, cell::in_domain(shape_.bodies[entry.body], q)};
    std::uint32_t node = 0;
    if (entry.is_border) {
      node = last ? made.nodes.front() : nodes_.add(entry.curve.position(q), place);
    } else if (first || last) {
      node = corner_nodes_[first ? edge(entry).from : edge(entry).to];
      nodes_.places[node] = place;
    } else {
      node = nodes_.add(entry.curve.position(q), place);
    }
    made.nodes.push_back(node);
    made.parameters.push_back(q);
    made.on_crest.push_back(parts[k].crest.has_value());
  }
  if (entry.is_border)
    made.on_crest.back() = made.on_crest.front() = made.on_crest.front() || made.on_crest.back();
}

// The nodes of the low arc, moved; each with the parameters of the place nearest to it on the high arc.
Status Divider::copy(ArcEntry& entry) {
  const ArcEntry& low = arcs_[entry.low];
  const Chain& original = chain(low);
  const int a = cell::axis_of(entry.arc->face);
  auto& opposite = curves_.opposite[static_cast<std::size_t>(a)];
  const yarn::Body& body = shape_.bodies[entry.body];
  const double period = body.surface.last_u() - body.surface.first_u();
  struct Node {
    double along;
    std::uint32_t low;
    bool on_crest;
  };
  std::vector<Node> order;
  const std::size_t count = original.nodes.size() - (entry.is_border ? 1 : 0);
  for (std::size_t k = 0; k < count; ++k)
    order.push_back({entry.polygon.nearest(moved(nodes_.points[original.nodes[k]], a)).along,
                     original.nodes[k], original.on_crest[k]});
  if (!entry.is_border) {
    // Ends are ends; the way round is told by them.
    const Vec3 first = moved(nodes_.points[original.nodes.front()], a),
               last = moved(nodes_.points[original.nodes.back()], a);
    if ((first - entry.polygon.points.front()).norm() + (last - entry.polygon.points.back()).norm() >
        (last - entry.polygon.points.front()).norm() + (first - entry.polygon.points.back()).norm())
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
  Chain& made = chain(entry);
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k > 0 && !(order[k].along > order[k - 1].along))
      return does_not_go_on(entry, (miss_ > 0 ? std::numeric_limits<double>::infinity() : 0),
                            nodes_.points[order[k].low]);
    Vec2 q = entry.curve.at(order[k].along);
    if (order[k].on_crest && !crests_[entry.body].empty()) {
      double best = std::numeric_limits<double>::infinity();
      for (const double crest : crests_[entry.body]) {
        const double u = crest + period * std::round((q.x() - crest) / period);
        if (std::abs(u - q.x()) < std::abs(best - q.x())) best = u;
      }
      q.x() = best;
    }
    const SurfacePlace place{entry.body, cell::in_domain(body, q)};
    const Vec3 point = moved(nodes_.points[order[k].low], a);
    std::uint32_t node = 0;
    if (!entry.is_border && (k == 0 || k + 1 == order.size())) {
      node = corner_nodes_[k == 0 ? edge(entry).from : edge(entry).to];
      nodes_.places[node] = place;
    } else {
      node = nodes_.add(point, place);
    }
    opposite[order[k].low] = node;
    made.nodes.push_back(node);
    made.parameters.push_back(q);
    made.on_crest.push_back(order[k].on_crest);
  }
  if (entry.is_border) {
    made.nodes.push_back(made.nodes.front());
    made.parameters.push_back(made.parameters.front() + turn_of(entry));
    made.on_crest.push_back(made.on_crest.front());
  }
  return {};
}

Result<CellCurves> Divider::run() {
  collect_arcs();
  if (Status found = find_copies(); !found) return found.error();
  if (Status made = make_corners(); !made) return made.error();
  if (Status made = make_segments(); !made) return made.error();
  for (ArcEntry& entry : arcs_)
    if (entry.low == none) divide(entry);
  for (ArcEntry& entry : arcs_)
    if (entry.low != none)
      if (Status made = copy(entry); !made) return made.error();
  return std::move(curves_);
}

}  // namespace

Result<CellCurves> divide_curves(const CellShape& shape, const SizeField& field, double miss,
                                 CellNodes& nodes) {
  return Divider(shape, field, miss, nodes).run();
}

}  // namespace selvage::fem
