// 186, 514, 510, 508, 504, 502: solids by their faces, edges and vertices.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "cad/edges.h"
#include "cad/natural_border.h"
#include "cad/sampled_curve.h"
#include "formats/iges/surfaces.h"
#include "formats/iges/types.h"

namespace selvage::formats::iges {

namespace {

// An item of a loop, before its curves are read.
struct Use {
  bool is_vertex = false;  // a pole
  int list = 0;            // a 504, or a 502 for a vertex
  std::int64_t index = 0;  // in it, from 1
  bool forward = true;
  int flat = 0;  // pointer to the curve in the surface's parameters, where there is exactly one; else 0
};

// Of `what` of a list there are `size`.
void check_index(const Use& use, std::string_view what, std::size_t size, Parameters& by) {
  if (use.index < 1 || use.index > static_cast<std::int64_t>(size))
    by.fail(fmt::format("{} {} of the list D{}, which has {}", what, use.index, use.list, size));
}

void check_vertex(Reading& reading, const Use& use, Parameters& by) {
  const auto size = reading.inside(reading.entry(use.list, 502, by), by,
                                   [](Parameters& in) { return std::optional(in.count("vertices", 3)); });
  if (size) check_index(use, "vertex", *size, by);
}

// Null after an error.
const Reading::ListedEdge* listed_edge(Reading& reading, const Use& use, Parameters& by) {
  const std::vector<Reading::ListedEdge>* const edges = reading.edge_list(use.list, by);
  if (edges == nullptr) return nullptr;
  check_index(use, "edge", edges->size(), by);
  return by.ok() ? &(*edges)[static_cast<std::size_t>(use.index) - 1] : nullptr;
}

// The curve of an edge from its start to its end, which some writers leave to the vertices.
std::optional<nurbs::Curve> curve_of(Reading& reading, const Use& use, Parameters& by) {
  const Reading::ListedEdge* const edge = listed_edge(reading, use, by);
  if (edge == nullptr) return std::nullopt;
  std::optional<nurbs::Curve> curve = reading.curve(edge->curve, by);
  std::array<Vec3, 2> ends;
  for (const std::size_t k : {0U, 1U}) {
    const DirectoryEntry* const list = reading.file().entity(edge->lists[k]);
    // A curve says enough where its vertices cannot be read.
    if (!curve || list == nullptr || list->type != 502 || !reading.file().parameters(*list).ok())
      return curve;
    const std::vector<Vec3>* const places = reading.vertex_list(edge->lists[k], by);
    if (places == nullptr || edge->vertices[k] < 1 ||
        edge->vertices[k] > static_cast<std::int64_t>(places->size()))
      return curve;
    ends[k] = (*places)[static_cast<std::size_t>(edge->vertices[k]) - 1];
  }
  const Vec3 from = cad::at_share(*curve, 0), to = cad::at_share(*curve, 1);
  if ((from - ends[0]).norm() + (to - ends[1]).norm() > (from - ends[1]).norm() + (to - ends[0]).norm())
    curve = nurbs::reversed(*curve);
  return curve;
}

// One number for an edge of one list in the whole file: an edge takes five values, so a line of 64 columns
// has fewer than 16 of them.
int id_of(const DirectoryEntry& list, std::int64_t index) {
  return static_cast<int>(16LL * list.first_line + index);
}

// Those of a 508.
std::vector<Use> read_uses(Reading& reading, Parameters& in) {
  std::vector<Use> uses(in.count("edges of the loop", 5));
  for (Use& use : uses) {
    use.is_vertex = in.integer() == 1;
    use.list = in.pointer();
    use.index = in.integer();
    use.forward = in.logical(true);
    const std::size_t curves = in.count("curves in the parameters", 2);
    for (std::size_t k = 0; k < curves && in.ok(); ++k) {
      in.skip();  // whether it is an isoparametric curve
      const int flat = in.pointer();
      reading.use(flat);
      use.flat = curves == 1 ? flat : 0;
    }
    if (!in.ok()) break;
    if (use.is_vertex)
      check_vertex(reading, use, in);
    else
      listed_edge(reading, use, in);
  }
  if (in.ok() && uses.empty()) in.fail("a loop without edges");
  return uses;
}

// The curves in the parameters are still as in the file.
std::optional<cad::Loop> read_loop(Reading& reading, int pointer, Parameters& by) {
  const auto uses = reading.inside(reading.entry(pointer, 508, by), by,
                                   [&](Parameters& in) { return std::optional(read_uses(reading, in)); });
  if (!uses) return std::nullopt;
  cad::Loop loop;
  for (const Use& use : *uses) {
    cad::Edge edge;
    if (!use.is_vertex) {
      std::optional<nurbs::Curve> curve = curve_of(reading, use, by);
      if (!curve) return std::nullopt;
      edge.curve = use.forward ? std::move(*curve) : nurbs::reversed(*curve);
      edge.id = id_of(*reading.file().entity(use.list), use.index);
    }
    if (use.flat != 0) {
      std::optional<nurbs::Curve> flat = reading.curve(use.flat, by);
      if (!flat) return std::nullopt;
      edge.flat = std::move(*flat);
    }
    loop.edges.push_back(std::move(edge));
  }
  return loop;
}

// 510: SURF, N, OF (is the first loop the outer one), N loops.
std::optional<cad::Face> read_face(Reading& reading, const DirectoryEntry& /*entry*/, Parameters& in) {
  const int surface_pointer = in.pointer();
  const std::size_t count = in.count("loops");
  in.skip();
  std::vector<int> loops(count);
  for (int& loop : loops) loop = in.pointer();
  cad::Face face;
  for (const int pointer : loops) {
    std::optional<cad::Loop> loop = read_loop(reading, pointer, in);
    if (!loop) return std::nullopt;
    face.loops.push_back(std::move(*loop));
  }
  const std::optional<FlatMap> map = put_surface(reading, surface_pointer, face, in);
  if (!map) return std::nullopt;
  for (cad::Edge& edge : cad::edges_of(face)) {
    if (edge.flat.points.empty()) continue;
    edge.flat = (*map)(edge.flat).value_or(nurbs::Curve{});  // a pole needs none
    align_flat(edge, face.surface);
  }
  cad::drop_natural_border(face, cad::border_tolerance(face, reading.file().global().resolution));
  return face;
}

// 514: N, and for each face its pointer and whether it points as the shell does.
std::optional<cad::Part> read_shell(Reading& reading, const DirectoryEntry& /*entry*/, Parameters& in) {
  const std::size_t count = in.count("faces", 2);
  cad::Part part;
  part.kind = cad::Part::Kind::shell;
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    const int pointer = in.pointer();
    const bool forward = in.logical(true);
    if (reading.entry(pointer, 510, in) == nullptr) return std::nullopt;
    std::optional<cad::Face> face = reading.face(pointer, in);
    if (!face) return std::nullopt;
    face->reversed = !forward;
    part.faces.push_back(std::move(*face));
  }
  if (in.ok() && part.faces.empty()) in.fail("a shell without faces");
  return in.ok() ? std::optional(std::move(part)) : std::nullopt;
}

// 186: the outer shell and whether it points out, N voids, each alike.
std::optional<cad::Part> read_solid(Reading& reading, const DirectoryEntry& /*entry*/, Parameters& in) {
  cad::Part solid;
  solid.kind = cad::Part::Kind::solid;
  std::size_t shells = 1;
  for (std::size_t i = 0; i < shells && in.ok(); ++i) {
    const int pointer = in.pointer();
    const bool forward = in.logical(true);
    if (i == 0) shells += in.count("voids", 2);
    if (reading.entry(pointer, 514, in) == nullptr) return std::nullopt;
    std::optional<cad::Part> shell = reading.part(pointer, in);
    if (!shell) return std::nullopt;
    for (cad::Face& face : shell->faces) {
      if (!forward) face.reversed = !face.reversed;
      solid.faces.push_back(std::move(face));
    }
  }
  return in.ok() ? std::optional(std::move(solid)) : std::nullopt;
}

}  // namespace

std::span<const EntityType> topology_types() {
  static constexpr std::array<EntityType, 6> types = {{{.number = 186, .part = read_solid},
                                                       {.number = 514, .part = read_shell},
                                                       {.number = 510, .face = read_face},
                                                       {.number = 508},
                                                       {.number = 504},
                                                       {.number = 502}}};
  return types;
}

}  // namespace selvage::formats::iges
