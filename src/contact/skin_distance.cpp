#include "contact/skin_distance.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace selvage::contact {

SkinDistance::SkinDistance(const SkinMesh& skin)
    : skin_(skin), tree_(boxes_of(skin.vertices, skin.triangles)) {
  for (const Vec3& p : skin.vertices) box_.extend(p);
  find_neighbours();
  find_corner_normals();
}

void SkinDistance::find_neighbours() {
  struct Edge {
    std::uint32_t low, high, triangle, side;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * skin_.triangles.size());
  for (std::uint32_t t = 0; t < skin_.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = skin_.triangles[t][k], b = skin_.triangles[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, k});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return std::tuple(x.low, x.high, x.triangle, x.side) < std::tuple(y.low, y.high, y.triangle, y.side);
  });
  neighbours_.assign(skin_.triangles.size(), {none, none, none});
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
    const Edge &one = edges[k], &two = edges[k + 1];
    if (one.low != two.low || one.high != two.high) continue;
    neighbours_[one.triangle][one.side] = two.triangle;
    neighbours_[two.triangle][two.side] = one.triangle;
    ++k;
  }
}

void SkinDistance::find_corner_normals() {
  corner_normals_.assign(skin_.vertices.size(), Vec3::Zero());
  for (std::uint32_t t = 0; t < skin_.triangles.size(); ++t) {
    const Vec3 n = normal(t);
    const auto& corner = skin_.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = skin_.vertices[corner[k]];
      const Vec3 a = skin_.vertices[corner[(k + 1) % 3]] - p, b = skin_.vertices[corner[(k + 2) % 3]] - p;
      corner_normals_[corner[k]] += std::atan2(a.cross(b).norm(), a.dot(b)) * n;
    }
  }
  for (Vec3& n : corner_normals_) n = unit_or_zero(n);
  for (std::uint32_t t = 0; t < skin_.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      if (neighbours_[t][k] == none)
        for (const std::size_t end : {k, (k + 1) % 3})
          corner_normals_[skin_.triangles[t][end]] = Vec3::Zero();
}

Vec3 SkinDistance::normal(std::uint32_t triangle) const {
  const auto& t = skin_.triangles[triangle];
  const Vec3& p = skin_.vertices[t[0]];
  return unit_or_zero((skin_.vertices[t[1]] - p).cross(skin_.vertices[t[2]] - p));
}

Vec3 SkinDistance::normal_at(std::uint32_t triangle, int feature) const {
  if (feature == 0) return normal(triangle);
  if (feature >= 4) return corner_normals_[skin_.triangles[triangle][static_cast<std::size_t>(feature - 4)]];
  const std::uint32_t other = neighbours_[triangle][static_cast<std::size_t>(feature - 1)];
  return other == none ? Vec3(Vec3::Zero()) : unit_or_zero(normal(triangle) + normal(other));
}

// By the signs of barycentric coordinates and of the edges' parameters.
SkinDistance::Foot SkinDistance::foot_on(std::uint32_t triangle, const Vec3& point) const {
  const auto& t = skin_.triangles[triangle];
  const std::array<Vec3, 3> p = {skin_.vertices[t[0]], skin_.vertices[t[1]], skin_.vertices[t[2]]};
  const Vec3 face = (p[1] - p[0]).cross(p[2] - p[0]);
  const double size = face.squaredNorm();
  bool is_inside = size > 0.0;
  for (std::size_t k = 0; k < 3 && is_inside; ++k)
    is_inside = (p[(k + 1) % 3] - p[k]).cross(point - p[k]).dot(face) >= 0.0;
  if (is_inside) return {point - (point - p[0]).dot(face) / size * face, 0};
  Foot best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 edge = p[(k + 1) % 3] - p[k];
    const double length = edge.squaredNorm();
    const double s = length > 0.0 ? (point - p[k]).dot(edge) / length : 0.0;
    Foot foot;
    if (s <= 0.0)
      foot = {p[k], static_cast<int>(k) + 4};
    else if (s >= 1.0)
      foot = {p[(k + 1) % 3], static_cast<int>((k + 1) % 3) + 4};
    else
      foot = {p[k] + s * edge, static_cast<int>(k) + 1};
    const double distance = (point - foot.point).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best = foot;
  }
  return best;
}

std::optional<double> SkinDistance::at(const Vec3& point, double reach) const {
  const auto all = [](auto...) { return true; };
  return nearest(point, reach, all, all);
}

}  // namespace selvage::contact
