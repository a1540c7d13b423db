#include "solid/occt/shape.h"

#include <fmt/format.h>

#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <ElSLib.hxx>
#include <GProp_GProps.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_Line.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Plane.hxx>
#include <Precision.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TColgp_Array1OfPnt2d.hxx>
#include <TColgp_Array2OfPnt.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopoDS_Wire.hxx>
#include <array>
#include <cmath>
#include <gp_Pln.hxx>

#include "nurbs/turn.h"

namespace selvage::solid::occt {

namespace {

using nurbs::Curve;
using nurbs::Surface;

int as_int(std::size_t n) {
  return static_cast<int>(n);
}

// Knots as OpenCASCADE keeps them: each value once, with its multiplicity.
struct Knots {
  TColStd_Array1OfReal values;
  TColStd_Array1OfInteger multiplicities;
};

Knots different_knots(const std::vector<double>& knots) {
  std::vector<double> values;
  std::vector<int> counts;
  for (double knot : knots) {
    if (values.empty() || knot != values.back()) {
      values.push_back(knot);
      counts.push_back(0);
    }
    ++counts.back();
  }
  Knots result{{1, as_int(values.size())}, {1, as_int(values.size())}};
  for (int i = 0; i < as_int(values.size()); ++i) {
    result.values.SetValue(i + 1, values[static_cast<std::size_t>(i)]);
    result.multiplicities.SetValue(i + 1, counts[static_cast<std::size_t>(i)]);
  }
  return result;
}

}  // namespace

gp_Pnt point(const Vec3& p, double scale) {
  return {scale * p.x(), scale * p.y(), scale * p.z()};
}

double area_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(shape, properties, 1e-9);
  return properties.Mass();
}

Handle(Geom_BSplineCurve) spatial_curve(const Curve& curve, double scale) {
  const int count = as_int(curve.points.size());
  TColgp_Array1OfPnt poles(1, count);
  TColStd_Array1OfReal weights(1, count);
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    poles.SetValue(i + 1, point(curve.points[k], scale));
    weights.SetValue(i + 1, curve.is_rational() ? curve.weights[k] : 1.0);
  }
  const Knots knots = different_knots(curve.knots);
  if (!curve.is_rational())
    return new Geom_BSplineCurve(poles, knots.values, knots.multiplicities, curve.degree);
  return new Geom_BSplineCurve(poles, weights, knots.values, knots.multiplicities, curve.degree);
}

Handle(Geom_BSplineSurface) spatial_surface(const Surface& surface, double scale) {
  TColgp_Array2OfPnt poles(1, surface.count_u, 1, surface.count_v);
  TColStd_Array2OfReal weights(1, surface.count_u, 1, surface.count_v);
  for (int j = 0; j < surface.count_v; ++j)
    for (int i = 0; i < surface.count_u; ++i) {
      poles.SetValue(i + 1, j + 1, point(surface.point(i, j), scale));
      weights.SetValue(i + 1, j + 1, surface.weight(i, j));
    }
  const Knots u = different_knots(surface.knots_u), v = different_knots(surface.knots_v);
  if (!surface.is_rational())
    return new Geom_BSplineSurface(poles, u.values, v.values, u.multiplicities, v.multiplicities,
                                   surface.degree_u, surface.degree_v);
  return new Geom_BSplineSurface(poles, weights, u.values, v.values, u.multiplicities, v.multiplicities,
                                 surface.degree_u, surface.degree_v);
}

namespace {

// The straight line in parameter space that runs from `from` to `to` while the edge's parameter runs from
// first to last.
Handle(Geom2d_Curve) straight(double first, double last, const gp_Pnt2d& from, const gp_Pnt2d& to) {
  const double length = last - first;
  if (from.Distance(to) ==
      length)  // runs with the edge's own speed: a line, its zero where the parameter is 0
    return new Geom2d_Line(from.Translated(gp_Vec2d(from, to) * (-first / length)),
                           gp_Dir2d(gp_Vec2d(from, to)));
  TColgp_Array1OfPnt2d poles(1, 2);
  poles.SetValue(1, from);
  poles.SetValue(2, to);
  TColStd_Array1OfReal knots(1, 2);
  knots.SetValue(1, first);
  knots.SetValue(2, last);
  TColStd_Array1OfInteger multiplicities(1, 2);
  multiplicities.Init(2);
  return new Geom2d_BSplineCurve(poles, knots, multiplicities, 1);
}

// A curve that lies in a plane, in the plane's own coordinates.
Handle(Geom2d_Curve) in_plane(const Curve& curve, double scale, const gp_Pln& plane) {
  const Handle(Geom_BSplineCurve) spatial = spatial_curve(curve, scale);
  TColgp_Array1OfPnt2d poles(1, spatial->NbPoles());
  for (int i = 1; i <= spatial->NbPoles(); ++i) {
    double x = 0.0, y = 0.0;
    ElSLib::Parameters(plane, spatial->Pole(i), x, y);
    poles.SetValue(i, {x, y});
  }
  if (!spatial->IsRational())
    return new Geom2d_BSplineCurve(poles, spatial->Knots(), spatial->Multiplicities(), curve.degree);
  TColStd_Array1OfReal weights(1, spatial->NbPoles());
  spatial->Weights(weights);
  return new Geom2d_BSplineCurve(poles, weights, spatial->Knots(), spatial->Multiplicities(), curve.degree);
}

// A closed or open run of edges, each from one corner to the next, along the outline of one end.
struct Outline {
  std::vector<TopoDS_Vertex> corners;
  std::vector<TopoDS_Edge> edges;
  std::vector<double> parameters;  // of the body's u: one more than edges
};

class ShapeBuilder {
 public:
  ShapeBuilder(const yarn::Body& body, double scale) : body_(body), scale_(scale) {}

  YarnShape build() {
    builder_.MakeShell(shell_);
    closed_ = true;
    if (body_.closed_along) {
      add_ring();
    } else {
      const Outline start = make_outline(false), end = make_outline(true);
      add_tube(start, end);
      close_end(start, false);
      close_end(end, true);
    }
    YarnShape result{shell_, closed_, std::move(defects_)};
    if (closed_) {
      shell_.Closed(true);
      TopoDS_Solid solid;
      builder_.MakeSolid(solid);
      builder_.Add(solid, shell_);
      result.shape = solid;
    }
    return result;
  }

 private:
  TopoDS_Vertex make_vertex(const gp_Pnt& at) {
    TopoDS_Vertex vertex;
    builder_.MakeVertex(vertex, at, Precision::Confusion());
    return vertex;
  }

  TopoDS_Edge make_edge(const Curve& curve, const TopoDS_Vertex& from, const TopoDS_Vertex& to) {
    TopoDS_Edge edge;
    builder_.MakeEdge(edge, spatial_curve(curve, scale_), Precision::Confusion());
    builder_.Add(edge, from.Oriented(TopAbs_FORWARD));
    builder_.Add(edge, to.Oriented(TopAbs_REVERSED));
    builder_.Range(edge, curve.first_parameter(), curve.last_parameter());
    return edge;
  }

  TopoDS_Face make_face(const Handle(Geom_Surface) & surface) {
    TopoDS_Face face;
    builder_.MakeFace(face, surface, Precision::Confusion());
    return face;
  }

  void set_pcurve(const TopoDS_Edge& edge, const Handle(Geom2d_Curve) & curve, const TopoDS_Face& face) {
    builder_.UpdateEdge(edge, curve, face, Precision::Confusion());
  }

  // A seam: one edge with two curves on the same face, the first where the edge runs forward round the face.
  void set_seam(const TopoDS_Edge& edge, const Handle(Geom2d_Curve) & forward,
                const Handle(Geom2d_Curve) & reversed, const TopoDS_Face& face) {
    builder_.UpdateEdge(edge, forward, reversed, face, Precision::Confusion());
  }

  void finish_face(TopoDS_Face& face, const std::vector<TopoDS_Shape>& edges, bool inward) {
    TopoDS_Wire wire;
    builder_.MakeWire(wire);
    for (const TopoDS_Shape& edge : edges) builder_.Add(wire, edge);
    wire.Closed(true);
    builder_.Add(face, wire);
    builder_.Add(shell_, face.Oriented(inward ? TopAbs_REVERSED : TopAbs_FORWARD));
  }

  Outline make_outline(bool last) {
    Outline outline;
    const yarn::EndFace& face = last ? body_.end : body_.start;
    const auto corner = [&](const Curve& curve) { return make_vertex(point(curve.points.front(), scale_)); };
    if (face.style == yarn::EndStyle::patch) {
      const std::array<Curve, 4> quarters = yarn::end_quarters(body_, last);
      for (const Curve& quarter : quarters) outline.corners.push_back(corner(quarter));
      for (std::size_t i = 0; i < 4; ++i) {
        outline.edges.push_back(make_edge(quarters[i], outline.corners[i], outline.corners[(i + 1) % 4]));
        outline.parameters.push_back(quarters[i].first_parameter());
      }
    } else {
      const Curve whole = yarn::end_curve(body_, last);
      outline.corners.push_back(corner(whole));
      outline.edges.push_back(make_edge(whole, outline.corners[0], outline.corners[0]));
      outline.parameters.push_back(whole.first_parameter());
    }
    outline.parameters.push_back(body_.surface.last_u());
    return outline;
  }

  void add_tube(const Outline& start, const Outline& end) {
    const Surface& s = body_.surface;
    const double u0 = s.first_u(), u1 = s.last_u(), v0 = s.first_v(), v1 = s.last_v();
    TopoDS_Face face = make_face(spatial_surface(s, scale_));
    const TopoDS_Edge seam = make_edge(nurbs::boundary_column(s, false), start.corners[0], end.corners[0]);
    set_seam(seam, straight(v0, v1, {u1, v0}, {u1, v1}), straight(v0, v1, {u0, v0}, {u0, v1}), face);
    const auto set_row = [&](const Outline& outline, double v) {
      for (std::size_t i = 0; i < outline.edges.size(); ++i) {
        const double from = outline.parameters[i], to = outline.parameters[i + 1];
        set_pcurve(outline.edges[i], straight(from, to, {from, v}, {to, v}), face);
      }
    };
    set_row(start, v0);
    set_row(end, v1);
    std::vector<TopoDS_Shape> edges(start.edges.begin(), start.edges.end());
    edges.push_back(seam);
    for (auto edge = end.edges.rbegin(); edge != end.edges.rend(); ++edge) edges.push_back(edge->Reversed());
    edges.push_back(seam.Reversed());
    finish_face(face, edges, body_.inward);
  }

  void add_ring() {
    const Surface& s = body_.surface;
    const double u0 = s.first_u(), u1 = s.last_u(), v0 = s.first_v(), v1 = s.last_v();
    TopoDS_Face face = make_face(spatial_surface(s, scale_));
    const TopoDS_Vertex vertex = make_vertex(point(s.point(0, 0), scale_));
    const TopoDS_Edge round = make_edge(yarn::end_curve(body_, false), vertex, vertex);
    const TopoDS_Edge along = make_edge(nurbs::boundary_column(s, false), vertex, vertex);
    set_seam(round, straight(u0, u1, {u0, v0}, {u1, v0}), straight(u0, u1, {u0, v1}, {u1, v1}), face);
    set_seam(along, straight(v0, v1, {u1, v0}, {u1, v1}), straight(v0, v1, {u0, v0}, {u0, v1}), face);
    finish_face(face, {round, along, round.Reversed(), along.Reversed()}, body_.inward);
  }

  void close_end(const Outline& shared, bool last) {
    const yarn::EndFace& end = last ? body_.end : body_.start;
    if (end.style == yarn::EndStyle::none) {
      closed_ = false;
      return;
    }
    const double gap = yarn::end_gap(body_, last);
    if (gap <= relative_tolerance * thickness(body_)) {
      add_end(end, shared, last);
      return;
    }
    closed_ = false;
    defects_.push_back(error(
        Kind::geometry,
        fmt::format("yarn '{}': its {} face stands {:.3g} off the body's {} curve, so it does not close "
                    "the yarn; build the ends anew from the body, or check the points of that end",
                    body_.name, last ? "end" : "start", gap, last ? "end" : "start"),
        about(body_, end.origin)));
    add_end(end, own_outline(end, shared), last);
  }

  // Edges for an end face that does not meet its body, made from the face itself.
  Outline own_outline(const yarn::EndFace& end, const Outline& shared) {
    Outline own = shared;
    own.corners.clear();
    own.edges.clear();
    std::vector<Curve> sides;
    const Surface& s = end.surface;
    if (end.style == yarn::EndStyle::patch) {
      const std::array<Curve, 4> round = nurbs::boundary_round(s);
      sides.assign(round.begin(), round.end());
    } else if (end.style == yarn::EndStyle::fan) {
      sides = {nurbs::boundary_row(s, false)};
    } else {
      Curve projected = yarn::end_curve(body_, &end == &body_.end);
      for (Vec3& p : projected.points) p -= (p - end.origin).dot(end.normal) * end.normal;
      sides = {projected};
    }
    for (const Curve& side : sides) own.corners.push_back(make_vertex(point(side.points.front(), scale_)));
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const double from = own.parameters[i], to = own.parameters[i + 1];
      const double first = sides[i].first_parameter(), length = sides[i].last_parameter() - first;
      for (double& knot : sides[i].knots) knot = from + (knot - first) / length * (to - from);
      own.edges.push_back(make_edge(sides[i], own.corners[i], own.corners[(i + 1) % sides.size()]));
    }
    return own;
  }

  void add_end(const yarn::EndFace& end, const Outline& outline, bool last) {
    if (end.style == yarn::EndStyle::patch) add_patch(end, outline);
    if (end.style == yarn::EndStyle::fan) add_fan(end, outline);
    if (end.style == yarn::EndStyle::planar) add_plane(end, outline, last);
  }

  void add_patch(const yarn::EndFace& end, const Outline& outline) {
    const Surface& s = end.surface;
    const double u0 = s.first_u(), u1 = s.last_u(), v0 = s.first_v(), v1 = s.last_v();
    const std::array<gp_Pnt2d, 5> corners = {gp_Pnt2d(u0, v0), {u1, v0}, {u1, v1}, {u0, v1}, {u0, v0}};
    TopoDS_Face face = make_face(spatial_surface(s, scale_));
    for (std::size_t i = 0; i < 4; ++i)
      set_pcurve(outline.edges[i],
                 straight(outline.parameters[i], outline.parameters[i + 1], corners[i], corners[i + 1]),
                 face);
    finish_face(face, {outline.edges.begin(), outline.edges.end()}, end.inward);
  }

  void add_fan(const yarn::EndFace& end, const Outline& outline) {
    const Surface& s = end.surface;
    const double u0 = s.first_u(), u1 = s.last_u(), v0 = s.first_v(), v1 = s.last_v();
    TopoDS_Face face = make_face(spatial_surface(s, scale_));
    const TopoDS_Vertex centre = make_vertex(point(s.point(0, s.count_v - 1), scale_));
    const TopoDS_Edge seam = make_edge(nurbs::boundary_column(s, false), outline.corners[0], centre);
    set_seam(seam, straight(v0, v1, {u1, v0}, {u1, v1}), straight(v0, v1, {u0, v0}, {u0, v1}), face);
    set_pcurve(outline.edges[0], straight(u0, u1, {u0, v0}, {u1, v0}), face);
    // The pole: an edge in parameter space only.
    TopoDS_Edge pole;
    builder_.MakeEdge(pole);
    set_pcurve(pole, straight(u0, u1, {u0, v1}, {u1, v1}), face);
    builder_.Add(pole, centre.Oriented(TopAbs_FORWARD));
    builder_.Add(pole, centre.Oriented(TopAbs_REVERSED));
    builder_.Range(pole, u0, u1);
    builder_.Degenerated(pole, true);
    finish_face(face, {outline.edges[0], seam, pole.Reversed(), seam.Reversed()}, end.inward);
  }

  void add_plane(const yarn::EndFace& end, const Outline& outline, bool last) {
    const gp_Dir normal(end.normal.x(), end.normal.y(), end.normal.z());
    const Handle(Geom_Plane) plane = new Geom_Plane(point(end.origin, scale_), normal);
    TopoDS_Face face = make_face(plane);
    set_pcurve(outline.edges[0], in_plane(yarn::end_curve(body_, last), scale_, plane->Pln()), face);
    // Seen from outside, the outline runs against the body's use of it.
    const bool forward = last != body_.inward;
    finish_face(face, {outline.edges[0].Oriented(forward ? TopAbs_FORWARD : TopAbs_REVERSED)}, false);
  }

  const yarn::Body& body_;
  double scale_;
  BRep_Builder builder_;
  TopoDS_Shell shell_;
  bool closed_ = false;
  std::vector<Message> defects_;
};

}  // namespace

YarnShape build_shape(const yarn::Body& body, double scale) {
  return ShapeBuilder(body, scale).build();
}

double thickness(const yarn::Body& body) {
  if (body.end_area > 0) return std::sqrt(body.end_area);
  return 0.1 * yarn::bounds(body).diagonal().norm();
}

double unit_scale(const yarn::Body& body) {
  return std::exp2(-std::round(std::log2(thickness(body))));
}

}  // namespace selvage::solid::occt
