#include "fabric/as_grid.h"

#include <algorithm>

#include "core/index.h"
#include "nurbs/interpolate.h"
#include "yarn/ends.h"
#include "yarn/grid.h"

namespace selvage::fabric {

namespace {

// What the grid gives, and whether that is the body's surface.
bool gives(const Grid& grid, const yarn::Body& body, yarn::Body& built) {
  built = {};
  return yarn::fill_from_grid(built, grid).ok() && built.closed_along == body.closed_along &&
         built.surface == body.surface;
}

// The columns [first, last) of the surface as the grid's rows.
Grid rows_of(const nurbs::Surface& surface, int first, int last) {
  Grid grid;
  grid.sections = surface.count_v;
  grid.per_section = last - first;
  grid.points.reserve(at(grid.sections) * at(grid.per_section));
  for (int j = 0; j < surface.count_v; ++j)
    for (int i = first; i < last; ++i) {
      grid.points.push_back(surface.point(i, j));
      if (surface.is_rational()) grid.weights.push_back(surface.weight(i, j));
    }
  return grid;
}

// The words for the direction along the yarn.
void describe_along(Grid& grid, const yarn::Body& body) {
  const nurbs::Surface& surface = body.surface;
  grid.closed_along = body.closed_along;
  const int standard = std::min(3, body.closed_along ? surface.count_v : surface.count_v - 1);
  if (surface.degree_v != standard) grid.degree_along = surface.degree_v;
  if (body.closed_along || surface.knots_v != nurbs::clamped_integer_knots(surface.count_v, surface.degree_v))
    grid.knots_along = surface.knots_v;
}

// The clamped form of the sections, which any surface has.
Grid open_form(const yarn::Body& body, yarn::Body& built) {
  const nurbs::Surface& surface = body.surface;
  Grid grid = rows_of(surface, 0, surface.count_u);
  grid.open_round = true;
  describe_along(grid, body);
  if (surface.degree_u != std::min(2, surface.count_u - 1)) grid.degree_round = surface.degree_u;
  if (gives(grid, body, built)) return grid;
  grid.knots_round = surface.knots_u;
  gives(grid, body, built);
  return grid;
}

// The closed polygon where that gives the surface (a quadratic of uniform knots has its points but for the
// seam's); nothing where it does not.
std::optional<Grid> closed_form(const yarn::Body& body, yarn::Body& built) {
  const nurbs::Surface& surface = body.surface;
  if (surface.degree_u != 2 || surface.count_u < 5) return std::nullopt;
  const auto spans = surface.count_u - 2;
  for (int i = 0; i <= spans; ++i)
    if (surface.knots_u[at(i) + 2] != static_cast<double>(i) / spans) return std::nullopt;
  Grid grid = rows_of(surface, 1, surface.count_u - 1);
  describe_along(grid, body);
  if (!gives(grid, body, built)) return std::nullopt;
  return grid;
}

}  // namespace

nurbs::Curve grid_axis(const yarn::Body& body) {
  yarn::Body built;
  if (!closed_form(body, built)) open_form(body, built);
  return built.axis;
}

GridYarn as_grid(const yarn::Body& body) {
  GridYarn result;
  Yarn& yarn = result.yarn = yarn_like(body);
  if (body.color != Color{}) yarn.own.color = body.color;
  yarn::Body built;
  std::optional<Grid> closed = closed_form(body, built);
  Grid grid = closed ? std::move(*closed) : open_form(body, built);
  if (body.closed_along) {
    yarn.shape = std::move(grid);
    return result;
  }
  if (built.quarters != body.quarters) grid.corners = body.quarters;
  if (body.start.style != yarn::EndStyle::patch || body.end.style != yarn::EndStyle::patch)
    yarn.ends = std::array<yarn::EndStyle, 2>{body.start.style, body.end.style};
  for (const bool last : {false, true}) {
    const yarn::EndFace& face = last ? body.end : body.start;
    result.keeps_ends = result.keeps_ends && yarn::is_standard_end(body, last);
    if (face.style != yarn::EndStyle::fan) continue;
    const Vec3& centre = face.surface.point(0, face.surface.count_v - 1);
    if (centre != (last ? built.axis.points.back() : built.axis.points.front()))
      grid.fan_centres[last ? 1 : 0] = centre;
  }
  yarn.shape = std::move(grid);
  return result;
}

GridYarn as_grid(const Fabric& fabric, const Yarn& yarn) {
  const yarn::Body& body = *std::get<ReadBody>(yarn.shape);
  GridYarn result = as_grid(body);
  result.yarn.thread = yarn.thread;
  result.yarn.own = yarn.own;
  result.yarn.own.color.reset();
  // What it would be without a word.
  const Color usual = resolved_thread(fabric, result.yarn).color.value_or(Color{});
  if (body.color != usual) result.yarn.own.color = body.color;
  return result;
}

}  // namespace selvage::fabric
