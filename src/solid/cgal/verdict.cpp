#include "solid/cgal/verdict.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>

#include <utility>
#include <vector>

#include "core/bounds.h"

namespace selvage::solid {

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Face = Mesh::Face_index;
using Vertex = Mesh::Vertex_index;

// The coordinates in turn, so that the skin's longest extent comes first: the search for triangles that cross
// scans along that (of a yarn that lies across it every triangle would meet thousands).
class Turn {
 public:
  explicit Turn(const Tessellation& skin) { bounds_of(skin.vertices).sizes().maxCoeff(&first_); }
  [[nodiscard]] Point to(const Vec3& p) const {
    return {p[first_], p[(first_ + 1) % 3], p[(first_ + 2) % 3]};
  }
  [[nodiscard]] Vec3 back(const Point& p) const {
    Vec3 out;
    for (int k = 0; k < 3; ++k) out[(first_ + k) % 3] = p[k];
    return out;
  }

 private:
  Eigen::Index first_ = 0;
};

Box3 box_of(const Mesh& mesh, Face face, const Turn& turn) {
  Box3 box;
  for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face)))
    box.extend(turn.back(mesh.point(vertex)));
  return box;
}

// False: some edge would have two triangles that run the same way along it, or three.
bool fill(Mesh& mesh, const Tessellation& skin, const Turn& turn) {
  const auto vertices = static_cast<Mesh::size_type>(skin.vertices.size());
  const auto faces = static_cast<Mesh::size_type>(skin.triangles.size());
  mesh.reserve(vertices, vertices + faces, faces);
  for (const Vec3& p : skin.vertices) mesh.add_vertex(turn.to(p));
  for (const auto& t : skin.triangles)
    if (mesh.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2])) == Mesh::null_face()) return false;
  return true;
}

}  // namespace

Verdict judge(const Tessellation& skin) {
  Verdict verdict;
  if (skin.triangles.empty()) return verdict;
  const Turn turn(skin);
  Mesh mesh;
  if (!fill(mesh, skin, turn)) return verdict;
  verdict.consistent = true;
  verdict.closed = CGAL::is_closed(mesh);
  std::vector<std::pair<Face, Face>> pairs;
  if (pmp::does_self_intersect(mesh)) {
    verdict.self_intersecting = true;
    pmp::self_intersections<CGAL::Sequential_tag>(mesh, std::back_inserter(pairs),
                                                  CGAL::parameters::maximum_number(1));
    if (!pairs.empty())
      verdict.crossing =
          box_of(mesh, pairs[0].first, turn).intersection(box_of(mesh, pairs[0].second, turn)).center();
  }
  if (!verdict.closed) return verdict;
  verdict.outward = pmp::is_outward_oriented(mesh);
  verdict.bounds_volume = !verdict.self_intersecting && pmp::does_bound_a_volume(mesh);
  return verdict;
}

const char* cgal_version() {
  return CGAL_VERSION_STR;
}

}  // namespace selvage::solid
