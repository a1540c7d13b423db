#include "cad/outline.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "cad/basis.h"
#include "cad/carrier.h"
#include "cad/edges.h"
#include "cad/region.h"
#include "cad/sampled_curve.h"
#include "nurbs/basis.h"
#include "nurbs/hermite.h"
#include "nurbs/sweep.h"

namespace selvage::cad {

using nurbs::Curve;
using nurbs::Surface;

namespace {

// What is found to be farther is told within half of itself.
constexpr SurveyOptions survey = {.most_cells = 2000, .near = 1.5};

double size_of(const std::vector<Vec3>& points) {
  return points.empty() ? 0.0 : box_of(points).diagonal().norm();
}

bool same_curve(const Curve& a, const Curve& b, double near) {
  const std::optional<ControlChange> change = compare_control_points(as_surface(a), as_surface(b), near);
  return change && change->bound <= near;
}

// The surface's curve over one in its parameters, cubic between places that are dense.
Curve in_space(const Surface& surface, const Curve& flat) {
  constexpr int each = 32;
  const std::vector<double> spans = nurbs::breakpoints(flat.knots, flat.degree);
  std::vector<double> parameters;
  for (std::size_t i = 0; i + 1 < spans.size(); ++i)
    for (int k = 0; k < each; ++k)
      parameters.push_back(std::lerp(spans[i], spans[i + 1], static_cast<double>(k) / each));
  parameters.push_back(spans.back());
  const Range range = domain(surface);
  std::vector<Vec3> points, slopes;
  for (const double t : parameters) {
    const nurbs::CurveJet at = nurbs::evaluate_jet(flat, t);
    const nurbs::SurfaceJet jet =
        nurbs::evaluate_jet(surface, std::clamp(at.position.x(), range.u0, range.u1),
                            std::clamp(at.position.y(), range.v0, range.v1));
    points.push_back(jet.position);
    slopes.push_back(jet.du * at.d1.x() + jet.dv * at.d1.y());
  }
  return nurbs::through_derivatives(parameters, points, slopes);
}

// Without those that occur twice, and those without a length.
std::vector<Curve> open_ones(std::vector<Curve> curves, double size) {
  const double near = 1e-7 * size;
  std::erase_if(curves,
                [&](const Curve& curve) { return curve.points.empty() || size_of(curve.points) <= near; });
  std::vector<bool> gone(curves.size());
  for (std::size_t i = 0; i < curves.size(); ++i)
    for (std::size_t j = i + 1; j < curves.size() && !gone[i]; ++j)
      if (!gone[j] && same_curve(curves[i], curves[j], near)) gone[i] = gone[j] = true;
  std::vector<Curve> kept;
  for (std::size_t i = 0; i < curves.size(); ++i)
    if (!gone[i]) kept.push_back(std::move(curves[i]));
  return kept;
}

std::vector<Surface> as_surfaces(const std::vector<Curve>& curves) {
  std::vector<Surface> out;
  out.reserve(curves.size());
  for (const Curve& curve : curves) out.push_back(as_surface(curve));
  return out;
}

Reach one_way(const std::vector<Surface>& from, const std::vector<Surface>& to, double enough) {
  std::vector<const Surface*> all;
  all.reserve(to.size());
  for (const Surface& surface : to) all.push_back(&surface);
  const SurfaceSet others(all);
  Reach reach;
  for (const Surface& surface : from)
    reach = worse(reach, distance_to(surface, domain(surface), others, enough, survey), enough);
  return reach;
}

}  // namespace

std::vector<Curve> outline(const Face& face) {
  std::vector<Curve> curves;
  for (const Edge& edge : edges_of(face))
    curves.push_back(edge.curve.points.empty() && !edge.flat.points.empty()
                         ? in_space(face.surface, edge.flat)
                         : edge.curve);
  if (face.loops.empty()) std::ranges::copy(sides_of(face.surface), std::back_inserter(curves));
  return open_ones(std::move(curves), size_of(face.surface.points));
}

namespace {

// A whole face beside a trimmed one: by the edges that its file has round it, which may lie beside its
// surface's sides by as much as that file's tolerance.
std::vector<Curve> outline_beside(const Face& face, const Face& other) {
  if (!face.loops.empty() || face.border.empty() || other.loops.empty()) return outline(face);
  Face trimmed = face;
  std::swap(trimmed.loops, trimmed.border);
  return outline(trimmed);
}

}  // namespace

Reach outline_distance(const Face& a, const Face& b, double enough) {
  const std::vector<Curve> of_a = outline_beside(a, b), of_b = outline_beside(b, a);
  if (of_a.empty() && of_b.empty()) return {};
  const Vec3 somewhere = of_a.empty() ? of_b.front().points.front() : of_a.front().points.front();
  if (of_a.empty() || of_b.empty()) return {0, std::numeric_limits<double>::infinity(), somewhere};
  if (of_a.size() == of_b.size()) {  // mostly they are the same, one by one
    Reach reach;
    for (std::size_t k = 0; k < of_a.size(); ++k) {
      const auto change = compare_control_points(as_surface(of_a[k]), as_surface(of_b[k]), enough);
      if (!change || change->bound > enough) break;
      reach.at_most = std::max(reach.at_most, change->bound);
      if (k + 1 == of_a.size()) return reach;
    }
  }
  const std::vector<Surface> all_a = as_surfaces(of_a), all_b = as_surfaces(of_b);
  return worse(one_way(all_a, all_b, enough), one_way(all_b, all_a, enough), enough);
}

Range used_range(const Face& face) {
  const Range whole = domain(face.surface);
  Box3 box;
  for (const Edge& edge : edges_of(face)) {
    if (edge.flat.points.empty()) return Region(face).range();
    box.extend(box_of(edge.flat.points));
  }
  if (box.isEmpty()) return whole;
  const Range range = {std::max(whole.u0, box.min().x()), std::min(whole.u1, box.max().x()),
                       std::max(whole.v0, box.min().y()), std::min(whole.v1, box.max().y())};
  return range.u0 < range.u1 && range.v0 < range.v1 ? range : whole;
}

Place place_of(const Face& face) {
  constexpr int inside = 4;
  Place place;
  for (const Curve& curve : outline(face))
    for (const Vec3& p : SampledCurve(curve).points) place.box.extend(p);
  const Region region(face);
  if (!face.loops.empty() && !region.is_known() && !place.box.isEmpty()) return place;
  const Range range = used_range(face);
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (int j = 0; j < inside; ++j)
    for (int i = 0; i < inside; ++i) {
      const double u = std::lerp(range.u0, range.u1, (i + 0.5) / inside),
                   v = std::lerp(range.v0, range.v1, (j + 0.5) / inside);
      if (!region.contains(u, v)) continue;
      const Vec3 p = nurbs::evaluate(face.surface, u, v);
      place.box.extend(p);
      sum += p;
      ++count;
    }
  if (count > 0) place.middle = sum / count;
  return place;
}

bool is_flat(const Surface& surface) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : surface.points) mean += p;
  mean /= static_cast<double>(surface.points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Vec3& p : surface.points) scatter += (p - mean) * (p - mean).transpose();
  const Vec3 normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  const double near = 1e-9 * size_of(surface.points);
  return std::all_of(surface.points.begin(), surface.points.end(),
                     [&](const Vec3& p) { return std::abs(normal.dot(p - mean)) <= near; });
}

namespace {

// Where the middle of one face is on the other one's surface, but outside of that one's loops: the two have
// one outline and are the two sides of it.
Reach beyond_outline(const Face& a, const Region& of_a, const SurfaceSet& others, const Face& b,
                     const Region& of_b, double enough) {
  constexpr int grid = 7;
  Reach reach;
  if (!of_a.is_known() || !of_b.is_known()) return reach;
  const Range range = used_range(a);
  std::vector<Vec3> outside;
  for (int j = 0; j < grid; ++j)
    for (int i = 0; i < grid; ++i) {
      const double u = std::lerp(range.u0, range.u1, (i + 0.5) / grid),
                   v = std::lerp(range.v0, range.v1, (j + 0.5) / grid);
      if (!of_a.contains(u, v)) continue;
      const Vec3 p = nurbs::evaluate(a.surface, u, v);
      const SurfaceSet::Foot foot = others.near(p);
      if (foot.distance <= enough && !of_b.contains(foot.u, foot.v)) outside.push_back(p);
    }
  if (outside.empty()) return reach;
  const std::vector<Surface> border = as_surfaces(outline(b));
  std::vector<const Surface*> all;
  all.reserve(border.size());
  for (const Surface& surface : border) all.push_back(&surface);
  if (all.empty()) return reach;
  const SurfaceSet sides(all);
  const double deep = std::max(enough, 1e-3 * size_of(a.surface.points));
  for (const Vec3& p : outside) {
    const SurfaceSet::Foot foot = sides.near(p);
    if (foot.distance <= std::max(deep, reach.found)) continue;
    reach.found = reach.at_most = foot.distance;
    reach.at_least = sides.least_distance(p, foot);
    reach.at = p;
  }
  return reach;
}

}  // namespace

Reach trimmed_distance(const Face& a, const Face& b, double enough) {
  const Range range_a = used_range(a), range_b = used_range(b);
  const Region of_a(a), of_b(b);
  const SurfaceSet set_a({&a.surface}), set_b({&b.surface});
  Reach reach = worse(beyond_outline(a, of_a, set_b, b, of_b, enough),
                      beyond_outline(b, of_b, set_a, a, of_a, enough), enough);
  if (reach.at_least > enough) return reach;
  if (const auto bound = carrier_distance(a.surface, range_a, b.surface, range_b, enough)) {
    reach.at_most = *bound;
    return reach;
  }
  SurveyOptions options = survey;
  if (a.loops.empty() || !b.loops.empty()) {
    options.region = &of_a;
    reach = distance_to(a.surface, range_a, set_b, enough, options);
  }
  if (b.loops.empty() || !a.loops.empty()) {
    options.region = &of_b;
    reach = worse(reach, distance_to(b.surface, range_b, set_a, enough, options), enough);
  }
  return reach;
}

const Reach& worse(const Reach& a, const Reach& b, double enough) {
  if (std::max(a.at_least, b.at_least) > enough) return a.at_least >= b.at_least ? a : b;
  return a.at_most >= b.at_most ? a : b;
}

}  // namespace selvage::cad
