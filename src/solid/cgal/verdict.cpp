#include "solid/cgal/verdict.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>

#include <utility>
#include <vector>

namespace selvage::solid {

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;
using Face = Mesh::Face_index;
using Vertex = Mesh::Vertex_index;

Point to_point(const Vec3& p) {
  return {p.x(), p.y(), p.z()};
}

Box3 box_of(const Mesh& mesh, Face face) {
  Box3 box;
  for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face))) {
    const Point& p = mesh.point(vertex);
    box.extend(Vec3(p.x(), p.y(), p.z()));
  }
  return box;
}

// False: some edge would have two triangles that run the same way along it, or three.
bool fill(Mesh& mesh, const Tessellation& skin) {
  const auto vertices = static_cast<Mesh::size_type>(skin.vertices.size());
  const auto faces = static_cast<Mesh::size_type>(skin.triangles.size());
  mesh.reserve(vertices, vertices + faces, faces);
  for (const Vec3& p : skin.vertices) mesh.add_vertex(to_point(p));
  for (const auto& t : skin.triangles)
    if (mesh.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2])) == Mesh::null_face()) return false;
  return true;
}

}  // namespace

Verdict judge(const Tessellation& skin) {
  Verdict verdict;
  Mesh mesh;
  if (skin.triangles.empty() || !fill(mesh, skin)) return verdict;
  verdict.consistent = true;
  verdict.closed = CGAL::is_closed(mesh);
  std::vector<std::pair<Face, Face>> pairs;
  if (pmp::does_self_intersect(mesh)) {
    verdict.self_intersecting = true;
    pmp::self_intersections<CGAL::Sequential_tag>(mesh, std::back_inserter(pairs),
                                                  CGAL::parameters::maximum_number(1));
    if (!pairs.empty())
      verdict.crossing = box_of(mesh, pairs[0].first).intersection(box_of(mesh, pairs[0].second)).center();
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
