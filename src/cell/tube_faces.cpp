#include "cell/tube_faces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "cell/trim.h"
#include "nurbs/bezier.h"  // Box2
#include "nurbs/restrict.h"
#include "nurbs/spline.h"

namespace selvage::cell {

namespace {

using nurbs::Box2;

constexpr double on_line = 1e-9;  // of the period
// Of a curve as long as the yarn is round: along the yarn, and across it where a face of the box cuts it.
constexpr double pieces_along = 4, pieces_across = 8;
constexpr double unevenness = 0.13;
constexpr double most_sag = 0.005;  // of the thickness: half a piece along the yarn off its chord
// How far lines along the yarn are bowed, of the period: below what is seen, above what meshers take for
// rounding.
constexpr double bow_share = 2e-5;
constexpr std::size_t none = static_cast<std::size_t>(-1);

// A place of a border where edges end: a corner between two arcs, or a node.
struct Stop {
  std::size_t arc = 0;
  double along = 0;
  // A node: where a line of constant u meets the border; the piece is above it (v more) or below.
  bool is_node = false, is_up = false;
  std::size_t line = 0;
  long turn = 0;                                    // periods that the line is moved by
  std::size_t first_edge = none, last_edge = none;  // [first, last) leave it forward along the border
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

double area(const std::vector<Vec2>& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

bool holds(const std::vector<Vec2>& outline, const Vec2& p) {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

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
    is_smooth_ = is_smooth();
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
    const double u = path.at(node.along).x();
    node.turn = std::lround((u - lines_[node.line]) / period_);
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
      node.turn -= border.turns_u;
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
    out_.of_arc.emplace_back();
    for (std::size_t b = 0; b < stops_.size(); ++b) {
      out_.of_arc.back().emplace_back(piece_.borders[b].arcs.size());
      std::vector<std::vector<std::size_t>>& of_arc = out_.of_arc.back().back();
      if (stops_[b].empty()) stops_[b].push_back({});
      for (std::size_t s = 0; s < stops_[b].size(); ++s) {
        Stop& here = stops_[b][s];
        const Stop& next = stops_[b][(s + 1) % stops_[b].size()];
        const ArcPath& path = paths_[b][here.arc];
        double to = next.arc == here.arc ? next.along : path.length();
        if (path.is_closed() && to <= here.along) to += path.length();
        if (!path.is_closed() && to <= here.along) to = path.length();
        here.first_edge = out_.edges.size();
        const std::vector<double> places = places_of(path, here.along, to);
        for (std::size_t i = 1; i < places.size(); ++i) {
          of_arc[here.arc].push_back(out_.edges.size());
          out_.edges.push_back(path.curves(places[i - 1], places[i], tolerance_));
        }
        here.last_edge = out_.edges.size();
      }
    }
    for (Pair& pair : pairs_) {
      const double u = lines_[stop(pair.from).line];
      const double low = parameters_of(pair.from).y(), high = parameters_of(pair.to).y();
      pair.first_edge = out_.edges.size();
      const std::vector<double> stations = stations_of(u, low, high);
      for (std::size_t i = 1; i < stations.size(); ++i)
        out_.edges.push_back(line(u, low, high, stations[i - 1], stations[i]));
      pair.last_edge = out_.edges.size();
    }
  }

  struct Pair {
    StopPlace from, to;
    std::size_t first_edge = none, last_edge = none;  // from `from` up to `to`
  };

  // Bowed as a whole, and each of its edges once more: no three points lie on a line of the parameters, no
  // two have the same u.
  [[nodiscard]] EdgeCurves line(double u, double low, double high, double from, double to) const {
    if (!is_smooth_) return line_of_constant_u(body_.surface, u, from, to);
    const double bow = bow_share * period_;
    const auto beside = [&](double v) {
      return 4 * bow * (v - low) * (high - v) / ((high - low) * (high - low));
    };
    const double first = std::max(beside(from), 0.0), last = std::max(beside(to), 0.0);
    return line_beside_u(body_.surface, u, from, to, {first, 0.5 * (first + last) + 2 * bow, last},
                         tolerance_);
  }

  // Goes the surface on across each line as it comes there, for as far as lines are bowed? Not where sections
  // have a tip: there the line has to be on it.
  [[nodiscard]] bool is_smooth() const {
    const nurbs::Surface& surface = body_.surface;
    const double beyond = 3 * bow_share * period_;
    const std::vector<double> knots = nurbs::breakpoints(surface.knots_v, surface.degree_v);
    for (const double line : lines_) {
      const double end = line > first_u_ ? line : surface.last_u();
      const nurbs::Surface going_on = nurbs::extended_u(
          nurbs::restricted(surface, surface.first_u(), end, surface.first_v(), surface.last_v()), beyond);
      for (std::size_t i = 1; i < knots.size(); ++i)
        for (const double share : {0.0, 0.5}) {
          const double v = std::lerp(knots[i - 1], knots[i], share);
          const Vec3 there = nurbs::evaluate(surface, line + beyond, v);
          if ((nurbs::evaluate(going_on, end + beyond, v) - there).norm() > 0.5 * tolerance_) return false;
        }
    }
    return true;
  }

  // Meshers put points on each edge, so edges are divided into short pieces. Uneven ones: where four such
  // points lie on one circle of the surface's parameters, gmsh leaves it to random numbers how they are
  // joined, in each of two solids that share a face anew.
  static std::vector<double> uneven(double from, double to, int count, double amount) {
    std::vector<double> places;
    for (int i = 0; i <= count; ++i) {
      const double share = static_cast<double>(i) / count;
      places.push_back(i == count ? to : std::lerp(from, to, share + share * (1 - share) * amount));
    }
    return places;
  }

  template <typename At>
  static double length(const At& at) {
    constexpr int samples = 64;
    double sum = 0;
    for (int i = 1; i <= samples; ++i)
      sum += (at(static_cast<double>(i) / samples) - at(static_cast<double>(i - 1) / samples)).norm();
    return sum;
  }

  struct Size {
    double round = 0, thickness = 0;
  };
  // Of the section at v; the thickness as if it were an ellipse of the same area and width.
  [[nodiscard]] Size size_at(double v) const {
    constexpr std::size_t count = 64;
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i)
      points.push_back(position(body_, {first_u_ + period_ * static_cast<double>(i) / count, v}));
    Size size;
    double width = 0;
    Vec3 twice_area = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 next = points[(i + 1) % count];
      size.round += (next - points[i]).norm();
      twice_area += (points[i] - points[0]).cross(next - points[0]);
      width = std::max(width, (points[i] - points[(i + count / 2) % count]).norm());
    }
    size.thickness = 2 * twice_area.norm() / (std::numbers::pi * width);
    return size;
  }

  // Where the yarn bends, as short as it takes for half a piece to stay near its chord: yarns that cross bend
  // round each other.
  [[nodiscard]] std::vector<double> stations_of(double u, double low, double high) const {
    constexpr int samples = 512;
    const Size size = size_at(0.5 * (low + high));
    const double step = (high - low) / samples;
    const auto at = [&](int i) { return position(body_, {u, std::clamp(low + step * i, low, high)}); };
    std::vector<double> pieces = {0};  // from `low` on
    for (int i = 0; i < samples; ++i) {
      const Vec3 before = at(std::max(i - 1, 0)), here = at(std::max(i, 1)), after = at(std::max(i + 1, 2));
      const Vec3 in = here - before, out = after - here;
      const double length = 0.5 * (in.norm() + out.norm());
      const double bend = in.cross(out).norm() / (length * length * length);
      pieces.push_back(pieces.back() + length * std::max(pieces_along / size.round,
                                                         std::sqrt(bend / (32 * most_sag * size.thickness))));
    }
    const int count = std::clamp(static_cast<int>(std::ceil(pieces.back())), 2, 256);
    std::vector<double> stations =
        uneven(0, pieces.back(), count, u == first_u_ ? unevenness : -1.3 * unevenness);
    for (double& station : stations) {
      const auto next = std::upper_bound(pieces.begin() + 1, pieces.end() - 1, station);
      const double share = std::clamp((station - *(next - 1)) / (*next - *(next - 1)), 0.0, 1.0);
      station = std::lerp(low, high, (static_cast<double>(next - 1 - pieces.begin()) + share) / samples);
    }
    stations.front() = low;
    stations.back() = high;
    return stations;
  }

  // Across the yarn alike where it enters and where it leaves the box: with u; along it with the border.
  [[nodiscard]] std::vector<double> places_of(const ArcPath& path, double from, double to) const {
    const Vec2 way = path.at(to) - path.at(from);
    const double along = length([&](double share) { return path.position(std::lerp(from, to, share)); });
    const double round = size_at(path.at(0.5 * (from + to)).y()).round;
    const bool is_backward = way.x() < -0.1 * period_;
    const int count = std::clamp(static_cast<int>(std::ceil(pieces_across * along / round - 1e-6)), 1, 256);
    return uneven(from, to, count, is_backward ? -unevenness : unevenness);
  }

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
        (area(traced.outline) > 0 ? outer : holes).push_back(std::move(traced));
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
      for (std::size_t e = stop(place).first_edge; e < stop(place).last_edge; ++e) append(traced, e, false);
      place.stop = (place.stop + 1) % stops_[place.border].size();
      if (!stop(place).is_node) continue;
      const Pair& pair = *pair_at(place);
      const bool up = pair.from.border == place.border && pair.from.stop == place.stop;
      for (std::size_t e = pair.first_edge; e < pair.last_edge; ++e)
        append(traced, up ? e : pair.first_edge + pair.last_edge - 1 - e, !up);
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
        if (holds(outer[i].outline, hole.outline.front()) &&
            (best == none || area(outer[i].outline) < area(outer[best].outline)))
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
    if (value > last) return value + bow_share * (last - first);
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
  bool is_smooth_ = false;                   // across the lines
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
