#include "solid/cgal/surface_pair.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace selvage::solid {

namespace {

using Vec4 = Eigen::Vector4d;
using Mat4 = Eigen::Matrix4d;

double wrapped(double t, double first, double last) {
  const double period = last - first;
  return t - period * std::floor((t - first) / period);
}

// Sites outside the domain go round (closed directions) or to its border.
Vec2 inside(const yarn::Body& body, Vec2 site) {
  const nurbs::Surface& s = body.surface;
  site.x() = wrapped(site.x(), s.first_u(), s.last_u());
  site.y() = body.closed_along ? wrapped(site.y(), s.first_v(), s.last_v())
                               : std::clamp(site.y(), s.first_v(), s.last_v());
  return site;
}

struct SurfacePoint {
  nurbs::SurfaceJet jet;
  Vec3 normal = Vec3::Zero();  // outward; zero where there is none
};

SurfacePoint point_at(const yarn::Body& body, const Vec2& site) {
  const Vec2 s = inside(body, site);
  SurfacePoint out;
  out.jet = nurbs::evaluate_jet(body.surface, s.x(), s.y());
  const Vec3 cross = out.jet.du.cross(out.jet.dv);
  const double size = cross.norm();
  if (size > 0.0) out.normal = (body.inward ? -1.0 : 1.0) / size * cross;
  return out;
}

// The four equations of a critical pair, in lengths of `scale`.
struct Equations {
  const yarn::Body& a;
  const yarn::Body& b;
  double scale;

  [[nodiscard]] Vec4 residual(const Vec4& x) const {
    const SurfacePoint p = point_at(a, x.head<2>()), q = point_at(b, x.tail<2>());
    const Vec3 t1 = p.jet.du.normalized(), t2 = p.normal.cross(t1);
    const Vec3 way = (p.jet.position - q.jet.position) / scale;
    return {q.normal.dot(t1), q.normal.dot(t2), way.dot(t1), way.dot(t2)};
  }
};

}  // namespace

std::optional<Critical> find_critical(const yarn::Body& a, const Vec2& site_a, const yarn::Body& b,
                                      const Vec2& site_b) {
  Vec4 x;
  x << inside(a, site_a), inside(b, site_b);
  const SurfacePoint p0 = point_at(a, site_a), q0 = point_at(b, site_b);
  // Lengths are measured by how far the section's u goes round: S_u times its whole range.
  const double scale = 0.25 * p0.jet.du.norm() * (a.surface.last_u() - a.surface.first_u());
  if (!(scale > 0.0)) return std::nullopt;
  // Unknowns in lengths too, so that a step means the same in each.
  const Vec4 unit = scale * Vec4(1.0 / p0.jet.du.norm(), 1.0 / p0.jet.dv.norm(), 1.0 / q0.jet.du.norm(),
                                 1.0 / q0.jet.dv.norm());
  if (!unit.allFinite()) return std::nullopt;
  const Equations equations{a, b, scale};
  Vec4 r = equations.residual(x);
  constexpr double accuracy = 1e-10;
  for (int step = 0; step < 40 && r.norm() > accuracy; ++step) {
    Mat4 jacobian;
    constexpr double h = 1e-6;
    for (int k = 0; k < 4; ++k) {
      Vec4 up = x, down = x;
      up[k] += h * unit[k];
      down[k] -= h * unit[k];
      jacobian.col(k) = (equations.residual(up) - equations.residual(down)) / (2.0 * h);
    }
    Eigen::CompleteOrthogonalDecomposition<Mat4> solver;
    solver.setThreshold(1e-5);  // along a line of solutions: the shortest step
    solver.compute(jacobian);
    Vec4 move = solver.solve(-r);
    if (!move.allFinite()) return std::nullopt;
    if (const double size = move.norm(); size > 0.3) move *= 0.3 / size;
    bool better = false;
    for (int halving = 0; halving < 8 && !better; ++halving, move *= 0.5) {
      Vec4 next = x + move.cwiseProduct(unit);
      next << inside(a, next.head<2>()), inside(b, next.tail<2>());
      const Vec4 residual = equations.residual(next);
      if (residual.norm() < r.norm()) {
        x = next;
        r = residual;
        better = true;
      }
    }
    if (!better) break;
  }
  if (!(r.norm() <= 1e-7)) return std::nullopt;
  const SurfacePoint p = point_at(a, x.head<2>()), q = point_at(b, x.tail<2>());
  if (!(p.normal.dot(q.normal) < -0.5))
    return std::nullopt;  // the same way round: one surface touches the other inside
  return Critical{p.jet.position, q.jet.position, p.normal, (p.jet.position - q.jet.position).dot(p.normal)};
}

namespace {

// cells + 1 places from low to high and the knots between them (where an edge can be), which repeat by
// `period`.
std::vector<double> places(double low, double high, int cells, const std::vector<double>& breaks,
                           double period) {
  std::vector<double> sites;
  for (int i = 0; i <= cells; ++i) sites.push_back(low + (high - low) * i / cells);
  const double grain = 1e-9 * (high - low);
  for (int turn = -2; turn <= 2; ++turn)
    for (double t : breaks) {
      t += turn * period;
      if (t <= low || t >= high || (turn != 0 && period == 0.0)) continue;
      const auto near = std::lower_bound(sites.begin(), sites.end(), t - grain);
      if (std::abs(*near - t) <= grain) {
        *near = t;
      } else {
        sites.insert(near, t);
      }
    }
  return sites;
}

}  // namespace

Tessellation sample(const yarn::Body& body, const Window& window, int cells) {
  const nurbs::Surface& s = body.surface;
  const double first = s.first_v(), last = s.last_v();
  const bool ring = body.closed_along;
  std::vector<double> us = places(window.low.x(), window.high.x(), cells,
                                  nurbs::breakpoints(s.knots_u, s.degree_u), s.last_u() - s.first_u());
  std::vector<double> vs = places(ring ? window.low.y() : std::clamp(window.low.y(), first, last),
                                  ring ? window.high.y() : std::clamp(window.high.y(), first, last), cells,
                                  nurbs::breakpoints(s.knots_v, s.degree_v), ring ? last - first : 0.0);
  for (double& u : us) u = inside(body, {u, vs[0]}).x();
  for (double& v : vs) v = inside(body, {us[0], v}).y();
  Tessellation out;
  out.vertices = nurbs::evaluate_grid(body.surface, us, vs);
  for (double v : vs)
    for (double u : us) out.sites.emplace_back(u, v);
  const auto n = static_cast<std::uint32_t>(us.size()), rows = static_cast<std::uint32_t>(vs.size());
  for (std::uint32_t j = 0; j + 1 < rows; ++j)
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      const std::uint32_t k = j * n + i;
      if (body.inward) {
        out.triangles.push_back({k, k + n + 1, k + 1});
        out.triangles.push_back({k, k + n, k + n + 1});
      } else {
        out.triangles.push_back({k, k + 1, k + n + 1});
        out.triangles.push_back({k, k + n + 1, k + n});
      }
    }
  return out;
}

}  // namespace selvage::solid
