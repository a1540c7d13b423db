#include "formats/step/geometry.h"

#include <Geom2dConvert.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Conic.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <StepGeom_BSplineSurfaceWithKnots.hxx>
#include <StepGeom_BSplineSurfaceWithKnotsAndRationalBSplineSurface.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <algorithm>
#include <cmath>

#include "nurbs/basis.h"

namespace selvage::formats::step {

namespace {

Vec3 vector_of(const gp_Pnt& p) {
  return {p.X(), p.Y(), p.Z()};
}
Vec3 vector_of(const gp_Pnt2d& p) {
  return {p.X(), p.Y(), 0.0};
}

template <class SplineHandle>
nurbs::Curve from_spline(const SplineHandle& spline) {
  if (spline->IsPeriodic()) spline->SetNotPeriodic();
  nurbs::Curve curve;
  curve.degree = spline->Degree();
  for (int i = 1; i <= spline->NbKnots(); ++i)
    curve.knots.insert(curve.knots.end(), static_cast<std::size_t>(spline->Multiplicity(i)), spline->Knot(i));
  for (int i = 1; i <= spline->NbPoles(); ++i) {
    curve.points.push_back(vector_of(spline->Pole(i)));
    if (spline->IsRational()) curve.weights.push_back(spline->Weight(i));
  }
  return curve;
}

nurbs::Surface from_spline(const Handle(Geom_BSplineSurface) & spline) {
  if (spline->IsUPeriodic()) spline->SetUNotPeriodic();
  if (spline->IsVPeriodic()) spline->SetVNotPeriodic();
  nurbs::Surface surface;
  surface.degree_u = spline->UDegree();
  surface.degree_v = spline->VDegree();
  surface.count_u = spline->NbUPoles();
  surface.count_v = spline->NbVPoles();
  for (int i = 1; i <= spline->NbUKnots(); ++i)
    surface.knots_u.insert(surface.knots_u.end(), static_cast<std::size_t>(spline->UMultiplicity(i)),
                           spline->UKnot(i));
  for (int i = 1; i <= spline->NbVKnots(); ++i)
    surface.knots_v.insert(surface.knots_v.end(), static_cast<std::size_t>(spline->VMultiplicity(i)),
                           spline->VKnot(i));
  const bool is_rational = spline->IsURational() || spline->IsVRational();
  for (int j = 1; j <= surface.count_v; ++j)
    for (int i = 1; i <= surface.count_u; ++i) {
      surface.points.push_back(vector_of(spline->Pole(i, j)));
      if (is_rational) surface.weights.push_back(spline->Weight(i, j));
    }
  return surface;
}

bool covers(const Range2& range, const Handle(Geom_Surface) & surface) {
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  surface->Bounds(u0, u1, v0, v1);
  const double within_u = 1e-9 * (u1 - u0), within_v = 1e-9 * (v1 - v0);
  return range.u1 - range.u0 >= u1 - u0 - within_u && range.v1 - range.v0 >= v1 - v0 - within_v;
}

// The full knot vector; nothing when it does not fit.
std::optional<std::vector<double>> knots_of(const Handle(TColStd_HArray1OfReal) & values,
                                            const Handle(TColStd_HArray1OfInteger) & multiplicities,
                                            int points, int degree) {
  if (values.IsNull() || multiplicities.IsNull() || values->Length() != multiplicities->Length())
    return std::nullopt;
  std::vector<double> knots;
  const auto count = static_cast<std::size_t>(points) + static_cast<std::size_t>(degree) + 1;
  for (int i = 0; i < values->Length(); ++i) {
    const int times = multiplicities->Value(multiplicities->Lower() + i);
    const double value = values->Value(values->Lower() + i);
    if (times < 1 || times > degree + 1 || knots.size() + static_cast<std::size_t>(times) > count)
      return std::nullopt;
    if (!std::isfinite(value) || (!knots.empty() && value <= knots.back())) return std::nullopt;
    knots.insert(knots.end(), static_cast<std::size_t>(times), value);
  }
  if (knots.size() != count) return std::nullopt;
  return knots;
}

// A handle that may be null: the file's author's numbers need not fit.
struct SplineEntity {
  Handle(StepGeom_BSplineSurface) base;
  Handle(TColStd_HArray1OfReal) knots_u, knots_v;
  Handle(TColStd_HArray1OfInteger) times_u, times_v;
  Handle(TColStd_HArray2OfReal) weights;
};

template <class Entity>
void take_knots(SplineEntity& spline, const Handle(Entity) & entity) {
  spline.base = entity;
  spline.knots_u = entity->UKnots();
  spline.knots_v = entity->VKnots();
  spline.times_u = entity->UMultiplicities();
  spline.times_v = entity->VMultiplicities();
}

SplineEntity spline_entity(const Handle(StepGeom_Surface) & surface) {
  SplineEntity spline;
  if (const auto plain = Handle(StepGeom_BSplineSurfaceWithKnots)::DownCast(surface); !plain.IsNull())
    take_knots(spline, plain);
  const auto rational = Handle(StepGeom_BSplineSurfaceWithKnotsAndRationalBSplineSurface)::DownCast(surface);
  if (!rational.IsNull() && !rational->BSplineSurfaceWithKnots().IsNull()) {
    take_knots(spline, rational);
    spline.weights = rational->WeightsData();
    if (spline.weights.IsNull()) spline.base.Nullify();
  }
  return spline;
}

bool is_identity(const gp_Trsf& placement) {
  if (placement.Form() == gp_Identity) return true;
  for (int row = 1; row <= 3; ++row)
    for (int column = 1; column <= 4; ++column)
      if (placement.Value(row, column) != (row == column ? 1.0 : 0.0)) return false;
  return true;
}

void place(std::vector<Vec3>& points, const gp_Trsf& placement) {
  if (is_identity(placement)) return;
  for (Vec3& p : points) p = vector_of(gp_Pnt(p.x(), p.y(), p.z()).Transformed(placement));
}

}  // namespace

nurbs::Curve to_spline(const Handle(Geom_Curve) & curve, double first, double last) {
  if (const auto spline = Handle(Geom_BSplineCurve)::DownCast(curve); !spline.IsNull()) {
    const double within = 1e-12 * (spline->LastParameter() - spline->FirstParameter());
    if (std::abs(first - spline->FirstParameter()) <= within &&
        std::abs(last - spline->LastParameter()) <= within)
      return from_spline(Handle(Geom_BSplineCurve)::DownCast(spline->Copy()));
  }
  return from_spline(GeomConvert::CurveToBSplineCurve(new Geom_TrimmedCurve(curve, first, last)));
}

nurbs::Curve to_spline(const Handle(Geom2d_Curve) & curve, double first, double last) {
  return from_spline(Geom2dConvert::CurveToBSplineCurve(new Geom2d_TrimmedCurve(curve, first, last)));
}

nurbs::Surface to_spline(const Handle(Geom_Surface) & surface, const Range2& range) {
  if (surface->IsKind(STANDARD_TYPE(Geom_BSplineSurface)) && covers(range, surface))
    return from_spline(Handle(Geom_BSplineSurface)::DownCast(surface->Copy()));
  Handle(Geom_Surface) basis = surface;
  if (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface); !trimmed.IsNull())
    basis = trimmed->BasisSurface();
  Range2 used = range;
  if (basis->IsUPeriodic()) used.u1 = std::min(used.u1, used.u0 + basis->UPeriod());
  if (basis->IsVPeriodic()) used.v1 = std::min(used.v1, used.v0 + basis->VPeriod());
  return from_spline(GeomConvert::SurfaceToBSplineSurface(
      new Geom_RectangularTrimmedSurface(basis, used.u0, used.u1, used.v0, used.v1)));
}

bool keeps_parameters(const Handle(Geom_Surface) & surface) {
  if (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface); !trimmed.IsNull())
    return keeps_parameters(trimmed->BasisSurface());
  if (const auto extrusion = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(surface); !extrusion.IsNull())
    return !extrusion->BasisCurve()->IsKind(STANDARD_TYPE(Geom_Conic));
  return surface->IsKind(STANDARD_TYPE(Geom_Plane)) || surface->IsKind(STANDARD_TYPE(Geom_BSplineSurface)) ||
         surface->IsKind(STANDARD_TYPE(Geom_BezierSurface));
}

std::optional<nurbs::Surface> exact_spline(const Handle(StepGeom_Surface) & surface, double scale) {
  const SplineEntity entity = spline_entity(surface);
  if (entity.base.IsNull() || entity.base->ControlPointsList().IsNull()) return std::nullopt;
  nurbs::Surface spline;
  spline.degree_u = entity.base->UDegree();
  spline.degree_v = entity.base->VDegree();
  spline.count_u = entity.base->NbControlPointsListI();
  spline.count_v = entity.base->NbControlPointsListJ();
  if (spline.degree_u < 1 || spline.degree_v < 1 || spline.degree_u >= spline.count_u ||
      spline.degree_v >= spline.count_v || std::max(spline.degree_u, spline.degree_v) > nurbs::max_degree)
    return std::nullopt;
  auto knots_u = knots_of(entity.knots_u, entity.times_u, spline.count_u, spline.degree_u);
  auto knots_v = knots_of(entity.knots_v, entity.times_v, spline.count_v, spline.degree_v);
  if (!knots_u || !knots_v) return std::nullopt;
  spline.knots_u = std::move(*knots_u);
  spline.knots_v = std::move(*knots_v);
  if (!entity.weights.IsNull() &&
      (entity.weights->ColLength() != spline.count_u || entity.weights->RowLength() != spline.count_v))
    return std::nullopt;
  for (int j = 1; j <= spline.count_v; ++j)
    for (int i = 1; i <= spline.count_u; ++i) {
      const Handle(StepGeom_CartesianPoint) point = entity.base->ControlPointsListValue(i, j);
      if (point.IsNull() || point->NbCoordinates() != 3) return std::nullopt;
      spline.points.emplace_back(point->CoordinatesValue(1), point->CoordinatesValue(2),
                                 point->CoordinatesValue(3));
      if (scale != 1.0) spline.points.back() *= scale;
      if (entity.weights.IsNull()) continue;
      const double weight =
          entity.weights->Value(entity.weights->LowerRow() + i - 1, entity.weights->LowerCol() + j - 1);
      if (!(weight > 0) || !std::isfinite(weight)) return std::nullopt;
      spline.weights.push_back(weight);
    }
  return spline;
}

void place(nurbs::Curve& curve, const gp_Trsf& placement) {
  place(curve.points, placement);
}
void place(nurbs::Surface& surface, const gp_Trsf& placement) {
  place(surface.points, placement);
}

}  // namespace selvage::formats::step
