#include "cad/sphere.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "cad/sampled_curve.h"
#include "nurbs/basis.h"
#include "nurbs/measure.h"

namespace selvage::cad {

namespace {

using nurbs::Curve;
using std::numbers::pi;

// A place of the boundary on the unit sphere, and how far it goes on there (derivative times weight).
struct Progress {
  Vec3 at, along;
};

void add_steps(std::vector<Progress>& steps, const Sphere& sphere, const Curve& curve) {
  constexpr int parts = 4;  // of a span
  const nurbs::GaussRule& rule = nurbs::gauss_rule(8);
  const std::vector<double> breaks = nurbs::breakpoints(curve.knots, curve.degree);
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
    for (int part = 0; part < parts; ++part) {
      const double half = 0.5 * (breaks[k + 1] - breaks[k]) / parts,
                   middle = breaks[k] + (2 * part + 1) * half;
      for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
        const nurbs::CurveJet jet = nurbs::evaluate_jet(curve, middle + half * rule.nodes[i]);
        const Vec3 offset = jet.position - sphere.center;
        const double distance = offset.norm();
        const Vec3 at = offset / distance;
        steps.push_back({at, half * rule.weights[i] * (jet.d1 - at * at.dot(jet.d1)) / distance});
      }
    }
}

// The direction that is farthest from the boundary, of those of a grid.
std::optional<Vec3> away_from(const std::vector<Progress>& steps) {
  constexpr double least = 1e-3;  // radians
  constexpr int rings = 8, around = 16;
  Vec3 best = Vec3::Zero();
  double nearest = 2;  // largest cosine of the angle to the boundary
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < around; ++k) {
      const double polar = pi * (i + 0.5) / rings, turn = 2 * pi * (k + 0.3 * i) / around;
      const Vec3 d(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
      double cosine = -1;
      for (const Progress& step : steps) cosine = std::max(cosine, d.dot(step.at));
      if (cosine < nearest) {
        nearest = cosine;
        best = d;
      }
    }
  if (nearest > std::cos(least)) return std::nullopt;
  return best;
}

}  // namespace

std::optional<Sphere> sphere_of(const nurbs::Surface& surface) {
  constexpr int looks = 7;
  constexpr double tolerance = 1e-7;  // of the radius, and of the points' extent
  std::vector<Vec3> points;
  for (int i = 0; i < looks; ++i)
    for (int j = 0; j < looks; ++j)
      points.push_back(at_shares(surface, (i + 0.31) / looks, (j + 0.37) / looks));
  // |p|^2 = 2 p.c + (r^2 - |c|^2), about the first point.
  constexpr double flattest = 1000;  // of the points' extent: what bends less is as good as flat
  const double extent = box_of(points).diagonal().norm();
  Eigen::MatrixXd system(points.size(), 4);
  Eigen::VectorXd right(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3 p = points[k] - points.front();
    const auto row = static_cast<Eigen::Index>(k);
    system.row(row) << 2 * p.transpose(), 1;
    right[row] = p.squaredNorm();
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(system);
  if (solver.rank() < 4) return std::nullopt;
  const Eigen::VectorXd found = solver.solve(right);
  Sphere sphere;
  sphere.radius = std::sqrt(found.head<3>().squaredNorm() + found[3]);
  sphere.center = points.front() + found.head<3>();
  if (!(sphere.radius <= flattest * extent)) return std::nullopt;
  for (const Vec3& p : points)
    if (!(std::abs((p - sphere.center).norm() - sphere.radius) <=
          tolerance * std::min(sphere.radius, extent)))
      return std::nullopt;
  return sphere;
}

std::optional<FaceIntegrals> integrals_on(const Sphere& sphere, const Face& face, const Vec3& origin) {
  std::vector<Progress> steps;
  for (const Loop& loop : face.loops)
    for (const Edge& edge : loop.edges) {
      if (!edge.curve.points.empty())
        add_steps(steps, sphere, edge.curve);
      else if (!edge.flat.points.empty() && !is_point(face.surface, edge.flat, 1e-6 * sphere.radius))
        return std::nullopt;
    }
  const std::optional<Vec3> away = away_from(steps);
  if (steps.empty() || !away) return std::nullopt;
  const nurbs::SurfaceJet jet =
      nurbs::evaluate_jet(face.surface, std::lerp(face.surface.first_u(), face.surface.last_u(), 0.43),
                          std::lerp(face.surface.first_v(), face.surface.last_v(), 0.47));
  const double out = jet.du.cross(jet.dv).dot(jet.position - sphere.center) > 0 ? 1 : -1;
  const double r = sphere.radius;
  double area = 0;
  Vec3 vector = Vec3::Zero();
  for (const Progress& step : steps) {
    const Vec3 moment = step.at.cross(step.along);
    area -= out * away->dot(moment) / (1 - away->dot(step.at));
    vector += 0.5 * moment;
  }
  area -= 4 * pi * std::floor(area / (4 * pi));
  FaceIntegrals integrals;
  integrals.area = r * r * area;
  integrals.area_vector = r * r * vector;
  integrals.volume = (out * r * integrals.area + (sphere.center - origin).dot(integrals.area_vector)) / 3;
  return integrals;
}

}  // namespace selvage::cad
