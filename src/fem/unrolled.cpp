#include "fem/unrolled.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/plane.h"
#include "fem/divided_line.h"

namespace selvage::fem {

namespace {

struct LoopPoint {
  std::uint32_t node;  // of the cell
  Vec2 q;
  bool on_crest;
};

struct Loop {
  std::vector<LoopPoint> points;  // the first is not repeated
  Vec2 turn = Vec2::Zero();       // what the parameters gain in one round
  [[nodiscard]] Vec2 at(std::size_t k) const {
    const std::size_t round = k / points.size();
    return points[k % points.size()].q + turn * static_cast<double>(round);
  }
};

// A sharp crest between two borders: u is constant.
struct CrestLine {
  double u;
  std::uint32_t low, high;  // nodes of the cell
  double low_v, high_v;
  std::vector<std::uint32_t> inner;  // indices into Unrolled::nodes, v increasing
};

bool do_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double p = cross(b - a, c - a), q = cross(b - a, d - a), r = cross(d - c, a - c),
               s = cross(d - c, b - c);
  return (p > 0) != (q > 0) && (r > 0) != (s > 0);
}

class Unroller {
 public:
  Unroller(const CellShape& shape, const CellCurves& curves, std::size_t piece, const SizeField& field,
           const CellNodes& nodes)
      : body_(shape.bodies[shape.cut.pieces[piece].body]),
        piece_(shape.cut.pieces[piece]),
        chains_(curves.chains),
        first_edges_(shape.division.first_edges[piece]),
        field_(field),
        cell_nodes_(nodes),
        period_(body_.surface.last_u() - body_.surface.first_u(),
                body_.surface.last_v() - body_.surface.first_v()) {}

  Result<Unrolled> run();

 private:
  void collect_loops();
  void find_scale();
  void find_crest_lines();
  void add_crest_line(const LoopPoint& low, const LoopPoint& high, double u);
  Status unroll_disc();
  Status unroll_tube(std::size_t low, std::size_t high);
  Status unroll_all();  // no borders
  struct CutPath {
    std::size_t low = 0, high = 0;  // points of the two loops
    Vec2 shift = Vec2::Zero();      // of the high one, so that it faces the low one
    const CrestLine* crest = nullptr;
    double length = std::numeric_limits<double>::infinity();
  };
  [[nodiscard]] std::optional<CutPath> crest_path(const Loop& low, const Loop& high) const;
  [[nodiscard]] std::optional<CutPath> straight_path(const Loop& low, const Loop& high) const;
  [[nodiscard]] bool is_clear(const Vec2& from, const Vec2& to) const;
  [[nodiscard]] std::vector<std::uint32_t> straight_nodes(const Vec2& from, const Vec2& to);
  void add_holes(const std::vector<std::size_t>& used);
  void add_crests(const CrestLine* cut);
  void add_rows_beside_crests();
  void add_beside(double u, double v, double distance, double side);
  [[nodiscard]] Vec2 chart(const Vec2& q) const { return q.cwiseProduct(result_.region.scale); }

  std::uint32_t node_of(std::uint32_t known, const Vec2& q) {
    const auto [at, is_new] = numbers_.emplace(known, static_cast<std::uint32_t>(result_.nodes.size()));
    if (is_new) result_.nodes.push_back({cell_nodes_.points[known], q, known, true});
    return at->second;
  }
  std::uint32_t add_point(std::uint32_t node, const Vec2& q) {
    result_.region.parameters.push_back(q);
    result_.region.points.push_back(result_.nodes[node].point);
    result_.owner.push_back(node);
    return static_cast<std::uint32_t>(result_.owner.size() - 1);
  }
  void add_segment(std::uint32_t a, std::uint32_t b, std::int32_t right) {
    result_.region.segments.push_back({a, b, 0, right});
    const Unrolled::Node &p = result_.nodes[result_.owner[a]], &q = result_.nodes[result_.owner[b]];
    if (p.is_fixed && q.is_fixed) result_.fixed_edges.push_back({result_.owner[a], result_.owner[b]});
  }
  // Points from the first number on, closed to a loop round the domain.
  void close(std::uint32_t first) {
    const auto last = static_cast<std::uint32_t>(result_.owner.size());
    for (std::uint32_t k = first; k < last; ++k) add_segment(k, k + 1 < last ? k + 1 : first, -1);
  }

  const yarn::Body& body_;
  const cell::Piece& piece_;
  const std::vector<Chain>& chains_;
  const std::vector<std::size_t>& first_edges_;
  const SizeField& field_;
  const CellNodes& cell_nodes_;
  Vec2 period_;
  std::vector<Loop> loops_;
  std::vector<CrestLine> crests_;
  std::map<std::uint32_t, std::uint32_t> numbers_;
  std::vector<Vec2> outline_;  // of the unrolled domain
  Unrolled result_;
};

void Unroller::collect_loops() {
  for (std::size_t b = 0; b < first_edges_.size(); ++b) {
    Loop loop;
    loop.turn = Vec2(piece_.borders[b].turns_u, piece_.borders[b].turns_v).cwiseProduct(period_);
    for (std::size_t a = 0; a < piece_.borders[b].arcs.size(); ++a) {
      const Chain& chain = chains_[first_edges_[b] + a];
      for (std::size_t k = 0; k + 1 < chain.nodes.size(); ++k)
        loop.points.push_back({chain.nodes[k], chain.parameters[k], chain.on_crest[k]});
    }
    loops_.push_back(std::move(loop));
  }
}

// Mean lengths per parameter, round the section of an inner point.
void Unroller::find_scale() {
  constexpr int round = 32;
  Vec2 sum = Vec2::Zero();
  for (int k = 0; k < round; ++k) {
    const nurbs::SurfaceJet s =
        cell::jet(body_, {body_.surface.first_u() + period_.x() * k / round, piece_.inside.y()});
    sum += Vec2(s.du.norm(), s.dv.norm());
  }
  result_.region.scale = sum / round;
}

void Unroller::find_crest_lines() {
  for (const double crest : crests_of(body_.surface)) {
    std::vector<LoopPoint> on_line;
    for (const Loop& loop : loops_)
      for (LoopPoint p : loop.points) {
        const double off = p.q.x() - crest;
        if (!p.on_crest || std::abs(off - period_.x() * std::round(off / period_.x())) > 1e-9 * period_.x())
          continue;
        p.q.x() = crest;
        on_line.push_back(p);
      }
    std::stable_sort(on_line.begin(), on_line.end(),
                     [](const LoopPoint& a, const LoopPoint& b) { return a.q.y() < b.q.y(); });
    for (std::size_t k = 0; k + 1 < on_line.size(); ++k) {
      const double v = (on_line[k].q.y() + on_line[k + 1].q.y()) / 2;
      // Borders above the middle: an odd number where it is inside.
      int above = 0;
      for (const Loop& loop : loops_)
        for (std::size_t i = 0; i < loop.points.size(); ++i) {
          const Vec2 a = loop.at(i), b = loop.at(i + 1);
          const double first = std::floor((std::min(a.x(), b.x()) - crest) / period_.x());
          for (int m = 0; m < 3; ++m) {
            const double u = crest + period_.x() * (first + m);
            if ((a.x() <= u) == (b.x() <= u)) continue;
            if (a.y() + (u - a.x()) / (b.x() - a.x()) * (b.y() - a.y()) > v) ++above;
          }
        }
      if (above % 2 == 1) add_crest_line(on_line[k], on_line[k + 1], crest);
    }
  }
}

void Unroller::add_crest_line(const LoopPoint& low, const LoopPoint& high, double u) {
  constexpr int parts = 96;
  std::vector<double> vs, lengths = {0};
  std::vector<Vec3> points;
  for (int k = 0; k <= parts; ++k) {
    vs.push_back(low.q.y() + (high.q.y() - low.q.y()) * k / parts);
    points.push_back(cell::position(body_, {u, vs.back()}));
    if (k > 0) lengths.push_back(lengths.back() + (points.back() - points[points.size() - 2]).norm());
  }
  const auto v_at = [&](double along) {
    const auto after = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, along);
    const auto k = static_cast<std::size_t>(after - lengths.begin());
    const double share = (along - lengths[k - 1]) / (lengths[k] - lengths[k - 1]);
    return vs[k - 1] + share * (vs[k] - vs[k - 1]);
  };
  CrestLine line{u, low.node, high.node, low.q.y(), high.q.y(), {}};
  const std::vector<double> divided = divided_line(
      lengths.back(),
      [&](double along) {
        return field_.at(cell::position(body_, {u, v_at(along)}));
      },
      1);
  for (std::size_t k = 1; k + 1 < divided.size(); ++k) {
    const Vec2 q(u, v_at(divided[k]));
    line.inner.push_back(static_cast<std::uint32_t>(result_.nodes.size()));
    result_.nodes.push_back({cell::position(body_, q), q, Unrolled::none, true});
  }
  crests_.push_back(std::move(line));
}

// Loops without a turn: the outer one, then holes.
Status Unroller::unroll_disc() {
  std::size_t outer = 0;
  double largest = 0;
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    std::vector<Vec2> polygon;
    for (const LoopPoint& p : loops_[k].points) polygon.push_back(chart(p.q));
    const double area = twice_area(polygon);
    if (area > largest) {
      largest = area;
      outer = k;
    }
  }
  if (!(largest > 0)) return error(Kind::geometry, "a part of the yarn's surface has no outer border");
  for (const LoopPoint& p : loops_[outer].points) {
    outline_.push_back(p.q);
    add_point(node_of(p.node, p.q), p.q);
  }
  close(0);
  add_holes({outer});
  add_crests(nullptr);
  return {};
}

void Unroller::add_holes(const std::vector<std::size_t>& used) {
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    if (std::find(used.begin(), used.end(), k) != used.end()) continue;
    const Loop& loop = loops_[k];
    Vec2 shift = Vec2::Zero();
    for (int m = -3; m <= 3; ++m)
      for (int n = body_.closed_along ? -3 : 0; n <= (body_.closed_along ? 3 : 0); ++n)
        if (contains(outline_, loop.points[0].q + Vec2(m, n).cwiseProduct(period_)))
          shift = Vec2(m, n).cwiseProduct(period_);
    const auto first = static_cast<std::uint32_t>(result_.owner.size());
    for (const LoopPoint& p : loop.points) add_point(node_of(p.node, p.q), p.q + shift);
    close(first);
  }
}

// Crests inside the unrolled domain, but the one along which it was cut.
void Unroller::add_crests(const CrestLine* cut) {
  std::multimap<std::uint32_t, std::uint32_t> points;  // of each node
  for (std::uint32_t k = 0; k < result_.owner.size(); ++k) points.emplace(result_.owner[k], k);
  for (const CrestLine& line : crests_) {
    if (&line == cut) continue;
    for (int m = -3; m <= 3; ++m) {
      const double u = line.u + m * period_.x();
      const double v = (line.low_v + line.high_v) / 2;
      if (!contains(outline_, {u, v})) continue;
      const auto point_at = [&](std::uint32_t known, double at_v) {
        const auto [from, to] = points.equal_range(numbers_.at(known));
        std::uint32_t best = from->second;
        for (auto k = from; k != to; ++k)
          if ((result_.region.parameters[k->second] - Vec2(u, at_v)).norm() <
              (result_.region.parameters[best] - Vec2(u, at_v)).norm())
            best = k->second;
        return best;
      };
      std::uint32_t last = point_at(line.low, line.low_v);
      for (const std::uint32_t node : line.inner) {
        const std::uint32_t next = add_point(node, {u, result_.nodes[node].parameters.y()});
        add_segment(last, next, 0);
        last = next;
      }
      add_segment(last, point_at(line.high, line.high_v), 0);
      break;
    }
  }
}

// The two sides of a sharp crest get the same triangles next to it, mirrored: tetrahedra in so thin a wedge
// are well shaped only where the points of both sides stand opposite each other.
void Unroller::add_rows_beside_crests() {
  for (const CrestLine& line : crests_) {
    std::vector<double> vs = {line.low_v};
    for (const std::uint32_t node : line.inner) vs.push_back(result_.nodes[node].parameters.y());
    vs.push_back(line.high_v);
    for (std::size_t k = 0; k + 1 < vs.size(); ++k) {
      const double height = std::sqrt(0.75);  // of a triangle of equal edges
      const double edge =
          (cell::position(body_, {line.u, vs[k + 1]}) - cell::position(body_, {line.u, vs[k]})).norm();
      for (const double side : {-1.0, 1.0}) add_beside(line.u, (vs[k] + vs[k + 1]) / 2, height * edge, side);
    }
  }
}

// A fixed point at this distance from a crest, unless something else of the outline is near.
void Unroller::add_beside(double u, double v, double distance, double side) {
  constexpr double widest = 0.2;  // of the way round
  const Vec3 from = cell::position(body_, {u, v});
  double step = distance / result_.region.scale.x();
  for (int k = 0; k < 4; ++k) {
    const double reached = (cell::position(body_, {u + side * step, v}) - from).norm();
    if (!(reached > 0)) return;
    step *= distance / reached;
    if (!(step < widest * period_.x())) return;
  }
  for (int m = -3; m <= 3; ++m) {
    const Vec2 q(u + side * step + m * period_.x(), v);
    if (!contains(outline_, q)) continue;
    const Vec3 point = cell::position(body_, q);
    const double room = 0.6 * distance;
    // Near in space alone is the other side of the crest.
    for (std::size_t k = 0; k < result_.region.points.size(); ++k)
      if ((result_.region.points[k] - point).norm() < room &&
          chart(result_.region.parameters[k] - q).norm() < 2 * room)
        return;
    const auto node = static_cast<std::uint32_t>(result_.nodes.size());
    result_.nodes.push_back({point, q, Unrolled::none, true});
    add_point(node, q);
    return;
  }
}

std::optional<Unroller::CutPath> Unroller::crest_path(const Loop& low, const Loop& high) const {
  const auto find = [](const Loop& loop, std::uint32_t node) {
    const auto at = std::find_if(loop.points.begin(), loop.points.end(),
                                 [&](const LoopPoint& p) { return p.node == node; });
    return at == loop.points.end() ? std::optional<std::size_t>()
                                   : static_cast<std::size_t>(at - loop.points.begin());
  };
  for (const CrestLine& line : crests_) {
    const auto a = find(low, line.low), b = find(high, line.high);
    if (!a || !b) continue;
    const double shift = low.points[*a].q.x() - high.points[*b].q.x();
    return CutPath{*a, *b, Vec2(shift, 0), &line, 0};
  }
  return std::nullopt;
}

// May a cut run there? It meets no border and no crest but with its ends.
bool Unroller::is_clear(const Vec2& from, const Vec2& to) const {
  const Vec2 way = to - from, a = from + 1e-6 * way, b = to - 1e-6 * way;
  for (int m = -2; m <= 2; ++m)
    for (int n = body_.closed_along ? -2 : 0; n <= (body_.closed_along ? 2 : 0); ++n) {
      const Vec2 shift = Vec2(m, n).cwiseProduct(period_);
      for (const Loop& loop : loops_)
        for (std::size_t k = 0; k < loop.points.size(); ++k)
          if (do_cross(a, b, loop.at(k) + shift, loop.at(k + 1) + shift)) return false;
      for (const CrestLine& line : crests_)
        if (do_cross(a, b, Vec2(line.u, line.low_v) + shift, Vec2(line.u, line.high_v) + shift)) return false;
    }
  return true;
}

std::optional<Unroller::CutPath> Unroller::straight_path(const Loop& low, const Loop& high) const {
  const auto path_between = [&](std::size_t i, std::size_t j) {
    const Vec2 way = high.points[j].q - low.points[i].q;
    Vec2 shift(-period_.x() * std::round(way.x() / period_.x()),
               body_.closed_along ? -period_.y() * std::round(way.y() / period_.y()) : 0.0);
    // Only along the way in which they turn: across it, it would be another place.
    if (low.turn.x() == 0) shift.x() = 0;
    if (low.turn.y() == 0) shift.y() = 0;
    return CutPath{i, j, shift, nullptr, chart(way + shift).norm()};
  };
  const auto is_free = [&](const CutPath& path) {
    return is_clear(low.points[path.low].q, high.points[path.high].q + path.shift);
  };
  // The shortest from some points of the low border to their nearest on the high one, or else from any to
  // any.
  std::vector<CutPath> paths;
  for (std::size_t i = 0; i < low.points.size(); ++i) {
    CutPath nearest = path_between(i, 0);
    for (std::size_t j = 1; j < high.points.size(); ++j)
      if (const CutPath path = path_between(i, j); path.length < nearest.length) nearest = path;
    paths.push_back(nearest);
  }
  const auto shorter = [](const CutPath& a, const CutPath& b) { return a.length < b.length; };
  std::stable_sort(paths.begin(), paths.end(), shorter);
  for (const CutPath& path : paths)
    if (is_free(path)) return path;
  paths.clear();
  constexpr std::size_t most = 4'000'000;
  const std::size_t stride = 1 + low.points.size() * high.points.size() / most;
  for (std::size_t i = 0; i < low.points.size(); i += stride)
    for (std::size_t j = 0; j < high.points.size(); ++j) paths.push_back(path_between(i, j));
  std::stable_sort(paths.begin(), paths.end(), shorter);
  for (const CutPath& path : paths)
    if (is_free(path)) return path;
  return std::nullopt;
}

std::vector<std::uint32_t> Unroller::straight_nodes(const Vec2& from, const Vec2& to) {
  const auto at = [&](double along, double length) { return Vec2(from + along / length * (to - from)); };
  double length = 0;
  for (int k = 0; k < 32; ++k)
    length += (cell::position(body_, at(k + 1, 32)) - cell::position(body_, at(k, 32))).norm();
  const std::vector<double> divided = divided_line(
      length, [&](double along) { return field_.at(cell::position(body_, at(along, length))); }, 1);
  std::vector<std::uint32_t> result;
  for (std::size_t k = 1; k + 1 < divided.size(); ++k) {
    const Vec2 q = at(divided[k], length);
    result.push_back(static_cast<std::uint32_t>(result_.nodes.size()));
    result_.nodes.push_back({cell::position(body_, q), q, Unrolled::none, false});
  }
  return result;
}

// Between two loops that turn: along the low one, up the cut, back along the high one, and down the cut.
Status Unroller::unroll_tube(std::size_t low_number, std::size_t high_number) {
  const Loop &low = loops_[low_number], &high = loops_[high_number];
  std::optional<CutPath> path = crest_path(low, high);
  if (!path) path = straight_path(low, high);
  if (!path) return error(Kind::geometry, "a part of the yarn's surface cannot be cut open along the yarn");
  const Vec2 turn = low.turn, from = low.points[path->low].q, to = high.points[path->high].q + path->shift;
  const std::vector<std::uint32_t> inner =
      path->crest != nullptr ? path->crest->inner : straight_nodes(from, to);
  const auto add = [&](std::uint32_t node, const Vec2& q) {
    outline_.push_back(q);
    add_point(node, q);
  };
  const auto inner_at = [&](std::size_t k) {
    const Vec2& q = result_.nodes[inner[k]].parameters;
    return path->crest != nullptr ? Vec2(from.x(), q.y()) : q;
  };
  for (std::size_t k = 0; k <= low.points.size(); ++k) {
    const LoopPoint& p = low.points[(path->low + k) % low.points.size()];
    add(node_of(p.node, p.q), low.at(path->low + k));
  }
  for (std::size_t k = 0; k < inner.size(); ++k) add(inner[k], inner_at(k) + turn);
  for (std::size_t k = 0; k <= high.points.size(); ++k) {
    const LoopPoint& p = high.points[(path->high + k) % high.points.size()];
    add(node_of(p.node, p.q), high.at(path->high + k) + path->shift + turn);
  }
  for (std::size_t k = inner.size(); k-- > 0;) add(inner[k], inner_at(k));
  close(0);
  add_holes({low_number, high_number});
  add_crests(path->crest);
  return {};
}

// A ring inside the box: cut open both ways.
Status Unroller::unroll_all() {
  const Vec2 corner(body_.surface.first_u(), body_.surface.first_v());
  const Vec2 u(period_.x(), 0), v(0, period_.y());
  const auto start = static_cast<std::uint32_t>(result_.nodes.size());
  result_.nodes.push_back({cell::position(body_, corner), corner, Unrolled::none, false});
  const std::vector<std::uint32_t> round = straight_nodes(corner, corner + u),
                                   along = straight_nodes(corner, corner + v);
  const auto at = [&](std::uint32_t node) { return result_.nodes[node].parameters; };
  add_point(start, corner);
  for (const std::uint32_t node : round) add_point(node, at(node));
  add_point(start, corner + u);
  for (const std::uint32_t node : along) add_point(node, at(node) + u);
  add_point(start, corner + u + v);
  for (std::size_t k = round.size(); k-- > 0;) add_point(round[k], at(round[k]) + v);
  add_point(start, corner + v);
  for (std::size_t k = along.size(); k-- > 0;) add_point(along[k], at(along[k]));
  close(0);
  return {};
}

Result<Unrolled> Unroller::run() {
  collect_loops();
  find_scale();
  find_crest_lines();
  std::vector<std::size_t> ahead, back;
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    const double turn = loops_[k].turn.x() + loops_[k].turn.y();
    if (turn > 0) ahead.push_back(k);
    if (turn < 0) back.push_back(k);
  }
  Status done;
  if (loops_.empty())
    done = unroll_all();
  else if (ahead.empty() && back.empty())
    done = unroll_disc();
  else if (ahead.size() == 1 && back.size() == 1 && (loops_[ahead[0]].turn + loops_[back[0]].turn).isZero())
    done = unroll_tube(ahead[0], back[0]);
  else
    done = error(Kind::geometry, "a part of the yarn's surface inside the cell is no tube, disc or ring");
  if (done) add_rows_beside_crests();
  if (!done) {
    Message message = done.error();
    message.at = cell::position(body_, piece_.inside);
    return message;
  }
  return std::move(result_);
}

}  // namespace

Result<Unrolled> unroll(const CellShape& shape, const CellCurves& curves, std::size_t piece,
                        const SizeField& field, const CellNodes& nodes) {
  return Unroller(shape, curves, piece, field, nodes).run();
}

}  // namespace selvage::fem
