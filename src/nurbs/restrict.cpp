#include "nurbs/restrict.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/index.h"
#include "nurbs/basis.h"

namespace selvage::nurbs {

namespace {

// One direction: the new knots, and each new control point as a combination of degree + 1 old ones.
struct Restriction {
  std::vector<double> knots;
  struct Row {
    int first = 0;  // old control point
    BasisRow factors{};
  };
  std::vector<Row> rows;
};

// The control points over knots that hold all the old ones of their range.
Restriction over_knots(const std::vector<double>& knots, int degree, int count,
                       std::vector<double> new_knots) {
  Restriction result;
  result.knots = std::move(new_knots);
  const std::vector<double>& made = result.knots;
  const int new_count = static_cast<int>(made.size()) - degree - 1;
  for (int i = 0; i < new_count; ++i) {
    // A span that the new basis function lives on, as near to the middle of its arguments as there is one.
    int j = i + (degree + 1) / 2;
    while (j < i + degree && made[at(j)] == made[at(j) + 1]) ++j;
    while (j > i && made[at(j)] == made[at(j) + 1]) --j;
    const int span = find_span(knots, degree, count, (made[at(j)] + made[at(j) + 1]) / 2);
    Restriction::Row& row = result.rows.emplace_back();
    row.first = span - degree;
    polar_form(knots, degree, span, made.data() + i + 1, row.factors);
  }
  return result;
}

Restriction restriction(const std::vector<double>& knots, int degree, int count, double t0, double t1) {
  std::vector<double> made(at(degree) + 1, t0);
  for (const double knot : knots)
    if (knot > t0 && knot < t1) made.push_back(knot);
  made.insert(made.end(), at(degree) + 1, t1);
  return over_knots(knots, degree, count, std::move(made));
}

}  // namespace

Curve restricted(const Curve& curve, double t0, double t1) {
  const Restriction along =
      restriction(curve.knots, curve.degree, static_cast<int>(curve.points.size()), t0, t1);
  Curve part;
  part.degree = curve.degree;
  part.knots = along.knots;
  for (const Restriction::Row& row : along.rows) {
    Vec4 sum = Vec4::Zero();
    for (int c = 0; c <= curve.degree; ++c) {
      const std::size_t old = at(row.first + c);
      sum += row.factors[at(c)] * homogeneous(curve.points[old], curve.weight(old));
    }
    part.points.push_back(curve.is_rational() ? Vec3(sum.head<3>() / sum.w()) : Vec3(sum.head<3>()));
    if (curve.is_rational()) part.weights.push_back(sum.w());
  }
  return part;
}

namespace {

Surface combined(const Surface& surface, const Restriction& along_u, const Restriction& along_v) {
  const std::size_t nu = along_u.rows.size(), nv = along_v.rows.size();
  std::vector<Vec4> rows(nu * at(surface.count_v), Vec4::Zero());  // new in u, old in v
  for (int j = 0; j < surface.count_v; ++j)
    for (std::size_t i = 0; i < nu; ++i)
      for (int c = 0; c <= surface.degree_u; ++c) {
        const int old = along_u.rows[i].first + c;
        rows[at(j) * nu + i] +=
            along_u.rows[i].factors[at(c)] * homogeneous(surface.point(old, j), surface.weight(old, j));
      }
  Surface part;
  part.degree_u = surface.degree_u;
  part.degree_v = surface.degree_v;
  part.count_u = static_cast<int>(nu);
  part.count_v = static_cast<int>(nv);
  part.knots_u = along_u.knots;
  part.knots_v = along_v.knots;
  for (std::size_t j = 0; j < nv; ++j)
    for (std::size_t i = 0; i < nu; ++i) {
      Vec4 sum = Vec4::Zero();
      for (int c = 0; c <= surface.degree_v; ++c)
        sum += along_v.rows[j].factors[at(c)] * rows[at(along_v.rows[j].first + c) * nu + i];
      part.points.push_back(surface.is_rational() ? Vec3(sum.head<3>() / sum.w()) : Vec3(sum.head<3>()));
      if (surface.is_rational()) part.weights.push_back(sum.w());
    }
  return part;
}

}  // namespace

Surface restricted(const Surface& surface, double u0, double u1, double v0, double v1) {
  return combined(surface, restriction(surface.knots_u, surface.degree_u, surface.count_u, u0, u1),
                  restriction(surface.knots_v, surface.degree_v, surface.count_v, v0, v1));
}

Surface refined(const Surface& surface, const std::vector<double>& new_v) {
  std::vector<double> made;
  std::merge(surface.knots_v.begin(), surface.knots_v.end(), new_v.begin(), new_v.end(),
             std::back_inserter(made));
  return combined(surface, over_knots(surface.knots_u, surface.degree_u, surface.count_u, surface.knots_u),
                  over_knots(surface.knots_v, surface.degree_v, surface.count_v, std::move(made)));
}

}  // namespace selvage::nurbs
