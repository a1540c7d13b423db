#include "nurbs/patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
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

// One coordinate of a polynomial patch: Bernstein coefficients, u fastest.
struct Height {
  int count_u = 0, count_v = 0;
  std::vector<double> values;
  double bound = 0;  // the largest of them

  void find_bound() { bound = *std::max_element(values.begin(), values.end()); }
  [[nodiscard]] double corner() const {
    const std::size_t last = values.size() - 1, row = at(count_u) - 1;
    return std::max({values[0], values[row], values[last - row], values[last]});
  }
  [[nodiscard]] double bend(std::size_t step, std::size_t steps, std::size_t other, std::size_t lines) const {
    double most = 0.0;
    for (std::size_t l = 0; l < lines; ++l)
      for (std::size_t k = l * other + step; k < l * other + (steps - 1) * step; k += step)
        most = std::max(most, std::abs(values[k - step] - 2.0 * values[k] + values[k + step]));
    return most;
  }
  // Leaves the lower half here, and the upper one there (de Casteljau).
  void halve(Height& upper) {
    const std::size_t nu = at(count_u), nv = at(count_v);
    const bool is_along_u = bend(1, nu, nu, nv) >= bend(nu, nv, 1, nu);
    const std::size_t step = is_along_u ? 1 : nu, steps = is_along_u ? nu : nv, other = is_along_u ? nu : 1,
                      lines = is_along_u ? nv : nu;
    upper = *this;
    for (std::size_t l = 0; l < lines; ++l) {
      double* const line = upper.values.data() + l * other;
      for (std::size_t r = steps; r-- > 0;) {
        values[l * other + (steps - 1 - r) * step] = line[0];
        for (std::size_t k = 0; k < r; ++k) line[k * step] = 0.5 * (line[k * step] + line[(k + 1) * step]);
      }
    }
    find_bound();
    upper.find_bound();
  }
};

// Grows `highest` to the patch's maximum, but for `tolerance`. Of the stack of patches the first is taken,
// and the rest is room to work in.
void raise(double& highest, std::vector<Height>& stack, double tolerance) {
  for (std::size_t count = 1; count > 0;) {
    Height& height = stack[count - 1];
    highest = std::max(highest, height.corner());
    if (!(height.bound > highest + tolerance)) {
      --count;
      continue;
    }
    if (count == stack.size()) stack.emplace_back();
    stack[count - 1].halve(stack[count]);
    // The more promising half first.
    if (stack[count].bound < stack[count - 1].bound) std::swap(stack[count], stack[count - 1]);
    ++count;
  }
}

// How far a polynomial surface reaches.
class Reach {
 public:
  explicit Reach(const Surface& surface)
      : surface_(surface),
        us_(breakpoints(surface.knots_u, surface.degree_u)),
        vs_(breakpoints(surface.knots_v, surface.degree_v)) {
    for (std::size_t j = 0; j + 1 < vs_.size(); ++j)
      rows_.push_back(
          at(find_span(surface.knots_v, surface.degree_v, surface.count_v, vs_[j]) - surface.degree_v));
  }

  // Along an axis (`sign`: 1 or -1): `known` or more, exact but for `tolerance`. Strips between two knots of
  // v are looked at in the order of what they promise.
  double operator()(Eigen::Index axis, double sign, double known, double tolerance) {
    const auto rows = at(surface_.degree_v) + 1, columns = at(surface_.count_u);
    heights_.resize(surface_.points.size());
    highest_.assign(at(surface_.count_v), -std::numeric_limits<double>::infinity());
    for (std::size_t j = 0, k = 0; j < highest_.size(); ++j)
      for (std::size_t i = 0; i < columns; ++i, ++k) {
        heights_[k] = sign * surface_.points[k][axis];
        highest_[j] = std::max(highest_[j], heights_[k]);
      }
    strips_.clear();
    for (std::size_t j = 0; j + 1 < vs_.size(); ++j) {
      const double bound = *std::max_element(&highest_[rows_[j]], &highest_[rows_[j]] + rows);
      if (bound > known + tolerance) strips_.push_back({bound, j});
    }
    std::sort(strips_.begin(), strips_.end(),
              [](const Strip& a, const Strip& b) { return a.bound > b.bound; });
    for (const Strip& strip : strips_)
      if (strip.bound > known + tolerance) look_at(strip, known, tolerance);
    return known;
  }

 private:
  struct Strip {
    double bound;
    std::size_t number;
  };

  void look_at(const Strip& strip, double& known, double tolerance) {
    const auto columns = at(surface_.count_u), width = at(surface_.degree_u) + 1,
               rows = at(surface_.degree_v) + 1;
    extract(surface_.knots_v, surface_.degree_v, surface_.count_v, vs_[strip.number], vs_[strip.number + 1],
            along_);
    lines_.resize(rows * columns);
    const double* const heights = &heights_[rows_[strip.number] * columns];
    for (std::size_t l = 0; l < rows; ++l)
      for (std::size_t i = 0; i < columns; ++i) {
        double sum = 0.0;
        for (std::size_t j = 0; j < rows; ++j) sum += along_.rows[l][j] * heights[j * columns + i];
        lines_[l * columns + i] = sum;
      }
    for (std::size_t i = 0; i + 1 < us_.size(); ++i) {
      const std::size_t column =
          at(find_span(surface_.knots_u, surface_.degree_u, surface_.count_u, us_[i])) + 1 - width;
      double bound = lines_[column];
      for (std::size_t l = 0; l < rows; ++l)
        for (std::size_t k = 0; k < width; ++k) bound = std::max(bound, lines_[l * columns + column + k]);
      if (!(bound > known + tolerance)) continue;
      const auto [round, is_new] = round_.try_emplace(i);
      if (is_new)
        extract(surface_.knots_u, surface_.degree_u, surface_.count_u, us_[i], us_[i + 1], round->second);
      Height& patch = stack_.front();
      patch.count_u = surface_.degree_u + 1;
      patch.count_v = surface_.degree_v + 1;
      patch.values.clear();
      for (std::size_t l = 0; l < rows; ++l)
        for (std::size_t k = 0; k < width; ++k) {
          double sum = 0.0;
          for (std::size_t c = 0; c < width; ++c)
            sum += round->second.rows[k][c] * lines_[l * columns + column + c];
          patch.values.push_back(sum);
        }
      patch.find_bound();
      raise(known, stack_, tolerance);
    }
  }

  const Surface& surface_;
  std::vector<double> us_, vs_;
  std::vector<double> heights_, highest_;  // of the control points, and of each row the highest
  std::vector<double> lines_;              // of a strip: B-splines over u, Bernstein polynomials over v
  std::vector<std::size_t> rows_;          // of each strip the first row of control points that counts there
  std::vector<Strip> strips_;
  Extraction along_;
  std::map<std::size_t, Extraction> round_;  // of the spans of u that were needed
  std::vector<Height> stack_{1};
};

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
  if (!surface.is_rational()) {
    Reach reach(surface);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      box.min()[axis] = -reach(axis, -1.0, -box.min()[axis], tolerance);
      box.max()[axis] = reach(axis, 1.0, box.max()[axis], tolerance);
    }
    return;
  }
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
