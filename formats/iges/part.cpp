#include "formats/iges/part.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "cad/edges.h"
#include "cad/feet.h"
#include "cad/sampled_curve.h"
#include "cad/seam.h"
#include "formats/iges/header.h"
#include "formats/iges/solid.h"
#include "nurbs/restrict.h"

namespace selvage::formats::iges {

namespace {

// A pole: an edge that has no length.
bool is_pole(const cad::Edge& edge) {
  return edge.curve.points.empty();
}

bool has_all_flats(const cad::Loop& loop) {
  return std::none_of(loop.edges.begin(), loop.edges.end(),
                      [](const cad::Edge& edge) { return edge.flat.points.empty(); });
}
// All are there, and none is another curve than the one in space, as close as other programs fit them.
bool flats_hold(const cad::Loop& loop, const nurbs::Surface& surface) {
  constexpr double fitted = 1e-3;  // of the surface's size
  return std::ranges::all_of(loop.edges,
                             [&](const cad::Edge& edge) { return cad::flat_holds(surface, edge, fitted); });
}
// An edge that has a length, but no curve in space.
bool lacks_curve(const cad::Edge& edge, const nurbs::Surface& surface) {
  return is_pole(edge) && !edge.flat.points.empty() &&
         !cad::is_point(surface, edge.flat, 1e-6 * cad::box_of(surface.points).sizes().norm());
}
// Poles aside; their places can be told by their neighbours, unless there are none.
bool has_all_curves(const cad::Loop& loop, const nurbs::Surface& surface) {
  return !std::all_of(loop.edges.begin(), loop.edges.end(), is_pole) &&
         std::none_of(loop.edges.begin(), loop.edges.end(),
                      [&](const cad::Edge& edge) { return lacks_curve(edge, surface); });
}

// Curves in the parameters that the file does not have: OpenCASCADE's own projections onto a parallelogram
// are off by 1e-5 of what a circle holds, and cannot close a boundary through a sphere's pole.
void give_flats(cad::Face& face) {
  constexpr double tolerance = 1e-8;  // of the surface's size
  cad::give_flats(face, tolerance * cad::box_of(face.surface.points).diagonal().norm());
}

// What is written of one thing: colour, level, label and name. Its 406 is written at once, so that the
// pointer is known.
struct Look : Common {
  Look(Records& records, ColorSource& colors, const cad::Label& of) : ascii_name(ascii(of.name)) {
    color = colors.pointer(of.color);
    level = of.level;
    label = ascii_name;
    name = label.empty() ? 0 : write_name(records, *this);
  }
  Look(const Look&) = delete;
  Look& operator=(const Look&) = delete;

  std::string ascii_name;
};

struct Shared;

class PartWriter {
 public:
  PartWriter(Records& records, ColorSource& colors) : records_(records), colors_(colors) {}

  int part(const cad::Part& part);

 private:
  int chain(const Common& common, const std::vector<const nurbs::Curve*>& curves, std::string_view status);
  int boundary(const Common& common, int pointer, const nurbs::Surface& surface, const cad::Loop& loop);
  int face(const cad::Face& given);
  int loop(Shared& shared, const Common& common, const cad::Loop& given, bool is_whole);
  SolidFace face_of_solid(Shared& shared, const cad::Face& given);
  int solid(const cad::Part& part);

  Records& records_;
  ColorSource& colors_;
};

// A 102 of 126s, or the only one.
int PartWriter::chain(const Common& common, const std::vector<const nurbs::Curve*>& curves,
                      std::string_view status) {
  const Vec3 up = Vec3::UnitZ();
  const Vec3* const normal = status == dependent_in_2d ? &up : nullptr;
  std::vector<int> parts;
  parts.reserve(curves.size());
  for (const nurbs::Curve* const curve : curves)
    parts.push_back(write_curve(records_, common.entity(126, 0, status), *curve, normal));
  return parts.size() == 1 ? parts.front() : write_composite(records_, common, status, parts);
}

// Where the curves in the parameters hold, poles have none in space: OpenCASCADE would take an edge on the
// seam beside a pole without length to the seam's other side. Else the poles are curves without length.
int PartWriter::boundary(const Common& common, int pointer, const nurbs::Surface& surface,
                         const cad::Loop& loop) {
  const bool by_flats = flats_hold(loop, surface);
  std::vector<const nurbs::Curve*> flats, curves;
  std::vector<nurbs::Curve> poles(loop.edges.size());
  for (std::size_t i = 0; i < loop.edges.size(); ++i) {
    const cad::Edge& edge = loop.edges[i];
    flats.push_back(&edge.flat);
    if (!is_pole(edge)) {
      curves.push_back(&edge.curve);
      continue;
    }
    if (by_flats) continue;
    for (std::size_t k = 1; k < loop.edges.size(); ++k) {
      const cad::Edge& before = loop.edges[(i + loop.edges.size() - k) % loop.edges.size()];
      if (is_pole(before)) continue;
      const Vec3 at = cad::at_share(before.curve, 1);
      poles[i] = nurbs::segment(at, at);
      break;
    }
    curves.push_back(&poles[i]);
  }
  const bool lacks_poles = curves.size() < flats.size();
  const int flat = has_all_flats(loop) ? chain(common, flats, dependent_in_2d) : 0;
  const int spatial = has_all_curves(loop, surface) ? chain(common, curves, dependent) : 0;
  return write_boundary(records_, common, pointer, flat, spatial, lacks_poles);
}

// Of a closed surface with a face that begins or ends at its seam just the range of that face: OpenCASCADE
// takes an edge on a seam to either of its sides.
nurbs::Surface beside_seam(const cad::Face& face) {
  const nurbs::Surface& s = face.surface;
  cad::Range range = cad::domain(s);
  if (!std::ranges::all_of(face.loops, [&](const cad::Loop& loop) { return flats_hold(loop, s); })) return s;
  Box3 used;
  for (const cad::Edge& edge : cad::edges_of(face)) used.extend(cad::box_of(edge.flat.points));
  const std::array<double, 2> periods = cad::periods_of(s);
  const auto narrow = [](double& low, double& high, double first, double last, double period) {
    const double near = 1e-7 * period;
    const bool touches = first <= low + near || last >= high - near,
               fits = first >= low - near && last <= high + near;
    if (!touches || !fits || last - first >= period - near) return false;
    low = std::max(low, first);
    high = std::min(high, last);
    return true;
  };
  const bool narrower = narrow(range.u0, range.u1, used.min().x(), used.max().x(), periods[0]);
  return narrow(range.v0, range.v1, used.min().y(), used.max().y(), periods[1]) || narrower
             ? nurbs::restricted(s, range.u0, range.u1, range.v0, range.v1)
             : s;
}

int PartWriter::face(const cad::Face& given) {
  cad::Face face = given;
  give_flats(face);
  const Look own(records_, colors_, face);
  if (face.loops.empty()) return write_surface(records_, own.entity(128), face.surface, own.name);
  const nurbs::Surface beside = beside_seam(face);
  const int surface = write_surface(records_, own.entity(128, 0, dependent), beside);
  std::vector<int> boundaries;
  for (const cad::Loop& loop : face.loops) boundaries.push_back(boundary(own, surface, beside, loop));
  return write_trimmed(records_, own, boundaries, surface);
}

// Vertices that two edges share to the bit, or nearly, are one.
class Vertices {
 public:
  explicit Vertices(double tolerance) : tolerance_(tolerance) {}
  std::size_t at(const Vec3& p) {
    const auto known = exact_.find({p.x(), p.y(), p.z()});
    if (known != exact_.end()) return known->second;
    std::size_t index = 0;
    while (index < points_.size() && (points_[index] - p).norm() > tolerance_) ++index;
    if (index == points_.size()) points_.push_back(p);
    exact_[{p.x(), p.y(), p.z()}] = index;
    return index;
  }
  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }

 private:
  double tolerance_;
  std::vector<Vec3> points_;
  std::map<std::array<double, 3>, std::size_t> exact_;
};

// Does it run as the shared curve does?
bool runs_along(const cad::Edge& edge, const nurbs::Curve& curve) {
  const Vec3 start = cad::at_share(edge.curve, 0), from = cad::at_share(curve, 0),
             to = cad::at_share(curve, 1);
  if ((from - to).norm() > 1e-9 * ((from - start).norm() + (to - start).norm()))
    return (start - from).norm() <= (start - to).norm();
  // A closed one: by a place inside.
  const Vec3 p = cad::at_share(edge.curve, 0.3);
  return (p - cad::at_share(curve, 0.3)).norm() <= (p - cad::at_share(curve, 0.7)).norm();
}

// What the faces of a solid share, each edge in the direction in which it was first met.
struct Shared {
  explicit Shared(const cad::Part& part) : vertices(1e-7 * cad::box_of(part).sizes().norm()) {
    for (const cad::Face& face : part.faces)
      for (const cad::Edge& edge : cad::boundary_edges_of(face)) {
        if (is_pole(edge) || !index_of.try_emplace(edge.id, edges.size()).second) continue;
        const std::size_t from = vertices.at(cad::at_share(edge.curve, 0));
        edges.push_back({edge.curve, from, end_of(edge)});
      }
  }

  std::size_t end_of(const cad::Edge& edge) { return vertices.at(cad::at_share(edge.curve, 1)); }

  Vertices vertices;
  std::vector<SolidEdge> edges;
  std::map<int, std::size_t> index_of;  // by the edges' ids
  SolidLists lists;
};

// Begun with an edge: OpenCASCADE turns a pole that comes first round. On a whole face a pole has its curve
// in the parameters only where all edges have theirs: else OpenCASCADE makes it a second time.
int PartWriter::loop(Shared& shared, const Common& common, const cad::Loop& given, bool is_whole) {
  cad::Loop loop = given;
  std::rotate(loop.edges.begin(), std::find_if_not(loop.edges.begin(), loop.edges.end(), is_pole),
              loop.edges.end());
  std::vector<EdgeUse> uses;
  std::size_t vertex = 0;
  for (const cad::Edge& edge : loop.edges) {
    EdgeUse& use = uses.emplace_back();
    use.is_vertex = is_pole(edge);
    const bool has_flat = !edge.flat.points.empty() && !(is_whole && use.is_vertex && !has_all_flats(loop));
    use.flat = has_flat ? chain(common, {&edge.flat}, dependent_in_2d) : 0;
    if (!use.is_vertex) vertex = shared.end_of(edge);
    use.index = use.is_vertex ? vertex : shared.index_of[edge.id];
    use.forward = use.is_vertex || runs_along(edge, shared.edges[use.index].curve);
  }
  return write_loop(records_, common, shared.lists, uses);
}

SolidFace PartWriter::face_of_solid(Shared& shared, const cad::Face& given) {
  cad::Face face = given;
  give_flats(face);
  const Look own(records_, colors_, face);
  const int surface = write_surface(records_, own.entity(128, 0, dependent), face.surface);
  std::vector<int> loops;
  for (const cad::Loop& each : cad::boundary_of(face))
    loops.push_back(loop(shared, own, each, face.loops.empty()));
  return {write_face(records_, own, surface, loops, own.name), !face.reversed};
}

int PartWriter::solid(const cad::Part& part) {
  Shared shared(part);
  const Look own(records_, colors_, part);
  shared.lists = write_lists(records_, own, shared.vertices.points(), shared.edges);
  std::vector<std::vector<SolidFace>> shells;
  for (const std::vector<std::size_t>& members : cad::shells_of(part.faces)) {
    std::vector<SolidFace>& shell = shells.emplace_back();
    for (const std::size_t i : members) shell.push_back(face_of_solid(shared, part.faces[i]));
  }
  return write_shells(records_, own, shells);
}

int PartWriter::part(const cad::Part& part) {
  if (is_written_as_solid(part)) return solid(part);
  std::vector<int> faces;
  for (const cad::Face& each : part.faces) faces.push_back(face(each));
  const cad::Face& first = part.faces.front();
  if (faces.size() == 1 && part.group.empty() && first.name == part.name && first.color == part.color &&
      first.level == part.level)
    return faces.front();
  return write_group(records_, Look(records_, colors_, part), faces);
}

}  // namespace

std::string_view fault_of(const cad::Part& part) {
  if (part.faces.empty()) return "has no faces";
  for (const cad::Face& face : part.faces) {
    if (!is_finite(face.surface)) return not_finite;
    for (const cad::Loop& loop : cad::boundary_of(face)) {
      for (const cad::Edge& edge : loop.edges)
        if (!is_finite(edge.curve) || !is_finite(edge.flat))
          return "has an edge with a number that is not finite";
      if (!face.loops.empty() && !has_all_flats(loop) && !has_all_curves(loop, face.surface))
        return "has a loop whose curves are known neither all in space nor all in the surface's parameters";
    }
  }
  return {};
}

std::string_view why_no_solid(const cad::Part& part) {
  if (!cad::has_shared_edges(part)) return "not all of its edges are known to be shared by two of its faces";
  for (const cad::Face& face : part.faces)
    for (const cad::Edge& edge : cad::boundary_edges_of(face))
      if (lacks_curve(edge, face.surface)) return "an edge has no curve in space";
  return {};
}

bool is_written_as_solid(const cad::Part& part) {
  return part.kind == cad::Part::Kind::solid && why_no_solid(part).empty();
}

std::int64_t most_values_of_part(const cad::Part& part) {
  std::size_t values = 1000;
  for (const cad::Face& face : part.faces) {
    values +=
        100 + 4 * face.surface.points.size() + face.surface.knots_u.size() + face.surface.knots_v.size();
    for (const cad::Edge& edge : cad::boundary_edges_of(face))
      values += 100 + 5 * (edge.curve.points.size() + edge.flat.points.size()) + edge.curve.knots.size() +
                edge.flat.knots.size();
  }
  return static_cast<std::int64_t>(values);
}

int write_part(Records& records, ColorSource& colors, const cad::Part& part) {
  return PartWriter(records, colors).part(part);
}

int write_free_curve(Records& records, ColorSource& colors, const cad::NamedCurve& curve) {
  const Look own(records, colors, curve);
  return write_curve(records, own.entity(126), curve.curve, nullptr, own.name);
}

}  // namespace selvage::formats::iges
