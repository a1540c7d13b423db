#include "surface_mesh/unrolled.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/plane.h"
#include "surface_mesh/divided_line.h"

namespace selvage::fem {

namespace {

struct LoopPoint {
  std::uint32_t node;  // of the cell
  Vec2 q;
  bool on_crest;
  double needle;  // Chain
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
  std::vector<std::uint32_t> inner;  // nodes of the region, v increasing
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
        period_(cell::periods(body_)) {}

  Result<PlanarRegion> run();

 private:
  void collect_loops();
  void find_scale();
  void find_crest_lines();
  void add_crest_line(const LoopPoint& low, const LoopPoint& high, double u);
  Status unroll_disc();
  Status unroll_tube(std::size_t low, std::size_t high);
  void unroll_all();  // no borders
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
  void add_along(const Loop& loop, std::size_t from, std::size_t count, const Vec2& shift = Vec2::Zero(),
                 const Vec2& turn = Vec2::Zero());
  void enclose();
  void add_holes(const std::vector<std::size_t>& used);
  void add_crests(const CrestLine* cut);
  void add_rows_beside_crests();
  void add_beside(double u, double v, double distance, double side);
  [[nodiscard]] Vec2 chart(const Vec2& q) const { return q.cwiseProduct(region_.scale); }
  [[nodiscard]] Vec3 position(const Vec2& q) const { return cell::position(body_, q); }
  // Whole periods: up to `most` either way.
  [[nodiscard]] std::vector<Vec2> shifts(int most) const;

  std::uint32_t node_of(std::uint32_t known, const Vec2& q) {
    const auto [at, is_new] = numbers_.emplace(known, static_cast<std::uint32_t>(region_.nodes.size()));
    if (is_new) region_.add_node({cell_nodes_.points[known], q, known});
    return at->second;
  }
  std::uint32_t new_node(const Vec2& q, bool is_fixed) {
    return region_.add_node({position(q), q, PlanarRegion::none, is_fixed});
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
  PlanarRegion region_;
};

std::vector<Vec2> Unroller::shifts(int most) const {
  std::vector<Vec2> result;
  const int most_v = body_.closed_along ? most : 0;
  for (int m = -most; m <= most; ++m)
    for (int n = -most_v; n <= most_v; ++n) result.push_back(Vec2(m, n).cwiseProduct(period_));
  return result;
}

void Unroller::collect_loops() {
  for (std::size_t b = 0; b < first_edges_.size(); ++b) {
    Loop loop;
    loop.turn = Vec2(piece_.borders[b].turns_u, piece_.borders[b].turns_v).cwiseProduct(period_);
    for (std::size_t a = 0; a < piece_.borders[b].arcs.size(); ++a) {
      const Chain& chain = chains_[first_edges_[b] + a];
      for (std::size_t k = 0; k + 1 < chain.nodes.size(); ++k)
        loop.points.push_back({chain.nodes[k], chain.parameters[k], chain.on_crest[k], chain.needle[k]});
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
  region_.scale = sum / round;
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
    points.push_back(position({u, vs.back()}));
    if (k > 0) lengths.push_back(lengths.back() + (points.back() - points[points.size() - 2]).norm());
  }
  const auto v_at = [&](double along) {
    const auto after = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, along);
    const auto k = static_cast<std::size_t>(after - lengths.begin());
    const double share = (along - lengths[k - 1]) / (lengths[k] - lengths[k - 1]);
    return vs[k - 1] + share * (vs[k] - vs[k - 1]);
  };
  CrestLine line{u, low.node, high.node, low.q.y(), high.q.y(), {}};
  const auto wanted = [&](double along) { return field_.at(position({u, v_at(along)})); };
  for (const double along : divided_between(lengths.back(), wanted, low.needle, high.needle, 1))
    line.inner.push_back(new_node({u, v_at(along)}, true));
  crests_.push_back(std::move(line));
}

// So many points of a loop from one on.
void Unroller::add_along(const Loop& loop, std::size_t from, std::size_t count, const Vec2& shift,
                         const Vec2& turn) {
  for (std::size_t k = from; k < from + count; ++k) {
    const LoopPoint& p = loop.points[k % loop.points.size()];
    region_.add_place(loop.at(k) + shift + turn, node_of(p.node, p.q));
  }
}

// What there is until now is the outer border.
void Unroller::enclose() {
  for (const PlanarRegion::Place& place : region_.places) outline_.push_back(place.parameters);
  region_.close(0);
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
  add_along(loops_[outer], 0, loops_[outer].points.size());
  enclose();
  add_holes({outer});
  add_crests(nullptr);
  return {};
}

void Unroller::add_holes(const std::vector<std::size_t>& used) {
  for (std::size_t k = 0; k < loops_.size(); ++k) {
    if (std::find(used.begin(), used.end(), k) != used.end()) continue;
    const Loop& loop = loops_[k];
    Vec2 shift = Vec2::Zero();
    for (const Vec2& other : shifts(3))
      if (contains(outline_, loop.points[0].q + other)) shift = other;
    const auto first = static_cast<std::uint32_t>(region_.places.size());
    add_along(loop, 0, loop.points.size(), shift);
    region_.close(first);
  }
}

// Crests inside the unrolled domain, but the one along which it was cut.
void Unroller::add_crests(const CrestLine* cut) {
  // Where a border's node is nearest to a place.
  const std::vector<PlanarRegion::Place> on_borders = region_.places;
  const auto place_at = [&](std::uint32_t known, const Vec2& q) {
    std::uint32_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t k = 0; k < on_borders.size(); ++k)
      if (const double far = (on_borders[k].parameters - q).norm();
          on_borders[k].node == numbers_.at(known) && far < least) {
        least = far;
        best = k;
      }
    return best;
  };
  for (const CrestLine& line : crests_) {
    if (&line == cut) continue;
    for (int m = -3; m <= 3; ++m) {
      const double u = line.u + m * period_.x();
      if (!contains(outline_, {u, (line.low_v + line.high_v) / 2})) continue;
      std::uint32_t last = place_at(line.low, {u, line.low_v});
      const auto go_on = [&](std::uint32_t next) {
        region_.segments.push_back({last, next, 0, 0});
        last = next;
      };
      for (const std::uint32_t node : line.inner)
        go_on(region_.add_place({u, region_.nodes[node].parameters.y()}, node));
      go_on(place_at(line.high, {u, line.high_v}));
      break;
    }
  }
}

// The two sides of a sharp crest get the same triangles next to it, mirrored: tetrahedra in so thin a wedge
// are well shaped only where the points of both sides stand opposite each other.
void Unroller::add_rows_beside_crests() {
  for (const CrestLine& line : crests_) {
    std::vector<double> vs = {line.low_v};
    for (const std::uint32_t node : line.inner) vs.push_back(region_.nodes[node].parameters.y());
    vs.push_back(line.high_v);
    for (std::size_t k = 0; k + 1 < vs.size(); ++k) {
      const double height = std::sqrt(0.75);  // of a triangle of equal edges
      const double edge = (position({line.u, vs[k + 1]}) - position({line.u, vs[k]})).norm();
      for (const double side : {-1.0, 1.0}) add_beside(line.u, (vs[k] + vs[k + 1]) / 2, height * edge, side);
    }
  }
}

// A fixed point at this distance from a crest, unless something else of the outline is near.
void Unroller::add_beside(double u, double v, double distance, double side) {
  constexpr double widest = 0.2;  // of the way round
  const Vec3 from = position({u, v});
  double step = distance / region_.scale.x();
  for (int k = 0; k < 4; ++k) {
    const double reached = (position({u + side * step, v}) - from).norm();
    if (!(reached > 0)) return;
    step *= distance / reached;
    if (!(step < widest * period_.x())) return;
  }
  for (int m = -3; m <= 3; ++m) {
    const Vec2 q(u + side * step + m * period_.x(), v);
    if (!contains(outline_, q)) continue;
    const Vec3 point = position(q);
    const double room = 0.6 * distance;
    // Near in space alone is the other side of the crest.
    for (const PlanarRegion::Place& place : region_.places)
      if ((region_.nodes[place.node].point - point).norm() < room &&
          chart(place.parameters - q).norm() < 2 * room)
        return;
    region_.add_place(q, new_node(q, true));
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
  for (const Vec2& shift : shifts(2)) {
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
  const auto first_free = [&](std::vector<CutPath> paths) -> std::optional<CutPath> {
    std::stable_sort(paths.begin(), paths.end(),
                     [](const CutPath& a, const CutPath& b) { return a.length < b.length; });
    for (const CutPath& path : paths)
      if (is_clear(low.points[path.low].q, high.points[path.high].q + path.shift)) return path;
    return std::nullopt;
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
  if (auto path = first_free(std::move(paths))) return path;
  constexpr std::size_t most = 4'000'000;
  const std::size_t stride = 1 + low.points.size() * high.points.size() / most;
  paths.clear();
  for (std::size_t i = 0; i < low.points.size(); i += stride)
    for (std::size_t j = 0; j < high.points.size(); ++j) paths.push_back(path_between(i, j));
  return first_free(std::move(paths));
}

std::vector<std::uint32_t> Unroller::straight_nodes(const Vec2& from, const Vec2& to) {
  const auto at = [&](double along, double length) { return Vec2(from + along / length * (to - from)); };
  double length = 0;
  for (int k = 0; k < 32; ++k) length += (position(at(k + 1, 32)) - position(at(k, 32))).norm();
  const auto wanted = [&](double along) { return field_.at(position(at(along, length))); };
  const std::vector<double> divided = divided_line(length, wanted, 1);
  std::vector<std::uint32_t> result;
  for (std::size_t k = 1; k + 1 < divided.size(); ++k)
    result.push_back(new_node(at(divided[k], length), false));
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
  const auto inner_at = [&](std::uint32_t node) {
    const Vec2& q = region_.nodes[node].parameters;
    return path->crest != nullptr ? Vec2(from.x(), q.y()) : q;
  };
  add_along(low, path->low, low.points.size() + 1);
  for (const std::uint32_t node : inner) region_.add_place(inner_at(node) + turn, node);
  add_along(high, path->high, high.points.size() + 1, path->shift, turn);
  for (std::size_t k = inner.size(); k-- > 0;) region_.add_place(inner_at(inner[k]), inner[k]);
  enclose();
  add_holes({low_number, high_number});
  add_crests(path->crest);
  return {};
}

// A ring inside the box: cut open both ways.
void Unroller::unroll_all() {
  const Vec2 start(body_.surface.first_u(), body_.surface.first_v());
  const Vec2 u(period_.x(), 0), v(0, period_.y());
  const std::uint32_t corner = new_node(start, false);
  std::vector<std::uint32_t> round = straight_nodes(start, start + u),
                             along = straight_nodes(start, start + v);
  round.insert(round.begin(), corner);
  along.insert(along.begin(), corner);
  const auto add = [&](std::uint32_t node, const Vec2& shift) {
    region_.add_place(region_.nodes[node].parameters + shift, node);
  };
  for (const std::uint32_t node : round) add(node, Vec2::Zero());
  for (const std::uint32_t node : along) add(node, u);
  add(corner, u + v);
  for (std::size_t k = round.size(); k-- > 0;) add(round[k], v);
  for (std::size_t k = along.size(); k-- > 1;) add(along[k], Vec2::Zero());
  enclose();
}

Result<PlanarRegion> Unroller::run() {
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
    unroll_all();
  else if (ahead.empty() && back.empty())
    done = unroll_disc();
  else if (ahead.size() == 1 && back.size() == 1 && (loops_[ahead[0]].turn + loops_[back[0]].turn).isZero())
    done = unroll_tube(ahead[0], back[0]);
  else
    done = error(Kind::geometry, "a part of the yarn's surface inside the cell is no tube, disc or ring");
  if (done) add_rows_beside_crests();
  if (!done) return done.error().at_point(position(piece_.inside));
  return std::move(region_);
}

}  // namespace

Result<PlanarRegion> unroll(const CellShape& shape, const CellCurves& curves, std::size_t piece,
                            const SizeField& field, const CellNodes& nodes) {
  return Unroller(shape, curves, piece, field, nodes).run();
}

}  // namespace selvage::fem
