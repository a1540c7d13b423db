#include "unit/contact/oracle.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Surface_mesh.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "solid/tessellation.h"

namespace selvage::test {

namespace {

struct Sampled {
  std::vector<double> us, vs;
  std::vector<Vec3> points, normals;

  Sampled(const yarn::Body& body, int round, int along) {
    const nurbs::Surface& s = body.surface;
    for (int i = 0; i < round; ++i)
      us.push_back(s.first_u() + (s.last_u() - s.first_u()) * (i + 0.5) / round);
    for (int j = 0; j <= along; ++j) vs.push_back(s.first_v() + (s.last_v() - s.first_v()) * j / along);
    for (const double v : vs)
      for (const double u : us) {
        const nurbs::SurfaceJet jet = nurbs::evaluate_jet(s, u, v);
        points.push_back(jet.position);
        normals.push_back((body.inward ? -1.0 : 1.0) * jet.du.cross(jet.dv).normalized());
      }
  }
};

struct Pair {
  Vec3 p, q, normal_p, normal_q;
};

class Solver {
 public:
  Solver(const yarn::Body& a, const yarn::Body& b) : a_(a), b_(b) {}

  // Where both normals lie on one line through both points, from a start; nothing where Newton's method
  // fails.
  std::optional<Pair> solve(Eigen::Vector4d x) const {
    for (int step = 0; step < 60; ++step) {
      const Eigen::Vector4d f = residual(x);
      Eigen::Matrix4d slope;
      for (int k = 0; k < 4; ++k) {
        Eigen::Vector4d up = x, down = x;
        const double h = 1e-6 * (k % 2 == 0 ? range_u(k) : range_v(k));
        up[k] += h;
        down[k] -= h;
        slope.col(k) = (residual(up) - residual(down)) / (2.0 * h);
      }
      Eigen::Vector4d move = slope.fullPivLu().solve(-f);
      if (!move.allFinite()) return std::nullopt;
      double most = 0.0;
      for (int k = 0; k < 4; ++k)
        most = std::max(most, std::abs(move[k]) / (k % 2 == 0 ? range_u(k) : range_v(k)));
      if (most > 0.02) move *= 0.02 / most;
      x += move;
      if (most < 1e-12) break;
    }
    if (x[1] < a_.surface.first_v() || x[1] > a_.surface.last_v() || x[3] < b_.surface.first_v() ||
        x[3] > b_.surface.last_v())
      return std::nullopt;
    const Pair found = at(x);
    if ((found.normal_p + found.normal_q).norm() > 1e-5) return std::nullopt;
    const Vec3 way = found.p - found.q;
    if ((way - way.dot(found.normal_p) * found.normal_p).norm() > 1e-8) return std::nullopt;
    return found;
  }

 private:
  [[nodiscard]] double range_u(int k) const {
    const nurbs::Surface& s = k < 2 ? a_.surface : b_.surface;
    return s.last_u() - s.first_u();
  }
  [[nodiscard]] double range_v(int k) const {
    const nurbs::Surface& s = k < 2 ? a_.surface : b_.surface;
    return s.last_v() - s.first_v();
  }
  [[nodiscard]] static nurbs::SurfaceJet jet(const yarn::Body& body, double u, double v) {
    const nurbs::Surface& s = body.surface;
    const double period = s.last_u() - s.first_u();
    u -= period * std::floor((u - s.first_u()) / period);
    return nurbs::evaluate_jet(s, u, v);
  }
  [[nodiscard]] Eigen::Vector4d residual(const Eigen::Vector4d& x) const {
    const Pair pair = at(x);
    const nurbs::SurfaceJet p = jet(a_, x[0], x[1]);
    const Vec3 way = pair.p - pair.q, tu = p.du.normalized(), tv = p.dv.normalized();
    return {pair.normal_q.dot(tu), pair.normal_q.dot(tv), way.dot(tu), way.dot(tv)};
  }
  [[nodiscard]] Pair at(const Eigen::Vector4d& x) const {
    const nurbs::SurfaceJet p = jet(a_, x[0], x[1]), q = jet(b_, x[2], x[3]);
    return {p.position, q.position, (a_.inward ? -1.0 : 1.0) * p.du.cross(p.dv).normalized(),
            (b_.inward ? -1.0 : 1.0) * q.du.cross(q.dv).normalized()};
  }

  const yarn::Body& a_;
  const yarn::Body& b_;
};

}  // namespace

std::optional<FacingPair> sampled_deepest(const yarn::Body& a, const yarn::Body& b, double farthest,
                                          int round, int along) {
  const Sampled sa(a, round, along), sb(b, round, along);
  const std::size_t n = sa.points.size();
  std::vector<double> depth(n, -std::numeric_limits<double>::infinity());
  std::vector<std::size_t> partner(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < sb.points.size(); ++j) {
      if (sa.normals[i].dot(sb.normals[j]) > -0.6) continue;
      const Vec3 way = sa.points[i] - sb.points[j];
      const double along_normal = way.dot(sa.normals[i]);
      if (std::abs(along_normal) > farthest) continue;
      const double aside = way.squaredNorm() - along_normal * along_normal;
      if (aside >= nearest) continue;
      nearest = aside;
      partner[i] = j;
      depth[i] = along_normal;
    }
  }
  std::optional<FacingPair> best;
  const Solver solver(a, b);
  const int rows = along + 1;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < round; ++i) {
      const auto k = static_cast<std::size_t>(j * round + i);
      if (!std::isfinite(depth[k])) continue;
      bool is_peak = true;
      for (int dj = -1; dj <= 1 && is_peak; ++dj)
        for (int di = -1; di <= 1 && is_peak; ++di) {
          if (j + dj < 0 || j + dj >= rows) continue;
          const auto other = static_cast<std::size_t>((j + dj) * round + (i + di + round) % round);
          is_peak = !(depth[other] > depth[k]);
        }
      if (!is_peak) continue;
      const std::size_t m = partner[k];
      const auto columns = static_cast<std::size_t>(round);
      const std::optional<Pair> found =
          solver.solve({sa.us[k % columns], sa.vs[k / columns], sb.us[m % columns], sb.vs[m / columns]});
      if (!found) continue;
      const double here = (found->p - found->q).dot(found->normal_p);
      if (std::abs(here) > farthest || (best && here <= best->depth)) continue;
      best = FacingPair{here, found->p, found->q, found->normal_p};
    }
  return best;
}

double common_volume(const yarn::Body& a, const yarn::Body& b, double chord) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  const auto mesh_of = [&](const yarn::Body& body) {
    Mesh mesh;
    const Result<solid::Tessellation> skin = solid::tessellate(body, chord);
    if (!skin) return mesh;
    for (const Vec3& p : skin->vertices) mesh.add_vertex({p.x(), p.y(), p.z()});
    for (const auto& t : skin->triangles)
      mesh.add_face(Mesh::Vertex_index(t[0]), Mesh::Vertex_index(t[1]), Mesh::Vertex_index(t[2]));
    return mesh;
  };
  Mesh one = mesh_of(a), two = mesh_of(b), common;
  if (!pmp::corefine_and_compute_intersection(one, two, common)) return -1.0;
  return common.is_empty() ? 0.0 : CGAL::to_double(pmp::volume(common));
}

}  // namespace selvage::test
