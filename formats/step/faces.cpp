#include "formats/step/faces.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Surface.hxx>
#include <Precision.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Wire.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "cad/edges.h"
#include "cad/feet.h"
#include "cad/sampled_curve.h"
#include "core/plane.h"
#include "formats/step/geometry.h"

namespace selvage::formats::step {

namespace {

using Chain = std::vector<TopoDS_Edge>;  // oriented, in the direction of the loop round the forward face

Chain chain_of(const TopoDS_Wire& wire, const TopoDS_Face& face) {
  Chain listed, linked;
  for (TopoDS_Iterator it(wire); it.More(); it.Next())
    if (it.Value().ShapeType() == TopAbs_EDGE) listed.push_back(TopoDS::Edge(it.Value()));
  for (BRepTools_WireExplorer it(wire, face); it.More() && linked.size() <= listed.size(); it.Next())
    linked.push_back(it.Current());
  if (linked.size() == listed.size()) return linked;
  if (wire.Orientation() == TopAbs_REVERSED) std::reverse(listed.begin(), listed.end());
  return listed;
}

// The outer one first.
std::vector<Chain> chains_of(const TopoDS_Face& face) {
  std::vector<Chain> chains;
  const TopoDS_Wire outer = BRepTools::OuterWire(face);
  for (TopoDS_Iterator it(face); it.More(); it.Next()) {
    if (it.Value().ShapeType() != TopAbs_WIRE) continue;
    Chain chain = chain_of(TopoDS::Wire(it.Value()), face);
    if (chain.empty()) continue;
    if (!outer.IsNull() && it.Value().IsSame(outer))
      chains.insert(chains.begin(), std::move(chain));
    else
      chains.push_back(std::move(chain));
  }
  return chains;
}

// A loop in parameter space as a polygon, in its direction.
constexpr int samples = 8;  // an edge
using Polygon = std::vector<Vec2>;

// Nothing where an edge has no curve there.
Polygon polygon_of(const Chain& chain, const TopoDS_Face& face) {
  Polygon polygon;
  for (const TopoDS_Edge& edge : chain) {
    double first = 0, last = 0;
    const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
    if (curve.IsNull()) return {};
    const bool backward = edge.Orientation() == TopAbs_REVERSED;
    for (int i = 0; i <= samples; ++i) {
      const double share = static_cast<double>(backward ? samples - i : i) / samples;
      const gp_Pnt2d place = curve->Value(first + share * (last - first));
      polygon.emplace_back(place.X(), place.Y());
    }
  }
  return polygon;
}

cad::Range box_of(const Polygon& polygon) {
  Eigen::AlignedBox2d box;
  for (const Vec2& p : polygon) box.extend(p);
  return {box.min().x(), box.max().x(), box.min().y(), box.max().y()};
}

// Do the edge's curves in parameters and in space agree? Files have some that are off by a thousandth of the
// face: then the one in space holds. `surface`: the face's, in its place.
bool has_true_flat(const TopoDS_Edge& edge, const TopoDS_Face& face, const Handle(Geom_Surface) & surface,
                   double tolerance) {
  double first = 0, last = 0, from = 0, to = 0;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, from, to);
  const Handle(Geom2d_Curve) flat = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull() || flat.IsNull() || !BRep_Tool::SameParameter(edge)) return true;
  for (int i = 0; i <= samples; ++i) {
    const double t = first + (last - first) * i / samples;
    const gp_Pnt2d place = flat->Value(t);
    if (surface->Value(place.X(), place.Y()).Distance(curve->Value(t)) > tolerance) return false;
  }
  return true;
}

// How far two parameters may be from each other and be one: what the face's tolerance is there, and no more
// than a ten thousandth of the range.
std::array<double, 2> slack(const TopoDS_Face& face, const cad::Range& range) {
  const BRepAdaptor_Surface adaptor(face, false);
  const double tolerance = std::max(BRep_Tool::Tolerance(face), 10 * Precision::Confusion());
  const auto within = [](double resolution, double width) {
    return std::clamp(resolution, 1e-9 * width, 1e-4 * width);
  };
  return {within(adaptor.UResolution(tolerance), range.u1 - range.u0),
          within(adaptor.VResolution(tolerance), range.v1 - range.v0)};
}

// Does the loop run once round a rectangle of parameters?
bool is_rectangle(const Polygon& polygon, const cad::Range& box, const TopoDS_Face& face) {
  const double width = box.u1 - box.u0, height = box.v1 - box.v0;
  if (!(width > 0) || !(height > 0)) return false;
  const auto [slack_u, slack_v] = slack(face, box);
  for (const Vec2& p : polygon)
    if (p.x() - box.u0 > slack_u && box.u1 - p.x() > slack_u && p.y() - box.v0 > slack_v &&
        box.v1 - p.y() > slack_v)
      return false;
  return std::abs(0.5 * std::abs(twice_area(polygon)) - width * height) <
         4 * (slack_u * height + slack_v * width);
}

// The rectangle brought to a border of the surface that it misses by no more than the slack.
cad::Range snapped(cad::Range box, const cad::Range& whole, const TopoDS_Face& face) {
  const auto [slack_u, slack_v] = slack(face, box);
  const auto snap = [](double& value, double border, double within) {
    if (std::abs(value - border) <= within) value = border;
  };
  snap(box.u0, whole.u0, slack_u);
  snap(box.u1, whole.u1, slack_u);
  snap(box.v0, whole.v0, slack_v);
  snap(box.v1, whole.v1, slack_v);
  return box;
}

bool is_finite(const cad::Range& range) {
  return !Precision::IsInfinite(range.u0) && !Precision::IsInfinite(range.u1) &&
         !Precision::IsInfinite(range.v0) && !Precision::IsInfinite(range.v1);
}

bool is_whole(const cad::Range& box, const cad::Range& whole, const TopoDS_Face& face) {
  const auto [slack_u, slack_v] = slack(face, whole);
  return box.u1 - box.u0 >= whole.u1 - whole.u0 - slack_u && box.v1 - box.v0 >= whole.v1 - whole.v0 - slack_v;
}

nurbs::Curve flat_of(const TopoDS_Edge& edge, const TopoDS_Face& face) {
  double first = 0, last = 0;
  const Handle(Geom2d_Curve) curve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (curve.IsNull()) return {};
  nurbs::Curve flat = to_spline(curve, first, last);
  return edge.Orientation() == TopAbs_REVERSED ? nurbs::reversed(flat) : flat;
}

bool lies_in(const nurbs::Curve& flat, const nurbs::Surface& surface) {
  const double du = 1e-6 * (surface.last_u() - surface.first_u()),
               dv = 1e-6 * (surface.last_v() - surface.first_v());
  return std::all_of(flat.points.begin(), flat.points.end(), [&](const Vec3& p) {
    return p.x() >= surface.first_u() - du && p.x() <= surface.last_u() + du &&
           p.y() >= surface.first_v() - dv && p.y() <= surface.last_v() + dv;
  });
}

class FaceMaker {
 public:
  FaceMaker(const TopoDS_Face& face, const Handle(StepShape_FaceSurface) & entity, double scale, EdgeIds& ids)
      : face_(TopoDS::Face(face.Oriented(TopAbs_FORWARD))), ids_(ids) {
    surface_ = BRep_Tool::Surface(face_, location_);
    if (surface_.IsNull()) throw Standard_Failure("a face without a surface");
    if (!entity.IsNull()) exact_ = exact_spline(entity->FaceGeometry(), scale);
    result_.reversed = face.Orientation() == TopAbs_REVERSED;
  }

  cad::Face make() {
    const std::vector<Chain> chains = chains_of(face_);
    std::vector<Polygon> polygons;
    polygons.reserve(chains.size());
    for (const Chain& chain : chains) polygons.push_back(polygon_of(chain, face_));
    find_untrue(chains);
    const cad::Range whole = bounds_of(surface_);
    if (chains.empty()) {
      if (!is_finite(whole)) throw Standard_Failure("a face without a boundary on an unbounded surface");
      take_surface(whole, whole);
    } else if (untrue_.empty() && polygons.size() == 1 && !polygons[0].empty() &&
               is_rectangle(polygons[0], box_of(polygons[0]), face_)) {
      take_surface(snapped(box_of(polygons[0]), whole, face_), whole);
      result_.border = loops_of(chains);
    } else {
      take_surface(trimmed_range(polygons, whole), whole);
      result_.loops = loops_of(chains);
      complete();
    }
    return std::move(result_);
  }

 private:
  void find_untrue(const std::vector<Chain>& chains) {
    Bnd_Box box;
    BRepBndLib::AddClose(face_, box);
    const double size = box.IsVoid() ? 0 : std::sqrt(box.SquareExtent());
    const double tolerance = std::max(10 * Precision::Confusion(), 1e-5 * size);
    const Handle(Geom_Surface) placed = BRep_Tool::Surface(face_);
    for (const Chain& chain : chains)
      for (const TopoDS_Edge& edge : chain)
        if (!has_true_flat(edge, face_, placed, tolerance)) untrue_.insert(edge.TShape().get());
  }

  void take_surface(const cad::Range& range, const cad::Range& whole) {
    const bool is_spline = surface_->IsKind(STANDARD_TYPE(Geom_BSplineSurface));
    result_.surface = exact_ && is_spline && is_whole(range, whole, face_) ? std::move(*exact_)
                                                                           : to_spline(surface_, range);
    place(result_.surface.points, location_.Transformation());
  }

  // B-spline surfaces are kept whole under their loops; others are given where the loops are.
  [[nodiscard]] cad::Range trimmed_range(const std::vector<Polygon>& polygons,
                                         const cad::Range& whole) const {
    if (surface_->IsKind(STANDARD_TYPE(Geom_BSplineSurface))) return whole;
    Polygon all;
    for (const Polygon& polygon : polygons) all.insert(all.end(), polygon.begin(), polygon.end());
    cad::Range box = whole;
    if (!all.empty()) {
      const cad::Range used = box_of(all);
      follow(used.u0, used.u1, surface_->IsUPeriodic(), box.u0, box.u1);
      follow(used.v0, used.v1, surface_->IsVPeriodic(), box.v0, box.v1);
    }
    if (!is_finite(box)) throw Standard_Failure("a face without a boundary on an unbounded surface");
    return box;
  }

  // A range that holds the loops' own: they may run over a periodic surface's seam. Between two samples a
  // curve may bulge out. A surface that is not closed where the loops leave a gap has its sides in that gap:
  // an edge that lies on a seam has two places in the parameters, and who projects it may take the wrong one.
  static void follow(double used_low, double used_high, bool is_periodic, double& low, double& high) {
    constexpr double least_gap = 1e-3;  // of the period
    const double used = used_high - used_low, period = high - low, gap = period - used;
    const double slack = is_periodic ? std::min(0.05 * used, 0.4 * gap) : 0.05 * used;
    if (!is_periodic) {
      low = std::max(used_low - slack, low);
      high = std::min(used_high + slack, high);
    } else if (gap > least_gap * period) {
      low = used_low - slack;
      high = used_high + slack;
    } else {
      low = used_low;
      high = used_low + period;
    }
  }

  std::vector<cad::Loop> loops_of(const std::vector<Chain>& chains) {
    std::vector<cad::Loop> loops;
    const bool has_flats = keeps_parameters(surface_);
    for (const Chain& chain : chains) {
      cad::Loop loop;
      for (const TopoDS_Edge& edge : chain) {
        cad::Edge piece;
        piece.curve = to_curve(edge);
        if (piece.curve.points.empty() || (has_flats && !untrue_.contains(edge.TShape().get())))
          piece.flat = flat_of(edge, face_);
        if (!lies_in(piece.flat, result_.surface)) piece.flat = {};
        piece.id = ids_.try_emplace(edge.TShape().get(), static_cast<int>(ids_.size())).first->second;
        if (piece.curve.points.empty() && piece.flat.points.empty()) continue;
        loop.edges.push_back(std::move(piece));
      }
      if (!loop.edges.empty()) loops.push_back(std::move(loop));
    }
    return loops;
  }

  // A loop that is known neither all in space nor all in the parameters becomes known in these.
  void complete() {
    const double tolerance = 1e-8 * cad::box_of(result_.surface.points).diagonal().norm();
    const auto lacks_curve = [&](const cad::Edge& edge) {
      return edge.curve.points.empty() && !cad::is_point(result_.surface, edge.flat, 100 * tolerance);
    };
    for (const cad::Loop& loop : result_.loops)
      if (std::ranges::any_of(loop.edges, lacks_curve)) return cad::give_flats(result_, tolerance);
  }

  TopoDS_Face face_;
  EdgeIds& ids_;
  TopLoc_Location location_;
  Handle(Geom_Surface) surface_;
  std::optional<nurbs::Surface> exact_;
  std::unordered_set<const TopoDS_TShape*> untrue_;  // edges whose curves do not agree
  cad::Face result_;
};

}  // namespace

cad::Face to_face(const TopoDS_Face& face, const Handle(StepShape_FaceSurface) & entity, double scale,
                  EdgeIds& ids) {
  cad::Face made = FaceMaker(face, entity, scale, ids).make();
  made.area = std::abs(area_of(face));  // negative where the loop runs the wrong way round
  return made;
}

void stretch(nurbs::Curve& curve, double factor) {
  for (Vec3& p : curve.points) p *= factor;
}

void stretch(cad::Face& face, double factor) {
  for (Vec3& p : face.surface.points) p *= factor;
  for (cad::Edge& edge : cad::boundary_edges_of(face)) stretch(edge.curve, factor);
  if (face.area) *face.area *= factor * factor;
}

double area_of(const TopoDS_Shape& face) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties);
  return properties.Mass();
}

nurbs::Curve to_curve(const TopoDS_Edge& edge) {
  if (BRep_Tool::Degenerated(edge)) return {};
  double first = 0, last = 0;
  TopLoc_Location location;
  const Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, location, first, last);
  if (curve.IsNull()) return {};
  nurbs::Curve spline = to_spline(curve, first, last);
  place(spline.points, location.Transformation());
  return edge.Orientation() == TopAbs_REVERSED ? nurbs::reversed(spline) : spline;
}

}  // namespace selvage::formats::step
