#include "structured/yarn_triangles.h"

#include <algorithm>

#include "nurbs/divided.h"

namespace selvage::fem {

void triangulate_yarn(const yarn::Body& body, double round, double along, const TakeTriangle& take) {
  const nurbs::Surface& surface = body.surface;
  const double middle_v = (surface.first_v() + surface.last_v()) / 2;
  const auto steps = [](const std::vector<double>& breaks, double edge, const auto& place) {
    return nurbs::divided(breaks, [&](std::size_t k) {
      return nurbs::whole_parts((place(breaks[k + 1]) - place(breaks[k])).norm() / edge, 2, 1000);
    });
  };
  const std::vector<double> us = steps(nurbs::breakpoints(surface.knots_u, surface.degree_u), round,
                                       [&](double u) { return nurbs::evaluate(surface, u, middle_v); });
  const std::vector<double> vs = steps(nurbs::breakpoints(surface.knots_v, surface.degree_v), along,
                                       [&](double v) { return nurbs::evaluate(body.axis, v); });
  std::vector<Vec3> points = nurbs::evaluate_grid(surface, us, vs);
  const std::size_t columns = us.size(), rows = vs.size();
  const auto vertex = [&](std::size_t i, std::size_t j) {
    return YarnVertex{points[j * columns + (i + 1 == columns ? 0 : i)], vs[j]};
  };
  if (body.closed_along)  // the last row is the first one, to the bit
    std::copy_n(points.begin(), columns, points.end() - static_cast<std::ptrdiff_t>(columns));

  for (std::size_t j = 0; j + 1 < rows; ++j)
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      take(vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1));
      take(vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1));
    }
  if (body.closed_along) return;
  const YarnVertex start{nurbs::evaluate(body.axis, vs.front()), vs.front()};
  const YarnVertex end{nurbs::evaluate(body.axis, vs.back()), vs.back()};
  for (std::size_t i = 0; i + 1 < columns; ++i) {
    take(start, vertex(i + 1, 0), vertex(i, 0));
    take(end, vertex(i, rows - 1), vertex(i + 1, rows - 1));
  }
}

}  // namespace selvage::fem
