#include "formats/step/geometry.h"

#include <Geom2dConvert.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <GeomConvert.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Conic.hxx>
#include <Geom_ElementarySurface.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <StepGeom_BSplineSurfaceWithKnots.hxx>
#include <StepGeom_BSplineSurfaceWithKnotsAndRationalBSplineSurface.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Ax1.hxx>

#include "nurbs/basis.h"
#include "nurbs/restrict.h"

namespace selvage::formats::step {

namespace {

template <class SplineHandle>
nurbs::Curve from_spline(const SplineHandle& spline) {
  if (spline->IsPeriodic()) spline->SetNotPeriodic();
  nurbs::Curve curve;
  curve.degree = spline->Degree();
  curve.knots.assign(spline->KnotSequence().begin(), spline->KnotSequence().end());
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
  const auto sequence = [](const TColStd_Array1OfReal& knots) {
    return std::vector<double>(knots.begin(), knots.end());
  };
  surface.knots_u = sequence(spline->UKnotSequence());
  surface.knots_v = sequence(spline->VKnotSequence());
  const bool is_rational = spline->IsURational() || spline->IsVRational();
  for (int j = 1; j <= surface.count_v; ++j)
    for (int i = 1; i <= surface.count_u; ++i) {
      surface.points.push_back(vector_of(spline->Pole(i, j)));
      if (is_rational) surface.weights.push_back(spline->Weight(i, j));
    }
  return surface;
}

bool covers(const cad::Range& range, const Handle(Geom_Surface) & surface) {
  const auto [u0, u1, v0, v1] = bounds_of(surface);
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

bool is_identity(const gp_Trsf& placement) {
  if (placement.Form() == gp_Identity) return true;
  for (int row = 1; row <= 3; ++row)
    for (int column = 1; column <= 4; ++column)
      if (placement.Value(row, column) != (row == column ? 1.0 : 0.0)) return false;
  return true;
}

}  // namespace

cad::Range bounds_of(const Handle(Geom_Surface) & surface) {
  cad::Range whole;
  surface->Bounds(whole.u0, whole.u1, whole.v0, whole.v1);
  return whole;
}

Vec3 vector_of(const gp_Pnt& p) {
  return {p.X(), p.Y(), p.Z()};
}

Vec3 vector_of(const gp_Pnt2d& p) {
  return {p.X(), p.Y(), 0.0};
}

nurbs::Curve to_spline(const Handle(Geom_Curve) & curve, double first, double last) {
  if (const auto spline = Handle(Geom_BSplineCurve)::DownCast(curve); !spline.IsNull()) {
    const double within = 1e-12 * (spline->LastParameter() - spline->FirstParameter());
    if (std::abs(first - spline->FirstParameter()) <= within &&
        std::abs(last - spline->LastParameter()) <= within)
      return from_spline(Handle(Geom_BSplineCurve)::DownCast(spline->Copy()));
    // OpenCASCADE's own cut fails where an end is beside a knot.
    const double from = std::max(first, spline->FirstParameter()),
                 to = std::min(last, spline->LastParameter());
    if (!spline->IsPeriodic() && from < to)
      return nurbs::restricted(from_spline(Handle(Geom_BSplineCurve)::DownCast(spline->Copy())), from, to);
  }
  return from_spline(GeomConvert::CurveToBSplineCurve(new Geom_TrimmedCurve(curve, first, last)));
}

nurbs::Curve to_spline(const Handle(Geom2d_Curve) & curve, double first, double last) {
  return from_spline(Geom2dConvert::CurveToBSplineCurve(new Geom2d_TrimmedCurve(curve, first, last)));
}

namespace {

// The axis of a surface that closes round one; none for others.
std::optional<gp_Ax1> axis_of(const Handle(Geom_Surface) & surface) {
  if (const auto revolution = Handle(Geom_SurfaceOfRevolution)::DownCast(surface); !revolution.IsNull())
    return revolution->Axis();
  const auto elementary = Handle(Geom_ElementarySurface)::DownCast(surface);
  if (elementary.IsNull() || !surface->IsUPeriodic()) return std::nullopt;
  return elementary->Axis();
}

// u runs clockwise about the axis of what has a left-handed system.
bool axis_turns_back(const Geom_Surface& surface) {
  const auto* const elementary = dynamic_cast<const Geom_ElementarySurface*>(&surface);
  return elementary != nullptr && !elementary->Position().Direct();
}

// Within the surface's own bounds: boundaries reach beyond its end by what their tolerance allows.
void fit(double& low, double& high, double first, double last, bool is_periodic) {
  if (is_periodic) {
    if (high - low >= last - first) low = first, high = last;
    return;
  }
  low = std::clamp(low, first, last);
  high = std::clamp(high, first, last);
  if (!(low < high)) low = first, high = last;
}

}  // namespace

nurbs::Surface to_spline(const Handle(Geom_Surface) & surface, const cad::Range& range) {
  if (surface->IsKind(STANDARD_TYPE(Geom_BSplineSurface)) && covers(range, surface))
    return from_spline(Handle(Geom_BSplineSurface)::DownCast(surface->Copy()));
  Handle(Geom_Surface) basis = surface;
  if (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface); !trimmed.IsNull())
    basis = trimmed->BasisSurface();
  const cad::Range whole = bounds_of(basis);
  cad::Range used = range;
  // A whole turn that begins elsewhere is made by turning the surface, which then closes to the last digit.
  double turn = 0;
  if (const std::optional<gp_Ax1> axis = axis_of(basis);
      axis && used.u0 != whole.u0 && used.u1 - used.u0 >= whole.u1 - whole.u0) {
    turn = used.u0 - whole.u0;
    basis = Handle(Geom_Surface)::DownCast(basis->Rotated(*axis, axis_turns_back(*basis) ? -turn : turn));
  }
  fit(used.u0, used.u1, whole.u0, whole.u1, basis->IsUPeriodic());
  fit(used.v0, used.v1, whole.v0, whole.v1, basis->IsVPeriodic());
  // OpenCASCADE's own cut fails where an end is beside a knot.
  if (basis->IsKind(STANDARD_TYPE(Geom_BSplineSurface)) && !basis->IsUPeriodic() && !basis->IsVPeriodic())
    return nurbs::restricted(from_spline(Handle(Geom_BSplineSurface)::DownCast(basis->Copy())), used.u0,
                             used.u1, used.v0, used.v1);
  nurbs::Surface spline = from_spline(GeomConvert::SurfaceToBSplineSurface(
      new Geom_RectangularTrimmedSurface(basis, used.u0, used.u1, used.v0, used.v1)));
  for (double& knot : spline.knots_u) knot += turn;
  return spline;
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
  const auto base = Handle(StepGeom_BSplineSurface)::DownCast(surface);
  auto with_knots = Handle(StepGeom_BSplineSurfaceWithKnots)::DownCast(surface);
  Handle(TColStd_HArray2OfReal) weights;
  const auto rational = Handle(StepGeom_BSplineSurfaceWithKnotsAndRationalBSplineSurface)::DownCast(surface);
  if (!rational.IsNull()) {
    with_knots = rational->BSplineSurfaceWithKnots();
    weights = rational->WeightsData();
    if (weights.IsNull()) return std::nullopt;
  }
  // The file's author's numbers need not fit.
  if (with_knots.IsNull() || base->ControlPointsList().IsNull()) return std::nullopt;
  nurbs::Surface spline;
  spline.degree_u = base->UDegree();
  spline.degree_v = base->VDegree();
  spline.count_u = base->NbControlPointsListI();
  spline.count_v = base->NbControlPointsListJ();
  if (spline.degree_u < 1 || spline.degree_v < 1 || spline.degree_u >= spline.count_u ||
      spline.degree_v >= spline.count_v || std::max(spline.degree_u, spline.degree_v) > nurbs::max_degree)
    return std::nullopt;
  auto knots_u =
      knots_of(with_knots->UKnots(), with_knots->UMultiplicities(), spline.count_u, spline.degree_u);
  auto knots_v =
      knots_of(with_knots->VKnots(), with_knots->VMultiplicities(), spline.count_v, spline.degree_v);
  if (!knots_u || !knots_v) return std::nullopt;
  spline.knots_u = std::move(*knots_u);
  spline.knots_v = std::move(*knots_v);
  if (!weights.IsNull() && (weights->ColLength() != spline.count_u || weights->RowLength() != spline.count_v))
    return std::nullopt;
  for (int j = 1; j <= spline.count_v; ++j)
    for (int i = 1; i <= spline.count_u; ++i) {
      const Handle(StepGeom_CartesianPoint) point = base->ControlPointsListValue(i, j);
      if (point.IsNull() || point->NbCoordinates() != 3) return std::nullopt;
      spline.points.emplace_back(point->CoordinatesValue(1), point->CoordinatesValue(2),
                                 point->CoordinatesValue(3));
      if (scale != 1.0) spline.points.back() *= scale;
      if (weights.IsNull()) continue;
      const double weight = weights->Value(weights->LowerRow() + i - 1, weights->LowerCol() + j - 1);
      if (!(weight > 0) || !std::isfinite(weight)) return std::nullopt;
      spline.weights.push_back(weight);
    }
  return spline;
}

void place(std::vector<Vec3>& points, const gp_Trsf& placement) {
  if (is_identity(placement)) return;
  for (Vec3& p : points) p = vector_of(gp_Pnt(p.x(), p.y(), p.z()).Transformed(placement));
}

}  // namespace selvage::formats::step
