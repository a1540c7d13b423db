#include "cell/tube_faces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/plane.h"
#include "nurbs/bezier.h"  // Box2
#include "nurbs/restrict.h"
#include "nurbs/spline.h"

namespace selvage::cell {

namespace {

using nurbs::Box2;

constexpr double on_line = 1e-9;  // of the period
constexpr std::size_t none = static_cast<std::size_t>(-1);

// A place of a border where edges end: a corner between two arcs, or a node.
struct Stop {
  std::size_t arc = 0;  // of the border
  double along = 0;
  // A node: where a line of constant u meets the border; the piece is above it (v more) or below.
  bool is_node = false, is_up = false;
  std::size_t line = 0;
  std::size_t opposite = none, line_edge = none;  // the node at its line's other end, and the edge to there
  const ArcPath* path = nullptr;
  std::size_t next = none;  // along the border
  std::size_t edge = none;  // to there
  bool is_done = false;
};

// A kept point of a border.
struct Sample {
  std::size_t arc = 0;
  double along = 0;
  Vec2 at;
};

// One use of an edge by a loop.
struct EdgeUse {
  std::size_t edge = 0;
  bool backward = false;
  double shift_u = 0;  // to be added to the edge's flat curve for this face
};
using EdgeLoop = std::vector<EdgeUse>;

// A loop while it is put together: with the parameters along it, for its sense and place.
struct Traced {
  EdgeLoop uses;
  std::vector<Vec2> outline;
};

class PieceDivider {
 public:
  PieceDivider(const yarn::Body& body, const Box3& box, const Piece& piece, const Division& division,
               double tolerance, TubeFaces& out)
      : body_(body), piece_(piece), division_(division), tolerance_(tolerance), out_(out) {
    first_u_ = body.surface.first_u();
    period_ = body.surface.last_u() - first_u_;
    for (const Border& border : piece.borders) {
      std::vector<ArcPath> paths;
      for (const Arc& arc : border.arcs) paths.emplace_back(body, box, arc, border.arcs.size() == 1);
      paths_.push_back(std::move(paths));
    }
  }

  Status run() {
    if (body_.closed_along) return fault("is closed along; cut yarns with ends only are written as CAD", {});
    lines_ = {first_u_};
    const bool goes_round = std::any_of(piece_.borders.begin(), piece_.borders.end(),
                                        [](const Border& border) { return border.turns_u != 0; });
    if (goes_round) lines_.push_back(body_.quarters[2]);
    for (std::size_t b = 0; b < piece_.borders.size(); ++b)
      if (Status status = find_stops(b); !status.ok()) return status;
    if (Status status = join_nodes(); !status.ok()) return status;
    return trace_all();
  }

 private:
  Status fault(const std::string& what, const std::optional<Vec2>& at) const {
    return error(Kind::geometry, fmt::format("yarn '{}' {}", body_.name, what))
        .of_yarn(body_.name, body_.place)
        .at_point(position(body_, at.value_or(piece_.inside)));
  }

  // Which stripe between copies of the line u is in; nothing where it is on one of them.
  [[nodiscard]] std::optional<long> stripe(double u, double line) const {
    const double turns = (u - line) / period_;
    if (std::abs(turns - std::round(turns)) < on_line) return std::nullopt;
    return static_cast<long>(std::floor(turns));
  }

  [[nodiscard]] std::vector<Sample> samples(std::size_t b) const {
    std::vector<Sample> result;
    const Border& border = piece_.borders[b];
    for (std::size_t a = 0; a < border.arcs.size(); ++a)
      for (std::size_t i = 0; i < border.arcs[a].parameters.size(); ++i)
        result.push_back({a, paths_[b][a].along_of(i), border.arcs[a].parameters[i]});
    return result;
  }

  Status find_stops(std::size_t b) {
    const Border& border = piece_.borders[b];
    std::vector<Stop> stops;
    if (border.arcs.size() > 1)
      for (std::size_t a = 0; a < border.arcs.size(); ++a) stops.push_back({.arc = a, .along = 0});
    const std::vector<Sample> kept = samples(b);
    for (std::size_t line = 0; line < lines_.size(); ++line)
      if (Status status = find_nodes(b, line, kept, stops); !status.ok()) return status;
    for (std::size_t a = 0; a < border.arcs.size(); ++a) add_corners_of_end(b, a, stops);
    std::stable_sort(stops.begin(), stops.end(), [](const Stop& x, const Stop& y) {
      return x.arc != y.arc ? x.arc < y.arc : x.along < y.along;
    });
    if (stops.empty()) stops.push_back({});
    add_edges(b, std::move(stops));
    return {};
  }

  // An end inside the box is divided where its patch has corners.
  void add_corners_of_end(std::size_t b, std::size_t a, std::vector<Stop>& stops) const {
    const Arc& arc = piece_.borders[b].arcs[a];
    if (arc.face < face_count) return;
    const yarn::EndFace& end = arc.along == Arc::Along::start ? body_.start : body_.end;
    if (end.style != yarn::EndStyle::patch) return;
    const double first = arc.parameters.front().x(), way = arc.parameters.back().x() - first;
    for (const double quarter : body_.quarters) {
      double ahead = std::fmod(way > 0 ? quarter - first : first - quarter, period_);
      if (ahead < -on_line * period_) ahead += period_;
      ahead = std::max(ahead, 0.0);
      if (ahead > std::abs(way) - on_line * period_) ahead = 0;
      const bool known = std::any_of(stops.begin(), stops.end(), [&](const Stop& stop) {
        return stop.arc == a && std::abs(stop.along - ahead) < 2 * on_line * period_;
      });
      if (!known) stops.push_back({.arc = a, .along = ahead});
    }
  }

  // Along the border from one point that is off the line to the next.
  Status find_nodes(std::size_t b, std::size_t line, const std::vector<Sample>& kept,
                    std::vector<Stop>& stops) const {
    const double at_u = lines_[line];
    std::size_t start = 0;
    while (start < kept.size() && !stripe(kept[start].at.x(), at_u)) ++start;
    if (start == kept.size()) return {};  // runs along the line all the way
    std::size_t before = start;
    long stripe_before = *stripe(kept[start].at.x(), at_u);
    for (std::size_t step = 1; step <= kept.size(); ++step) {
      const std::size_t i = (start + step) % kept.size();
      // Once round, u has gained its turns.
      const long wrapped = start + step >= kept.size() ? piece_.borders[b].turns_u : 0;
      std::optional<long> now = stripe(kept[i].at.x(), at_u);
      if (!now) continue;
      *now += wrapped;
      if (*now != stripe_before) {
        if (std::abs(*now - stripe_before) > 1)
          return fault("is cut too near to its seam to be divided there", kept[i].at);
        settle(b, node_between(b, line, kept, before, i, *now > stripe_before), stops);
      }
      before = i;
      stripe_before = *now;
    }
    return {};
  }

  // Between the kept points `before` and `after`, of which those between lie on the line.
  [[nodiscard]] Stop node_between(std::size_t b, std::size_t line, const std::vector<Sample>& kept,
                                  std::size_t before, std::size_t after, bool up) const {
    Stop node{.is_node = true, .is_up = up, .line = line};
    std::optional<std::size_t> best;
    for (std::size_t i = (before + 1) % kept.size(); i != after; i = (i + 1) % kept.size())
      if (!best || (up ? kept[i].at.y() > kept[*best].at.y() : kept[i].at.y() < kept[*best].at.y())) best = i;
    if (best) {
      node.arc = kept[*best].arc;
      node.along = kept[*best].along;
    } else {
      node.arc = kept[before].arc;
      const double low = std::min(kept[before].at.x(), kept[after].at.x());
      const double value = lines_[line] + period_ * std::ceil((low - lines_[line]) / period_);
      node.along = paths_[b][node.arc].crossing(0, value, kept[before].along, kept[after].along);
    }
    return node;
  }

  // At a corner where it is as good as there; else a stop of its own.
  void settle(std::size_t b, Stop node, std::vector<Stop>& stops) const {
    const Border& border = piece_.borders[b];
    const ArcPath& path = paths_[b][node.arc];
    if (border.arcs.size() > 1) {
      const Vec3 here = path.position(node.along);
      for (const bool last : {false, true}) {
        if ((path.position(last ? path.length() : 0) - here).norm() > 10 * tolerance_) continue;
        node.arc = last ? (node.arc + 1) % border.arcs.size() : node.arc;
        for (Stop& stop : stops)
          if (stop.arc == node.arc && stop.along == 0 && !stop.is_node) {
            node.along = 0;
            stop = node;
            return;
          }
      }
    } else if (node.along >= path.length()) {
      node.along = 0;
    }
    stops.push_back(node);
  }

  void add_edges(std::size_t b, std::vector<Stop> stops) {
    const std::size_t first_arc = out_.of_arc.size(), first = stops_.size();
    out_.of_arc.resize(first_arc + piece_.borders[b].arcs.size());
    for (std::size_t s = 0; s < stops.size(); ++s) {
      Stop& here = stops[s];
      const std::size_t after = (s + 1) % stops.size();
      const Stop& next = stops[after];
      const ArcPath& path = paths_[b][here.arc];
      double to = next.arc == here.arc ? next.along : path.length();
      if (to <= here.along) to = path.is_closed() ? to + path.length() : path.length();
      here.path = &path;
      here.next = first + after;
      here.edge = out_.edges.size();
      out_.of_arc[first_arc + here.arc].push_back(here.edge);
      out_.edges.push_back(path.curves(here.along, to, tolerance_));
    }
    // Where yarns cross the edges of the box: the corners' own numbers.
    for (std::size_t arc = first_arc; arc < out_.of_arc.size(); ++arc) {
      const Edge& edge = division_.edges[arc];
      if (edge.is_border()) continue;
      out_.edges[out_.of_arc[arc].front()].space.points.front() = division_.corners[edge.from].at;
      out_.edges[out_.of_arc[arc].back()].space.points.back() = division_.corners[edge.to].at;
    }
    stops_.insert(stops_.end(), stops.begin(), stops.end());
  }

  [[nodiscard]] Vec2 parameters_of(std::size_t stop) const {
    return stops_[stop].path->at(stops_[stop].along);
  }

  // Along each line nodes come in pairs: from one with the piece above it to one with the piece below it.
  Status join_nodes() {
    for (std::size_t line = 0; line < lines_.size(); ++line) {
      std::vector<std::size_t> nodes;
      for (std::size_t s = 0; s < stops_.size(); ++s)
        if (stops_[s].is_node && stops_[s].line == line) nodes.push_back(s);
      std::stable_sort(nodes.begin(), nodes.end(), [&](std::size_t x, std::size_t y) {
        return parameters_of(x).y() < parameters_of(y).y();
      });
      for (std::size_t i = 0; i < nodes.size(); i += 2) {
        if (i + 1 == nodes.size() || !stops_[nodes[i]].is_up || stops_[nodes[i + 1]].is_up)
          return fault("is cut too near to its seam to be divided there", parameters_of(nodes[i]));
        for (const std::size_t end : {i, i + 1}) {
          stops_[nodes[end]].opposite = nodes[end == i ? i + 1 : i];
          stops_[nodes[end]].line_edge = out_.edges.size();
        }
        out_.edges.push_back(line_of_constant_u(body_.surface, lines_[line], parameters_of(nodes[i]).y(),
                                                parameters_of(nodes[i + 1]).y()));
      }
    }
    return {};
  }

  Status trace_all() {
    std::vector<EdgeLoop> loops;
    std::vector<std::vector<Vec2>> outlines;
    for (std::size_t s = 0; s < stops_.size(); ++s) {
      if (stops_[s].is_done) continue;
      Traced traced;
      if (Status status = trace(s, traced); !status.ok()) return status;
      loops.push_back(std::move(traced.uses));
      outlines.push_back(std::move(traced.outline));
    }
    const std::vector<std::size_t> outer = outer_polygons(outlines);
    std::vector<cad::Face>& faces = out_.of_body[piece_.body];
    const std::size_t first = faces.size();
    for (std::size_t i = 0; i < loops.size(); ++i) {
      if (outer[i] != i) continue;
      std::vector<EdgeLoop> own = {loops[i]};
      for (std::size_t k = 0; k < loops.size(); ++k)
        if (k != i && outer[k] == i) own.push_back(loops[k]);
      faces.push_back(face_of(own));
    }
    if (faces.size() == first) return fault("cannot be divided into faces", {});
    for (std::size_t i = 0; i < loops.size(); ++i)
      if (outer[i] == no_polygon) return fault("cannot be divided into faces", outlines[i].front());
    return {};
  }

  // From the edge that leaves this stop, always to the left.
  Status trace(std::size_t start, Traced& traced) {
    std::size_t k = start;
    do {
      if (stops_[k].is_done) return fault("cannot be divided into faces", parameters_of(k));
      stops_[k].is_done = true;
      append(traced, stops_[k].edge, false);
      k = stops_[k].next;
      const Stop& here = stops_[k];
      if (!here.is_node) continue;
      append(traced, here.line_edge, !here.is_up);
      k = here.opposite;
    } while (k != start);
    const double miss = std::abs(traced.outline.back().x() - traced.outline.front().x());
    if (miss > 0.5 * period_) return fault("cannot be divided into faces", traced.outline.front());
    to_domain(traced);
    return {};
  }

  // With u next to where the loop has come to.
  void append(Traced& traced, std::size_t edge, bool backward) const {
    const nurbs::Curve& flat = out_.edges[edge].flat;
    double shift = 0;
    for (std::size_t i = 0; i < flat.points.size(); ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(flat.points.size() - 1);
      const double t = std::lerp(flat.first_parameter(), flat.last_parameter(), backward ? 1 - share : share);
      const Vec3 p = nurbs::evaluate(flat, t);
      if (i == 0 && !traced.outline.empty())
        shift = period_ * std::round((traced.outline.back().x() - p.x()) / period_);
      traced.outline.emplace_back(p.x() + shift, p.y());
    }
    traced.uses.push_back({edge, backward, shift});
  }

  void to_domain(Traced& traced) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vec2& p : traced.outline) {
      low = std::min(low, p.x());
      high = std::max(high, p.x());
    }
    const double shift = period_ * std::floor((0.5 * (low + high) - first_u_) / period_);
    for (Vec2& p : traced.outline) p.x() -= shift;
    for (EdgeUse& use : traced.uses) use.shift_u -= shift;
  }

  // A little more of the surface than the outer loop needs, but not across the lines that it runs along.
  [[nodiscard]] cad::Face face_of(const std::vector<EdgeLoop>& loops) const {
    Box2 box;
    for (const EdgeUse& use : loops.front())
      for (const Vec3& p : out_.edges[use.edge].flat.points) box.extend(Vec2(p.x() + use.shift_u, p.y()));
    const Vec2 margin = 0.02 * box.sizes();
    const nurbs::Surface& s = body_.surface;
    const double low_u = bound(box.min().x(), -margin.x(), s.knots_u, first_u_, s.last_u(), lines_),
                 high_u = bound(box.max().x(), margin.x(), s.knots_u, first_u_, s.last_u(), lines_),
                 low_v = bound(box.min().y(), -margin.y(), s.knots_v, s.first_v(), s.last_v(), {}),
                 high_v = bound(box.max().y(), margin.y(), s.knots_v, s.first_v(), s.last_v(), {});
    cad::Face face;
    face.surface = nurbs::restricted(s, low_u, high_u, low_v, high_v);
    face.reversed = body_.inward;
    for (const EdgeLoop& uses : loops) {
      cad::Loop& loop = face.loops.emplace_back();
      for (const EdgeUse& use : uses) {
        cad::Edge& edge = loop.edges.emplace_back(out_.edge(use.edge, use.backward));
        edge.flat = use.backward ? nurbs::reversed(out_.edges[use.edge].flat) : out_.edges[use.edge].flat;
        for (Vec3& p : edge.flat.points)
          p = Vec3(std::clamp(p.x() + use.shift_u, low_u, high_u), std::clamp(p.y(), low_v, high_v), 0);
      }
    }
    return face;
  }

  // Where a knot is near the bound, it is the bound: surfaces with very short spans are bad geometry.
  [[nodiscard]] static double bound(double value, double margin, const std::vector<double>& knots,
                                    double first, double last, const std::vector<double>& lines) {
    for (const double line : lines)
      if (std::abs(value - line) <= 1e-6 * (last - first)) return line;
    value = std::clamp(value + margin, first, last);
    for (const double knot : knots)
      if ((knot - value) * margin >= 0 && std::abs(knot - value) <= 1e-3 * (last - first)) return knot;
    return value;
  }

  const yarn::Body& body_;
  const Piece& piece_;
  const Division& division_;
  double tolerance_;
  TubeFaces& out_;
  double first_u_ = 0, period_ = 1;
  std::vector<std::vector<ArcPath>> paths_;  // [border][arc]
  std::vector<double> lines_;                // of constant u
  std::vector<Stop> stops_;                  // border after border, along it
};

}  // namespace

cad::Edge TubeFaces::edge(std::size_t number, bool backward) const {
  cad::Edge edge;
  edge.curve = backward ? nurbs::reversed(edges[number].space) : edges[number].space;
  edge.id = static_cast<int>(number);
  return edge;
}

Result<TubeFaces> tube_faces(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut,
                             const Division& division, double tolerance) {
  TubeFaces result;
  result.of_body.resize(bodies.size());
  for (const Piece& piece : cut.pieces) {
    PieceDivider divider(bodies[piece.body], box, piece, division, tolerance, result);
    if (Status status = divider.run(); !status.ok()) return status.error();
  }
  return result;
}

}  // namespace selvage::cell
