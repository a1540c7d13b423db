#include "tetrahedra/mesh_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/groups.h"
#include "fem/cell_sides.h"
#include "fem/edge_key.h"

namespace selvage::fem {
namespace {

CellSide side_of(const Triangle& t, std::uint32_t number) {
  return fem::side_of({number, t[0], t[1], t[2]}, number, 0);
}

bool is_before(const CellSide& a, const CellSide& b) {
  return a.corners < b.corners;
}

Message wrong(const std::string& text) {
  return error(Kind::internal, text + "; try another --size");
}

// Of triangles of the surface that are in each other's way.
Message in_the_way(const std::string& text) {
  return error(Kind::geometry, text + "; try another --size");
}

Status check_input(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  if (points.size() > 500'000'000 || triangles.size() > 500'000'000)
    return error(Kind::limit, "the surface has more than 5e8 points or triangles; choose a coarser --size");
  for (const Vec3& point : points)
    if (!point.allFinite())
      return error(Kind::geometry, "a coordinate of the surface is not a finite number");
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (t[k] >= points.size() || t[k] == t[(k + 1) % 3])
        return error(Kind::internal, "a triangle of the surface has no three different points");
  return {};
}

// The faces of all cells, sorted. TetGen gives all cells one orientation: all are turned round, or none. The
// sign of one flat cell's volume is rounding, and turned alone it would no longer fit its neighbours.
Result<std::vector<CellSide>> sorted_faces(TetMesh& mesh, std::span<const Vec3> points) {
  if (mesh.cells.empty()) return wrong("TetGen made no tetrahedra");
  if (mesh.points.size() < points.size() || !std::equal(points.begin(), points.end(), mesh.points.begin()))
    return wrong("TetGen did not keep the points of the surface");
  double volume = 0;
  for (const auto& cell : mesh.cells) {
    for (const std::uint32_t corner : cell)
      if (corner >= mesh.points.size()) return wrong("a tetrahedron has a point that is not there");
    volume += six_volumes(mesh.points, cell);
  }
  if (volume < 0)
    for (auto& cell : mesh.cells) std::swap(cell[2], cell[3]);
  return sorted_sides(mesh.cells, mesh.points.size());
}

std::size_t count_regions(std::span<const Sides> sides) {
  std::size_t count = 0;
  for (const Sides& s : sides)
    for (const std::uint32_t region : {s.behind, s.front})
      if (region != Sides::outside) count = std::max<std::size_t>(count, region + std::size_t{1});
  return count;
}

std::vector<double> enclosed_volumes(std::span<const Vec3> points, std::span<const Triangle> triangles,
                                     std::span<const Sides> sides) {
  std::vector<double> result(count_regions(sides), 0.0);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const Triangle& t = triangles[k];
    const Vec3 &o = points.front(), a = points[t[0]] - o, b = points[t[1]] - o, c = points[t[2]] - o;
    const double part = a.dot(b.cross(c)) / 6;
    if (sides[k].behind != Sides::outside) result[sides[k].behind] += part;
    if (sides[k].front != Sides::outside) result[sides[k].front] -= part;
  }
  return result;
}

}  // namespace

Status check_surface(std::span<const Vec3> points, std::span<const Triangle> triangles,
                     std::span<const Sides> sides) {
  if (Status sound = check_input(points, triangles); !sound) return sound;
  // Of each region, an edge is used as often one way as the other.
  struct Use {
    std::uint32_t region;
    std::uint64_t edge;
    int sense;
  };
  std::vector<Use> uses;
  uses.reserve(6 * triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[i][k], b = triangles[i][(k + 1) % 3];
      const std::uint64_t edge = edge_key(a, b);
      const int sense = a < b ? 1 : -1;
      if (sides[i].behind != Sides::outside) uses.push_back({sides[i].behind, edge, sense});
      if (sides[i].front != Sides::outside) uses.push_back({sides[i].front, edge, -sense});
    }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
    return std::tie(a.region, a.edge) < std::tie(b.region, b.edge);
  });
  for (std::size_t i = 0; i < uses.size();) {
    int sum = 0;
    const Use& first = uses[i];
    for (; i < uses.size() && uses[i].region == first.region && uses[i].edge == first.edge; ++i)
      sum += uses[i].sense;
    if (sum != 0)
      return error(Kind::geometry, "the surface is not closed here; look at the yarn with 'selvage check'")
          .at_point(points[first.edge >> 32U]);
  }
  const std::vector<double> volumes = enclosed_volumes(points, triangles, sides);
  if (std::any_of(volumes.begin(), volumes.end(), [](double volume) { return !(volume > 0); }))
    return error(
        Kind::geometry,
        "the surface encloses no volume; try a finer --size, or look at the yarn with 'selvage check'");
  return {};
}

Status find_regions(TetMesh& mesh, std::span<const Vec3> points, std::span<const Triangle> triangles,
                    std::span<const Sides> sides) {
  Result<std::vector<CellSide>> faces = sorted_faces(mesh, points);
  if (!faces) return faces.error();
  std::vector<CellSide> wanted;  // `cell`: the triangle's number
  for (std::uint32_t k = 0; k < triangles.size(); ++k) wanted.push_back(side_of(triangles[k], k));
  std::sort(wanted.begin(), wanted.end(), is_before);

  constexpr std::uint32_t unknown = Sides::outside - 1;
  mesh.regions.assign(mesh.cells.size(), unknown);
  Groups groups(mesh.cells.size());
  // Joins cells over faces; then triangles say what is on their sides.
  std::size_t next = 0;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> told;  // cell, region
  for (std::size_t i = 0; i < faces->size();) {
    std::size_t last = i + 1;
    while (last < faces->size() && (*faces)[last].corners == (*faces)[i].corners) ++last;
    if (last - i > 2) return wrong("TetGen's mesh has a face with more than two tetrahedra");
    if (next < wanted.size() && wanted[next].corners < (*faces)[i].corners)
      return in_the_way("TetGen did not keep a triangle of the surface");
    if (next < wanted.size() && wanted[next].corners == (*faces)[i].corners) {
      const Sides& s = sides[wanted[next].cell];
      const bool open = s.behind == Sides::outside || s.front == Sides::outside;
      if ((last - i == 1) != open)
        return in_the_way("a triangle of the surface has not the tetrahedra beside it");
      for (std::size_t k = i; k < last; ++k)
        told.emplace_back((*faces)[k].cell, (*faces)[k].even == wanted[next].even ? s.behind : s.front);
      ++next;
    } else if (last - i == 2) {
      groups.join((*faces)[i].cell, (*faces)[i + 1].cell);
    } else {
      return in_the_way("the boundary of TetGen's mesh is not the yarns' surface");
    }
    i = last;
  }
  if (next < wanted.size()) return in_the_way("TetGen did not keep a triangle of the surface");
  for (const auto& [cell, region] : told) {
    std::uint32_t& known = mesh.regions[groups.of(cell)];
    if (region == Sides::outside || (known != unknown && known != region))
      return in_the_way("TetGen's mesh joins two regions");
    known = region;
  }
  std::vector<double> volumes(count_regions(sides), 0.0);
  for (std::uint32_t c = 0; c < mesh.cells.size(); ++c) {
    const std::uint32_t region = mesh.regions[groups.of(c)];
    if (region == unknown) return wrong("a tetrahedron is in no region");
    mesh.regions[c] = region;
    volumes[region] += six_volumes(mesh.points, mesh.cells[c]) / 6;
  }
  const std::vector<double> enclosed = enclosed_volumes(points, triangles, sides);
  for (std::size_t r = 0; r < volumes.size(); ++r)
    if (!(std::abs(volumes[r] - enclosed[r]) <= 1e-9 * enclosed[r]))
      return wrong(
          fmt::format("region {} of TetGen's mesh has the volume {:.12g}, its surface encloses {:.12g}", r,
                      volumes[r], enclosed[r]));
  return {};
}

}  // namespace selvage::fem
