#include "nurbs/power.h"

#include <algorithm>

namespace selvage::nurbs {

namespace {

// Bernstein coefficients of a cubic over a piece of length h.
Cubic bernstein(const Cubic& power, double h) {
  const Vec3 b = power[1] * (h / 3), c = power[2] * (h * h / 3), d = power[3] * (h * h * h);
  const Vec3 first = power[0] + b;
  return {power[0], first, first + b + c, power[0] + 3 * b + 3 * c + d};
}

std::vector<double> triple_knots(const std::vector<double>& breaks) {
  std::vector<double> knots(1, breaks.front());
  for (const double t : breaks) knots.insert(knots.end(), 3, t);
  knots.push_back(breaks.back());
  return knots;
}

}  // namespace

Curve from_power(const std::vector<double>& breaks, const std::vector<Cubic>& pieces, double* gap) {
  Curve curve;
  curve.degree = 3;
  curve.knots = triple_knots(breaks);
  double largest = 0;
  Vec3 end = pieces.front()[0];
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Cubic b = bernstein(pieces[i], breaks[i + 1] - breaks[i]);
    largest = std::max(largest, (b[0] - end).norm());
    curve.points.insert(curve.points.end(), b.begin(), b.begin() + 3);
    end = b[3];
  }
  curve.points.push_back(end);
  if (gap != nullptr) *gap = largest;
  return curve;
}

Surface from_power(const std::vector<double>& breaks_u, const std::vector<double>& breaks_v,
                   const std::vector<Bicubic>& patches, double* gap) {
  const std::size_t nu = breaks_u.size() - 1, nv = breaks_v.size() - 1;
  Surface surface;
  surface.degree_u = surface.degree_v = 3;
  surface.count_u = static_cast<int>(3 * nu) + 1;
  surface.count_v = static_cast<int>(3 * nv) + 1;
  surface.knots_u = triple_knots(breaks_u);
  surface.knots_v = triple_knots(breaks_v);
  surface.points.assign(static_cast<std::size_t>(surface.count_u) * static_cast<std::size_t>(surface.count_v),
                        Vec3::Zero());
  std::vector<char> set(surface.points.size(), 0);
  double largest = 0;
  // Backwards, so that a patch's own start stands where the one before it ends.
  for (std::size_t j = nv; j-- > 0;)
    for (std::size_t i = nu; i-- > 0;) {
      Bicubic patch = patches[j * nu + i];
      for (auto& along_t : patch) along_t = bernstein(along_t, breaks_v[j + 1] - breaks_v[j]);
      for (std::size_t l = 0; l < 4; ++l) {
        const Cubic b =
            bernstein({patch[0][l], patch[1][l], patch[2][l], patch[3][l]}, breaks_u[i + 1] - breaks_u[i]);
        for (std::size_t k = 0; k < 4; ++k) {
          const std::size_t at = surface.index(static_cast<int>(3 * i + k), static_cast<int>(3 * j + l));
          if (set[at] != 0) largest = std::max(largest, (surface.points[at] - b[k]).norm());
          const bool inner = (k < 3 || i + 1 == nu) && (l < 3 || j + 1 == nv);
          if (set[at] == 0 || inner) surface.points[at] = b[k];
          set[at] = 1;
        }
      }
    }
  if (gap != nullptr) *gap = largest;
  return surface;
}

}  // namespace selvage::nurbs
