// 142 and 144, 141 and 143: faces that are parts of surfaces.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "cad/feet.h"
#include "cad/natural_border.h"
#include "cad/sampled_curve.h"
#include "formats/iges/curves.h"
#include "formats/iges/surfaces.h"
#include "formats/iges/types.h"

namespace selvage::formats::iges {

namespace {

using nurbs::Curve;

// A boundary as the file has it: curves in space, in the parameters, or both, one after the other.
struct Boundary {
  std::vector<Curve> spatial, flat;
};

// A 142, the curve on the surface of a 144.
Boundary read_curve_on_surface(Reading& reading, Parameters& in) {
  in.integer();  // how it was made
  in.pointer();  // the surface
  const int flat = in.pointer(), spatial = in.pointer();
  in.integer();  // which one is preferred
  Boundary boundary;
  if (in.ok() && flat == 0 && spatial == 0) in.fail("it has no curve, neither in space nor in parameters");
  if (in.ok() && flat != 0) boundary.flat = read_chain(reading, flat, in);
  if (in.ok() && spatial != 0) boundary.spatial = read_chain(reading, spatial, in);
  if (in.ok() && spatial != 0) turn_to_meet(reading, *reading.entry(spatial, in), boundary.spatial);
  return boundary;
}

// A 141.
Boundary read_boundary_entity(Reading& reading, Parameters& in) {
  const bool has_flats = in.integer() == 1;
  in.integer();  // which ones are preferred
  in.pointer();  // the surface
  Boundary boundary;
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
    std::ranges::move(chain, std::back_inserter(boundary.spatial));
    const std::size_t flats = in.count("curves in parameters");
    for (std::size_t k = 0; k < flats && in.ok(); ++k)
      std::ranges::move(read_chain(reading, in.pointer(), in), std::back_inserter(boundary.flat));
  }
  if (!has_flats) boundary.flat.clear();
  return boundary;
}

// With the entity's own transformation, which curves in parameters do not have.
std::optional<Boundary> read_boundary(Reading& reading, int pointer, int type, Parameters& by) {
  const DirectoryEntry* const entry = reading.entry(pointer, type, by);
  std::optional<Boundary> boundary = reading.inside(entry, by, [&](Parameters& in) {
    return std::optional(type == 142 ? read_curve_on_surface(reading, in)
                                     : read_boundary_entity(reading, in));
  });
  if (boundary) reading.placement(*entry).apply(boundary->spatial);
  return boundary;
}

// As many edges as the file has, with both curves where they go together one by one.
cad::Loop spatial_loop(std::vector<Curve> spatial) {
  cad::Loop loop;
  for (Curve& curve : spatial) {
    cad::Edge edge;
    if (!cad::is_point(curve, 0)) edge.curve = std::move(curve);
    loop.edges.push_back(std::move(edge));
  }
  return loop;
}

// Puts the curves in the parameters beside those in space where there are as many, or instead of them where
// there are none. Where only poles are left out in space, these are edges without a curve there.
void add_flats(cad::Loop& loop, const Boundary& boundary, const FlatMap& map, const nurbs::Surface& surface,
               double tolerance, Parameters& by) {
  if (boundary.flat.empty()) return;
  const bool alone = loop.edges.empty();
  std::vector<std::optional<Curve>> flats;
  for (const Curve& flat : boundary.flat) flats.push_back(map(flat));
  const bool are_known = std::ranges::none_of(flats, [](const auto& flat) { return !flat; });
  if (alone && !are_known)
    by.give_up("its boundary is known in the surface's parameters only, which are not understood");
  cad::Loop joined;
  std::size_t used = 0;
  const bool all_beside = flats.size() == loop.edges.size();
  for (std::optional<Curve>& flat : flats) {
    cad::Edge& edge = joined.edges.emplace_back();
    if (!alone && (all_beside || (flat && !cad::is_point(surface, *flat, tolerance)))) {
      if (used == loop.edges.size()) return;
      edge = loop.edges[used++];
    }
    if (!flat) continue;
    edge.flat = std::move(*flat);
    align_flat(edge, surface);
  }
  if (used != loop.edges.size()) return;
  loop = std::move(joined);
  if (are_known) cad::give_poles(loop, surface, tolerance);
}

// `boundaries` are entities of `type`.
std::optional<cad::Face> read_trimmed(Reading& reading, int surface_pointer,
                                      const std::vector<int>& boundaries, int type, bool own_border,
                                      Parameters& in) {
  std::vector<Boundary> read_ones;
  cad::Face face;
  for (const int pointer : boundaries) {
    std::optional<Boundary> boundary = read_boundary(reading, pointer, type, in);
    if (!boundary) return std::nullopt;
    // Where only the parameters count, the file's curves in space are what somebody made of them.
    face.loops.push_back(spatial_loop(std::move(boundary->spatial)));
    read_ones.push_back(std::move(*boundary));
  }
  const std::optional<FlatMap> map = put_surface(reading, surface_pointer, face, in);
  if (!map) return std::nullopt;
  const double tolerance = cad::border_tolerance(face, reading.file().global().resolution);
  for (std::size_t i = 0; i < face.loops.size(); ++i)
    add_flats(face.loops[i], read_ones[i], *map, face.surface, tolerance, in);
  if (!in.ok()) return std::nullopt;
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
  return read_trimmed(reading, surface, boundaries, 142, outer == 0, in);
}

std::optional<cad::Face> read_143(Reading& reading, const DirectoryEntry& /*entry*/, Parameters& in) {
  in.integer();  // with curves in parameters or without
  const int surface = in.pointer();
  const std::size_t count = in.count("boundaries");
  std::vector<int> boundaries;
  for (std::size_t i = 0; i < count && in.ok(); ++i) boundaries.push_back(in.pointer());
  return read_trimmed(reading, surface, boundaries, 141, false, in);
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
