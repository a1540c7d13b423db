#include "formats/step/part_shape.h"

#include <fmt/format.h>

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepClass_FaceClassifier.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom_Plane.hxx>
#include <Precision.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <ShapeFix_Face.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <gp_Ax3.hxx>
#include <map>
#include <tuple>

#include "cad/edges.h"
#include "cad/feet.h"
#include "cad/region.h"
#include "cad/sampled_curve.h"
#include "cad/seam.h"
#include "formats/step/faces.h"
#include "formats/step/geometry.h"
#include "solid/occt/faults.h"
#include "solid/occt/shape.h"

namespace selvage::formats::step {

namespace {

Handle(Geom2d_BSplineCurve) flat_curve(const nurbs::Curve& flat) {
  nurbs::Curve spatial = flat;
  const Handle(Geom_BSplineCurve) spline = solid::occt::spatial_curve(spatial, 1.0);
  TColgp_Array1OfPnt2d poles(1, spline->NbPoles());
  TColStd_Array1OfReal weights(1, spline->NbPoles());
  for (int i = 1; i <= spline->NbPoles(); ++i) {
    poles.SetValue(i, {spline->Pole(i).X(), spline->Pole(i).Y()});
    weights.SetValue(i, spline->Weight(i));
  }
  if (!flat.is_rational())
    return new Geom2d_BSplineCurve(poles, spline->Knots(), spline->Multiplicities(), flat.degree);
  return new Geom2d_BSplineCurve(poles, weights, spline->Knots(), spline->Multiplicities(), flat.degree);
}

// One vertex for all ends of edges that are one place.
class Vertices {
 public:
  explicit Vertices(double tolerance) : tolerance_(tolerance) {}

  TopoDS_Vertex at(const Vec3& place) {
    const Cell home = cell(place);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          const Cell near{std::get<0>(home) + dx, std::get<1>(home) + dy, std::get<2>(home) + dz};
          const auto found = cells_.find(near);
          if (found == cells_.end()) continue;
          for (const TopoDS_Vertex& vertex : found->second)
            if ((vector_of(BRep_Tool::Pnt(vertex)) - place).norm() <= tolerance_) return vertex;
        }
    TopoDS_Vertex vertex;
    BRep_Builder().MakeVertex(vertex, gp_Pnt(place.x(), place.y(), place.z()), tolerance_);
    cells_[home].push_back(vertex);
    return vertex;
  }

 private:
  using Cell = std::tuple<double, double, double>;  // whole numbers
  [[nodiscard]] Cell cell(const Vec3& p) const {
    const Vec3 q = (p / (2 * tolerance_)).array().floor();
    return {q.x(), q.y(), q.z()};
  }

  double tolerance_;
  std::map<Cell, std::vector<TopoDS_Vertex>> cells_;
};

class PartBuilder {
 public:
  PartBuilder(const cad::Part& part, double tolerance)
      : part_(part), tolerance_(tolerance), vertices_(tolerance) {}

  PartShape build() {
    if (is_stated(part_)) {
      PartShape result = stated();
      if (BRepCheck_Analyzer(result.shape).IsValid()) return result;
      shared_.clear();
    }
    std::vector<TopoDS_Face> faces;
    for (const cad::Face& face : part_.faces) faces.push_back(build_face(cad::with_seam_in_gap(face)));
    return part_.kind == cad::Part::Kind::surfaces ? loose(faces) : joined(faces);
  }

 private:
  // Nothing has to be found: every edge has both its curves, and an id that two faces share.
  static bool is_stated(const cad::Part& part) {
    if (part.kind != cad::Part::Kind::solid || !cad::has_shared_edges(part)) return false;
    for (const cad::Face& face : part.faces) {
      if (face.loops.empty()) return false;
      for (const cad::Edge& edge : cad::edges_of(face))
        if (edge.curve.points.empty() || edge.flat.points.empty() ||
            edge.curve.first_parameter() != edge.flat.first_parameter() ||
            edge.curve.last_parameter() != edge.flat.last_parameter())
          return false;
    }
    return true;
  }

  // One shell for all faces that hang together, in the order of their first ones.
  PartShape stated() {
    PartShape result;
    std::vector<TopoDS_Face> faces;
    for (const cad::Face& face : part_.faces) faces.push_back(stated_face(face));
    TopoDS_Solid solid;
    builder_.MakeSolid(solid);
    for (const std::vector<std::size_t>& group : cad::shells_of(part_.faces)) {
      TopoDS_Shell shell;
      builder_.MakeShell(shell);
      for (const std::size_t i : group) builder_.Add(shell, faces[i]);
      shell.Closed(true);
      builder_.Add(solid, shell);
    }
    for (const auto& [id, edge] : shared_) BRepLib::SameParameter(edge, Precision::Confusion());
    BRepLib::UpdateTolerances(solid);
    result.shape = solid;
    result.closed = true;
    result.faces.assign(faces.begin(), faces.end());
    return result;
  }

  TopoDS_Face stated_face(const cad::Face& face) {
    TopoDS_Face built;
    builder_.MakeFace(built, surface_of(face.surface), Precision::Confusion());
    for (const cad::Loop& loop : face.loops) {
      TopoDS_Wire wire;
      builder_.MakeWire(wire);
      for (const cad::Edge& edge : loop.edges) {
        auto known = shared_.find(edge.id);
        if (known == shared_.end()) known = shared_.emplace(edge.id, spatial_edge(edge.curve)).first;
        const TopoDS_Edge use = turned(known->second, edge);
        const bool forward = use.Orientation() == TopAbs_FORWARD;
        builder_.UpdateEdge(known->second, flat_curve(forward ? edge.flat : nurbs::reversed(edge.flat)),
                            built, Precision::Confusion());
        builder_.Add(wire, use);
      }
      wire.Closed(true);
      builder_.Add(built, wire);
    }
    if (face.reversed) built.Reverse();
    return built;
  }

  // A rectangle whose parameters are lengths is a plane with the same parameters.
  static Handle(Geom_Surface) surface_of(const nurbs::Surface& surface) {
    if (surface.degree_u == 1 && surface.degree_v == 1 && surface.count_u == 2 && surface.count_v == 2 &&
        !surface.is_rational()) {
      const Vec3 &a = surface.points[0], &b = surface.points[1], &c = surface.points[2],
                 &d = surface.points[3];
      const double length_u = surface.last_u() - surface.first_u(),
                   length_v = surface.last_v() - surface.first_v();
      const Vec3 x = (b - a) / length_u, y = (c - a) / length_v;
      const double size = length_u + length_v;
      if (((b - a) - (d - c)).norm() < 1e-12 * size && std::abs(x.norm() - 1) < 1e-12 &&
          std::abs(y.norm() - 1) < 1e-12 && std::abs(x.dot(y)) < 1e-12) {
        const Vec3 origin = a - surface.first_u() * x - surface.first_v() * y, normal = x.cross(y);
        return new Geom_Plane(gp_Ax3(gp_Pnt(origin.x(), origin.y(), origin.z()),
                                     gp_Dir(normal.x(), normal.y(), normal.z()),
                                     gp_Dir(x.x(), x.y(), x.z())));
      }
    }
    return solid::occt::spatial_surface(surface, 1.0);
  }

  TopoDS_Face build_face(const cad::Face& face) {
    const Handle(Geom_BSplineSurface) surface = solid::occt::spatial_surface(face.surface, 1.0);
    TopoDS_Face built;
    if (face.loops.empty()) {
      BRepBuilderAPI_MakeFace maker(surface, Precision::Confusion());
      if (!maker.IsDone()) throw Standard_Failure("a surface that makes no face");
      built = maker.Face();
    } else if (const std::optional<TopoDS_Face> on_plane = face_on_plane(face)) {
      built = *on_plane;
    } else if (const std::optional<TopoDS_Face> by_flats = face_by_flats(face)) {
      built = *by_flats;
    } else if (const std::optional<TopoDS_Face> by_own_flats = face_by_flats(with_flats(face))) {
      built = *by_own_flats;
    } else {
      builder_.MakeFace(built, surface, Precision::Confusion());
      for (const cad::Loop& loop : face.loops) builder_.Add(built, build_wire(loop, surface));
      built = fixed(built);
    }
    if (face.reversed) built.Reverse();
    return built;
  }

  // A trimmed rectangle is its plane: curves in a plane's parameters are those in space, to the last digit.
  // Nothing where an edge has no curve in space, or OpenCASCADE does not find that valid.
  std::optional<TopoDS_Face> face_on_plane(const cad::Face& face) {
    const nurbs::Surface& s = face.surface;
    if (s.degree_u != 1 || s.degree_v != 1 || s.count_u != 2 || s.count_v != 2) return std::nullopt;
    for (const cad::Edge& edge : cad::edges_of(face))
      if (edge.curve.points.empty()) return std::nullopt;
    const Vec3 &a = s.points[0], x = s.points[1] - a, y = s.points[2] - a, normal = x.cross(y);
    const double size = x.norm() + y.norm();
    if (!(normal.norm() > 1e-9 * size * size)) return std::nullopt;
    if (std::abs((s.points[3] - a).dot(normal.normalized())) > 1e-12 * size) return std::nullopt;
    const Handle(Geom_Plane) plane =
        new Geom_Plane(gp_Ax3(gp_Pnt(a.x(), a.y(), a.z()), gp_Dir(normal.x(), normal.y(), normal.z()),
                              gp_Dir(x.x(), x.y(), x.z())));
    TopoDS_Face built;
    builder_.MakeFace(built, plane, Precision::Confusion());
    for (const cad::Loop& loop : face.loops) builder_.Add(built, build_wire(loop, plane));
    built = fixed(built);
    if (!BRepCheck_Analyzer(built).IsValid()) return std::nullopt;
    return built;
  }

  // A trimmed face that shares no edges, by the curves that the file has in the surface's parameters; nothing
  // where it has not all of them, or OpenCASCADE does not find that valid.
  std::optional<TopoDS_Face> face_by_flats(const cad::Face& face) {
    for (const cad::Edge& edge : cad::edges_of(face))
      if (edge.flat.points.empty() || edge.id >= 0) return std::nullopt;
    TopoDS_Face built;
    builder_.MakeFace(built, solid::occt::spatial_surface(face.surface, 1.0), Precision::Confusion());
    for (const cad::Loop& loop : face.loops) {
      const std::vector<TopoDS_Vertex> corners = corners_of(face, loop);
      TopoDS_Wire wire;
      builder_.MakeWire(wire);
      for (std::size_t i = 0; i < loop.edges.size(); ++i) {
        const TopoDS_Vertex &from = corners[i], &to = corners[(i + 1) % corners.size()];
        builder_.Add(wire, edge_by_flat(loop.edges[i], from, to, built));
      }
      wire.Closed(true);
      builder_.Add(built, wire);
    }
    BRepLib::UpdateTolerances(built);
    built = turned_outward(built);
    if (!BRepCheck_Analyzer(built).IsValid()) return std::nullopt;
    return built;
  }

  static cad::Face with_flats(cad::Face face) {
    cad::give_flats(face, 1e-8 * cad::box_of(face.surface.points).diagonal().norm());
    return face;
  }

  static Vec3 end_of(const cad::Face& face, const cad::Edge& edge, double share) {
    return edge.curve.points.empty() ? cad::at_share(face.surface, edge.flat, share)
                                     : cad::at_share(edge.curve, share);
  }

  // Where each edge of a loop begins; edges that follow each other meet, as far as the file leaves them
  // apart.
  std::vector<TopoDS_Vertex> corners_of(const cad::Face& face, const cad::Loop& loop) {
    std::vector<TopoDS_Vertex> corners;
    for (std::size_t i = 0; i < loop.edges.size(); ++i) {
      const cad::Edge& before = loop.edges[(i + loop.edges.size() - 1) % loop.edges.size()];
      const Vec3 to = end_of(face, before, 1), from = end_of(face, loop.edges[i], 0);
      const Vec3 middle = 0.5 * (to + from);
      builder_.MakeVertex(corners.emplace_back(), gp_Pnt(middle.x(), middle.y(), middle.z()),
                          0.5 * (to - from).norm() + Precision::Confusion());
    }
    return corners;
  }

  TopoDS_Edge edge_by_flat(const cad::Edge& edge, const TopoDS_Vertex& from, const TopoDS_Vertex& to,
                           const TopoDS_Face& face) {
    const bool has_curve = !edge.curve.points.empty();
    nurbs::Curve flat = edge.flat;
    if (has_curve) flat.knots = stretched(flat, edge.curve.first_parameter(), edge.curve.last_parameter());
    TopoDS_Edge built;
    if (has_curve)
      builder_.MakeEdge(built, solid::occt::spatial_curve(edge.curve, 1.0), Precision::Confusion());
    else
      builder_.MakeEdge(built);
    builder_.UpdateEdge(built, flat_curve(flat), face, Precision::Confusion());
    builder_.Add(built, from.Oriented(TopAbs_FORWARD));
    builder_.Add(built, to.Oriented(TopAbs_REVERSED));
    builder_.Range(built, flat.first_parameter(), flat.last_parameter());
    if (has_curve) {
      builder_.SameParameter(built, false);
      BRepLib::SameParameter(built, Precision::Confusion());
    } else if (from.IsSame(to) || is_pole(face, flat)) {
      builder_.Degenerated(built, true);
    } else {
      BRepLib::BuildCurve3d(built);
    }
    return built;
  }

  static std::vector<double> stretched(const nurbs::Curve& curve, double first, double last) {
    const double from = curve.first_parameter(), factor = (last - first) / (curve.last_parameter() - from);
    std::vector<double> knots = curve.knots;
    for (double& knot : knots) knot = knot == curve.last_parameter() ? last : first + factor * (knot - from);
    return knots;
  }

  [[nodiscard]] bool is_pole(const TopoDS_Face& face, const nurbs::Curve& flat) const {
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
    const auto at = [&](double share) {
      const Vec3 p = cad::at_share(flat, share);
      return vector_of(surface->Value(p.x(), p.y()));
    };
    const Vec3 start = at(0);
    return (at(0.31) - start).norm() <= tolerance_ && (at(0.77) - start).norm() <= tolerance_ &&
           (at(1) - start).norm() <= tolerance_;
  }

  // Curves in parameter space, seams and orientations, which a STEP file does not need but sewing does.
  static TopoDS_Face fixed(const TopoDS_Face& face) {
    const Handle(ShapeFix_Face) fix = new ShapeFix_Face(face);
    fix->Perform();
    const TopoDS_Shape result = fix->Result();
    if (result.IsNull() || result.ShapeType() != TopAbs_FACE) return face;
    return turned_outward(TopoDS::Face(result));
  }

  // Loops that run clockwise are turned round, which ShapeFix_Face::Perform() does not always do.
  static TopoDS_Face turned_outward(const TopoDS_Face& face) {
    const Handle(ShapeFix_Face) turn = new ShapeFix_Face(face);
    turn->FixOrientation();
    return TopoDS::Face(turn->Face().Oriented(TopAbs_FORWARD));
  }

  TopoDS_Wire build_wire(const cad::Loop& loop, const Handle(Geom_Surface) & surface) {
    TopoDS_Wire wire;
    builder_.MakeWire(wire);
    for (const cad::Edge& edge : loop.edges) {
      const TopoDS_Edge built = edge_of(edge, surface);
      if (!built.IsNull()) builder_.Add(wire, built);
    }
    wire.Closed(true);
    return wire;
  }

  // In the loop's direction. Poles are left out: OpenCASCADE puts them back.
  TopoDS_Edge edge_of(const cad::Edge& edge, const Handle(Geom_Surface) & surface) {
    if (edge.curve.points.empty() && edge.flat.points.empty()) return {};
    if (edge.id >= 0) {
      const auto known = shared_.find(edge.id);
      if (known != shared_.end()) return turned(known->second, edge);
    }
    TopoDS_Edge built;
    if (!edge.curve.points.empty()) {
      built = spatial_edge(edge.curve);
    } else {
      const auto at = [&](const Vec3& p) { return vector_of(surface->Value(p.x(), p.y())); };
      const Vec3 from = at(edge.flat.points.front()), to = at(edge.flat.points.back());
      BRepBuilderAPI_MakeEdge maker(flat_curve(edge.flat), surface, vertices_.at(from), vertices_.at(to));
      if (!maker.IsDone()) return {};  // of no length
      built = maker.Edge();
      BRepLib::BuildCurve3d(built);
    }
    if (edge.id >= 0) shared_.emplace(edge.id, built);
    return built;
  }

  TopoDS_Edge spatial_edge(const nurbs::Curve& curve) {
    TopoDS_Edge edge;
    builder_.MakeEdge(edge, solid::occt::spatial_curve(curve, 1.0), Precision::Confusion());
    builder_.Add(edge, vertices_.at(curve.points.front()).Oriented(TopAbs_FORWARD));
    builder_.Add(edge, vertices_.at(curve.points.back()).Oriented(TopAbs_REVERSED));
    builder_.Range(edge, curve.first_parameter(), curve.last_parameter());
    return edge;
  }

  // A shared edge in the direction of this use of it, told by a point before its middle (a closed edge has
  // but one end).
  static TopoDS_Edge turned(const TopoDS_Edge& shared, const cad::Edge& use) {
    double first = 0, last = 0;
    const Handle(Geom_Curve) curve = BRep_Tool::Curve(shared, first, last);
    if (use.curve.points.empty() || curve.IsNull()) return TopoDS::Edge(shared.Reversed());
    const auto point = [&](double share) { return vector_of(curve->Value(first + share * (last - first))); };
    const Vec3 mine = cad::at_share(use.curve, 0.25);
    const bool same = (mine - point(0.25)).norm() <= (mine - point(0.75)).norm();
    return same ? shared : TopoDS::Edge(shared.Reversed());
  }

  TopoDS_Shape shell_of(const TopoDS_Shape& face) {
    TopoDS_Shell shell;
    builder_.MakeShell(shell);
    builder_.Add(shell, face);
    return shell;
  }

  PartShape loose(const std::vector<TopoDS_Face>& faces) {
    PartShape result;
    TopoDS_Compound compound;
    builder_.MakeCompound(compound);
    for (const TopoDS_Face& face : faces) builder_.Add(compound, shell_of(face));
    result.shape = faces.size() == 1 ? shell_of(faces.front()) : TopoDS_Shape(compound);
    result.faces.assign(faces.begin(), faces.end());
    return result;
  }

  // Edges of other programs meet within tolerances of their own: what does not close is sewn more loosely.
  PartShape joined(const std::vector<TopoDS_Face>& faces) {
    constexpr std::array<double, 3> looser = {1, 10, 100};
    PartShape result;
    for (const double factor : looser) {
      result = sewn(faces, factor * tolerance_);
      if (result.closed || part_.kind != cad::Part::Kind::solid) break;
    }
    return result;
  }

  PartShape sewn(const std::vector<TopoDS_Face>& faces, double tolerance) {
    BRepBuilderAPI_Sewing sewing(tolerance);
    for (const TopoDS_Face& face : faces) sewing.Add(face);
    sewing.Perform();
    PartShape result;
    result.shape = sewing.SewedShape();
    if (result.shape.IsNull()) throw Standard_Failure("faces that make no shell");
    for (const TopoDS_Face& face : faces) result.faces.push_back(sewing.ModifiedSubShape(face));
    if (result.shape.ShapeType() == TopAbs_FACE) result.shape = shell_of(result.shape);
    if (part_.kind == cad::Part::Kind::solid) make_solid(result);
    return result;
  }

  // The first shell is the outer one.
  void make_solid(PartShape& result) {
    TopoDS_Solid solid;
    builder_.MakeSolid(solid);
    int shells = 0;
    for (TopExp_Explorer it(result.shape, TopAbs_SHELL); it.More(); it.Next(), ++shells) {
      if (!BRep_Tool::IsClosed(it.Current())) return;
      builder_.Add(solid, it.Current());
    }
    if (shells == 0) return;
    if (shells == 1) BRepLib::OrientClosedSolid(solid);
    result.shape = solid;
    result.closed = true;
  }

  const cad::Part& part_;
  double tolerance_;
  BRep_Builder builder_;
  Vertices vertices_;
  std::map<int, TopoDS_Edge> shared_;
};

}  // namespace

PartShape build_part(const cad::Part& part, double tolerance) {
  return PartBuilder(part, tolerance).build();
}

namespace {

// A place of the face, well inside; nothing where its boundary does not tell which side is the face.
std::optional<Vec3> place_inside(const cad::Face& face) {
  constexpr int grid = 9;
  const cad::Region region(face);
  if (!region.is_known()) return std::nullopt;
  const cad::Range& range = region.range();
  for (int k = 0; k < grid * grid; ++k) {
    // From the middle outwards.
    const int i = (k / grid + grid / 2) % grid, j = (k % grid + grid / 2) % grid;
    const auto at = [&](double di, double dj) {
      return Vec2(std::lerp(range.u0, range.u1, (i + 0.5 + di) / grid),
                  std::lerp(range.v0, range.v1, (j + 0.5 + dj) / grid));
    };
    const std::array<Vec2, 5> places = {at(0, 0), at(0.3, 0), at(-0.3, 0), at(0, 0.3), at(0, -0.3)};
    if (std::ranges::all_of(places, [&](const Vec2& p) { return region.contains(p.x(), p.y()); }))
      return nurbs::evaluate(face.surface, places[0].x(), places[0].y());
  }
  return std::nullopt;
}

// Is it on the face that OpenCASCADE has made? Its distance of a point and a face passes over feet on knots.
bool has_place(const TopoDS_Shape& built, const Vec3& place, double size) {
  const gp_Pnt point(place.x(), place.y(), place.z());
  for (TopExp_Explorer it(built, TopAbs_FACE); it.More(); it.Next()) {
    const TopoDS_Face& face = TopoDS::Face(it.Current());
    ShapeAnalysis_Surface surface(BRep_Tool::Surface(face));
    const gp_Pnt2d foot = surface.ValueOfUV(point, Precision::Confusion());
    if (surface.Value(foot).Distance(point) > 1e-3 * size) continue;
    const TopAbs_State side = BRepClass_FaceClassifier(face, foot, Precision::PConfusion()).State();
    if (side == TopAbs_IN || side == TopAbs_ON) return true;
  }
  return false;
}

}  // namespace

std::optional<std::string> flaw_of(const PartShape& built, const cad::Part& part) {
  constexpr std::string_view remedy = "--to iges writes its faces as they are";
  // OpenCASCADE's quadrature of rational surfaces is good for about a percent; what goes wrong loses halves.
  constexpr double same_area = 0.05;
  if (part.kind == cad::Part::Kind::solid && !built.closed)
    return fmt::format("its faces do not close it, and a solid must stay one; {}", remedy);
  const auto who = [&](std::size_t i) {
    const std::string& entity = part.faces[i].origin.entity;
    return entity.empty() ? std::to_string(i + 1) : entity;
  };
  for (std::size_t i = 0; i < part.faces.size(); ++i) {
    const cad::Face& face = part.faces[i];
    if (i >= built.faces.size() || built.faces[i].IsNull())
      return fmt::format("OpenCASCADE loses its face {}; {}", who(i), remedy);
    std::size_t wires = 0;
    for (TopExp_Explorer it(built.faces[i], TopAbs_WIRE); it.More(); it.Next()) ++wires;
    if (!face.loops.empty() && wires != face.loops.size())
      return fmt::format("of the {} boundaries of its face {} OpenCASCADE makes {}; {}", face.loops.size(),
                         who(i), wires, remedy);
    // Faces of solids have directed edges, and areas that were measured.
    const std::optional<Vec3> inside = face.loops.empty() || face.area ? std::nullopt : place_inside(face);
    if (inside && !has_place(built.faces[i], *inside, cad::box_of(face.surface.points).diagonal().norm()))
      return fmt::format("OpenCASCADE takes what is beyond the boundary of its face {} for it; {}", who(i),
                         remedy);
    const double area = face.area ? std::abs(area_of(built.faces[i])) : 0;
    if (face.area && !(std::abs(area - *face.area) <= same_area * *face.area))
      return fmt::format("its face {} has an area of {:.6g}, and OpenCASCADE makes it {:.6g}; {}", who(i),
                         *face.area, area, remedy);
  }
  const std::vector<solid::occt::Fault> faults = solid::occt::faults_of(built.shape);
  if (faults.empty()) return std::nullopt;
  const bool was_so =
      part.kernel && !BRepCheck_Analyzer(*static_cast<const TopoDS_Shape*>(part.kernel.get())).IsValid();
  const std::string start =
      fmt::format("OpenCASCADE's check finds {} invalid", was_so ? "what the file holds" : "the result");
  for (std::size_t i = 0; i < part.faces.size(); ++i)
    if (const auto own = solid::occt::faults_of(built.faces[i]); !own.empty())
      return fmt::format("{} at its face {}: {}; {}", start, who(i), to_string(own.front()), remedy);
  return fmt::format("{}: {}; {}", start, to_string(faults.front()), remedy);
}

std::optional<PartShape> kept_part(const cad::Part& part) {
  if (!part.kernel) return std::nullopt;
  const auto& read = *static_cast<const TopoDS_Shape*>(part.kernel.get());
  gp_Trsf scale;
  scale.SetScale(gp_Pnt(0, 0, 0), part.kernel_scale);
  // Its place goes into its geometry.
  PartShape kept;
  kept.shape = BRepBuilderAPI_Transform(read.Located(TopLoc_Location()),
                                        scale * read.Location().Transformation(), true)
                   .Shape();
  for (TopExp_Explorer it(kept.shape, TopAbs_FACE); it.More(); it.Next()) kept.faces.push_back(it.Current());
  kept.closed = kept.shape.ShapeType() == TopAbs_SOLID;
  if (kept.faces.size() != part.faces.size() || kept.closed != (part.kind == cad::Part::Kind::solid) ||
      !BRepCheck_Analyzer(kept.shape).IsValid())
    return std::nullopt;
  return kept;
}

TopoDS_Edge build_edge(const nurbs::Curve& curve) {
  BRepBuilderAPI_MakeEdge maker(solid::occt::spatial_curve(curve, 1.0));
  if (!maker.IsDone()) throw Standard_Failure("a curve that makes no edge");
  return maker.Edge();
}

}  // namespace selvage::formats::step
