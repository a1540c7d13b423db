#include "cad/outline.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "cad/basis.h"
#include "cad/edges.h"
#include "cad/sampled_curve.h"

namespace selvage::cad {

using nurbs::Curve;
using nurbs::Surface;

namespace {

double size_of(const std::vector<Vec3>& points) {
  return points.empty() ? 0.0 : box_of(points).diagonal().norm();
}

bool same_curve(const Curve& a, const Curve& b, double near) {
  const std::optional<ControlChange> change = compare_control_points(as_surface(a), as_surface(b), near);
  return change && change->bound <= near;
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

Reach worse(const Reach& a, const Reach& b) {
  return a.at_most >= b.at_most ? a : b;
}

Reach one_way(const std::vector<Surface>& from, const std::vector<Surface>& to, double enough) {
  std::vector<const Surface*> all;
  all.reserve(to.size());
  for (const Surface& surface : to) all.push_back(&surface);
  const SurfaceSet others(all);
  Reach reach;
  for (const Surface& surface : from)
    reach = worse(reach, distance_to(surface, domain(surface), others, enough));
  return reach;
}

}  // namespace

std::vector<Curve> outline(const Face& face) {
  std::vector<Curve> curves;
  for (const Edge& edge : edges_of(face)) curves.push_back(edge.curve);
  if (face.loops.empty()) std::ranges::copy(sides_of(face.surface), std::back_inserter(curves));
  return open_ones(std::move(curves), size_of(face.surface.points));
}

Reach outline_distance(const Face& a, const Face& b, double enough) {
  const std::vector<Curve> of_a = outline(a), of_b = outline(b);
  if (of_a.empty() && of_b.empty()) return {};
  const Vec3 somewhere = of_a.empty() ? of_b.front().points.front() : of_a.front().points.front();
  if (of_a.empty() || of_b.empty()) return {0, std::numeric_limits<double>::infinity(), somewhere};
  if (of_a.size() == of_b.size()) {  // mostly they are the same, one by one
    Reach reach;
    for (std::size_t k = 0; k < of_a.size(); ++k) {
      const auto change = compare_control_points(as_surface(of_a[k]), as_surface(of_b[k]), enough);
      if (!change || change->bound > enough) break;
      reach = worse(reach, {change->largest, change->bound, of_a[k].points.front()});
      if (k + 1 == of_a.size()) return reach;
    }
  }
  const std::vector<Surface> all_a = as_surfaces(of_a), all_b = as_surfaces(of_b);
  return worse(one_way(all_a, all_b, enough), one_way(all_b, all_a, enough));
}

Range used_range(const Face& face) {
  const Range whole = domain(face.surface);
  Box3 box;
  for (const Edge& edge : edges_of(face)) {
    if (edge.flat.points.empty()) return whole;
    box.extend(box_of(edge.flat.points));
  }
  if (box.isEmpty()) return whole;
  const Range range = {std::max(whole.u0, box.min().x()), std::min(whole.u1, box.max().x()),
                       std::max(whole.v0, box.min().y()), std::min(whole.v1, box.max().y())};
  return range.u0 < range.u1 && range.v0 < range.v1 ? range : whole;
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

Reach trimmed_distance(const Face& a, const Face& b, double enough) {
  Reach reach;
  if (a.loops.empty() || !b.loops.empty())
    reach = distance_to(a.surface, used_range(a), SurfaceSet({&b.surface}), enough);
  if (b.loops.empty() || !a.loops.empty())
    reach = worse(reach, distance_to(b.surface, used_range(b), SurfaceSet({&a.surface}), enough));
  return reach;
}

}  // namespace selvage::cad
