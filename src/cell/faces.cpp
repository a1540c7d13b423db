#include "cell/faces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/bounds.h"
#include "core/plane.h"

namespace selvage::cell {
namespace {

// Where two closed polygons cross.
std::optional<Vec2> crossing(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  const Eigen::AlignedBox2d both = bounds_of(a).intersection(bounds_of(b));
  if (both.isEmpty()) return std::nullopt;
  const auto sides_in = [&](const std::vector<Vec2>& polygon) {
    std::vector<std::array<Vec2, 2>> sides;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      if (both.intersects(Eigen::AlignedBox2d(p.cwiseMin(q), p.cwiseMax(q)))) sides.push_back({p, q});
    }
    return sides;
  };
  const auto turn = [](const Vec2& p, const Vec2& q, const Vec2& r) { return cross(q - p, r - p); };
  const auto sides_b = sides_in(b);
  for (const auto& [p, q] : sides_in(a))
    for (const auto& [r, s] : sides_b)
      if (turn(p, q, r) * turn(p, q, s) < 0 && turn(r, s, p) * turn(r, s, q) < 0)
        return p + (q - p) * turn(r, s, p) / (turn(r, s, p) - turn(r, s, q));
  return std::nullopt;
}

constexpr std::size_t outside = FaceRegion::matrix - 1;  // outside of the box

class Divider {
 public:
  Divider(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut)
      : bodies_(bodies), box_(box), cut_(cut) {}

  Result<Division> run();

 private:
  struct OnEdge {  // a corner on an edge of the box
    std::size_t corner = 0, body = FaceRegion::matrix;
    double along = 0;
    bool leaves = false;  // the yarn, in the direction of the axis
  };
  void find_corners();
  Status divide_edges();
  Status own(std::size_t edge, std::size_t body);
  void spread_owners();
  Status trace_face(int face);
  Status chain(int face, std::size_t body, const std::vector<Side>& sides,
               std::vector<Outline>& outlines) const;
  void nest(int face, std::size_t body, std::vector<Outline> outlines);
  Status check_apart() const;
  [[nodiscard]] std::size_t body_left_of(const Side& side, int face) const;
  [[nodiscard]] std::vector<Vec2> polygon(int face, const Outline& outline) const;
  [[nodiscard]] const Edge& edge_of(const Side& side) const { return division_.edges[side.edge]; }
  [[nodiscard]] std::size_t start_of(const Side& side) const {
    return side.backward ? edge_of(side).to : edge_of(side).from;
  }
  [[nodiscard]] std::size_t end_of(const Side& side) const { return start_of({side.edge, !side.backward}); }
  [[nodiscard]] const yarn::Body& body_of(const Edge& arc) const {
    return bodies_[cut_.pieces[arc.piece].body];
  }
  [[nodiscard]] Message overlap(std::size_t a, std::size_t b, const Vec3& at) const;

  std::span<const yarn::Body> bodies_;
  const Box3& box_;
  const Cut& cut_;
  Division division_;
  std::array<std::vector<OnEdge>, edge_count> on_edges_;
  std::vector<std::size_t> owners_;  // of parts of the box's edges
  std::vector<bool> is_owned_;
};

Message Divider::overlap(std::size_t a, std::size_t b, const Vec3& at) const {
  return error(Kind::geometry,
               fmt::format("yarns '{}' and '{}' overlap where a face of the cell cuts them; --relax moves "
                           "them apart where they have room",
                           bodies_[a].name, bodies_[b].name))
      .of_yarn(bodies_[a].name)
      .at_point(at);
}

void Divider::find_corners() {
  for (int number = 0; number < 8; ++number) {
    Vec3 at;
    for (int axis = 0; axis < 3; ++axis) at[axis] = plane_of(box_, 2 * axis + (number >> axis & 1));
    division_.corners.push_back({at});
  }
  for (std::size_t p = 0; p < cut_.pieces.size(); ++p) {
    const Piece& piece = cut_.pieces[p];
    const yarn::Body& body = bodies_[piece.body];
    division_.first_edges.emplace_back();
    for (const Border& border : piece.borders) {
      const std::size_t count = border.arcs.size(), first = division_.edges.size();
      division_.first_edges.back().push_back(first);
      for (const Arc& arc : border.arcs) division_.edges.push_back({&arc, p});
      for (std::size_t k = 0; count > 1 && k < count; ++k) {
        const Arc &arc = border.arcs[k], &next = border.arcs[(k + 1) % count];
        const int edge = edge_between(arc.face, next.face);
        const nurbs::SurfaceJet s = jet(body, arc.parameters.back());
        const double outward = s.du.cross(s.dv)[edge / 4] * (body.inward ? -1 : 1);
        const std::size_t corner = division_.corners.size();
        division_.edges[first + k].to = division_.edges[first + (k + 1) % count].from = corner;
        on_edges_[static_cast<std::size_t>(edge)].push_back(
            {corner, piece.body, s.position[edge / 4], outward > 0});
        division_.corners.push_back({edge_point(box_, edge, s.position[edge / 4])});
      }
    }
  }
}

Status Divider::own(std::size_t edge, std::size_t body) {
  if (is_owned_[edge] && owners_[edge] != body) {
    const std::size_t other = owners_[edge];
    const Vec3 at = division_.corners[division_.edges[edge].from].at;
    if (body != FaceRegion::matrix && other != FaceRegion::matrix) return overlap(body, other, at);
    // One yarn's end is another's inside.
    for (const auto& list : on_edges_)
      for (const OnEdge& a : list)
        for (const OnEdge& b : list)
          if (a.body != b.body && (a.corner == division_.edges[edge].from) &&
              (b.corner == division_.edges[edge].to))
            return overlap(a.body, b.body, at);
    return error(Kind::geometry, "yarns overlap, or fold, where an edge of the cell cuts them")
        .of_yarn(bodies_[body == FaceRegion::matrix ? other : body].name)
        .at_point(at);
  }
  is_owned_[edge] = true;
  owners_[edge] = body;
  return {};
}

Status Divider::divide_edges() {
  for (int edge = 0; edge < edge_count; ++edge) {
    auto& list = on_edges_[static_cast<std::size_t>(edge)];
    std::stable_sort(list.begin(), list.end(),
                     [](const OnEdge& a, const OnEdge& b) { return a.along < b.along; });
    const std::array<int, 2> faces = faces_of_edge(edge);
    const int low =
        (is_high(faces[0]) ? 1 << axis_of(faces[0]) : 0) | (is_high(faces[1]) ? 1 << axis_of(faces[1]) : 0);
    std::size_t from = static_cast<std::size_t>(low);
    for (std::size_t k = 0; k <= list.size(); ++k) {
      const std::size_t to =
          k < list.size() ? list[k].corner : static_cast<std::size_t>(low | 1 << (edge / 4));
      division_.edges.push_back({nullptr, 0, edge, from, to});
      from = to;
    }
    owners_.resize(division_.edges.size(), FaceRegion::matrix);
    is_owned_.resize(division_.edges.size(), false);
    const std::size_t first = division_.edges.size() - list.size() - 1;
    for (std::size_t k = 0; k < list.size(); ++k) {
      if (Status s = own(first + k, list[k].leaves ? list[k].body : FaceRegion::matrix); !s) return s;
      if (Status s = own(first + k + 1, list[k].leaves ? FaceRegion::matrix : list[k].body); !s) return s;
    }
  }
  return {};
}

// A part that ends at a corner of the box belongs to what the others there belong to.
void Divider::spread_owners() {
  for (int pass = 0; pass < 8; ++pass)
    for (std::size_t a = 0; a < owners_.size(); ++a)
      for (std::size_t b = 0; b < owners_.size(); ++b) {
        if (!is_owned_[a] || is_owned_[b]) continue;
        const Edge &s = division_.edges[a], &t = division_.edges[b];
        for (const std::size_t corner : {s.from, s.to})
          if (corner < 8 && (corner == t.from || corner == t.to)) {
            owners_[b] = owners_[a];
            is_owned_[b] = true;
          }
      }
}

// What lies to the left of the side in a face that it is in: counter-clockwise is the inside of the face.
std::size_t Divider::body_left_of(const Side& side, int face) const {
  const Edge& edge = edge_of(side);
  if (edge.arc != nullptr)
    return side.backward != body_of(edge).inward ? cut_.pieces[edge.piece].body : FaceRegion::matrix;
  const Vec2 from = flat(division_.corners[start_of(side)].at, face),
             to = flat(division_.corners[end_of(side)].at, face);
  return cross(to - from, flat(box_.center(), face) - from) < 0 ? outside : owners_[side.edge];
}

// The points of an outline, in the face's coordinates.
std::vector<Vec2> Divider::polygon(int face, const Outline& outline) const {
  std::vector<Vec2> points;
  for (const Side& side : outline) {
    const Edge& edge = edge_of(side);
    if (edge.arc == nullptr) {
      points.push_back(flat(division_.corners[start_of(side)].at, face));
      continue;
    }
    std::vector<Vec2> run;
    for (const Vec2& q : edge.arc->parameters) run.push_back(flat(position(body_of(edge), q), face));
    if (side.backward) std::reverse(run.begin(), run.end());
    points.insert(points.end(), run.begin(), run.end() - 1);
  }
  return points;
}

Status Divider::chain(int face, std::size_t body, const std::vector<Side>& sides,
                      std::vector<Outline>& outlines) const {
  std::map<std::size_t, std::size_t> from;
  for (std::size_t i = 0; i < sides.size(); ++i) from[start_of(sides[i])] = i;
  std::vector<bool> used(sides.size(), false);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (used[i]) continue;
    Outline outline;
    std::size_t k = i;
    while (!used[k]) {
      used[k] = true;
      outline.push_back(sides[k]);
      const auto next = from.find(end_of(sides[k]));
      if (next == from.end()) break;
      k = next->second;
    }
    if (k != i)
      return error(Kind::geometry,
                   fmt::format("what is cut by the cell's face {} is not closed: yarns overlap "
                               "there, or one folds",
                               name_of_face(face)))
          .of_yarn(body != FaceRegion::matrix ? bodies_[body].name : std::string())
          .at_point(division_.corners[start_of(sides[i])].at);
    outlines.push_back(std::move(outline));
  }
  return {};
}

void Divider::nest(int face, std::size_t body, std::vector<Outline> outlines) {
  std::vector<std::vector<Vec2>> polygons;
  polygons.reserve(outlines.size());
  for (const Outline& outline : outlines) polygons.push_back(polygon(face, outline));
  const std::vector<std::size_t> outer = outer_polygons(polygons);
  std::vector<std::size_t> regions(outlines.size());
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    if (outer[i] != i) continue;
    regions[i] = division_.regions.size();
    division_.regions.push_back({face, body, {std::move(outlines[i])}});
  }
  for (std::size_t i = 0; i < outlines.size(); ++i)
    if (outer[i] != i && outer[i] != no_polygon)
      division_.regions[regions[outer[i]]].outlines.push_back(std::move(outlines[i]));
}

Status Divider::trace_face(int face) {
  std::map<std::size_t, std::vector<Side>> sides;        // by owner
  std::map<std::size_t, std::vector<Outline>> outlines;  // those of one arc
  for (std::size_t i = 0; i < division_.edges.size(); ++i) {
    const Edge& edge = division_.edges[i];
    const std::array<int, 2> faces =
        edge.arc != nullptr ? std::array{edge.arc->face, edge.arc->face} : faces_of_edge(edge.box_edge);
    if (faces[0] != face && faces[1] != face) continue;
    for (const bool backward : {false, true}) {
      const Side side{i, backward};
      const std::size_t owner = body_left_of(side, face);
      if (owner == outside) continue;
      if (edge.is_border())
        outlines[owner].push_back({side});
      else
        sides[owner].push_back(side);
    }
  }
  for (const auto& [owner, list] : sides)
    if (Status chained = chain(face, owner, list, outlines[owner]); !chained) return chained;
  for (auto& [owner, list] : outlines) nest(face, owner, std::move(list));
  return {};
}

// No two yarns' regions of a face may share any of it.
Status Divider::check_apart() const {
  struct Flat {
    const FaceRegion* region;
    std::vector<Vec2> points;
  };
  std::vector<Flat> flats;
  for (const FaceRegion& region : division_.regions)
    if (region.body != FaceRegion::matrix)
      flats.push_back({&region, polygon(region.face, region.outlines.front())});
  for (std::size_t i = 0; i < flats.size(); ++i)
    for (std::size_t j = i + 1; j < flats.size() && flats[j].region->face == flats[i].region->face; ++j) {
      if (flats[i].region->body == flats[j].region->body) continue;
      std::optional<Vec2> at = crossing(flats[i].points, flats[j].points);
      if (!at && flats[i].region->outlines.size() == 1 && contains(flats[i].points, flats[j].points.front()))
        at = flats[j].points.front();
      if (!at && flats[j].region->outlines.size() == 1 && contains(flats[j].points, flats[i].points.front()))
        at = flats[i].points.front();
      if (!at) continue;
      return overlap(flats[i].region->body, flats[j].region->body, in_face(box_, flats[i].region->face, *at));
    }
  return {};
}

Result<Division> Divider::run() {
  find_corners();
  if (Status divided = divide_edges(); !divided) return divided.error();
  spread_owners();
  for (int face = 0; face < face_count; ++face)
    if (Status traced = trace_face(face); !traced) return traced.error();
  if (Status apart = check_apart(); !apart) return apart.error();
  return std::move(division_);
}

}  // namespace

Result<Division> divide_faces(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut) {
  return Divider(bodies, box, cut).run();
}

}  // namespace selvage::cell
