#include "tetrahedra/block.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "fem/fibre.h"
#include "fem/quality.h"
#include "tetrahedra/improve.h"
#include "tetrahedra/midside.h"
#include "tetrahedra/slide.h"
#include "tetrahedra/tet_complex.h"

namespace selvage::fem {

Status check_options(const MeshOptions& options) {
  if (options.order != 1 && options.order != 2) return error(Kind::usage, "the order of a mesh is 1 or 2");
  if (!(options.size >= 0) || !std::isfinite(options.size))
    return error(Kind::usage, "the mesh size must be a positive number");
  if (!(options.min_dihedral >= 0 && options.min_dihedral <= 30))
    return error(Kind::usage, "the smallest dihedral angle wanted must be from 0 to 30 degrees");
  return {};
}

Block::Block(std::span<const yarn::Body> own_bodies, Unit own_units, const Parallelepiped& own_cell,
             const std::array<bool, 3>& own_periodic, Skin own_skin)
    : bodies(own_bodies),
      units(own_units),
      cell(own_cell),
      periodic(own_periodic),
      skin(std::move(own_skin)) {
  for (const Sides& sides : skin.surface.sides)
    for (const std::uint32_t body : {sides.behind, sides.front})
      if (body != Sides::outside) of_regions.push_back(body);
  std::sort(of_regions.begin(), of_regions.end());
  of_regions.erase(std::unique(of_regions.begin(), of_regions.end()), of_regions.end());
  const auto region_of = [&](std::uint32_t body) {
    if (body == Sides::outside) return body;
    return static_cast<std::uint32_t>(std::lower_bound(of_regions.begin(), of_regions.end(), body) -
                                      of_regions.begin());
  };
  for (Sides& sides : skin.surface.sides) sides = {region_of(sides.behind), region_of(sides.front)};
}

Result<TetMesh> fill(const Block& block, std::span<const Vec3> kept, double smallest,
                     const MeshOptions& options, const std::filesystem::path& program) {
  const std::vector<Vec3>& round = block.skin.nodes.points;
  const TetgenLimits limits{.timeout = options.timeout, .memory = options.memory};
  TetgenJob job{.points = round, .triangles = block.skin.surface.triangles, .smallest_feature = smallest};
  if (block.of_regions.size() > 1) job.sides = block.skin.surface.sides;
  if (!kept.empty()) job.points = kept;
  Result<TetMesh> tets = run_tetgen(program, job, limits);
  if (tets || kept.empty() || tets.error().kind != Kind::geometry) return tets;
  job.points = round;
  tets = run_tetgen(program, job, limits);
  if (!tets) return tets;
  std::vector<Vec3>& p = tets->points;
  std::copy(kept.begin(), kept.end(), p.begin());
  const bool turns = std::any_of(tets->cells.begin(), tets->cells.end(), [&](const Tetrahedron& t) {
    return tet_quality(p[t[0]], p[t[1]], p[t[2]], p[t[3]]) == inverted_quality;
  });
  if (turns) std::copy(round.begin(), round.end(), p.begin());
  return tets;
}

Improved improve(TetMesh& tets, Block& block, double largest, const MeshOptions& options) {
  constexpr int most_rounds = 6;                 // of sliding
  constexpr double good = 25, least_gain = 0.1;  // degrees
  ImproveOptions improving;
  improving.target = options.min_dihedral;
  improving.polish = good;
  improving.refine = {.max_volume = largest_volume(largest)};
  improving.threads = options.threads;
  const bool slides = block.of_regions.back() == CellTriangles::matrix;
  const std::size_t fixed = block.skin.nodes.points.size();
  const auto run = [&] { return improve(tets.points, tets.cells, tets.regions, fixed, improving); };
  // What sliding mends by itself need not be worked on before.
  if (slides) improving.passes = 0;
  Improvement done = run();
  improving.refine.reset();
  if (slides) improving.passes = 2;
  // The smallest angle that another surface could still mend.
  const auto smallest = [&] {
    const auto found = std::ranges::find_if(
        done.below, [](const BelowTarget& below) { return below.cause != BelowTarget::Cause::geometry; });
    return found == done.below.end() ? options.min_dihedral : found->angle;
  };
  double before = -1;
  for (int round = 0; slides && round < most_rounds; ++round) {
    if (round > 0 && (smallest() >= options.min_dihedral || smallest() < before + least_gain)) break;
    before = smallest();
    slide_points(tets, block, good, options.order == 2);
    done = run();
  }
  return {count(done, options.min_dihedral), describe(done, options.min_dihedral, name_of(block.units))};
}

Mesh assemble(const Block& block, const TetMesh& tets) {
  Mesh mesh;
  const double scale = millimetres_per(block.units);
  mesh.nodes.reserve(tets.points.size());
  for (const Vec3& point : tets.points) mesh.nodes.emplace_back(point * scale);
  std::vector<std::size_t> order(tets.cells.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return tets.regions[a] < tets.regions[b]; });
  mesh.regions.resize(block.of_regions.size());
  mesh.elements.reserve(order.size());
  for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
    Region& region = mesh.regions[r];
    const std::uint32_t body = block.of_regions[r];
    region.kind = body == CellTriangles::matrix ? Region::Kind::matrix : Region::Kind::yarn;
    region.name = region.kind == Region::Kind::matrix ? "matrix" : block.bodies[body].name;
    region.first_element = mesh.elements.size();
    for (; mesh.elements.size() < order.size() && tets.regions[order[mesh.elements.size()]] == r;) {
      const auto& cell = tets.cells[order[mesh.elements.size()]];
      mesh.elements.push_back({cell[0], cell[1], cell[2], cell[3]});
    }
    region.last_element = mesh.elements.size();
  }
  const CellTriangles& surface = block.skin.surface;
  for (std::size_t k = 0; k < surface.triangles.size(); ++k) {
    if (surface.parts[k] == CellTriangles::Part::box) continue;
    const Triangle& t = surface.triangles[k];
    faces_of(mesh.regions[surface.sides[k].behind], surface.parts[k]).push_back({t[0], t[1], t[2], t[2]});
  }
  return mesh;
}

std::vector<Message> complete(Mesh& mesh, const Block& block, int order) {
  const double scale = millimetres_per(block.units);
  const std::vector<SurfacePlace>& places = block.skin.nodes.places;
  for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
    const std::uint32_t body = block.of_regions[r];
    if (body == CellTriangles::matrix) continue;
    std::vector<double> known(mesh.nodes.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t k = 0; k < places.size(); ++k)
      if (places[k].body == body) known[k] = places[k].parameters.y();
    const std::vector<double> along =
        parameters_along(mesh, mesh.regions[r], block.bodies[body], known, scale);
    add_fibres(mesh, mesh.regions[r], block.bodies[body], along, scale);
  }
  if (order == 1) return {};
  const MidsideNodes nodes = add_midside_nodes(mesh, block);
  if (nodes.held == 0) return {};
  return {
      note(Kind::geometry,
           fmt::format("{} midside nodes were held back from the yarns' surfaces so that no element folds, "
                       "the farthest by {:.3g} mm",
                       nodes.held, nodes.farthest))};
}

Status check_elements(const Mesh& mesh, Unit units) {
  if (mesh.quality.min_scaled_jacobian > 0) return {};
  const Message message =
      error(Kind::geometry, "the mesh has an element with a negative Jacobian; try another --size");
  return mesh.worst.empty() ? message : message.at_point(mesh.worst.front().at / millimetres_per(units));
}

}  // namespace selvage::fem
