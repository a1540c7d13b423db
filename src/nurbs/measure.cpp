#include "nurbs/measure.h"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "nurbs/basis.h"

namespace selvage::nurbs {

namespace {

class AdaptiveIntegral {
 public:
  AdaptiveIntegral(const std::function<double(double)>& f, double rounding) : f_(f), rounding_(rounding) {}

  double over(double t0, double t1) {
    const double whole = by_gauss(t0, t1);
    // The span of a long curve is a small part of its parameters, whose rounding is then no small part of it.
    agreement_ = std::max(agreement_, 2 * DBL_EPSILON * std::max(std::abs(t0), std::abs(t1)) / (t1 - t0));
    rounding_ = std::max(rounding_, agreement_ * whole);
    return halved(t0, t1, whole, most_halvings);
  }

 private:
  static constexpr int most_halvings = 52, few_pieces = 256, most_pieces = 4096;

  [[nodiscard]] double by_gauss(double t0, double t1) const {
    const GaussRule& rule = gauss_rule(8);
    const double half = 0.5 * (t1 - t0), middle = 0.5 * (t1 + t0);
    double sum = 0.0;
    for (std::size_t g = 0; g < rule.nodes.size(); ++g)
      sum += rule.weights[g] * f_(middle + half * rule.nodes[g]);
    return half * sum;
  }

  double halved(double t0, double t1, double whole, int halvings) {
    const double middle = 0.5 * (t0 + t1);
    const double left = by_gauss(t0, middle), right = by_gauss(middle, t1), both = left + right;
    // A piece is measured by its own value while there are few. Where a curve all but stands still, under a
    // weight of 1e9, no piece ever is as exact as that, nor need be.
    const double enough = std::max(agreement_ * both, ++pieces_ > few_pieces ? rounding_ : 0.0);
    // So put that what is no number ends it, too.
    if (halvings == 0 || !(middle > t0 && middle < t1) || pieces_ > most_pieces ||
        !(std::abs(both - whole) > enough))
      return both;
    return halved(t0, middle, left, halvings - 1) + halved(middle, t1, right, halvings - 1);
  }

  const std::function<double(double)>& f_;
  double rounding_, agreement_ = 1e-13;
  int pieces_ = 0;
};

// What the rounding of coordinates leaves open of the length about this parameter: no piece can be as exact
// as 32 units in the last place of the span's points, or 1e-13 of their polygon.
double length_rounding(const Curve& curve, double t) {
  const int count = static_cast<int>(curve.points.size());
  const auto last = static_cast<std::size_t>(find_span(curve.knots, curve.degree, count, t));
  double largest = 0, polygon = 0;
  for (std::size_t i = last - static_cast<std::size_t>(curve.degree); i <= last; ++i) {
    largest = std::max(largest, curve.points[i].cwiseAbs().maxCoeff());
    if (i < last) polygon += (curve.points[i + 1] - curve.points[i]).norm();
  }
  return std::max(1e-13 * polygon, 32 * DBL_EPSILON * largest);
}

// The basis functions' values and first derivatives at the Gauss nodes of every span.
struct Node {
  int first;  // index of the first control point that counts here
  double weight;
  BasisRow value, slope;
};

std::vector<Node> gauss_nodes(const std::vector<double>& knots, int degree, int count, int order, int parts) {
  std::vector<double> breaks = breakpoints(knots, degree);
  if (parts > 1) {
    std::vector<double> finer = {breaks.front()};
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
      for (int i = 1; i <= parts; ++i) finer.push_back(breaks[k] + (breaks[k + 1] - breaks[k]) * i / parts);
    breaks = std::move(finer);
  }
  const GaussRule& rule = gauss_rule(order);
  std::vector<Node> nodes;
  std::array<BasisRow, 3> rows;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double half = 0.5 * (breaks[k + 1] - breaks[k]), middle = 0.5 * (breaks[k + 1] + breaks[k]);
    for (std::size_t g = 0; g < rule.nodes.size(); ++g) {
      const double t = middle + half * rule.nodes[g];
      const int span = find_span(knots, degree, count, t);
      basis_derivatives(knots, degree, span, t, rows);
      nodes.push_back({span - degree, half * rule.weights[g], rows[0], rows[1]});
    }
  }
  return nodes;
}

// Of a rational surface no polynomial rule is exact: four parts to a span bring the error down to rounding.
int parts_of(const Surface& surface) {
  return surface.is_rational() ? 4 : 1;
}

// take(position - origin, S_u, S_v, weight) at every Gauss node of the surface, each span in `parts` parts.
template <class Take>
void at_gauss_nodes(const Surface& surface, const Vec3& origin, int order_u, int order_v, int parts,
                    const Take& take) {
  const std::vector<Node> nodes_u =
      gauss_nodes(surface.knots_u, surface.degree_u, surface.count_u, order_u, parts);
  const std::vector<Node> nodes_v =
      gauss_nodes(surface.knots_v, surface.degree_v, surface.count_v, order_v, parts);
  std::vector<Vec4> line(static_cast<std::size_t>(surface.count_u)), slope_line(line.size());
  for (const Node& v : nodes_v) {
    // At one v the control net collapses to a row of points and a row of derivatives along v.
    for (int i = 0; i < surface.count_u; ++i) {
      Vec4 position = Vec4::Zero(), slope = Vec4::Zero();
      for (int j = 0; j <= surface.degree_v; ++j) {
        const double w = surface.weight(i, v.first + j);
        const Vec3 p = w * (surface.point(i, v.first + j) - origin);
        const Vec4 h(p.x(), p.y(), p.z(), w);  // faster than homogeneous(), whose product is not vectorized
        position += v.value[static_cast<std::size_t>(j)] * h;
        slope += v.slope[static_cast<std::size_t>(j)] * h;
      }
      line[static_cast<std::size_t>(i)] = position;
      slope_line[static_cast<std::size_t>(i)] = slope;
    }
    for (const Node& u : nodes_u) {
      Vec4 p = Vec4::Zero(), du = Vec4::Zero(), dv = Vec4::Zero();
      for (int i = 0; i <= surface.degree_u; ++i) {
        const auto k = static_cast<std::size_t>(u.first) + static_cast<std::size_t>(i);
        p += u.value[static_cast<std::size_t>(i)] * line[k];
        du += u.slope[static_cast<std::size_t>(i)] * line[k];
        dv += u.value[static_cast<std::size_t>(i)] * slope_line[k];
      }
      Vec3 position = p.head<3>(), along_u = du.head<3>(), along_v = dv.head<3>();
      if (surface.is_rational()) {
        position /= p.w();
        along_u = (along_u - du.w() * position) / p.w();
        along_v = (along_v - dv.w() * position) / p.w();
      }
      take(position, along_u, along_v, u.weight * v.weight);
    }
  }
}

}  // namespace

double adaptive_integral(const std::function<double(double)>& f, double t0, double t1, double rounding) {
  return AdaptiveIntegral(f, rounding).over(t0, t1);
}

double arc_length(const Curve& curve, double t0, double t1) {
  // Knot by knot from the one after t0: a short piece of a long curve costs no more than its own spans.
  auto knot = std::upper_bound(curve.knots.begin(), curve.knots.end(), t0);
  const std::function<double(double)> speed = [&](double t) { return evaluate_jet(curve, t).d1.norm(); };
  double sum = 0.0, from = t0;
  while (from < t1) {
    while (knot != curve.knots.end() && *knot <= from) ++knot;
    const double to = knot == curve.knots.end() ? t1 : std::min(*knot, t1);
    sum += adaptive_integral(speed, from, to, length_rounding(curve, 0.5 * (from + to)));
    from = to;
  }
  return sum;
}

double arc_length(const Curve& curve) {
  return arc_length(curve, curve.first_parameter(), curve.last_parameter());
}

double volume_flux(const Surface& surface, const Vec3& origin) {
  // S . (S_u x S_v) has degree 3 p - 1 in each direction.
  const auto order = [&](int degree) {
    return surface.is_rational() ? 8 : std::min(8, (3 * degree + 1) / 2);
  };
  double sum = 0.0;
  at_gauss_nodes(surface, origin, order(surface.degree_u), order(surface.degree_v), parts_of(surface),
                 [&](const Vec3& position, const Vec3& along_u, const Vec3& along_v, double weight) {
                   sum += weight * position.dot(along_u.cross(along_v));
                 });
  return sum / 3.0;
}

Moments& Moments::operator+=(const Moments& other) {
  area += other.area;
  area_vector += other.area_vector;
  volume += other.volume;
  first += other.first;
  return *this;
}

Moments moments(const Surface& surface, const Vec3& origin, double area_error) {
  constexpr int most_halvings = 5;
  const auto by_gauss = [&](int order, int parts) {
    Moments sum;
    at_gauss_nodes(surface, origin, order, order, parts,
                   [&](const Vec3& position, const Vec3& along_u, const Vec3& along_v, double weight) {
                     const Vec3 normal = weight * along_u.cross(along_v);
                     const double flux = position.dot(normal);
                     sum.area += normal.norm();
                     sum.area_vector += normal;
                     sum.volume += flux / 3.0;
                     sum.first += flux / 4.0 * position;
                   });
    return sum;
  };
  int parts = parts_of(surface);
  Moments coarse = by_gauss(6, parts), fine = by_gauss(8, parts);
  for (int i = 0;
       i < most_halvings && std::abs(fine.area - coarse.area) > std::max(area_error, 1e-11 * fine.area);
       ++i) {
    parts *= 2;
    coarse = fine;
    fine = by_gauss(8, parts);
  }
  return fine;
}

}  // namespace selvage::nurbs
