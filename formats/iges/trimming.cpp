// 142 and 144, 141 and 143: faces that are parts of surfaces.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "cad/natural_border.h"
#include "formats/iges/curves.h"
#include "formats/iges/surfaces.h"
#include "formats/iges/types.h"

namespace selvage::formats::iges {

namespace {

using nurbs::Curve;

// A boundary as the file has it: curves in space, in the parameters, or both, one after the other.
struct Boundary {
  std::vector<Curve> spatial, flat;
  bool prefers_flat = false;
  std::vector<std::size_t> flats_each;  // 141: how many of `flat` go with each spatial one
};

bool is_point_like(const Curve& curve) {
  for (const Vec3& p : curve.points)
    if (p != curve.points.front()) return false;
  return true;
}

// With the entity's own transformation, which curves in parameters do not have.
std::optional<Boundary> finished(Reading& reading, const DirectoryEntry& entry, Parameters& in,
                                 Boundary boundary, Parameters& by) {
  if (!reading.finish(entry, in)) {
    by.give_up({});
    return std::nullopt;
  }
  const Placement placement = reading.placement(entry);
  for (Curve& curve : boundary.spatial) placement.apply(curve);
  return boundary;
}

// The curve on the surface that a 142 says: its surface is that of the 144.
std::optional<Boundary> read_curve_on_surface(Reading& reading, int pointer, Parameters& by) {
  const DirectoryEntry* const entry = reading.entry(pointer, 142, by);
  if (entry == nullptr) return std::nullopt;
  Parameters in = reading.file().parameters(*entry);
  in.integer();  // how it was made
  in.pointer();  // the surface
  const int flat = in.pointer(), spatial = in.pointer();
  Boundary boundary;
  boundary.prefers_flat = in.integer() == 1;
  if (in.ok() && flat == 0 && spatial == 0) in.fail("it has no curve, neither in space nor in parameters");
  if (in.ok() && flat != 0) boundary.flat = read_chain(reading, flat, in);
  if (in.ok() && spatial != 0) boundary.spatial = read_chain(reading, spatial, in);
  return finished(reading, *entry, in, std::move(boundary), by);
}

std::optional<Boundary> read_boundary_entity(Reading& reading, int pointer, Parameters& by) {
  const DirectoryEntry* const entry = reading.entry(pointer, 141, by);
  if (entry == nullptr) return std::nullopt;
  Parameters in = reading.file().parameters(*entry);
  const bool has_flats = in.integer() == 1;
  Boundary boundary;
  boundary.prefers_flat = in.integer() == 2;
  in.pointer();  // the surface
  const std::size_t count = in.count("curves", 3);
  if (in.ok() && count == 0) in.fail("a boundary without curves");
  for (std::size_t i = 0; i < count && in.ok(); ++i) {
    const int curve = in.pointer();
    const bool backwards = in.integer() == 2;
    std::vector<Curve> chain = read_chain(reading, curve, in);
    if (backwards) {
      std::reverse(chain.begin(), chain.end());
      for (Curve& piece : chain) piece = nurbs::reversed(piece);
    }
    const std::size_t flats = in.count("curves in parameters"), before = boundary.flat.size();
    for (std::size_t k = 0; k < flats && in.ok(); ++k)
      for (Curve& flat : read_chain(reading, in.pointer(), in)) boundary.flat.push_back(std::move(flat));
    if (!has_flats) boundary.flat.resize(before);
    for (std::size_t k = 0; k < chain.size(); ++k) boundary.spatial.push_back(std::move(chain[k]));
  }
  return finished(reading, *entry, in, std::move(boundary), by);
}

// As many edges as the file has, with both curves where they go together one by one.
cad::Loop spatial_loop(std::vector<Curve> spatial) {
  cad::Loop loop;
  for (Curve& curve : spatial) {
    cad::Edge edge;
    if (!is_point_like(curve)) edge.curve = std::move(curve);
    loop.edges.push_back(std::move(edge));
  }
  return loop;
}

// Puts the flat curves beside those in space where there are as many, or instead of them where there are
// none.
void add_flats(cad::Loop& loop, const Boundary& boundary, const FlatMap& map, const nurbs::Surface& surface,
               Parameters& by) {
  if (boundary.flat.empty()) return;
  const bool alone = loop.edges.empty();
  if (!alone && boundary.flat.size() != loop.edges.size()) return;
  for (std::size_t i = 0; i < boundary.flat.size(); ++i) {
    std::optional<Curve> flat = map(boundary.flat[i], !alone);
    if (alone && !flat) {
      by.give_up("its boundary is known in the surface's parameters only, which are not understood");
      return;
    }
    if (alone) loop.edges.emplace_back();
    cad::Edge& edge = loop.edges[i];
    if (!flat) continue;
    edge.flat = std::move(*flat);
    align_flat(edge, surface);
  }
}

template <class Read>
std::optional<cad::Face> read_trimmed(Reading& reading, int surface_pointer,
                                      const std::vector<int>& boundaries, bool own_border, Parameters& in,
                                      Read read) {
  std::vector<Boundary> read_ones;
  cad::Face face;
  for (const int pointer : boundaries) {
    std::optional<Boundary> boundary = in.ok() ? read(reading, pointer, in) : std::nullopt;
    if (!boundary) return std::nullopt;
    // Where only the parameters count, the file's curves in space are what somebody made of them.
    face.loops.push_back(spatial_loop(std::move(boundary->spatial)));
    read_ones.push_back(std::move(*boundary));
  }
  std::optional<nurbs::Surface> surface = bounded_surface(reading, surface_pointer, face.loops, in);
  if (!in.ok() || !surface) return std::nullopt;
  face.surface = std::move(*surface);
  const FlatMap map(reading, surface_pointer, face.surface);
  for (std::size_t i = 0; i < face.loops.size(); ++i)
    add_flats(face.loops[i], read_ones[i], map, face.surface, in);
  if (!in.ok()) return std::nullopt;
  const double tolerance = cad::border_tolerance(face, reading.file().global().resolution);
  if (own_border && !face.loops.empty())
    face.loops.insert(face.loops.begin(), cad::natural_border(face.surface, tolerance));
  cad::drop_natural_border(face, tolerance);
  return face;
}

std::optional<cad::Face> read_144(Reading& reading, const DirectoryEntry& /*entry*/, Parameters& in) {
  const int surface = in.pointer();
  const std::int64_t outer = in.integer();
  const std::size_t holes = in.count("inner boundaries");
  std::vector<int> boundaries;
  const int first = in.pointer();
  if (outer != 0) boundaries.push_back(first);
  for (std::size_t i = 0; i < holes && in.ok(); ++i) boundaries.push_back(in.pointer());
  return read_trimmed(reading, surface, boundaries, outer == 0, in, read_curve_on_surface);
}

std::optional<cad::Face> read_143(Reading& reading, const DirectoryEntry& /*entry*/, Parameters& in) {
  in.integer();  // with curves in parameters or without
  const int surface = in.pointer();
  const std::size_t count = in.count("boundaries");
  std::vector<int> boundaries;
  for (std::size_t i = 0; i < count && in.ok(); ++i) boundaries.push_back(in.pointer());
  return read_trimmed(reading, surface, boundaries, false, in, read_boundary_entity);
}

}  // namespace

std::span<const EntityType> trimming_types() {
  static constexpr std::array<EntityType, 4> types = {{{.number = 141},
                                                       {.number = 142},
                                                       {.number = 143, .face = read_143},
                                                       {.number = 144, .face = read_144}}};
  return types;
}

}  // namespace selvage::formats::iges
