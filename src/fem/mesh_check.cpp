#include "fem/mesh_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace selvage::fem {
namespace {

// A face of a cell: its corners in increasing order, with the cell and the sense in which it runs.
struct Face {
  std::array<std::uint32_t, 3> corners;
  std::uint32_t cell;
  bool even;  // an even permutation brought the corners into order

  bool operator<(const Face& other) const { return corners < other.corners; }
};

Face make_face(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t cell) {
  Face face{{a, b, c}, cell, true};
  auto order = [&](std::size_t i, std::size_t j) {
    if (face.corners[i] < face.corners[j]) return;
    std::swap(face.corners[i], face.corners[j]);
    face.even = !face.even;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return face;
}

// Of a positive cell: each face seen from outside, counter-clockwise.
constexpr std::array<std::array<int, 3>, 4> outward_faces = {{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};

Message wrong(const std::string& text) {
  return error(Kind::internal, text + "; try another --size");
}

Message at(Message message, const Vec3& place) {
  message.at = place;
  return message;
}

// Joins cells over shared faces; true when one piece remains.
bool is_one_piece(const std::vector<Face>& faces, std::size_t cells) {
  std::vector<std::uint32_t> parent(cells);
  std::iota(parent.begin(), parent.end(), 0U);
  auto root = [&](std::uint32_t cell) {
    while (parent[cell] != cell) cell = parent[cell] = parent[parent[cell]];
    return cell;
  };
  std::size_t pieces = cells;
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    if (faces[i].corners != faces[i + 1].corners) continue;
    const std::uint32_t a = root(faces[i].cell), b = root(faces[i + 1].cell);
    if (a == b) continue;
    parent[a] = b;
    --pieces;
  }
  return pieces == 1;
}

// The faces that only one cell has, as they are seen from outside; nothing when a face has more than two
// cells.
std::optional<std::vector<Face>> boundary(const std::vector<Face>& faces) {
  std::vector<Face> result;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t next = i + 1;
    while (next < faces.size() && faces[next].corners == faces[i].corners) ++next;
    if (next - i > 2) return std::nullopt;
    if (next - i == 1) result.push_back(faces[i]);
    i = next;
  }
  return result;
}

}  // namespace

Status check_surface(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  if (points.size() > 500'000'000 || triangles.size() > 500'000'000)
    return error(Kind::limit, "the surface has more than 5e8 points or triangles; choose a coarser --size");
  for (const Vec3& point : points)
    if (!point.allFinite())
      return error(Kind::geometry, "a coordinate of the surface is not a finite number");
  std::vector<std::pair<std::uint64_t, bool>> edges;  // both ends in one number; forward?
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (a >= points.size() || b >= points.size() || a == b)
        return error(Kind::internal, "a triangle of the surface has no three different points");
      edges.emplace_back(std::uint64_t{std::min(a, b)} << 32U | std::max(a, b), a < b);
    }
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size(); i += 2) {
    const bool paired = i + 1 < edges.size() && edges[i].first == edges[i + 1].first &&
                        edges[i].second != edges[i + 1].second &&
                        (i + 2 == edges.size() || edges[i + 2].first != edges[i].first);
    if (!paired)
      return at(
          error(Kind::geometry, "the surface is not closed here; look at the yarn with 'selvage check'"),
          points[edges[i].first >> 32U]);
  }
  if (!(enclosed_volume(points, triangles) > 0))
    return error(Kind::geometry, "the surface encloses no volume; look at the yarn with 'selvage check'");
  return {};
}

Status check_mesh(TetMesh& mesh, std::span<const Vec3> points, std::span<const Triangle> triangles) {
  if (mesh.cells.empty()) return wrong("TetGen made no tetrahedra");
  if (mesh.points.size() < points.size() || !std::equal(points.begin(), points.end(), mesh.points.begin()))
    return wrong("TetGen did not keep the points of the surface");
  double volume = 0;
  std::vector<Face> faces;
  faces.reserve(4 * mesh.cells.size());
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    auto& cell = mesh.cells[c];
    for (const std::uint32_t corner : cell)
      if (corner >= mesh.points.size()) return wrong("a tetrahedron has a point that is not there");
    const Vec3& p = mesh.points[cell[0]];
    double six = (mesh.points[cell[1]] - p).cross(mesh.points[cell[2]] - p).dot(mesh.points[cell[3]] - p);
    if (six < 0) std::swap(cell[2], cell[3]);
    volume += std::abs(six) / 6;
    for (const auto& f : outward_faces)
      faces.push_back(make_face(cell[static_cast<std::size_t>(f[0])], cell[static_cast<std::size_t>(f[1])],
                                cell[static_cast<std::size_t>(f[2])], static_cast<std::uint32_t>(c)));
  }
  std::sort(faces.begin(), faces.end());
  const auto outside = boundary(faces);
  if (!outside) return wrong("TetGen's mesh has a face with more than two tetrahedra");
  std::vector<Face> wanted;
  wanted.reserve(triangles.size());
  for (const Triangle& t : triangles) wanted.push_back(make_face(t[0], t[1], t[2], 0));
  std::sort(wanted.begin(), wanted.end());
  const bool same =
      std::equal(wanted.begin(), wanted.end(), outside->begin(), outside->end(),
                 [](const Face& a, const Face& b) { return a.corners == b.corners && a.even == b.even; });
  if (!same) return wrong("the boundary of TetGen's mesh is not the yarn's surface");
  if (!is_one_piece(faces, mesh.cells.size())) return wrong("TetGen's mesh falls into several pieces");
  const double enclosed = enclosed_volume(points, triangles);
  if (!(std::abs(volume - enclosed) <= 1e-9 * enclosed))
    return wrong(
        fmt::format("TetGen's mesh has the volume {:.12g}, its surface encloses {:.12g}", volume, enclosed));
  return {};
}

}  // namespace selvage::fem
