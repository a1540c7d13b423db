#include "contact/critical.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "nurbs/basis.h"
#include "nurbs/spline.h"

namespace selvage::contact {

namespace {

using Vec4 = Eigen::Vector4d;
using Mat4 = Eigen::Matrix4d;

// Sites outside the domain go round (closed directions) or to its border.
Vec2 inside(const Face& face, Vec2 site) {
  const nurbs::Surface& s = *face.surface;
  site.x() = face.round_u ? wrapped(site.x(), s.first_u(), s.last_u())
                          : std::clamp(site.x(), s.first_u(), s.last_u());
  site.y() = face.round_v ? wrapped(site.y(), s.first_v(), s.last_v())
                          : std::clamp(site.y(), s.first_v(), s.last_v());
  return site;
}

// The four equations of a critical pair, in lengths of `scale`.
struct Equations {
  const Face& a;
  const Face& b;
  double scale;
  Vec3 shift;

  [[nodiscard]] Vec4 residual(const SurfacePoint& p, const SurfacePoint& q) const {
    const Vec3 t1 = p.jet.du.normalized(), t2 = p.normal.cross(t1);
    const Vec3 way = (p.jet.position - q.jet.position - shift) / scale;
    return {q.normal.dot(t1), q.normal.dot(t2), way.dot(t1), way.dot(t2)};
  }
  [[nodiscard]] Vec4 residual(const Vec4& x) const {
    return residual(point_at(a, x.head<2>()), point_at(b, x.tail<2>()));
  }
  // Central differences; a step moves one of the two points only.
  [[nodiscard]] Mat4 jacobian(const Vec4& x, const Vec4& unit) const {
    constexpr double h = 1e-6;
    const SurfacePoint p = point_at(a, x.head<2>()), q = point_at(b, x.tail<2>());
    Mat4 out;
    for (int k = 0; k < 4; ++k) {
      Vec4 up = x, down = x;
      up[k] += h * unit[k];
      down[k] -= h * unit[k];
      const Vec4 high =
          k < 2 ? residual(point_at(a, up.head<2>()), q) : residual(p, point_at(b, up.tail<2>()));
      const Vec4 low =
          k < 2 ? residual(point_at(a, down.head<2>()), q) : residual(p, point_at(b, down.tail<2>()));
      out.col(k) = (high - low) / (2.0 * h);
    }
    return out;
  }
};

}  // namespace

SurfacePoint point_at(const Face& face, const Vec2& site) {
  const Vec2 s = inside(face, site);
  SurfacePoint out;
  out.jet = nurbs::evaluate_jet(*face.surface, s.x(), s.y());
  const Vec3 cross = out.jet.du.cross(out.jet.dv);
  const double size = cross.norm();
  if (size > 0.0) out.normal = (face.inward ? -1.0 : 1.0) / size * cross;
  return out;
}

std::optional<Critical> find_critical(const Face& a, const Vec2& site_a, const Face& b, const Vec2& site_b,
                                      const Vec3& shift) {
  Vec4 x;
  x << inside(a, site_a), inside(b, site_b);
  const SurfacePoint p0 = point_at(a, site_a), q0 = point_at(b, site_b);
  // Lengths are measured by how far the section's u goes round: S_u times its whole range.
  const double scale = 0.25 * p0.jet.du.norm() * (a.surface->last_u() - a.surface->first_u());
  if (!(scale > 0.0)) return std::nullopt;
  // Unknowns in lengths too, so that a step means the same in each.
  const Vec4 unit = scale * Vec4(1.0 / p0.jet.du.norm(), 1.0 / p0.jet.dv.norm(), 1.0 / q0.jet.du.norm(),
                                 1.0 / q0.jet.dv.norm());
  if (!unit.allFinite()) return std::nullopt;
  const Equations equations{a, b, scale, shift};
  Vec4 r = equations.residual(x);
  constexpr double accuracy = 1e-10;
  for (int step = 0; step < 40 && r.norm() > accuracy; ++step) {
    Eigen::CompleteOrthogonalDecomposition<Mat4> solver;
    solver.setThreshold(1e-5);  // along a line of solutions: the shortest step
    solver.compute(equations.jacobian(x, unit));
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
  const Vec3 moved = q.jet.position + shift;
  return Critical{x.head<2>(), x.tail<2>(), p.jet.position,
                  moved,       p.normal,    (p.jet.position - moved).dot(p.normal)};
}

namespace {

// Three equations of a crease and a smooth surface, in lengths of `scale`: the way from its foot is along the
// normal, which the crease is perpendicular to.
struct CreaseEquations {
  const Face& a;
  const Face& b;
  double crease, scale;

  [[nodiscard]] Vec3 residual(const Vec3& x) const {
    const SurfacePoint p = point_at(a, {crease, x[0]}), q = point_at(b, x.tail<2>());
    const Vec3 t1 = q.jet.du.normalized(), t2 = q.normal.cross(t1);
    const Vec3 way = (p.jet.position - q.jet.position) / scale;
    return {way.dot(t1), way.dot(t2), q.normal.dot(p.jet.dv.normalized())};
  }
  [[nodiscard]] Eigen::Matrix3d jacobian(const Vec3& x, const Vec3& unit) const {
    constexpr double h = 1e-6;
    Eigen::Matrix3d out;
    for (int k = 0; k < 3; ++k) {
      const Vec3 step = h * unit[k] * Vec3::Unit(k);
      out.col(k) = (residual(x + step) - residual(x - step)) / (2.0 * h);
    }
    return out;
  }
};

}  // namespace

std::optional<Critical> find_crease(const Face& a, double crease, double v, const Face& b,
                                    const Vec2& site_b) {
  const SurfacePoint p0 = point_at(a, {crease, v}), q0 = point_at(b, site_b);
  const double scale = 0.25 * q0.jet.du.norm() * (b.surface->last_u() - b.surface->first_u());
  if (!(scale > 0.0)) return std::nullopt;
  const Vec3 unit = scale * Vec3(1.0 / p0.jet.dv.norm(), 1.0 / q0.jet.du.norm(), 1.0 / q0.jet.dv.norm());
  if (!unit.allFinite()) return std::nullopt;
  const CreaseEquations equations{a, b, crease, scale};
  Vec3 x(v, site_b.x(), site_b.y());
  Vec3 r = equations.residual(x);
  constexpr double accuracy = 1e-11;
  for (int step = 0; step < 40 && r.norm() > accuracy; ++step) {
    Vec3 move = equations.jacobian(x, unit).fullPivLu().solve(-r);
    if (!move.allFinite()) return std::nullopt;
    if (const double size = move.norm(); size > 0.3) move *= 0.3 / size;
    bool better = false;
    for (int halving = 0; halving < 8 && !better; ++halving, move *= 0.5) {
      Vec3 next = x + move.cwiseProduct(unit);
      next << inside(a, {crease, next[0]}).y(), inside(b, next.tail<2>());
      const Vec3 residual = equations.residual(next);
      better = residual.norm() < r.norm();
      if (!better) continue;
      x = next;
      r = residual;
    }
    if (!better) break;
  }
  if (!(r.norm() <= 1e-7)) return std::nullopt;
  const SurfacePoint p = point_at(a, {crease, x[0]}), q = point_at(b, x.tail<2>());
  return Critical{{crease, x[0]}, x.tail<2>(), p.jet.position,
                  q.jet.position, -q.normal,   (q.jet.position - p.jet.position).dot(q.normal)};
}

std::optional<double> crease_near(const Face& face, const Vec2& site) {
  const nurbs::Surface& s = *face.surface;
  const double range = s.last_u() - s.first_u();
  std::optional<double> nearest;
  double least = range / 16.0;
  for (const double u : nurbs::breakpoints(s.knots_u, s.degree_u)) {
    double distance = std::abs(u - site.x());
    if (face.round_u) distance = std::min(distance, range - distance);
    if (distance >= least || nurbs::multiplicity(s.knots_u, u) < s.degree_u) continue;
    // Its normals to both sides.
    constexpr double beside = 1e-4, smooth = 0.99;
    const Vec3 before = point_at(face, {u - beside * range, site.y()}).normal,
               after = point_at(face, {u + beside * range, site.y()}).normal;
    if (before.dot(after) > smooth) continue;
    nearest = u;
    least = distance;
  }
  return nearest;
}

NearestPoints find_nearest(const Face& a, const Cell& cell_a, const Vec2& site_a, const Face& b,
                           const Cell& cell_b, const Vec2& site_b) {
  Vec4 low, high, x;
  low << cell_a.low, cell_b.low;
  high << cell_a.high, cell_b.high;
  x << site_a, site_b;
  x = x.cwiseMax(low).cwiseMin(high);
  const auto jets = [&](const Vec4& at) {
    return std::pair(nurbs::evaluate_jet(*a.surface, at[0], at[1]),
                     nurbs::evaluate_jet(*b.surface, at[2], at[3]));
  };
  auto [p, q] = jets(x);
  double cost = (p.position - q.position).squaredNorm();
  double damping = 1e-6;
  for (int step = 0; step < 60 && cost > 0.0; ++step) {
    Eigen::Matrix<double, 3, 4> slope;
    slope << p.du, p.dv, -q.du, -q.dv;
    const Vec3 way = p.position - q.position;
    const Vec4 gradient = slope.transpose() * way;
    Mat4 normal = slope.transpose() * slope;
    const Vec4 scale = normal.diagonal().cwiseMax(1e-300);
    // Parameters at a bound that the gradient presses against stay there.
    for (int k = 0; k < 4; ++k) {
      const bool held = (x[k] <= low[k] && gradient[k] > 0.0) || (x[k] >= high[k] && gradient[k] < 0.0);
      normal(k, k) += damping * scale[k];
      if (!held) continue;
      normal.row(k).setZero();
      normal.col(k).setZero();
      normal(k, k) = 1.0;
    }
    Vec4 right = -gradient;
    for (int k = 0; k < 4; ++k)
      if ((x[k] <= low[k] && gradient[k] > 0.0) || (x[k] >= high[k] && gradient[k] < 0.0)) right[k] = 0.0;
    const Vec4 move = normal.ldlt().solve(right);
    if (!move.allFinite()) break;
    const Vec4 next = (x + move).cwiseMax(low).cwiseMin(high);
    const auto [np, nq] = jets(next);
    const double value = (np.position - nq.position).squaredNorm();
    if (value < cost) {
      const bool settled = value > cost * (1.0 - 1e-12);
      x = next;
      p = np;
      q = nq;
      cost = value;
      damping = std::max(damping * 0.2, 1e-12);
      if (settled) break;
    } else {
      damping *= 8.0;
      if (damping > 1e8) break;
    }
  }
  return {x.head<2>(), x.tail<2>(), p.position, q.position};
}

}  // namespace selvage::contact
