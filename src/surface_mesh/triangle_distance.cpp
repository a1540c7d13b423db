#include "surface_mesh/triangle_distance.h"

#include <algorithm>

namespace selvage::fem {
namespace {

// Between the segments (p, p + a) and (q, q + b): Ericson, "Real-Time Collision Detection" (2005), 5.1.9.
Vec3 between_segments(const Vec3& p, const Vec3& a, const Vec3& q, const Vec3& b) {
  const Vec3 back = p - q;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b);
  const double ar = a.dot(back), br = b.dot(back), determinant = aa * bb - ab * ab;
  double s = determinant > 0 ? std::clamp((ab * br - ar * bb) / determinant, 0.0, 1.0) : 0;
  double t = bb > 0 ? (ab * s + br) / bb : 0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = aa > 0 ? std::clamp((ab * t - ar) / aa, 0.0, 1.0) : 0;
  }
  return (q + t * b) - (p + s * a);
}

struct Plane {
  Vec3 normal;  // twice the area long
  double area;
};

Plane plane_of(const Corners3& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  return {normal, normal.squaredNorm()};
}

// From a point straight down to a triangle, where that meets it.
bool drop(const Vec3& point, const Corners3& t, const Plane& plane, Vec3& way) {
  if (!(plane.area > 0)) return false;
  for (std::size_t k = 0; k < 3; ++k)
    if ((t[(k + 1) % 3] - t[k]).cross(point - t[k]).dot(plane.normal) < 0) return false;
  way = plane.normal * (plane.normal.dot(t[0] - point) / plane.area);
  return true;
}

// Does an edge of one go through the other?
bool pierces(const Corners3& edges, const Corners3& t, const Plane& plane) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &p = edges[k], &q = edges[(k + 1) % 3];
    const double before = plane.normal.dot(p - t[0]), behind = plane.normal.dot(q - t[0]);
    if ((before > 0) == (behind > 0)) continue;
    Vec3 way;
    if (drop(p + (q - p) * (before / (before - behind)), t, plane, way)) return true;
  }
  return false;
}

}  // namespace

// Ericson, 5.1.5.
Vec3 nearest_on(const Corners3& t, const Vec3& p) {
  const Vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return t[0];
  const Vec3 bp = p - t[1];
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return t[1];
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return t[0] + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - t[2];
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return t[2];
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return t[0] + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]);
  const double scale = 1 / (va + vb + vc);
  return t[0] + vb * scale * ab + vc * scale * ac;
}

Vec3 shortest_way(const Corners3& from, const Corners3& to) {
  const Plane first = plane_of(from), second = plane_of(to);
  if (pierces(from, to, second) || pierces(to, from, first)) return Vec3::Zero();
  Vec3 best = to[0] - from[0], way;
  const auto take = [&](const Vec3& other) {
    if (other.squaredNorm() < best.squaredNorm()) best = other;
  };
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      take(between_segments(from[i], from[(i + 1) % 3] - from[i], to[k], to[(k + 1) % 3] - to[k]));
    if (drop(from[i], to, second, way)) take(way);
    if (drop(to[i], from, first, way)) take(-way);
  }
  return best;
}

}  // namespace selvage::fem
