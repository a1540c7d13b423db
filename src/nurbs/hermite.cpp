#include "nurbs/hermite.h"

#include <algorithm>
#include <array>

namespace selvage::nurbs {

namespace {

constexpr double known_to = 1e-12;  // of the largest coordinate

// A cubic between two parameters, as a Bezier.
struct HermitePiece {
  double from = 0, to = 0;
  std::array<Vec3, 4> b;

  [[nodiscard]] double length() const { return to - from; }
  // Its polar form (Ramshaw 1989): de Casteljau's steps, each at a parameter of its own.
  [[nodiscard]] Vec3 polar(double u, double v, double w) const {
    std::array<Vec3, 4> p = b;
    std::size_t left = 3;
    for (const double t : {u, v, w}) {
      const double share = (t - from) / length();
      for (std::size_t i = 0; i < left; ++i) p[i] = (1.0 - share) * p[i] + share * p[i + 1];
      --left;
    }
    return p[0];
  }
  [[nodiscard]] Vec3 slope(double t) const {
    const double s = (t - from) / length(), r = 1.0 - s;
    return 3.0 / length() * (r * r * (b[1] - b[0]) + 2.0 * r * s * (b[2] - b[1]) + s * s * (b[3] - b[2]));
  }
  // Second derivatives at both ends.
  [[nodiscard]] Vec3 bend_at_start() const {
    return 6.0 / (length() * length()) * (b[0] - 2.0 * b[1] + b[2]);
  }
  [[nodiscard]] Vec3 bend_at_end() const { return 6.0 / (length() * length()) * (b[1] - 2.0 * b[2] + b[3]); }
};

}  // namespace

Curve through_derivatives(const std::vector<double>& t, const std::vector<Vec3>& points,
                          const std::vector<Vec3>& derivatives) {
  double scale = 0.0;
  for (const Vec3& point : points) scale = std::max(scale, point.cwiseAbs().maxCoeff());
  const double error = known_to * scale;
  const auto piece_of = [&](std::size_t i, std::size_t k) {
    const double third = (t[k] - t[i]) / 3.0;
    return HermitePiece{
        t[i],
        t[k],
        {points[i], points[i] + third * derivatives[i], points[k] - third * derivatives[k], points[k]}};
  };
  const auto holds_between = [&](const HermitePiece& piece, std::size_t i, std::size_t k) {
    for (std::size_t m = i + 1; m < k; ++m) {
      if ((piece.polar(t[m], t[m], t[m]) - points[m]).norm() > error) return false;
      if ((piece.slope(t[m]) - derivatives[m]).norm() * piece.length() > 4.0 * error) return false;
    }
    return true;
  };
  std::vector<HermitePiece> pieces;
  for (std::size_t i = 0; i + 1 < t.size();) {
    std::size_t k = i + 1;
    HermitePiece piece = piece_of(i, k);
    for (; k + 1 < t.size(); ++k) {
      const HermitePiece longer = piece_of(i, k + 1);
      if (!holds_between(longer, i, k + 1)) break;
      piece = longer;
    }
    pieces.push_back(piece);
    i = k;
  }
  Curve curve;
  curve.degree = 3;
  curve.knots.assign(4, t.front());
  std::vector<std::size_t> piece_at(4, 0);  // of the span that begins with each knot
  for (std::size_t k = 1; k < pieces.size(); ++k) {
    const double least = std::min(pieces[k - 1].length(), pieces[k].length());
    const double jump = (pieces[k].bend_at_start() - pieces[k - 1].bend_at_end()).norm() * least * least;
    for (int times = jump <= 16.0 * error ? 1 : 2; times > 0; --times) {
      curve.knots.push_back(pieces[k].from);
      piece_at.push_back(k);
    }
  }
  curve.knots.insert(curve.knots.end(), 4, t.back());
  piece_at.resize(curve.knots.size(), pieces.size() - 1);
  // A control point is the polar form of any span that it holds at the three knots inside; of the two in the
  // middle the longer one is the most exact.
  for (std::size_t i = 0; i + 4 < curve.knots.size(); ++i) {
    const double u = curve.knots[i + 1], v = curve.knots[i + 2], w = curve.knots[i + 3];
    std::size_t span = v - u >= w - v ? i + 1 : i + 2;
    if (!(curve.knots[span + 1] > curve.knots[span])) span = curve.knots[i + 1] > curve.knots[i] ? i : i + 3;
    curve.points.push_back(pieces[piece_at[span]].polar(u, v, w));
  }
  return curve;
}

}  // namespace selvage::nurbs
