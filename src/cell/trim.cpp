#include "cell/trim.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "cell/sampling.h"
#include "core/groups.h"

namespace selvage::cell {
namespace {

using Vertex = Sampling::Vertex;

// What a border runs along: faces 0..5, Arc::own_start, Arc::own_end.
constexpr int nothing = -1;

// A point of a border, named by where on the grid it is: neighbouring triangles give it the same name.
struct Name {
  enum class Kind { vertex, edge, corner } kind = Kind::vertex;
  std::size_t a = 0, b = 0;               // the vertex; the edge, a < b; the triangle
  int first = nothing, second = nothing;  // the faces
  bool operator<(const Name& other) const {
    return std::tie(kind, a, b, first, second) <
           std::tie(other.kind, other.a, other.b, other.first, other.second);
  }
};

// The part of the side from a to b that is inside: from and to as shares of its length, and by which faces
// they are; `nothing`: by the vertex.
struct Inside {
  double from = 0, to = 1;
  int from_face = nothing, to_face = nothing;
};

class Trimmer {
 public:
  Trimmer(const yarn::Body& body, const Box3& box, double tolerance)
      : body_(body), box_(box), tolerance_(tolerance), sampling_(body, box, tolerance) {}

  Result<Cut> run();

 private:
  struct Step {  // of a border: to the next point, along what
    std::size_t next = 0;
    int along = nothing;
    std::size_t triangle = 0;
  };
  struct Point {
    Name name;
    Vec2 parameters = Vec2::Zero();
  };

  [[nodiscard]] std::optional<Inside> inside_part(Vertex a, Vertex b) const;
  void visit(std::size_t triangle);
  void add_border(std::size_t triangle, const Name& from, int from_face, const Name& to, int to_face);
  std::size_t point_of(const Name& name);
  void add_step(const Name& from, const Name& to, int along, std::size_t triangle);
  [[nodiscard]] Name name_on(Vertex a, Vertex b, int face) const;
  [[nodiscard]] Vec2 place(const Name& name) const;
  [[nodiscard]] Vec2 crossing(Vertex a, Vertex b, int face) const;
  [[nodiscard]] Vec2 corner(std::size_t triangle, int first, int second) const;
  [[nodiscard]] double depth_of(const Vec3& point, int face) const {
    const double above = point[axis_of(face)] - plane_of(box_, face);
    return is_high(face) ? -above : above;
  }
  [[nodiscard]] double depth_at(const Vec2& parameters, int face) const {
    return depth_of(position(body_, parameters), face);
  }
  [[nodiscard]] bool is_beyond(const Vec2& parameters, int along) const;
  Border trace(std::size_t start, std::vector<bool>& seen) const;
  [[nodiscard]] Arc arc_along(int along) const;
  [[nodiscard]] Status check_grazing() const;
  Result<Cut> collect();

  const yarn::Body& body_;
  const Box3& box_;
  double tolerance_;
  Sampling sampling_;
  Groups groups_{sampling_.triangle_count()};  // of triangles that hang together inside
  std::map<Name, std::size_t> numbers_;
  std::vector<Point> points_;
  std::vector<Step> steps_;  // one a point
  std::optional<Message> failure_;
};

std::optional<Inside> Trimmer::inside_part(Vertex a, Vertex b) const {
  if (a > b) {
    std::optional<Inside> turned = inside_part(b, a);
    if (!turned) return turned;
    return Inside{1 - turned->to, 1 - turned->from, turned->to_face, turned->from_face};
  }
  Inside part;
  bool whole_a = true, whole_b = true;
  for (int face = 0; face < face_count; ++face) {
    const double at_a = sampling_.depth(a, face), at_b = sampling_.depth(b, face);
    if (at_a < 0 && at_b < 0) return std::nullopt;
    if (at_a < 0) {
      whole_a = false;
      const double share = at_a / (at_a - at_b);
      if (share >= part.from) part.from = share, part.from_face = face;
    } else if (at_b < 0) {
      whole_b = false;
      const double share = at_a / (at_a - at_b);
      if (share <= part.to) part.to = share, part.to_face = face;
    }
  }
  if (part.from > part.to || (part.from == part.to && !whole_a && !whole_b)) return std::nullopt;
  return part;
}

Name Trimmer::name_on(Vertex a, Vertex b, int face) const {
  return {Name::Kind::edge, std::min(a, b), std::max(a, b), face, nothing};
}

// Where the side of a triangle goes through a face: bisection, whose bracket is never lost.
Vec2 Trimmer::crossing(Vertex a, Vertex b, int face) const {
  Vec2 from = sampling_.parameters(a), to = beside(body_, from, sampling_.parameters(b));
  double low = 0, high = 1, low_depth = sampling_.depth(a, face), high_depth = sampling_.depth(b, face);
  if (low_depth == 0) return from;
  if (high_depth == 0) return to;
  for (int step = 0; step < 100 && high - low > 1e-15; ++step) {
    // Regula falsi and halving in turn.
    double share =
        step % 2 == 0 ? low + (high - low) * low_depth / (low_depth - high_depth) : (low + high) / 2;
    share = std::clamp(share, low, high);
    const double depth = depth_at(from + share * (to - from), face);
    if (depth == 0) return from + share * (to - from);
    if ((depth < 0) == (low_depth < 0)) {
      low = share;
      low_depth = depth;
    } else {
      high = share;
      high_depth = depth;
    }
  }
  return from + (low + (high - low) * low_depth / (low_depth - high_depth)) * (to - from);
}

// Where an edge of the box goes through the surface near a triangle.
Vec2 Trimmer::corner(std::size_t triangle, int first, int second) const {
  const auto t = sampling_.triangle(triangle);
  std::array<Vec2, 3> q;
  std::array<Vec2, 3> depths;
  for (std::size_t k = 0; k < 3; ++k) {
    q[k] = sampling_.parameters(t[k]);
    if (k > 0) q[k] = beside(body_, q[0], q[k]);
    depths[k] = {sampling_.depth(t[k], first), sampling_.depth(t[k], second)};
  }
  Eigen::Matrix2d slopes;
  slopes << depths[1] - depths[0], depths[2] - depths[0];
  Eigen::Matrix2d sides;
  sides << q[1] - q[0], q[2] - q[0];
  const Vec2 shares = slopes.fullPivLu().solve(-depths[0]);
  Vec2 result = q[0] + sides * shares;
  const double reach = 4 * (sides.col(0).norm() + sides.col(1).norm());
  const Vec2 start = result;
  for (int step = 0; step < 30; ++step) {
    const nurbs::SurfaceJet s = jet(body_, result);
    Eigen::Matrix2d by_parameters;
    Vec2 miss;
    for (int k = 0; k < 2; ++k) {
      const int face = k == 0 ? first : second, axis = axis_of(face);
      by_parameters.row(k) << s.du[axis], s.dv[axis];
      miss[k] = s.position[axis] - plane_of(box_, face);
    }
    const Vec2 change = by_parameters.fullPivLu().solve(miss);
    if (!change.allFinite() || (result - change - start).norm() > reach) break;
    result -= change;
    if (change.norm() <= 1e-15 * (1 + result.norm())) break;
  }
  return result;
}

Vec2 Trimmer::place(const Name& name) const {
  switch (name.kind) {
    case Name::Kind::vertex:
      return sampling_.parameters(static_cast<Vertex>(name.a));
    case Name::Kind::edge:
      return crossing(static_cast<Vertex>(name.a), static_cast<Vertex>(name.b), name.first);
    default:
      return corner(name.a, name.first, name.second);
  }
}

std::size_t Trimmer::point_of(const Name& name) {
  const auto [entry, is_new] = numbers_.try_emplace(name, points_.size());
  if (is_new) {
    points_.push_back({name, place(name)});
    steps_.emplace_back();
  }
  return entry->second;
}

void Trimmer::add_step(const Name& from, const Name& to, int along, std::size_t triangle) {
  const std::size_t a = point_of(from), b = point_of(to);
  steps_[a] = {b, along, triangle};
}

void Trimmer::add_border(std::size_t triangle, const Name& from, int from_face, const Name& to, int to_face) {
  if (from_face == to_face) return add_step(from, to, from_face, triangle);
  if (axis_of(from_face) == axis_of(to_face)) {
    failure_ =
        error(Kind::geometry, fmt::format("the cell is too thin along {} for its yarns: both its faces cut "
                                          "one of a yarn's smallest parts",
                                          "xyz"[axis_of(from_face)]))
            .at_point(sampling_.point(sampling_.triangle(triangle)[0]));
    return;
  }
  const Name corner{Name::Kind::corner, triangle, 0, from_face, to_face};
  // Near a corner of the box, a third face may lie between the two.
  const Vec2 there = place(corner);
  for (int face = 0; face < face_count; ++face) {
    const int axis = axis_of(face);
    if (axis == axis_of(from_face) || axis == axis_of(to_face) || depth_at(there, face) >= 0) continue;
    const Name before{Name::Kind::corner, triangle, 0, from_face, face},
        after{Name::Kind::corner, triangle, 0, face, to_face};
    add_step(from, before, from_face, triangle);
    add_step(before, after, face, triangle);
    return add_step(after, to, to_face, triangle);
  }
  add_step(from, corner, from_face, triangle);
  add_step(corner, to, to_face, triangle);
}

// Goes round the triangle: what lies inside of each side, and where the border leaves it for the next.
void Trimmer::visit(std::size_t triangle) {
  const auto t = sampling_.triangle(triangle);
  for (int face = 0; face < face_count; ++face)
    if (sampling_.depth(t[0], face) < 0 && sampling_.depth(t[1], face) < 0 && sampling_.depth(t[2], face) < 0)
      return;
  std::array<std::optional<Inside>, 3> parts;
  for (std::size_t k = 0; k < 3; ++k) parts[k] = inside_part(t[k], t[(k + 1) % 3]);
  for (std::size_t k = 0; k < 3; ++k) {
    if (!parts[k]) continue;
    const Vertex a = t[k], b = t[(k + 1) % 3];
    if (const int own = sampling_.own_border(a, b); own != 0) {
      const auto end_name = [&](int face, Vertex vertex) {
        return face == nothing ? Name{Name::Kind::vertex, vertex, 0, nothing, nothing} : name_on(a, b, face);
      };
      add_step(end_name(parts[k]->from_face, a), end_name(parts[k]->to_face, b), own, triangle);
    }
    if (parts[k]->to_face == nothing) continue;
    // The next side whose inner part begins inside of it.
    for (std::size_t step = 1; step <= 3; ++step) {
      const std::size_t m = (k + step) % 3;
      if (!parts[m] || parts[m]->from_face == nothing) continue;
      add_border(triangle, name_on(a, b, parts[k]->to_face), parts[k]->to_face,
                 name_on(t[m], t[(m + 1) % 3], parts[m]->from_face), parts[m]->from_face);
      break;
    }
  }
}

bool Trimmer::is_beyond(const Vec2& parameters, int along) const {
  const Vec3 point = position(body_, parameters);
  for (int face = 0; face < face_count; ++face) {
    if (face == along) continue;
    const double depth = depth_of(point, face);
    const auto& ends = sampling_.end_faces();
    if (depth < 0 && !(face == ends[0] || face == ends[1])) return true;
    if (depth < -tolerance_) return true;
  }
  return false;
}

Arc Trimmer::arc_along(int along) const {
  Arc arc;
  arc.face = along;
  if (along >= Arc::own_start) {
    const bool last = along == Arc::own_end;
    arc.along = last ? Arc::Along::end : Arc::Along::start;
    if (const int face = sampling_.end_faces()[last ? 1 : 0]; face >= 0) arc.face = face;
  }
  return arc;
}

Border Trimmer::trace(std::size_t start, std::vector<bool>& seen) const {
  // The way round, from a corner if there is one.
  std::vector<std::size_t> way{start};
  for (std::size_t p = steps_[start].next; p != start; p = steps_[p].next) way.push_back(p);
  const auto along_before = [&](std::size_t k) {
    return steps_[way[(k + way.size() - 1) % way.size()]].along;
  };
  std::size_t first = 0;
  while (first < way.size() && along_before(first) == steps_[way[first]].along) ++first;
  if (first == way.size()) first = 0;
  std::rotate(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(first), way.end());

  Border border;
  Vec2 last = points_[way.front()].parameters;
  const Vec2 begin = last;
  for (std::size_t k = 0; k <= way.size(); ++k) {
    const std::size_t p = way[k % way.size()];
    seen[p] = true;
    const bool is_corner = k == 0 || k == way.size() || along_before(k) != steps_[p].along;
    last = beside(body_, last, points_[p].parameters);
    if (k > 0) {
      std::vector<Vec2>& line = border.arcs.back().parameters;
      const bool is_new = (last - line.back()).norm() > 0;
      if (is_corner || (is_new && !is_beyond(last, along_before(k)))) line.push_back(last);
    }
    if (is_corner && k < way.size()) {
      border.arcs.push_back(arc_along(steps_[p].along));
      border.arcs.back().parameters.push_back(last);
    }
  }
  const Vec2 gain = (last - begin).cwiseQuotient(periods(body_));
  border.turns_u = static_cast<int>(std::lround(gain.x()));
  if (body_.closed_along) border.turns_v = static_cast<int>(std::lround(gain.y()));
  return border;
}

// What lies beyond a face has to reach farther through it than the tolerance.
Status Trimmer::check_grazing() const {
  for (int face = 0; face < face_count; ++face) {
    Groups groups(sampling_.vertex_count());  // of vertices beyond
    for (std::size_t t = 0; t < sampling_.triangle_count(); ++t) {
      const auto corners = sampling_.triangle(t);
      std::optional<Vertex> last;
      for (const Vertex vertex : corners) {
        if (sampling_.depth(vertex, face) >= 0) continue;
        if (last) groups.join(*last, vertex);
        last = vertex;
      }
    }
    std::map<Vertex, Vertex> deepest;
    for (Vertex vertex = 0; vertex < sampling_.vertex_count(); ++vertex) {
      if (sampling_.depth(vertex, face) >= 0) continue;
      const auto [entry, is_new] = deepest.try_emplace(groups.of(vertex), vertex);
      if (sampling_.depth(vertex, face) < sampling_.depth(entry->second, face)) entry->second = vertex;
    }
    for (const auto& [unused, vertex] : deepest)
      if (sampling_.depth(vertex, face) > -tolerance_)
        return error(
                   Kind::geometry,
                   fmt::format("grazes the cell's face {}: it reaches only {:.2g} through it; move that face "
                               "by more than {:.2g}",
                               name_of_face(face), -sampling_.depth(vertex, face), tolerance_))
            .at_point(sampling_.point(vertex));
  }
  return {};
}

Result<Cut> Trimmer::run() {
  if (Status free = check_grazing(); !free) return free.error();
  for (std::size_t t = 0; t < sampling_.triangle_count() && !failure_; ++t) visit(t);
  if (failure_) return *failure_;
  return collect();
}

// The deepest vertex of what hangs together, and the borders.
Result<Cut> Trimmer::collect() {
  // Triangles hang together over sides with a part inside; `outside` those over vertices that are not.
  std::map<std::pair<Vertex, Vertex>, std::size_t> over_side;
  std::vector<bool> is_entered(sampling_.triangle_count(), false);
  for (std::size_t t = 0; t < sampling_.triangle_count(); ++t) {
    const auto corners = sampling_.triangle(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex a = corners[k], b = corners[(k + 1) % 3];
      if (!inside_part(a, b)) continue;
      is_entered[t] = true;
      const auto [other, is_new] = over_side.try_emplace(std::minmax(a, b), t);
      if (!is_new) {
        groups_.join(t, other->second);
        over_side.erase(other);
      }
    }
  }
  struct Deepest {
    Vertex vertex = 0;
    double depth = -1;
  };
  std::map<std::size_t, Deepest> parts;
  for (std::size_t t = 0; t < sampling_.triangle_count(); ++t) {
    if (!is_entered[t]) continue;
    Deepest& deepest = parts[groups_.of(t)];
    for (const Vertex vertex : sampling_.triangle(t)) {
      double depth = std::numeric_limits<double>::infinity();
      for (int face = 0; face < face_count; ++face) depth = std::min(depth, sampling_.depth(vertex, face));
      if (depth > deepest.depth) deepest = {vertex, depth};
    }
  }
  std::map<std::size_t, std::vector<Border>> borders;
  std::vector<bool> seen(points_.size(), false);
  for (std::size_t p = 0; p < points_.size(); ++p)
    if (!seen[p]) {
      const std::size_t part = groups_.of(steps_[p].triangle);
      borders[part].push_back(trace(p, seen));
    }
  Cut result;
  for (const auto& [part, deepest] : parts) {
    if (deepest.depth < tolerance_) {
      result.notes.push_back(
          note(Kind::geometry,
               fmt::format("reaches less than the tolerance ({:.3g} deep) into the cell: left out there",
                           std::max(deepest.depth, 0.0)))
              .at_point(sampling_.point(deepest.vertex)));
      continue;
    }
    Piece piece;
    piece.borders = std::move(borders[part]);
    piece.inside = sampling_.parameters(deepest.vertex);
    for (const Border& border : piece.borders)
      for (const Arc& arc : border.arcs)
        if (arc.face >= face_count && border.arcs.size() > 1)
          return error(Kind::geometry,
                       "the yarn's end is partly inside of the cell: let it end in the cell's face, beyond "
                       "it, or "
                       "well inside")
              .at_point(position(body_, arc.parameters.front()));
    result.pieces.push_back(std::move(piece));
  }
  return result;
}

}  // namespace

Result<Cut> trim(const yarn::Body& body, const Box3& box, double tolerance) {
  if (!box.intersects(yarn::bounds(body))) return Cut{};
  return Trimmer(body, box, tolerance).run();
}

}  // namespace selvage::cell
