#include "formats/iges/solid.h"

#include <array>

#include "nurbs/turn.h"

namespace selvage::formats::iges {

namespace {

using yarn::EndStyle;

// The topology of one yarn.
struct Face {
  const nurbs::Surface* surface = nullptr;
  bool outward = true;        // S_u x S_v points out of the yarn
  std::vector<EdgeUse> loop;  // counter-clockwise in the surface's parameters
  // A flat end: its only edge has a curve in the parameters, too. OpenCASCADE's own projection of a circle is
  // off by 2e-6 of what it holds.
  const yarn::EndPlane* plane = nullptr;
};
struct Topology {
  std::vector<Vec3> vertices;
  std::vector<SolidEdge> edges;
  std::vector<Face> faces;
};

// The edges round one end: the whole end curve, or its quarters for a patch.
struct Rim {
  std::size_t first_edge = 0, count = 1, first_vertex = 0;
};

std::size_t edges_of_rim(EndStyle style) {
  return style == EndStyle::patch ? 4 : 1;
}

Rim add_rim(Topology& topology, const yarn::Body& body, bool last, const yarn::EndPlane* plane) {
  const EndStyle style = (last ? body.end : body.start).style;
  Rim rim{topology.edges.size(), edges_of_rim(style), topology.vertices.size()};
  const Vec3* normal = plane != nullptr ? &plane->normal : nullptr;
  const auto add = [&](nurbs::Curve curve, std::size_t k) {
    topology.vertices.push_back(curve.points.front());
    topology.edges.push_back(
        {std::move(curve), rim.first_vertex + k, rim.first_vertex + (k + 1) % rim.count, normal});
  };
  if (style == EndStyle::patch) {
    std::array<nurbs::Curve, 4> quarters = yarn::end_quarters(body, last);
    for (std::size_t k = 0; k < 4; ++k) add(std::move(quarters[k]), k);
  } else {
    add(yarn::end_curve(body, last), 0);
  }
  return rim;
}

void add_uses(std::vector<EdgeUse>& loop, const Rim& rim, bool forward) {
  for (std::size_t k = 0; k < rim.count; ++k)
    loop.push_back({false, rim.first_edge + (forward ? k : rim.count - 1 - k), forward});
}

void add_end(Topology& topology, const yarn::Body& body, bool last, const Rim& rim,
             const yarn::EndPlane* plane) {
  const yarn::EndFace& end = last ? body.end : body.start;
  Face face;
  face.surface = plane != nullptr ? &plane->surface : &end.surface;
  face.outward = !(plane != nullptr ? plane->inward : end.inward);
  face.plane = plane;
  add_uses(face.loop, rim, true);
  if (end.style == EndStyle::fan) {  // along the seam to the pole in the centre and back
    const std::size_t centre = topology.vertices.size(), seam = topology.edges.size();
    topology.vertices.push_back(end.surface.point(0, end.surface.count_v - 1));
    topology.edges.push_back({nurbs::boundary_column(end.surface, false), rim.first_vertex, centre, nullptr});
    face.loop.insert(face.loop.end(), {{false, seam, true}, {true, centre, true}, {false, seam, false}});
  }
  topology.faces.push_back(std::move(face));
}

// A torus: two closed edges through one vertex, each used twice.
Topology ring(const yarn::Body& body) {
  Topology topology;
  topology.vertices = {body.surface.points.front()};
  topology.edges = {{nurbs::boundary_row(body.surface, false), 0, 0, nullptr},
                    {nurbs::boundary_column(body.surface, false), 0, 0, nullptr}};
  topology.faces = {{&body.surface,
                     !body.inward,
                     {{false, 0, true}, {false, 1, true}, {false, 0, false}, {false, 1, false}},
                     nullptr}};
  return topology;
}

Topology tube(const yarn::Body& body, const yarn::EndPlane* start, const yarn::EndPlane* end) {
  Topology topology;
  const Rim first = add_rim(topology, body, false, start), last = add_rim(topology, body, true, end);
  const std::size_t seam = topology.edges.size();
  topology.edges.push_back(
      {nurbs::boundary_column(body.surface, false), first.first_vertex, last.first_vertex, nullptr});
  Face face{&body.surface, !body.inward, {}, nullptr};
  add_uses(face.loop, first, true);
  face.loop.push_back({false, seam, true});
  add_uses(face.loop, last, false);
  face.loop.push_back({false, seam, false});
  topology.faces.push_back(std::move(face));
  add_end(topology, body, false, first, start);
  add_end(topology, body, true, last, end);
  return topology;
}

}  // namespace

SolidLists write_lists(Records& records, const Common& common, const std::vector<Vec3>& vertices,
                       const std::vector<SolidEdge>& edges) {
  std::vector<int> curves;
  curves.reserve(edges.size());
  for (const SolidEdge& edge : edges)
    curves.push_back(write_curve(records, common.entity(126, 0, dependent), edge.curve, edge.normal));
  SolidLists lists;
  lists.vertices = records.begin(common.entity(502, 1, dependent));
  records.integer(static_cast<std::int64_t>(vertices.size()));
  records.points(vertices);
  records.end();
  lists.edges = records.begin(common.entity(504, 1, dependent));
  records.integer(static_cast<std::int64_t>(edges.size()));
  for (std::size_t i = 0; i < edges.size(); ++i) {
    records.integer(curves[i]);
    for (const std::size_t vertex : {edges[i].from, edges[i].to}) {
      records.integer(lists.vertices);
      records.integer(static_cast<std::int64_t>(vertex) + 1);
    }
  }
  records.end();
  return lists;
}

int write_loop(Records& records, const Common& common, const SolidLists& lists,
               std::span<const EdgeUse> uses) {
  const int pointer = records.begin(common.entity(508, 1, dependent));
  records.integer(static_cast<std::int64_t>(uses.size()));
  for (const EdgeUse& use : uses) {
    records.integer(use.is_vertex ? 1 : 0);
    records.integer(use.is_vertex ? lists.vertices : lists.edges);
    records.integer(static_cast<std::int64_t>(use.index) + 1);
    records.integer(use.forward ? 1 : 0);
    records.integer(use.flat != 0 ? 1 : 0);
    if (use.flat == 0) continue;
    records.integer(0);  // not said to be along a parameter
    records.integer(use.flat);
  }
  records.end();
  return pointer;
}

int write_face(Records& records, const Common& common, int surface, std::span<const int> loops,
               int property) {
  const int pointer = records.begin(common.entity(510, 1, dependent));
  records.integer(surface);
  records.integer(static_cast<std::int64_t>(loops.size()));
  records.integer(1);  // the first is the outer one
  for (const int loop : loops) records.integer(loop);
  records.end(property);
  return pointer;
}

int write_shells(Records& records, const Common& common, std::span<const std::vector<SolidFace>> shells) {
  std::vector<int> pointers;
  for (const std::vector<SolidFace>& faces : shells) {
    pointers.push_back(records.begin(common.entity(514, 1, dependent)));
    records.integer(static_cast<std::int64_t>(faces.size()));
    for (const SolidFace& face : faces) {
      records.integer(face.pointer);
      records.integer(face.outward ? 1 : 0);
    }
    records.end();
  }
  const int solid = records.begin(common.entity(186));
  for (std::size_t i = 0; i < pointers.size(); ++i) {
    records.integer(pointers[i]);
    records.integer(1);  // the shell's orientation is that of its faces
    if (i == 0) records.integer(static_cast<std::int64_t>(pointers.size()) - 1);  // voids
  }
  records.end(common.name);
  return solid;
}

int entities_of_solid(const yarn::Body& body) {
  // Face: surface, 508, 510; and 502, 504, 514, 186.
  if (body.closed_along) return 2 + 3 + 4;
  int edges = 1;
  for (const yarn::EndFace* end : {&body.start, &body.end}) {
    const bool has_seam = end->style == EndStyle::fan, has_flat = end->style == EndStyle::planar;
    edges += static_cast<int>(edges_of_rim(end->style)) + (has_seam || has_flat ? 1 : 0);
  }
  return edges + 3 * 3 + 4;
}

int write_solid(Records& records, const Common& common, const yarn::Body& body) {
  std::array<yarn::EndPlane, 2> planes;
  const auto plane_of = [&](bool last) -> const yarn::EndPlane* {
    if ((last ? body.end : body.start).style != EndStyle::planar) return nullptr;
    planes[last] = yarn::end_plane(body, yarn::end_curve(body, last), last);
    return &planes[last];
  };
  Topology topology = body.closed_along ? ring(body) : tube(body, plane_of(false), plane_of(true));

  std::vector<int> surfaces;
  for (const Face& face : topology.faces)
    surfaces.push_back(write_surface(records, common.entity(128, 0, dependent), *face.surface));
  const SolidLists lists = write_lists(records, common, topology.vertices, topology.edges);
  const Vec3 up = Vec3::UnitZ();
  std::vector<SolidFace> faces;
  for (Face& face : topology.faces) {
    if (face.plane != nullptr) {
      EdgeUse& only = face.loop.front();
      only.flat = write_curve(records, common.entity(126, 0, dependent_in_2d),
                              face.plane->in_parameters(topology.edges[only.index].curve), &up);
    }
    const int loop = write_loop(records, common, lists, face.loop);
    faces.push_back({write_face(records, common, surfaces[faces.size()], {&loop, 1}), face.outward});
  }
  return write_shells(records, common, {&faces, 1});
}

}  // namespace selvage::formats::iges
