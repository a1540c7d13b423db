#include "cell/cad_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "cad/edges.h"
#include "cad/sampled_curve.h"
#include "cell/faces.h"
#include "cell/tube_faces.h"
#include "nurbs/bezier.h"  // Box2
#include "nurbs/sweep.h"
#include "yarn/end_plane.h"

namespace selvage::cell {

namespace {

using nurbs::Box2;

constexpr int matrix_level = 9;  // after those of the yarns' roles

// Ends that lie in a face of the box within the tolerance of the cut, brought into it.
std::vector<yarn::Body> flush(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut) {
  std::vector<yarn::Body> result(bodies.begin(), bodies.end());
  for (const Piece& piece : cut.pieces)
    for (const Border& border : piece.borders)
      for (const Arc& arc : border.arcs) {
        if (arc.face >= face_count || arc.along == Arc::Along::through) continue;
        nurbs::Surface& surface = result[piece.body].surface;
        const int row = arc.along == Arc::Along::end ? surface.count_v - 1 : 0;
        for (int i = 0; i < surface.count_u; ++i)
          surface.point(i, row)[axis_of(arc.face)] = plane_of(box, arc.face);
      }
  return result;
}

// In the parameters of a face of the box.
nurbs::Curve in_plane(nurbs::Curve curve, int face) {
  for (Vec3& p : curve.points) p << flat(p, face), 0;
  return curve;
}

nurbs::Surface rectangle(const Box3& box, int face, const Box2& range) {
  const auto [x, y] = axes_in(face);
  return nurbs::flat(in_face(box, face, Vec2::Zero()), Vec3::Unit(x), Vec3::Unit(y), range.min(),
                     range.max());
}

// A shell: faces that hang together by their edges.
struct Shell {
  std::vector<cad::Face> faces;
  bool in_box_faces = false;
  Box3 box;
};

// In the order of their first faces; those from `first_planar` on lie in faces of the box.
std::vector<Shell> shells_of(std::vector<cad::Face> faces, std::size_t first_planar) {
  std::vector<Shell> shells;
  for (const std::vector<std::size_t>& members : cad::shells_of(faces)) {
    Shell& shell = shells.emplace_back();
    for (const std::size_t i : members) {
      shell.in_box_faces = shell.in_box_faces || i >= first_planar;
      for (const cad::Edge& edge : cad::edges_of(faces[i])) shell.box.extend(cad::box_of(edge.curve.points));
      shell.faces.push_back(std::move(faces[i]));
    }
  }
  return shells;
}

class CellBuilder {
 public:
  CellBuilder(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut, Division division,
              TubeFaces tubes)
      : bodies_(bodies), box_(box), cut_(cut), division_(std::move(division)), tubes_(std::move(tubes)) {}

  Result<std::vector<cad::Part>> run(bool with_matrix) {
    for (const Edge& part : division_.edges) {
      if (part.arc != nullptr) continue;
      tubes_.of_arc.push_back({tubes_.edges.size()});
      const Vec3 &a = division_.corners[part.from].at, &b = division_.corners[part.to].at;
      const double length = (b - a).norm();
      tubes_.edges.push_back({nurbs::segment(a, b, 0, length), {}});
    }
    std::vector<cad::Part> parts;
    std::vector<cad::Face> around;  // of the matrix
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
      Result<std::vector<cad::Face>> sides = sides_of(body);
      if (!sides) return sides.error();
      if (sides->empty()) continue;
      if (with_matrix)
        for (const cad::Face& face : *sides) {
          around.push_back(face);
          around.back().reversed = !face.reversed;
        }
      add_yarn(body, std::move(*sides), parts);
    }
    if (!with_matrix) return parts;
    const std::size_t first_planar = around.size();
    for (const FaceRegion& region : division_.regions)
      if (region.body == FaceRegion::matrix) around.push_back(region_face(region));
    add_matrix(shells_of(std::move(around), first_planar), parts);
    return parts;
  }

 private:
  // The parts of an edge, one after the other in the direction that is asked for.
  template <typename Take>
  void for_each_part(std::size_t edge, bool backward, const Take& take) const {
    const std::vector<std::size_t>& parts = tubes_.of_arc[edge];
    for (std::size_t i = 0; i < parts.size(); ++i)
      take(backward ? parts[parts.size() - 1 - i] : parts[i], backward);
  }

  [[nodiscard]] cad::Face region_face(const FaceRegion& region) const {
    cad::Face face;
    Box2 range;
    for (const Outline& outline : region.outlines) {
      cad::Loop loop;
      const auto add = [&](std::size_t id, bool backward) {
        cad::Edge edge = tubes_.edge(id, backward);
        edge.flat = in_plane(edge.curve, region.face);
        for (const Vec3& p : edge.flat.points) range.extend(p.head<2>());
        loop.edges.push_back(std::move(edge));
      };
      for (const Side& side : outline) for_each_part(side.edge, side.backward, add);
      face.loops.push_back(std::move(loop));
    }
    if (region.body != FaceRegion::matrix) {
      const Vec2 margin = Vec2::Constant(0.1 * range.sizes().maxCoeff());
      range = Box2(range.min() - margin, range.max() + margin);
    }
    face.surface = rectangle(box_, region.face, range);
    return face;
  }

  // What seals a yarn that ends inside the box.
  Result<cad::Face> end_face(const yarn::Body& body, std::size_t edge_number) const {
    const bool last = division_.edges[edge_number].arc->along == Arc::Along::end;
    const yarn::EndFace& end = last ? body.end : body.start;
    if (end.style == yarn::EndStyle::fan || end.style == yarn::EndStyle::none)
      return end_fault(body, end.style, last);
    cad::Face face;
    cad::Loop loop;
    std::optional<yarn::EndPlane> plane;
    if (end.style == yarn::EndStyle::planar) {
      plane = yarn::end_plane(body, yarn::end_curve(body, last), last);
      face.surface = plane->surface;
      face.reversed = plane->inward;
    } else {
      face.surface = end.surface;
      face.reversed = end.inward;
    }
    // Along growing u.
    for_each_part(edge_number, last, [&](std::size_t id, bool backward) {
      cad::Edge edge = tubes_.edge(id, backward);
      edge.flat = plane ? plane->in_parameters(edge.curve) : on_patch(body, edge.curve);
      loop.edges.push_back(std::move(edge));
    });
    face.loops.push_back(std::move(loop));
    return face;
  }

  Message end_fault(const yarn::Body& body, yarn::EndStyle style, bool last) const {
    return error(style == yarn::EndStyle::fan ? Kind::unsupported : Kind::geometry,
                 fmt::format("yarn '{}' ends inside the cell {}; --ends patch or planar closes it", body.name,
                             style == yarn::EndStyle::fan ? "in a fan of triangles, which is not cut"
                                                          : "without an end face"))
        .of_yarn(body.name, body.place)
        .at_point(yarn::end_curve(body, last).points.front());
  }

  // Along a side of the unit square, in proportion to its share of the quarter.
  static nurbs::Curve on_patch(const yarn::Body& body, const nurbs::Curve& edge) {
    const double t0 = edge.first_parameter(), t1 = edge.last_parameter(), middle = 0.5 * (t0 + t1);
    std::size_t k = 3;
    while (k > 0 && body.quarters[k] > middle) --k;
    const double from = body.quarters[k], to = k < 3 ? body.quarters[k + 1] : body.surface.last_u();
    const auto at = [&](double t) {
      const double share = std::clamp((t - from) / (to - from), 0.0, 1.0);
      switch (k) {
        case 0:
          return Vec3(share, 0, 0);
        case 1:
          return Vec3(1, share, 0);
        case 2:
          return Vec3(1 - share, 1, 0);
        default:
          return Vec3(0, 1 - share, 0);
      }
    };
    return nurbs::segment(at(t0), at(t1), t0, t1);
  }

  // The faces that a yarn has in common with the matrix.
  Result<std::vector<cad::Face>> sides_of(std::size_t body) const {
    std::vector<cad::Face> faces = tubes_.of_body[body];
    for (std::size_t e = 0; e < division_.edges.size(); ++e) {
      const Edge& edge = division_.edges[e];
      if (edge.arc == nullptr || edge.arc->face < face_count || cut_.pieces[edge.piece].body != body)
        continue;
      Result<cad::Face> face = end_face(bodies_[body], e);
      if (!face) return face.error();
      faces.push_back(std::move(*face));
    }
    return faces;
  }

  void add_yarn(std::size_t index, std::vector<cad::Face> faces, std::vector<cad::Part>& parts) const {
    const yarn::Body& body = bodies_[index];
    for (const FaceRegion& region : division_.regions)
      if (region.body == index) faces.push_back(region_face(region));
    std::vector<Shell> shells = shells_of(std::move(faces), 0);
    for (std::size_t i = 0; i < shells.size(); ++i) {
      cad::Part part = part_of(body.name, i, shells);
      part.group = shells.size() == 1 || !body.group.empty() ? body.group : body.name;
      add_part(std::move(part), body.color, static_cast<int>(body.role) + 1, body.place, parts);
    }
  }

  // Shells that lie in no face of the box are round yarns that stand free in the matrix.
  static void add_matrix(std::vector<Shell> shells, std::vector<cad::Part>& parts) {
    std::vector<Shell> outer, voids;
    for (Shell& shell : shells) (shell.in_box_faces ? outer : voids).push_back(std::move(shell));
    for (Shell& inner : voids) {
      auto home = std::find_if(outer.begin(), outer.end(),
                               [&](const Shell& shell) { return shell.box.contains(inner.box); });
      if (home == outer.end()) home = outer.begin();
      std::move(inner.faces.begin(), inner.faces.end(), std::back_inserter(home->faces));
    }
    for (std::size_t i = 0; i < outer.size(); ++i) {
      cad::Part part = part_of(matrix_name, i, outer);
      if (outer.size() > 1) part.group = matrix_name;
      add_part(std::move(part), yarn::Color{}, matrix_level, {}, parts);
    }
  }

  static cad::Part part_of(std::string_view name, std::size_t index, std::vector<Shell>& shells) {
    cad::Part part;
    part.kind = cad::Part::Kind::solid;
    part.name = shells.size() == 1 ? std::string(name) : fmt::format("{}.part{}", name, index + 1);
    part.faces = std::move(shells[index].faces);
    return part;
  }

  static void add_part(cad::Part part, const yarn::Color& color, int level, const TextPlace& place,
                       std::vector<cad::Part>& parts) {
    part.color = color;
    part.level = level;
    part.origin.place = place;
    for (cad::Face& face : part.faces) {
      face.label() = part.label();
    }
    parts.push_back(std::move(part));
  }

  std::span<const yarn::Body> bodies_;
  Box3 box_;
  const Cut& cut_;
  Division division_;
  TubeFaces tubes_;
};

}  // namespace

Result<std::vector<cad::Part>> cad_parts(std::span<const yarn::Body> given, const Box3& box, const Cut& cut,
                                         const CadOptions& options) {
  const std::vector<yarn::Body> bodies = flush(given, box, cut);
  Result<Division> division = divide_faces(bodies, box, cut);
  if (!division) return division.error();
  Result<TubeFaces> tubes = tube_faces(bodies, box, cut, *division, options.tolerance);
  if (!tubes) return tubes.error();
  return CellBuilder(bodies, box, cut, std::move(*division), std::move(*tubes)).run(options.matrix);
}

}  // namespace selvage::cell
