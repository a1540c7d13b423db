#include "solid/cgal/triangulate.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <utility>
#include <vector>

namespace selvage::solid {

namespace {

constexpr std::int32_t unknown = -2;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceInfoBase = CGAL::Triangulation_face_base_with_info_2<std::int32_t, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel, FaceInfoBase>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::No_constraint_intersection_tag>;
using Vertex = Triangulation::Vertex_handle;
using Face = Triangulation::Face_handle;

Message wrong(const char* what, const Vec2& place) {
  return error(Kind::geometry, what, {.at = Vec3(place.x(), place.y(), 0)});
}

// The face to the left of the edge from a to b.
Face left_of(const Triangulation& triangulation, Vertex a, Vertex b) {
  Face face;
  int index = 0;
  triangulation.is_edge(a, b, face, index);
  // `face` has both; the left one sees a before b counter-clockwise.
  return face->vertex(Triangulation::ccw(index)) == a ? face : face->neighbor(index);
}

// Every face that is not parted from this one by a segment gets its domain; false: one has another already.
bool spread(const Triangulation& triangulation, Face from, std::int32_t domain) {
  if (from->info() != unknown) return from->info() == domain;
  std::vector<Face> stack = {from};
  from->info() = domain;
  while (!stack.empty()) {
    const Face face = stack.back();
    stack.pop_back();
    for (int k = 0; k < 3; ++k) {
      if (face->is_constrained(k)) continue;
      const Face next = face->neighbor(k);
      if (triangulation.is_infinite(next) && domain >= 0) return false;
      if (next->info() == domain) continue;
      if (next->info() != unknown) return false;
      next->info() = domain;
      stack.push_back(next);
    }
  }
  return true;
}

}  // namespace

Result<PlanarTriangles> triangulate_with_cgal(std::span<const Vec2> points,
                                              std::span<const PlanarSegment> segments) {
  Triangulation triangulation;
  std::vector<std::pair<Triangulation::Point, std::uint32_t>> input;
  input.reserve(points.size());
  for (std::uint32_t k = 0; k < points.size(); ++k)
    input.emplace_back(Triangulation::Point(points[k].x(), points[k].y()), k);
  triangulation.insert(input.begin(), input.end());
  std::vector<Vertex> vertices(points.size());
  for (auto v = triangulation.finite_vertices_begin(); v != triangulation.finite_vertices_end(); ++v)
    vertices[v->info()] = v;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (vertices[k] == Vertex()) return wrong("two points lie in one place", points[k]);
  if (!points.empty() && triangulation.dimension() < 2)
    return wrong("all points lie on a line", points.front());
  for (const PlanarSegment& s : segments) {
    const Vec2 middle = (points[s.from] + points[s.to]) / 2;
    try {
      triangulation.insert_constraint(vertices[s.from], vertices[s.to]);
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
      return wrong("two lines cross", middle);
    }
    if (!triangulation.is_edge(vertices[s.from], vertices[s.to]))
      return wrong("a line passes through a point", middle);
  }
  for (auto f = triangulation.all_faces_begin(); f != triangulation.all_faces_end(); ++f) f->info() = unknown;
  for (const PlanarSegment& s : segments) {
    const Vertex a = vertices[s.from], b = vertices[s.to];
    if (!spread(triangulation, left_of(triangulation, a, b), s.left) ||
        !spread(triangulation, left_of(triangulation, b, a), s.right))
      return wrong("a line has another domain beside it than it should", (points[s.from] + points[s.to]) / 2);
  }
  PlanarTriangles result;
  for (auto f = triangulation.finite_faces_begin(); f != triangulation.finite_faces_end(); ++f) {
    if (f->info() < 0) continue;
    result.triangles.push_back({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
    result.domains.push_back(f->info());
  }
  return result;
}

}  // namespace selvage::solid
