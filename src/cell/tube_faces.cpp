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
  std::size_t arc = 0;
  double along = 0;
  // A node: where a line of constant u meets the border; the piece is above it (v more) or below.
  bool is_node = false, is_up = false;
  std::size_t line = 0;
  std::size_t edge = none;  // that leaves it forward along the border
};

// A kept point of a border.
struct Sample {
  std::size_t arc = 0;
  double along = 0;
  Vec2 at;
};

// Which stop of which border.
struct StopPlace {
  std::size_t border = 0, stop = 0;
};

// A loop while it is put together: with the parameters along it, for its sense and place.
struct Traced {
  EdgeLoop uses;
  std::vector<Vec2> outline;
};

class PieceDivider {
 public:
  PieceDivider(const yarn::Body& body, const Box3& box, const Piece& piece, double tolerance, TubeFaces& out)
      : body_(body), piece_(piece), tolerance_(tolerance), out_(out) {
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
    stops_.resize(piece_.borders.size());
    for (std::size_t b = 0; b < piece_.borders.size(); ++b)
      if (Status status = find_stops(b); !status.ok()) return status;
    if (Status status = pair_nodes(); !status.ok()) return status;
    make_edges();
    return trace_all();
  }

 private:
  Status fault(const std::string& what, const std::optional<Vec2>& at) const {
    Message message = error(Kind::geometry, fmt::format("yarn '{}' {}", body_.name, what));
    message.yarn = body_.name;
    message.place = body_.place;
    message.at = position(body_, at.value_or(piece_.inside));
    return message;
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
    std::vector<Stop>& stops = stops_[b];
    if (border.arcs.size() > 1)
      for (std::size_t a = 0; a < border.arcs.size(); ++a) stops.push_back({.arc = a, .along = 0});
    const std::vector<Sample> kept = samples(b);
    for (std::size_t line = 0; line < lines_.size(); ++line)
      if (Status status = find_nodes(b, line, kept); !status.ok()) return status;
    for (std::size_t a = 0; a < border.arcs.size(); ++a) add_corners_of_end(b, a);
    std::stable_sort(stops.begin(), stops.end(), [](const Stop& x, const Stop& y) {
      return x.arc != y.arc ? x.arc < y.arc : x.along < y.along;
    });
    return {};
  }

  // An end inside the box is divided where its patch has corners.
  void add_corners_of_end(std::size_t b, std::size_t a) {
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
      const bool known = std::any_of(stops_[b].begin(), stops_[b].end(), [&](const Stop& stop) {
        return stop.arc == a && std::abs(stop.along - ahead) < 2 * on_line * period_;
      });
      if (!known) stops_[b].push_back({.arc = a, .along = ahead});
    }
  }

  // Along the border from one point that is off the line to the next.
  Status find_nodes(std::size_t b, std::size_t line, const std::vector<Sample>& kept) {
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
        add_node(b, line, kept, before, i, *now > stripe_before);
      }
      before = i;
      stripe_before = *now;
    }
    return {};
  }

  // Between the kept points `before` and `after`, of which those between lie on the line.
  void add_node(std::size_t b, std::size_t line, const std::vector<Sample>& kept, std::size_t before,
                std::size_t after, bool up) {
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
    settle(b, node);
  }

  // At a corner where it is as good as there; else a stop of its own.
  void settle(std::size_t b, Stop node) {
    const Border& border = piece_.borders[b];
    const ArcPath& path = paths_[b][node.arc];
    if (border.arcs.size() > 1) {
      const Vec3 here = path.position(node.along);
      for (const bool last : {false, true}) {
        if ((path.position(last ? path.length() : 0) - here).norm() > 10 * tolerance_) continue;
        node.arc = last ? (node.arc + 1) % border.arcs.size() : node.arc;
        for (Stop& stop : stops_[b])
          if (stop.arc == node.arc && stop.along == 0 && !stop.is_node) {
            node.along = 0;
            stop = node;
            return;
          }
      }
    } else if (node.along >= path.length()) {
      node.along = 0;
    }
    stops_[b].push_back(node);
  }

  [[nodiscard]] Vec2 parameters_of(const StopPlace& place) const {
    const Stop& stop = stops_[place.border][place.stop];
    return paths_[place.border][stop.arc].at(stop.along);
  }

  // Along each line nodes come in pairs: from one with the piece above it to one with the piece below it.
  Status pair_nodes() {
    for (std::size_t line = 0; line < lines_.size(); ++line) {
      std::vector<StopPlace> nodes;
      for (std::size_t b = 0; b < stops_.size(); ++b)
        for (std::size_t s = 0; s < stops_[b].size(); ++s)
          if (stops_[b][s].is_node && stops_[b][s].line == line) nodes.push_back({b, s});
      std::stable_sort(nodes.begin(), nodes.end(), [&](const StopPlace& x, const StopPlace& y) {
        return parameters_of(x).y() < parameters_of(y).y();
      });
      for (std::size_t i = 0; i < nodes.size(); i += 2) {
        if (i + 1 == nodes.size() || !stop(nodes[i]).is_up || stop(nodes[i + 1]).is_up)
          return fault("is cut too near to its seam to be divided there", parameters_of(nodes[i]));
        pairs_.push_back({nodes[i], nodes[i + 1]});
      }
    }
    return {};
  }

  Stop& stop(const StopPlace& place) { return stops_[place.border][place.stop]; }

  void make_edges() {
    for (std::size_t b = 0; b < stops_.size(); ++b) {
      const std::size_t first = out_.of_arc.size();
      out_.of_arc.resize(first + piece_.borders[b].arcs.size());
      if (stops_[b].empty()) stops_[b].push_back({});
      for (std::size_t s = 0; s < stops_[b].size(); ++s) {
        Stop& here = stops_[b][s];
        const Stop& next = stops_[b][(s + 1) % stops_[b].size()];
        const ArcPath& path = paths_[b][here.arc];
        double to = next.arc == here.arc ? next.along : path.length();
        if (to <= here.along) to = path.is_closed() ? to + path.length() : path.length();
        here.edge = out_.edges.size();
        out_.of_arc[first + here.arc].push_back(here.edge);
        out_.edges.push_back(path.curves(here.along, to, tolerance_));
      }
    }
    for (Pair& pair : pairs_) {
      pair.edge = out_.edges.size();
      out_.edges.push_back(line_of_constant_u(body_.surface, lines_[stop(pair.from).line],
                                              parameters_of(pair.from).y(), parameters_of(pair.to).y()));
    }
  }

  struct Pair {
    StopPlace from, to;
    std::size_t edge = none;  // from `from` up to `to`
  };

  // The use of a line that goes on from this node, and the node at its other end.
  [[nodiscard]] const Pair* pair_at(const StopPlace& place) const {
    for (const Pair& pair : pairs_)
      for (const StopPlace& end : {pair.from, pair.to})
        if (end.border == place.border && end.stop == place.stop) return &pair;
    return nullptr;
  }

  Status trace_all() {
    std::vector<Traced> outer, holes;
    std::vector<std::vector<bool>> done;
    for (const std::vector<Stop>& stops : stops_) done.emplace_back(stops.size(), false);
    for (std::size_t b = 0; b < stops_.size(); ++b)
      for (std::size_t s = 0; s < stops_[b].size(); ++s) {
        if (done[b][s]) continue;
        Traced traced;
        if (Status status = trace({b, s}, done, traced); !status.ok()) return status;
        (twice_area(traced.outline) > 0 ? outer : holes).push_back(std::move(traced));
      }
    if (outer.empty()) return fault("cannot be divided into faces", {});
    return add_faces(outer, holes);
  }

  // From the edge that leaves this stop, always to the left.
  Status trace(StopPlace place, std::vector<std::vector<bool>>& done, Traced& traced) {
    const StopPlace start = place;
    do {
      if (done[place.border][place.stop]) return fault("cannot be divided into faces", parameters_of(place));
      done[place.border][place.stop] = true;
      append(traced, stop(place).edge, false);
      place.stop = (place.stop + 1) % stops_[place.border].size();
      if (!stop(place).is_node) continue;
      const Pair& pair = *pair_at(place);
      const bool up = pair.from.border == place.border && pair.from.stop == place.stop;
      append(traced, pair.edge, !up);
      place = up ? pair.to : pair.from;
    } while (place.border != start.border || place.stop != start.stop);
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

  Status add_faces(std::vector<Traced>& outer, std::vector<Traced>& holes) {
    std::vector<TubeFace> faces;
    faces.reserve(outer.size());
    for (Traced& traced : outer) faces.push_back(face_of(traced));
    for (Traced& hole : holes) {
      std::size_t best = none;
      for (std::size_t i = 0; i < outer.size(); ++i)
        if (contains(outer[i].outline, hole.outline.front()) &&
            (best == none || twice_area(outer[i].outline) < twice_area(outer[best].outline)))
          best = i;
      if (best == none) return fault("cannot be divided into faces", hole.outline.front());
      faces[best].loops.push_back(std::move(hole.uses));
    }
    for (TubeFace& face : faces) out_.faces.push_back(std::move(face));
    return {};
  }

  // A little more of the surface than the loop needs, but not across the lines that it runs along.
  [[nodiscard]] TubeFace face_of(Traced& traced) const {
    TubeFace face;
    Box2 box;
    for (const EdgeUse& use : traced.uses)
      for (const Vec3& p : out_.edges[use.edge].flat.points) box.extend(Vec2(p.x() + use.shift_u, p.y()));
    const Vec2 margin = 0.02 * box.sizes();
    const nurbs::Surface& s = body_.surface;
    face.low_u = bound(box.min().x(), -margin.x(), s.knots_u, first_u_, s.last_u(), lines_);
    face.high_u = bound(box.max().x(), margin.x(), s.knots_u, first_u_, s.last_u(), lines_);
    face.low_v = bound(box.min().y(), -margin.y(), s.knots_v, s.first_v(), s.last_v(), {});
    face.high_v = bound(box.max().y(), margin.y(), s.knots_v, s.first_v(), s.last_v(), {});
    face.loops.push_back(std::move(traced.uses));
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
  double tolerance_;
  TubeFaces& out_;
  double first_u_ = 0, period_ = 1;
  std::vector<std::vector<ArcPath>> paths_;  // [border][arc]
  std::vector<double> lines_;                // of constant u
  std::vector<std::vector<Stop>> stops_;     // [border], along it
  std::vector<Pair> pairs_;
};

}  // namespace

Result<TubeFaces> tube_faces(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut,
                             double tolerance) {
  TubeFaces result;
  for (const Piece& piece : cut.pieces) {
    const std::size_t first = result.faces.size();
    PieceDivider divider(bodies[piece.body], box, piece, tolerance, result);
    if (Status status = divider.run(); !status.ok()) return status.error();
    for (std::size_t i = first; i < result.faces.size(); ++i) result.faces[i].body = piece.body;
  }
  return result;
}

}  // namespace selvage::cell
