#include "solid/occt/check.h"

#include <fmt/format.h>

#include <BRepAdaptor_Surface.hxx>
#include <BRep_Tool.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_Plane.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <math.hxx>
#include <math_Vector.hxx>

#include "solid/occt/faults.h"
#include "solid/occt/guard.h"
#include "solid/occt/shape.h"

namespace selvage::solid::occt {

namespace {

// Gauss-Legendre on [0, 1]: with n points exact for polynomials up to degree 2n - 1.
using Rule = std::vector<std::pair<double, double>>;  // place, weight
Rule gauss(int points) {
  math_Vector places(1, points), weights(1, points);
  math::GaussPoints(points, places);
  math::GaussWeights(points, weights);
  Rule rule;
  for (int i = 1; i <= points; ++i) rule.emplace_back(0.5 + 0.5 * places(i), 0.5 * weights(i));
  return rule;
}

// One third of the flux of the position through a whole B-spline face, span by span: exact for a polynomial
// one. OpenCASCADE's own quadratures, the adaptive ones too, are off by up to 11 % on long tubes whose spans
// are uneven.
double flux_of(const Geom_BSplineSurface& surface) {
  const bool is_rational = surface.IsURational() || surface.IsVRational();
  const int more = is_rational ? 12 : 0;
  const Rule rule_u = gauss(3 * surface.UDegree() / 2 + 1 + more),
             rule_v = gauss(3 * surface.VDegree() / 2 + 1 + more);
  double flux = 0.0;
  for (int j = 1; j < surface.NbVKnots(); ++j) {
    const double v = surface.VKnot(j), width_v = surface.VKnot(j + 1) - v;
    for (int i = 1; i < surface.NbUKnots(); ++i) {
      const double u = surface.UKnot(i), width_u = surface.UKnot(i + 1) - u;
      for (const auto& [at_v, weight_v] : rule_v)
        for (const auto& [at_u, weight_u] : rule_u) {
          gp_Pnt position;
          gp_Vec du, dv;
          surface.D1(u + at_u * width_u, v + at_v * width_v, position, du, dv);
          flux += weight_u * weight_v * width_u * width_v * gp_Vec(position.XYZ()).Dot(du.Crossed(dv)) / 3.0;
        }
    }
  }
  return flux;
}

// The same for a plane: its distance from the origin times its area.
double flux_of_plane(const TopoDS_Face& face, const gp_Pln& plane) {
  const gp_Vec normal(plane.Axis().Direction().XYZ() * (plane.Direct() ? 1.0 : -1.0));
  return gp_Vec(plane.Location().XYZ()).Dot(normal) * area_of(face) / 3.0;
}

// The volume that the faces of a solid enclose, by their own orientation; none for a face of another kind.
std::optional<double> enclosed_volume(const TopoDS_Shape& shape) {
  double volume = 0.0;
  for (TopExp_Explorer faces(shape, TopAbs_FACE); faces.More(); faces.Next()) {
    const TopoDS_Face& face = TopoDS::Face(faces.Current());
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(face);
    double flux = 0.0;
    if (const auto spline = Handle(Geom_BSplineSurface)::DownCast(surface); !spline.IsNull())
      flux = flux_of(*spline);
    else if (const auto plane = Handle(Geom_Plane)::DownCast(surface); !plane.IsNull())
      flux = flux_of_plane(face, plane->Pln());
    else
      return std::nullopt;
    volume += face.Orientation() == TopAbs_REVERSED ? -flux : flux;
  }
  return volume;
}

class Judge {
 public:
  Judge(const yarn::Body& body, BrepCheck& verdict)
      : body_(body), verdict_(verdict), scale_(unit_scale(body)), yarn_(build_shape(body, scale_)) {}

  void judge_topology() {
    verdict_.defects = yarn_.defects;
    const bool agreed = analyze();
    count_free_edges();
    verdict_.tolerance = largest_tolerance() / scale_;
    verdict_.valid = agreed && yarn_.closed && verdict_.free_edges == 0;
  }

  void judge_volume() {
    if (!yarn_.closed) return;
    const std::optional<double> volume = enclosed_volume(yarn_.shape);
    verdict_.volume = volume.value_or(0.0) / (scale_ * scale_ * scale_);
    if (verdict_.volume > 0) return;
    verdict_.valid = false;
    verdict_.defects.push_back(error(
        Kind::geometry,
        volume ? fmt::format("yarn '{}' is inside out: its volume is {:.6g}; let the sections run round the "
                             "path the other way",
                             body_.name, verdict_.volume)
               : fmt::format("OpenCASCADE finds no volume for yarn '{}'", body_.name),
        about(body_, body_.start.origin)));
  }

 private:
  [[nodiscard]] Vec3 unscaled(const gp_Pnt& p) const { return Vec3(p.X(), p.Y(), p.Z()) / scale_; }

  bool analyze() {
    const std::vector<Fault> faults = faults_of(yarn_.shape);
    for (const Fault& fault : faults)
      verdict_.defects.push_back(
          error(Kind::geometry, fmt::format("yarn '{}': {}; {}", body_.name, to_string(fault), fault.remedy),
                about(body_, unscaled(fault.at))));
    return faults.empty();
  }

  void count_free_edges() {
    TopTools_IndexedDataMapOfShapeListOfShape faces_of;
    TopExp::MapShapesAndAncestors(yarn_.shape, TopAbs_EDGE, TopAbs_FACE, faces_of);
    std::optional<Vec3> first;
    for (int i = 1; i <= faces_of.Extent(); ++i) {
      // A seam stands twice in the list of its face; a degenerated edge has no other side.
      const TopoDS_Edge& edge = TopoDS::Edge(faces_of.FindKey(i));
      if (faces_of(i).Extent() >= 2 || BRep_Tool::Degenerated(edge)) continue;
      ++verdict_.free_edges;
      if (!first) first = unscaled(place_of(edge));
    }
    if (verdict_.free_edges == 0) return;
    const bool by_choice = !body_.closed_along && (body_.start.style == yarn::EndStyle::none ||
                                                   body_.end.style == yarn::EndStyle::none);
    verdict_.defects.push_back(
        error(Kind::geometry,
              fmt::format("yarn '{}' is open: {} edges have only one face{}", body_.name, verdict_.free_edges,
                          by_choice ? "; ends `none` leave no solid, use --ends patch" : ""),
              about(body_, first)));
  }

  double largest_tolerance() const {
    double largest = 0.0;
    for (TopExp_Explorer at(yarn_.shape, TopAbs_VERTEX); at.More(); at.Next())
      largest = std::max(largest, BRep_Tool::Tolerance(TopoDS::Vertex(at.Current())));
    for (TopExp_Explorer at(yarn_.shape, TopAbs_EDGE); at.More(); at.Next())
      largest = std::max(largest, BRep_Tool::Tolerance(TopoDS::Edge(at.Current())));
    return largest;
  }

  const yarn::Body& body_;
  BrepCheck& verdict_;
  double scale_;
  YarnShape yarn_;
};

BrepCheck judged(const yarn::Body& body, bool with_volume) {
  BrepCheck verdict;
  Status status = guarded(fmt::format("yarn '{}' as a solid", body.name), [&]() -> Status {
    Judge judge(body, verdict);
    judge.judge_topology();
    if (with_volume) judge.judge_volume();
    return {};
  });
  if (status.ok()) return verdict;
  verdict = BrepCheck{};  // what OpenCASCADE cannot even build is a defect of that yarn, not of the run
  verdict.defects.push_back(error(status.error().kind, status.error().text, about(body)));
  return verdict;
}

}  // namespace

Result<std::vector<BrepCheck>> check(std::span<const yarn::Body> bodies) {
  std::vector<BrepCheck> verdicts;
  verdicts.reserve(bodies.size());
  // What is sound is sound wherever it stands; defects are told of each yarn.
  const std::vector<std::size_t> first = yarn::first_of_shape(bodies);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const bool is_known = first[i] != i && verdicts[first[i]].defects.empty();
    verdicts.push_back(is_known ? verdicts[first[i]] : judged(bodies[i], true));
  }
  return verdicts;
}

BrepCheck check_topology(const yarn::Body& body) {
  return judged(body, false);
}

}  // namespace selvage::solid::occt
