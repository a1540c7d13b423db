#include "fem/cell_mesher.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/module.h"
#include "fem/bond.h"
#include "fem/cell_size.h"
#include "fem/fibre.h"
#include "fem/improve.h"
#include "fem/materials.h"
#include "fem/midside.h"
#include "fem/quality.h"
#include "fem/sides.h"
#include "fem/skin.h"
#include "fem/unit_cell.h"

namespace selvage::fem {

namespace {

constexpr double default_edges_per_extent = 4;

class CellMesher {
 public:
  CellMesher(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies, const CellMeshOptions& options,
             Diagnostics& diagnostics)
      : fabric_(fabric), bodies_(bodies), options_(options), diagnostics_(diagnostics) {}

  Result<Mesh> run();

 private:
  Status prepare();
  Status make_surfaces();
  Status fill_regions();
  void number_regions();
  [[nodiscard]] Mesh assemble() const;
  void add_directions(Mesh& mesh) const;
  Status finish(Mesh& mesh);
  [[nodiscard]] Message located(Message message) const;
  [[nodiscard]] std::string yarns_near(const Vec3& at) const;
  [[nodiscard]] double coarsest() const {
    return std::max(*std::max_element(sizes_.begin(), sizes_.end()), options_.coarsest);
  }
  void report(const Improvement& improvement);
  void bond();
  static void renew_side_faces(Mesh& mesh);
  void step(const char* name, std::size_t done) const {
    if (options_.progress) options_.progress(name, done, 5);
  }

  const fabric::Fabric& fabric_;
  std::span<const yarn::Body> bodies_;
  const CellMeshOptions& options_;
  Diagnostics& diagnostics_;
  double extent_ = 0, tolerance_ = 0;
  std::vector<double> sizes_;  // of each body
  Box3 box_;
  Skin skin_;
  std::vector<std::uint32_t> bodies_of_regions_;  // CellTriangles::matrix: the matrix
  TetMesh tets_;
  AngleTarget angles_;
};

Message CellMesher::located(Message message) const {
  if (message.file.empty()) message.file = fabric_.file;
  return message;
}

// The two yarns whose surfaces have corners nearest to a place, in words.
std::string CellMesher::yarns_near(const Vec3& at) const {
  std::vector<double> distances(bodies_.size(), std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < skin_.nodes.points.size(); ++k)
    if (const std::size_t body = skin_.nodes.places[k].body; body != no_body)
      distances[body] = std::min(distances[body], (skin_.nodes.points[k] - at).norm());
  std::vector<std::size_t> order(bodies_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return distances[a] < distances[b]; });
  if (order.empty() || !std::isfinite(distances[order[0]])) return "";
  if (order.size() < 2 || distances[order[1]] > 4 * sizes_[order[1]])
    return fmt::format(" (yarn '{}')", bodies_[order[0]].name);
  return fmt::format(" (yarns '{}' and '{}')", bodies_[order[0]].name, bodies_[order[1]].name);
}

Status CellMesher::prepare() {
  if (!fabric_.cell)
    return located(error(Kind::usage, "the file has no cell; say one with 'cell X Y Z  X Y Z'"));
  if (options_.order != 1 && options_.order != 2) return error(Kind::usage, "the order of a mesh is 1 or 2");
  for (const double size : options_.sizes)
    if (!(size > 0) || !std::isfinite(size))
      return error(Kind::usage, "the mesh size must be a positive number");
  if (!(options_.size >= 0) || !std::isfinite(options_.size))
    return error(Kind::usage, "the mesh size must be a positive number");
  if (!(options_.min_dihedral >= 0 && options_.min_dihedral <= 30))
    return error(Kind::usage, "the smallest dihedral angle wanted must be from 0 to 30 degrees");
  box_ = Box3(fabric_.cell->low, fabric_.cell->high);
  extent_ = std::numeric_limits<double>::infinity();
  for (const yarn::Body& body : bodies_) {
    if (yarn::bounds(body).intersects(box_)) extent_ = std::min(extent_, yarn::narrowest_section(body));
  }
  if (!std::isfinite(extent_)) return located(error(Kind::geometry, "no yarn enters the cell"));
  sizes_ = options_.sizes;
  sizes_.resize(bodies_.size(), options_.size > 0 ? options_.size : extent_ / default_edges_per_extent);
  tolerance_ = options_.tolerance > 0 ? options_.tolerance : 1e-3 * extent_;
  return {};
}

Status CellMesher::make_surfaces() {
  SkinOptions options;
  options.tolerance = tolerance_;
  options.miss = std::max(tolerance_, least_edge_share * extent_);
  options.periodic = options_.periodic;
  options.matrix = options_.matrix;
  options.threads = options_.threads;
  options.progress = [&, done = std::size_t{0}](const char* name) mutable { step(name, done++); };
  Result<Skin> skin =
      make_skin(bodies_, box_, cell_size_rules(bodies_, sizes_, options_.coarsest, extent_), options);
  if (!skin) {
    Message message = located(skin.error());
    if (message.place.line == 0) message.place = fabric_.cell->place;
    return message;
  }
  for (Message& note : skin->notes) diagnostics_.add(located(std::move(note)));
  skin_ = std::move(*skin);
  if (options_.order == 1)
    fem::keep_volumes(skin_.nodes.points, {.facets = facets_of(bodies_, skin_, options_.threads),
                                           .volumes = skin_.volumes,
                                           .leaders = skin_.leaders,
                                           .box = box_});
  return {};
}

// Regions are the bodies that are there, in their order, then the matrix.
void CellMesher::number_regions() {
  std::vector<std::uint32_t> there;
  for (const Sides& sides : skin_.surface.sides)
    for (const std::uint32_t body : {sides.behind, sides.front})
      if (body != Sides::outside) there.push_back(body);
  std::sort(there.begin(), there.end());
  there.erase(std::unique(there.begin(), there.end()), there.end());
  bodies_of_regions_ = there;
  const auto region_of = [&](std::uint32_t body) {
    if (body == Sides::outside) return body;
    return static_cast<std::uint32_t>(std::lower_bound(there.begin(), there.end(), body) - there.begin());
  };
  for (Sides& sides : skin_.surface.sides) sides = {region_of(sides.behind), region_of(sides.front)};
}

Status CellMesher::fill_regions() {
  const Result<std::filesystem::path> program = find_worker("selvage-tetgen");
  if (!program) return program.error();
  step("filling with tetrahedra", 2);
  TetgenJob job{
      .points = skin_.nodes.points, .triangles = skin_.surface.triangles, .sides = skin_.surface.sides};
  job.smallest_feature = *std::min_element(sizes_.begin(), sizes_.end());
  Result<TetMesh> tets = run_tetgen(*program, job, {.timeout = options_.timeout, .memory = options_.memory});
  if (!tets) {
    Message message = located(tets.error());
    if (message.at) message.text += yarns_near(*message.at);
    return message;
  }
  tets_ = std::move(*tets);
  step("improving tetrahedra", 3);
  ImproveOptions options;
  options.target = options_.min_dihedral;
  options.refine = {.max_volume = largest_volume(coarsest())};
  options.threads = options_.threads;
  report(improve(tets_.points, tets_.cells, tets_.regions, skin_.nodes.points.size(), options));
  return {};
}

void CellMesher::report(const Improvement& improvement) {
  angles_ = count(improvement, options_.min_dihedral);
  for (Message& message : describe(improvement, options_.min_dihedral, name_of(fabric_.units))) {
    message.text += yarns_near(*message.at);
    diagnostics_.add(located(std::move(message)));
  }
}

// What lies in narrow gaps goes over to the yarns; exact volumes follow.
void CellMesher::bond() {
  const auto matrix = static_cast<std::uint32_t>(bodies_of_regions_.size() - 1);
  if (!(options_.bond > 0) || bodies_of_regions_[matrix] != CellTriangles::matrix) return;
  std::vector<std::uint32_t> yarns(tets_.points.size(), no_yarn);
  for (std::size_t k = 0; k < skin_.nodes.places.size(); ++k)
    for (std::uint32_t r = 0; r < matrix; ++r)
      if (skin_.nodes.places[k].body == bodies_of_regions_[r]) yarns[k] = r;
  const std::vector<std::uint32_t> before = tets_.regions;
  const Bonding bonding =
      bond_contacts(tets_.points, tets_.cells, yarns, matrix, options_.bond, tets_.regions);
  for (std::size_t c = 0; c < before.size(); ++c) {
    if (before[c] == tets_.regions[c]) continue;
    const auto& cell = tets_.cells[c];
    const Vec3& p = tets_.points[cell[0]];
    skin_.volumes[bodies_of_regions_[tets_.regions[c]]] +=
        (tets_.points[cell[1]] - p).cross(tets_.points[cell[2]] - p).dot(tets_.points[cell[3]] - p) / 6;
  }
  const std::string_view unit = name_of(fabric_.units);
  Message note =
      warning(Kind::geometry,
              fmt::format("yarns within {:.3g} {} of each other are bonded: {} tetrahedra between them "
                          "({:.3g} {}3) became theirs, and they share {:.3g} {}2",
                          options_.bond, unit, bonding.cells, bonding.volume, unit, bonding.area, unit));
  note.severity = Severity::note;
  diagnostics_.add(located(std::move(note)));
}

// Where bonded yarns meet, their faces are no longer those of their surfaces.
void CellMesher::renew_side_faces(Mesh& mesh) {
  for (Region& region : mesh.regions) region.side_faces.clear();
  for (const OuterSide& side : outer_sides(mesh))
    if (side.behind != OuterSide::outside && mesh.regions[side.region].kind == Region::Kind::yarn)
      mesh.regions[side.region].side_faces.push_back({side.nodes[0], side.nodes[1], side.nodes[2]});
}

// Corner nodes in mm, elements region by region.
Mesh CellMesher::assemble() const {
  Mesh mesh;
  const double scale = millimetres_per(fabric_.units);
  mesh.title = fabric_.title.value_or("");
  mesh.nodes.reserve(tets_.points.size());
  for (const Vec3& point : tets_.points) mesh.nodes.emplace_back(point * scale);
  std::vector<std::size_t> order(tets_.cells.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return tets_.regions[a] < tets_.regions[b]; });
  mesh.regions.resize(bodies_of_regions_.size());
  for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
    Region& region = mesh.regions[r];
    const std::uint32_t body = bodies_of_regions_[r];
    region.kind = body == CellTriangles::matrix ? Region::Kind::matrix : Region::Kind::yarn;
    region.name = region.kind == Region::Kind::matrix ? "matrix" : bodies_[body].name;
    region.first_element = mesh.elements.size();
    for (; mesh.elements.size() < order.size() && tets_.regions[order[mesh.elements.size()]] == r;) {
      const auto& cell = tets_.cells[order[mesh.elements.size()]];
      mesh.elements.push_back({cell[0], cell[1], cell[2], cell[3]});
    }
    region.last_element = mesh.elements.size();
  }
  for (std::size_t k = 0; k < skin_.surface.triangles.size(); ++k) {
    const Triangle& t = skin_.surface.triangles[k];
    if (skin_.surface.parts[k] == CellTriangles::Part::box) continue;
    Region& region = mesh.regions[skin_.surface.sides[k].behind];
    faces_of(region, skin_.surface.parts[k]).push_back({t[0], t[1], t[2]});
  }
  return mesh;
}

// Fibres of the yarns' elements, by where the nodes on their surfaces stand.
void CellMesher::add_directions(Mesh& mesh) const {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double unit = millimetres_per(fabric_.units);
  for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
    const std::uint32_t body = bodies_of_regions_[r];
    if (body == CellTriangles::matrix) continue;
    std::vector<double> known(mesh.nodes.size(), nan);
    for (std::size_t k = 0; k < skin_.nodes.places.size(); ++k)
      if (skin_.nodes.places[k].body == body) known[k] = skin_.nodes.places[k].parameters.y();
    const std::vector<double> along = parameters_along(mesh, mesh.regions[r], bodies_[body], known, unit);
    add_fibres(mesh, mesh.regions[r], bodies_[body], along);
  }
}

Status CellMesher::finish(Mesh& mesh) {
  const double scale = millimetres_per(fabric_.units), cube = scale * scale * scale;
  double rest = box_.volume();
  for (const double volume : skin_.volumes) rest -= volume;
  for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
    const std::uint32_t body = bodies_of_regions_[r];
    mesh.regions[r].exact_volume = cube * (body == CellTriangles::matrix ? rest : skin_.volumes[body]);
  }
  MaterialChoice choice = choose_materials(fabric_, bodies_, diagnostics_);
  if (options_.matrix)
    if (Status added = add_matrix_material(fabric_, choice, diagnostics_); !added) return added;
  for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
    const std::uint32_t body = bodies_of_regions_[r];
    mesh.regions[r].material = body == CellTriangles::matrix ? fabric_.cell->matrix : choice.of_body[body];
  }
  mesh.materials = std::move(choice.materials);

  step("finishing", 4);
  add_directions(mesh);
  const Box3 box_mm(box_.min() * scale, box_.max() * scale);
  if (options_.order == 2) {
    const MidsideNodes midside =
        add_midside_nodes(mesh, {bodies_, skin_.nodes.places, scale, box_mm, options_.periodic,
                                 skin_.surface.caps, skin_.surface.triangles});
    if (midside.held > 0) diagnostics_.add(located(told_of(midside, 1)));
  }
  if (Status complete = complete_cell(mesh, box_mm, options_.periodic); !complete)
    return located(complete.error());
  measure(mesh);
  mesh.angles = angles_;
  if (!(mesh.quality.min_scaled_jacobian > 0)) {
    Message message =
        error(Kind::geometry, "the mesh has an element with a negative Jacobian; try another --size");
    if (!mesh.worst.empty()) message.at = mesh.worst.front().at / scale;
    return located(std::move(message));
  }
  return {};
}

Result<Mesh> CellMesher::run() {
  if (Status ready = prepare(); !ready) return ready.error();
  if (Status made = make_surfaces(); !made) return made.error();
  number_regions();
  if (Status filled = fill_regions(); !filled) return filled.error();
  bond();
  Mesh mesh = assemble();
  if (options_.bond > 0) renew_side_faces(mesh);
  if (Status finished = finish(mesh); !finished) return finished.error();
  step("finishing", 5);
  return mesh;
}

}  // namespace

Result<Mesh> mesh_cell(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                       const CellMeshOptions& options, Diagnostics& diagnostics) {
  return CellMesher(fabric, bodies, options, diagnostics).run();
}

}  // namespace selvage::fem
