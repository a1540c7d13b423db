#include "nurbs/patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "core/index.h"
#include "nurbs/basis.h"

namespace selvage::nurbs {

namespace {

// Bezier control points over [low, high] as combinations of the degree + 1 control points of a knot span.
struct Extraction {
  int first = 0;  // control point
  std::array<BasisRow, max_degree + 1> rows;
};

void extract(const std::vector<double>& knots, int degree, int count, double low, double high,
             Extraction& out) {
  const int span = find_span(knots, degree, count, 0.5 * (low + high));
  out.first = span - degree;
  std::array<double, max_degree> arguments{};  // `degree - k` times low, k times high
  std::fill_n(arguments.begin(), degree, low);
  for (int k = 0; k <= degree; ++k) {
    if (k > 0) arguments[at(degree - k)] = high;
    polar_form(knots, degree, span, arguments.data(), out.rows[at(k)]);
  }
}

// Bernstein polynomials of a degree at even steps: (steps + 1) x (degree + 1).
const std::vector<double>& bernstein_table(int degree, int steps, std::vector<double>& scratch) {
  scratch.assign(at((steps + 1) * (degree + 1)), 0.0);
  for (int s = 0; s <= steps; ++s) {
    double* row = scratch.data() + static_cast<std::ptrdiff_t>(s) * (degree + 1);
    const double t = static_cast<double>(s) / steps;
    row[0] = 1.0;
    for (int k = 1; k <= degree; ++k) {
      double saved = 0.0;
      for (int i = 0; i < k; ++i) {
        const double value = row[i];
        row[i] = saved + (1.0 - t) * value;
        saved = t * value;
      }
      row[k] = saved;
    }
  }
  return scratch;
}

// How far the hull of the points stands out of the box.
double excess(const Box3& box, std::span<const Vec3> points) {
  Box3 hull;
  for (const Vec3& p : points) hull.extend(p);
  return std::max((box.min() - hull.min()).maxCoeff(), (hull.max() - box.max()).maxCoeff());
}

// The largest second difference along an axis.
double bend(const Patch& patch, int axis) {
  const int step_u = axis == 0 ? 1 : 0, step_v = 1 - step_u;
  double most = 0.0;
  for (int j = step_v; j + step_v < patch.count_v; ++j)
    for (int i = step_u; i + step_u < patch.count_u; ++i)
      most = std::max(most, (patch.point(i - step_u, j - step_v) - 2.0 * patch.point(i, j) +
                             patch.point(i + step_u, j + step_v))
                                .squaredNorm());
  return most;
}

void extend(Box3& box, const Patch& patch, double tolerance) {
  for (const int j : {0, patch.count_v - 1})
    for (const int i : {0, patch.count_u - 1}) box.extend(patch.point(i, j));
  if (!(excess(box, patch.points) > tolerance)) return;
  const int axis = bend(patch, 0) >= bend(patch, 1) ? 0 : 1;
  for (const bool upper : {false, true}) extend(box, half_of(patch, axis, upper), tolerance);
}

}  // namespace

Patch patch_of(const Surface& s, const Vec2& low, const Vec2& high) {
  thread_local Extraction u, v;
  extract(s.knots_u, s.degree_u, s.count_u, low.x(), high.x(), u);
  extract(s.knots_v, s.degree_v, s.count_v, low.y(), high.y(), v);
  const int p = s.degree_u, q = s.degree_v;
  Patch out;
  out.count_u = p + 1;
  out.count_v = q + 1;
  out.points.resize(at((p + 1) * (q + 1)));
  if (s.is_rational()) out.weights.resize(out.points.size());
  std::array<Vec3, max_degree + 1> line;
  std::array<double, max_degree + 1> line_weights{};
  for (int l = 0; l <= q; ++l) {
    for (int i = 0; i <= p; ++i) {
      Vec3 sum = Vec3::Zero();
      double total = 0.0;
      for (int j = 0; j <= q; ++j) {
        const std::size_t k = s.index(u.first + i, v.first + j);
        const double share = v.rows[at(l)][at(j)] * (s.is_rational() ? s.weights[k] : 1.0);
        sum += share * s.points[k];
        total += share;
      }
      line[at(i)] = sum;
      line_weights[at(i)] = total;
    }
    for (int k = 0; k <= p; ++k) {
      Vec3 sum = Vec3::Zero();
      double total = 0.0;
      for (int i = 0; i <= p; ++i) {
        sum += u.rows[at(k)][at(i)] * line[at(i)];
        total += u.rows[at(k)][at(i)] * line_weights[at(i)];
      }
      const std::size_t n = at(l * (p + 1) + k);
      out.points[n] = s.is_rational() ? Vec3(sum / total) : sum;
      if (s.is_rational()) out.weights[n] = total;
    }
  }
  return out;
}

Patch half_of(const Patch& patch, int axis, bool upper) {
  Patch out = patch;
  const int count = axis == 0 ? patch.count_u : patch.count_v,
            lines = axis == 0 ? patch.count_v : patch.count_u;
  const int step = axis == 0 ? 1 : patch.count_u, next = axis == 0 ? patch.count_u : 1;
  for (int l = 0; l < lines; ++l) {
    const auto index = [&](int k) { return at(l * next + k * step); };
    // Round by round the end that is kept comes to rest.
    for (int r = 1; r < count; ++r)
      for (int k = 0; k < count - r; ++k) {
        const std::size_t to = index(upper ? k : count - 1 - k), from = index(upper ? k + 1 : count - 2 - k);
        if (out.weights.empty()) {
          out.points[to] = 0.5 * (out.points[to] + out.points[from]);
          continue;
        }
        const double sum = out.weights[to] + out.weights[from];
        out.points[to] = (out.weights[to] * out.points[to] + out.weights[from] * out.points[from]) / sum;
        out.weights[to] = 0.5 * sum;
      }
  }
  return out;
}

void sample(const Patch& patch, int cells_u, int cells_v, std::vector<Vec3>& out) {
  thread_local std::vector<double> table_u, table_v;
  thread_local std::vector<Vec3> line;
  thread_local std::vector<double> line_weights;
  const int nu = patch.count_u, nv = patch.count_v;
  bernstein_table(nu - 1, cells_u, table_u);
  bernstein_table(nv - 1, cells_v, table_v);
  out.clear();
  out.reserve(at((cells_u + 1) * (cells_v + 1)));
  line.resize(at(nu));
  line_weights.resize(at(nu));
  const bool rational = !patch.weights.empty();
  for (int l = 0; l <= cells_v; ++l) {
    for (int i = 0; i < nu; ++i) {
      Vec3 sum = Vec3::Zero();
      double total = 0.0;
      for (int j = 0; j < nv; ++j) {
        const std::size_t n = at(j * nu + i);
        const double share = table_v[at(l * nv + j)] * (rational ? patch.weights[n] : 1.0);
        sum += share * patch.points[n];
        total += share;
      }
      line[at(i)] = sum;
      line_weights[at(i)] = total;
    }
    for (int k = 0; k <= cells_u; ++k) {
      Vec3 sum = Vec3::Zero();
      double total = 0.0;
      for (int i = 0; i < nu; ++i) {
        sum += table_u[at(k * nu + i)] * line[at(i)];
        total += table_u[at(k * nu + i)] * line_weights[at(i)];
      }
      out.push_back(rational ? Vec3(sum / total) : sum);
    }
  }
}

void extend(Box3& box, const Surface& surface, double tolerance) {
  const std::vector<double> us = breakpoints(surface.knots_u, surface.degree_u),
                            vs = breakpoints(surface.knots_v, surface.degree_v);
  for (const Vec3& p : evaluate_grid(surface, us, vs)) box.extend(p);
  const auto columns = at(surface.count_u), rows = at(surface.degree_v) + 1;
  for (std::size_t j = 0; j + 1 < vs.size(); ++j) {
    const auto last =
        at(find_span(surface.knots_v, surface.degree_v, surface.count_v, 0.5 * (vs[j] + vs[j + 1])));
    const auto of_span = std::span(surface.points).subspan((last + 1 - rows) * columns, rows * columns);
    if (!(excess(box, of_span) > tolerance)) continue;
    for (std::size_t i = 0; i + 1 < us.size(); ++i)
      extend(box, patch_of(surface, {us[i], vs[j]}, {us[i + 1], vs[j + 1]}), tolerance);
  }
}

Vec3 middle_normal(const Patch& patch, bool inward) {
  const Vec3 across = patch.points.back() - patch.points.front(),
             other = patch.point(0, patch.count_v - 1) - patch.point(patch.count_u - 1, 0);
  return unit_or_zero(across.cross(other) * (inward ? -1.0 : 1.0));
}

double lowest(const Patch& patch, const Vec3& direction) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& p : patch.points) least = std::min(least, p.dot(direction));
  return least;
}

double highest(const Patch& patch, const Vec3& direction) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : patch.points) most = std::max(most, p.dot(direction));
  return most;
}

double slab_gap(const Patch& a, const Vec3& normal_a, const Patch& b, const Vec3& normal_b) {
  const auto middle = [](const Patch& patch) -> Vec3 {
    return 0.25 * (patch.points.front() + patch.points.back() + patch.point(patch.count_u - 1, 0) +
                   patch.point(0, patch.count_v - 1));
  };
  const auto gap = [&](const Vec3& n) { return lowest(b, n) - highest(a, n); };
  double best = -std::numeric_limits<double>::infinity();
  const Vec3 way = middle(b) - middle(a);
  const double length = way.norm();
  if (length > 0.0) best = gap(way / length);
  if (normal_a.squaredNorm() > 0.0) best = std::max(best, gap(normal_a));
  if (normal_b.squaredNorm() > 0.0) best = std::max(best, gap(-normal_b));
  const Vec3 both = normal_a - normal_b;
  const double size = both.norm();
  if (size > 1e-3) best = std::max(best, gap(both / size));
  return best;
}

}  // namespace selvage::nurbs
