#include "nurbs/turn.h"

#include <algorithm>

#include "nurbs/restrict.h"

namespace selvage::nurbs {

Surface reversed_u(const Surface& surface) {
  Surface out = surface;
  out.knots_u = reversed_knots(surface.knots_u);
  for (int j = 0; j < surface.count_v; ++j) {
    const auto row = static_cast<std::ptrdiff_t>(surface.index(0, j));
    std::reverse(out.points.begin() + row, out.points.begin() + row + surface.count_u);
    if (surface.is_rational())
      std::reverse(out.weights.begin() + row, out.weights.begin() + row + surface.count_u);
  }
  return out;
}

Surface reversed_v(const Surface& surface) {
  Surface out = surface;
  out.knots_v = reversed_knots(surface.knots_v);
  for (int j = 0; j < surface.count_v; ++j)
    for (int i = 0; i < surface.count_u; ++i) {
      const std::size_t from = surface.index(i, surface.count_v - 1 - j);
      out.points[out.index(i, j)] = surface.points[from];
      if (surface.is_rational()) out.weights[out.index(i, j)] = surface.weights[from];
    }
  return out;
}

bool is_clamped(const std::vector<double>& knots, int degree) {
  const auto order = static_cast<std::ptrdiff_t>(degree) + 1;
  const auto all_equal = [](auto first, auto last) {
    return std::all_of(first, last, [first](double knot) { return knot == *first; });
  };
  return all_equal(knots.begin(), knots.begin() + order) && all_equal(knots.end() - order, knots.end());
}

Surface clamped(const Surface& surface) {
  if (is_clamped(surface.knots_u, surface.degree_u) && is_clamped(surface.knots_v, surface.degree_v))
    return surface;
  return restricted(surface, surface.first_u(), surface.last_u(), surface.first_v(), surface.last_v());
}

}  // namespace selvage::nurbs
