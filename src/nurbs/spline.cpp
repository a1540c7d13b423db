#include "nurbs/spline.h"

#include <algorithm>
#include <cmath>

#include "core/index.h"
#include "nurbs/basis.h"

namespace selvage::nurbs {

namespace {

double clamp_to(const std::vector<double>& knots, int degree, int count, double t) {
  return std::clamp(t, knots[at(degree)], knots[at(count)]);
}

// Position, first and second derivative of a quotient A / w from those of A and w (Piegl and Tiller 4.8).
CurveJet quotient(const std::array<Vec3, 3>& a, const std::array<double, 3>& w) {
  CurveJet jet;
  jet.position = a[0] / w[0];
  jet.d1 = (a[1] - w[1] * jet.position) / w[0];
  jet.d2 = (a[2] - 2.0 * w[1] * jet.d1 - w[2] * jet.position) / w[0];
  return jet;
}

}  // namespace

CurveJet evaluate_jet(const Curve& curve, double t) {
  const int count = static_cast<int>(curve.points.size());
  t = clamp_to(curve.knots, curve.degree, count, t);
  const int span = find_span(curve.knots, curve.degree, count, t);
  std::array<BasisRow, 3> rows;
  basis_derivatives(curve.knots, curve.degree, span, t, rows);
  if (!curve.is_rational()) {
    const Vec3* const points = &curve.points[at(span - curve.degree)];
    CurveJet jet{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    for (std::size_t j = 0; j <= at(curve.degree); ++j) {
      jet.position += rows[0][j] * points[j];
      jet.d1 += rows[1][j] * points[j];
      jet.d2 += rows[2][j] * points[j];
    }
    return jet;
  }
  std::array<Vec3, 3> sums = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  std::array<double, 3> weights = {0.0, 0.0, 0.0};
  for (int j = 0; j <= curve.degree; ++j) {
    const std::size_t i = at(span - curve.degree + j);
    for (std::size_t k = 0; k < 3; ++k) {
      const double share = rows[k][at(j)] * curve.weight(i);
      sums[k] += share * curve.points[i];
      weights[k] += share;
    }
  }
  return quotient(sums, weights);
}

Vec3 evaluate(const Curve& curve, double t) {
  const int count = static_cast<int>(curve.points.size());
  t = clamp_to(curve.knots, curve.degree, count, t);
  const int span = find_span(curve.knots, curve.degree, count, t);
  BasisRow values;
  basis(curve.knots, curve.degree, span, t, values);
  Vec3 sum = Vec3::Zero();
  double total = 0.0;
  for (int j = 0; j <= curve.degree; ++j) {
    const std::size_t i = at(span - curve.degree + j);
    const double share = values[at(j)] * curve.weight(i);
    sum += share * curve.points[i];
    total += share;
  }
  return curve.is_rational() ? Vec3(sum / total) : sum;
}

SurfaceJet evaluate_jet(const Surface& surface, double u, double v) {
  u = clamp_to(surface.knots_u, surface.degree_u, surface.count_u, u);
  v = clamp_to(surface.knots_v, surface.degree_v, surface.count_v, v);
  const int span_u = find_span(surface.knots_u, surface.degree_u, surface.count_u, u);
  const int span_v = find_span(surface.knots_v, surface.degree_v, surface.count_v, v);
  std::array<BasisRow, 3> rows_u, rows_v;
  basis_derivatives(surface.knots_u, surface.degree_u, span_u, u, rows_u);
  basis_derivatives(surface.knots_v, surface.degree_v, span_v, v, rows_v);
  Vec3 position = Vec3::Zero(), du = Vec3::Zero(), dv = Vec3::Zero();
  double w = 0.0, wu = 0.0, wv = 0.0;
  for (int j = 0; j <= surface.degree_v; ++j) {
    for (int i = 0; i <= surface.degree_u; ++i) {
      const std::size_t k = surface.index(span_u - surface.degree_u + i, span_v - surface.degree_v + j);
      const double weight = surface.is_rational() ? surface.weights[k] : 1.0;
      const double value = rows_u[0][at(i)] * rows_v[0][at(j)] * weight;
      const double along_u = rows_u[1][at(i)] * rows_v[0][at(j)] * weight;
      const double along_v = rows_u[0][at(i)] * rows_v[1][at(j)] * weight;
      position += value * surface.points[k];
      du += along_u * surface.points[k];
      dv += along_v * surface.points[k];
      w += value;
      wu += along_u;
      wv += along_v;
    }
  }
  if (!surface.is_rational()) return {position, du, dv};
  position /= w;
  return {position, (du - wu * position) / w, (dv - wv * position) / w};
}

Vec3 evaluate(const Surface& surface, double u, double v) {
  return evaluate_grid(surface, {u}, {v}).front();
}

std::vector<Vec3> evaluate_grid(const Surface& surface, const std::vector<double>& us,
                                const std::vector<double>& vs) {
  struct Row {
    int first;
    BasisRow values;
  };
  const auto rows_of = [](const std::vector<double>& knots, int degree, int count,
                          const std::vector<double>& sites) {
    std::vector<Row> rows(sites.size());
    for (std::size_t k = 0; k < sites.size(); ++k) {
      const double t = clamp_to(knots, degree, count, sites[k]);
      const int span = find_span(knots, degree, count, t);
      basis(knots, degree, span, t, rows[k].values);
      rows[k].first = span - degree;
    }
    return rows;
  };
  const std::vector<Row> rows_u = rows_of(surface.knots_u, surface.degree_u, surface.count_u, us);
  const std::vector<Row> rows_v = rows_of(surface.knots_v, surface.degree_v, surface.count_v, vs);
  std::vector<Vec3> out;
  out.reserve(us.size() * vs.size());
  // One v at a time: the control net collapses to one row of (weighted) points, which every u then uses.
  std::vector<Vec3> line(at(surface.count_u));
  std::vector<double> line_weights(at(surface.count_u), 1.0);
  for (const Row& row_v : rows_v) {
    for (int i = 0; i < surface.count_u; ++i) {
      Vec3 sum = Vec3::Zero();
      double total = 0.0;
      for (int j = 0; j <= surface.degree_v; ++j) {
        const std::size_t k = surface.index(i, row_v.first + j);
        const double share = row_v.values[at(j)] * (surface.is_rational() ? surface.weights[k] : 1.0);
        sum += share * surface.points[k];
        total += share;
      }
      line[at(i)] = sum;
      line_weights[at(i)] = total;
    }
    for (const Row& row_u : rows_u) {
      Vec3 sum = Vec3::Zero();
      double total = 0.0;
      for (int i = 0; i <= surface.degree_u; ++i) {
        sum += row_u.values[at(i)] * line[at(row_u.first + i)];
        total += row_u.values[at(i)] * line_weights[at(row_u.first + i)];
      }
      out.push_back(surface.is_rational() ? Vec3(sum / total) : sum);
    }
  }
  return out;
}

Curve boundary_row(const Surface& surface, bool last) {
  Curve curve;
  curve.degree = surface.degree_u;
  curve.knots = surface.knots_u;
  const auto begin = static_cast<std::ptrdiff_t>(surface.index(0, last ? surface.count_v - 1 : 0));
  curve.points.assign(surface.points.begin() + begin, surface.points.begin() + begin + surface.count_u);
  if (surface.is_rational())
    curve.weights.assign(surface.weights.begin() + begin, surface.weights.begin() + begin + surface.count_u);
  return curve;
}

Curve row_at(const Surface& surface, double v) {
  v = clamp_to(surface.knots_v, surface.degree_v, surface.count_v, v);
  const int span = find_span(surface.knots_v, surface.degree_v, surface.count_v, v);
  BasisRow values;
  basis(surface.knots_v, surface.degree_v, span, v, values);
  Curve curve;
  curve.degree = surface.degree_u;
  curve.knots = surface.knots_u;
  for (int i = 0; i < surface.count_u; ++i) {
    Vec3 sum = Vec3::Zero();
    double total = 0.0;
    for (int j = 0; j <= surface.degree_v; ++j) {
      const int row = span - surface.degree_v + j;
      const double share = values[at(j)] * surface.weight(i, row);
      sum += share * surface.point(i, row);
      total += share;
    }
    curve.points.emplace_back(surface.is_rational() ? Vec3(sum / total) : sum);
    if (surface.is_rational()) curve.weights.push_back(total);
  }
  return curve;
}

Curve control_column(const Surface& surface, int i) {
  Curve curve;
  curve.degree = surface.degree_v;
  curve.knots = surface.knots_v;
  for (int j = 0; j < surface.count_v; ++j) {
    curve.points.push_back(surface.point(i, j));
    if (surface.is_rational()) curve.weights.push_back(surface.weight(i, j));
  }
  return curve;
}

Surface of_columns(int degree_u, const std::vector<double>& knots_u, const std::vector<Curve>& columns) {
  Surface surface;
  surface.degree_u = degree_u;
  surface.degree_v = columns.front().degree;
  surface.count_u = static_cast<int>(columns.size());
  surface.count_v = static_cast<int>(columns.front().points.size());
  surface.knots_u = knots_u;
  surface.knots_v = columns.front().knots;
  for (std::size_t j = 0; j < columns.front().points.size(); ++j)
    for (const Curve& column : columns) {
      surface.points.push_back(column.points[j]);
      if (column.is_rational()) surface.weights.push_back(column.weights[j]);
    }
  return surface;
}

Curve boundary_column(const Surface& surface, bool last) {
  return control_column(surface, last ? surface.count_u - 1 : 0);
}

std::array<Curve, 4> boundary_round(const Surface& surface) {
  return {boundary_row(surface, false), boundary_column(surface, true), reversed(boundary_row(surface, true)),
          reversed(boundary_column(surface, false))};
}

std::vector<double> breakpoints(const std::vector<double>& knots, int degree) {
  std::vector<double> values(knots.begin() + degree, knots.end() - degree);
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

Curve insert_knot(const Curve& curve, double t, int times) {
  if (times <= 0) return curve;
  const int p = curve.degree;
  const int count = static_cast<int>(curve.points.size());
  const int span = find_span(curve.knots, p, count, t);
  Curve out;
  out.degree = p;
  out.knots = curve.knots;
  out.knots.insert(out.knots.begin() + span + 1, t);
  out.points.reserve(at(count + 1));
  std::vector<double> weights;
  const auto weight = [&](int i) { return curve.weight(at(i)); };
  for (int i = 0; i <= count; ++i) {
    double alpha = 0.0;
    if (i <= span - p) {
      alpha = 1.0;
    } else if (i <= span) {
      const double low = curve.knots[at(i)], high = curve.knots[at(i + p)];
      alpha = high > low ? (t - low) / (high - low) : 0.0;
    }
    // The ends of the blend keep their bits.
    if (alpha == 1.0 || i == 0) {
      out.points.push_back(curve.points[at(i)]);
      weights.push_back(weight(i));
    } else if (alpha == 0.0) {
      out.points.push_back(curve.points[at(i - 1)]);
      weights.push_back(weight(i - 1));
    } else {
      const double here = alpha * weight(i), before = (1.0 - alpha) * weight(i - 1);
      out.points.push_back(
          curve.is_rational()
              ? Vec3((here * curve.points[at(i)] + before * curve.points[at(i - 1)]) / (here + before))
              : Vec3(alpha * curve.points[at(i)] + (1.0 - alpha) * curve.points[at(i - 1)]));
      weights.push_back(here + before);
    }
  }
  if (curve.is_rational()) out.weights = std::move(weights);
  return insert_knot(out, t, times - 1);
}

Curve segment(const Vec3& from, const Vec3& to, double t0, double t1) {
  return {.degree = 1, .knots = {t0, t0, t1, t1}, .points = {from, to}, .weights = {}};
}

int multiplicity(const std::vector<double>& knots, double t) {
  return static_cast<int>(std::count(knots.begin(), knots.end(), t));
}

Curve opened_at(const Curve& curve, double t) {
  return insert_knot(curve, t, curve.degree - multiplicity(curve.knots, t));
}

Curve sub_curve(const Curve& curve, double t0, double t1) {
  const Curve whole = opened_at(opened_at(curve, t0), t1);
  const auto first_knot = std::lower_bound(whole.knots.begin(), whole.knots.end(), t0),
             past_first = std::upper_bound(first_knot, whole.knots.end(), t0),
             last_knot = std::lower_bound(past_first, whole.knots.end(), t1);
  // With multiplicity p at t, the curve passes through the control point whose p following knots are all t;
  // a clamped start has p + 1.
  const auto first_point =
                 first_knot - whole.knots.begin() - (past_first - first_knot > curve.degree ? 0 : 1),
             end_point = last_knot - whole.knots.begin();
  Curve part;
  part.degree = curve.degree;
  part.points.assign(whole.points.begin() + first_point, whole.points.begin() + end_point);
  if (whole.is_rational())
    part.weights.assign(whole.weights.begin() + first_point, whole.weights.begin() + end_point);
  part.knots.assign(at(curve.degree + 1), t0);
  part.knots.insert(part.knots.end(), past_first, last_knot);
  part.knots.insert(part.knots.end(), at(curve.degree + 1), t1);
  return part;
}

std::vector<double> reversed_knots(const std::vector<double>& knots) {
  std::vector<double> out(knots.size());
  const double sum = knots.front() + knots.back();
  std::transform(knots.rbegin(), knots.rend(), out.begin(), [sum](double knot) { return sum - knot; });
  return out;
}

Curve reversed(const Curve& curve) {
  Curve out = curve;
  std::reverse(out.points.begin(), out.points.end());
  std::reverse(out.weights.begin(), out.weights.end());
  out.knots = reversed_knots(curve.knots);
  return out;
}

}  // namespace selvage::nurbs
