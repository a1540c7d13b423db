#include "tetrahedra/cell_mesher.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "cell_problem/bond.h"
#include "cell_problem/complete_cell.h"
#include "cell_problem/pores.h"
#include "core/module.h"
#include "fem/cell_sides.h"
#include "fem/cohesive_law.h"
#include "fem/materials.h"
#include "fem/quality.h"
#include "fem/sides.h"
#include "surface_mesh/cell_size.h"

namespace selvage::fem {

namespace {

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
  static void count_below(Mesh& mesh);
  Status finish(Mesh& mesh);
  [[nodiscard]] Message located(const Message& message) const { return message.placed({}, fabric_.file); }
  [[nodiscard]] std::string yarns_near(const Vec3& at) const;
  [[nodiscard]] double coarsest() const {
    return std::max(*std::max_element(sizes_.begin(), sizes_.end()), options_.coarsest);
  }
  void bond();
  Status check_joining(Mesh& mesh) const;
  static void renew_side_faces(Mesh& mesh);
  void step(const char* name, std::size_t done) const {
    if (options_.progress) options_.progress(name, done, 5);
  }

  const fabric::Fabric& fabric_;
  std::span<const yarn::Body> bodies_;
  const CellMeshOptions& options_;
  Diagnostics& diagnostics_;
  double extent_ = 0, tolerance_ = 0;
  MaterialChoice materials_;
  std::vector<double> sizes_;  // of each body
  Parallelepiped cell_;
  std::optional<Block> block_;
  TetMesh tets_;
  AngleTarget angles_;
};

// The two yarns whose surfaces have corners nearest to a place, in words.
std::string CellMesher::yarns_near(const Vec3& at) const {
  std::vector<double> distances(bodies_.size(), std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < block_->skin.nodes.points.size(); ++k)
    if (const std::size_t body = block_->skin.nodes.places[k].body; body != no_body)
      distances[body] = std::min(distances[body], (block_->skin.nodes.points[k] - at).norm());
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
  if (Status right = check_options(options_); !right) return right;
  for (const double size : options_.sizes)
    if (!(size > 0) || !std::isfinite(size))
      return error(Kind::usage, "the mesh size must be a positive number");
  cell_ = fabric_.cell->shape();
  extent_ = std::numeric_limits<double>::infinity();
  for (const yarn::Body& body : bodies_) {
    if (yarn::bounds(body).intersects(cell_.bounds()))
      extent_ = std::min(extent_, yarn::narrowest_section(body));
  }
  if (!std::isfinite(extent_)) return located(error(Kind::geometry, "no yarn enters the cell"));
  sizes_ = options_.sizes;
  sizes_.resize(bodies_.size(), options_.size > 0 ? options_.size : extent_ / default_edges_per_extent);
  tolerance_ = options_.tolerance > 0 ? options_.tolerance : 1e-3 * extent_;
  if (options_.pores) return {};
  Result<MaterialChoice> choice =
      choose_cell_materials(fabric_, bodies_, options_.matrix, options_.physics, diagnostics_);
  if (!choice) return choice.error();
  materials_ = std::move(*choice);
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
  Result<Skin> skin = make_skin(
      bodies_, cell_, cell_size_rules(bodies_, sizes_, options_.coarsest, options_.growth, extent_), options);
  if (!skin) return skin.error().placed(fabric_.cell->place, fabric_.file);
  for (Message& note : skin->notes) diagnostics_.add(located(note));
  if (options_.order == 1)
    fem::keep_volumes(skin->nodes.points, {.facets = facets_of(bodies_, *skin, options_.threads),
                                           .volumes = skin->volumes,
                                           .leaders = skin->leaders,
                                           .cell = cell_});
  block_.emplace(bodies_, fabric_.units, cell_, options_.periodic, std::move(*skin));
  return {};
}

Status CellMesher::fill_regions() {
  const Result<std::filesystem::path> program = find_worker("selvage-tetgen");
  if (!program) return program.error();
  step("filling with tetrahedra", 2);
  const double smallest = *std::min_element(sizes_.begin(), sizes_.end());
  Result<TetMesh> tets = fill(*block_, {}, smallest, options_, *program);
  if (!tets) {
    Message message = located(tets.error());
    if (message.at) message.text += yarns_near(*message.at);
    return message;
  }
  tets_ = std::move(*tets);
  step("improving tetrahedra", 3);
  Improved improved = improve(tets_, *block_, coarsest(), options_);
  angles_ = improved.angles;
  for (Message& note : improved.notes) {
    note.text += yarns_near(*note.at);
    diagnostics_.add(located(note));
  }
  return {};
}

// What lies in narrow gaps goes over to the yarns; exact volumes follow.
void CellMesher::bond() {
  const auto matrix = static_cast<std::uint32_t>(block_->of_regions.size() - 1);
  if (!(options_.bond > 0) || block_->of_regions[matrix] != CellTriangles::matrix) return;
  std::vector<std::uint32_t> yarns(tets_.points.size(), no_yarn);
  for (std::size_t k = 0; k < block_->skin.nodes.places.size(); ++k)
    for (std::uint32_t r = 0; r < matrix; ++r)
      if (block_->skin.nodes.places[k].body == block_->of_regions[r]) yarns[k] = r;
  const std::vector<std::uint32_t> before = tets_.regions;
  const Bonding bonding =
      bond_contacts(tets_.points, tets_.cells, yarns, matrix, options_.bond, tets_.regions);
  for (std::size_t c = 0; c < before.size(); ++c) {
    if (before[c] == tets_.regions[c]) continue;
    block_->skin.volumes[block_->of_regions[tets_.regions[c]]] +=
        six_volumes(tets_.points, tets_.cells[c]) / 6;
  }
  const std::string_view unit = name_of(fabric_.units);
  diagnostics_.add(located(
      note(Kind::geometry,
           fmt::format("yarns within {:.3g} {} of each other are bonded: {} tetrahedra between them "
                       "({:.3g} {}3) became theirs, and they share {:.3g} {}2",
                       options_.bond, unit, bonding.cells, bonding.volume, unit, bonding.area, unit))));
}

// Where bonded yarns meet, their faces are no longer those of their surfaces.
void CellMesher::renew_side_faces(Mesh& mesh) {
  for (Region& region : mesh.regions) region.side_faces.clear();
  for (const OuterSide& side : outer_sides(mesh))
    if (side.behind != OuterSide::outside && mesh.regions[side.region].kind == Region::Kind::yarn)
      mesh.regions[side.region].side_faces.push_back(side.nodes);
}

// Laws of cohesive interfaces. That nothing holds bonded yarns together was not meant.
Status CellMesher::check_joining(Mesh& mesh) const {
  if (mesh.joining != Joining::cohesive) return {};
  const auto is_of_yarns = [&](const Interface& interface) {
    return mesh.regions[interface.second].kind == Region::Kind::yarn;
  };
  if (options_.bond > 0 && std::none_of(mesh.interfaces.begin(), mesh.interfaces.end(), is_of_yarns))
    return located(error(
        Kind::geometry,
        fmt::format("no yarns are bonded, so that nothing is cohesive between them: all keep a gap of more "
                    "than {:.3g} {}, which is matrix. A larger --gap reaches farther; or leave out --bond, "
                    "and yarns hold on to the matrix alone",
                    options_.bond, name_of(fabric_.units))));
  if (Status right = choose_cohesive_laws(mesh); !right)
    return right.error().placed(right.error().place, fabric_.file);
  return {};
}

// Layers have changed tetrahedra since it was counted.
void CellMesher::count_below(Mesh& mesh) {
  mesh.angles->below = 0;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    mesh.angles->below += shape_of(mesh, e).min_dihedral < mesh.angles->wanted ? 1 : 0;
}

Status CellMesher::finish(Mesh& mesh) {
  const double scale = millimetres_per(fabric_.units), cube = scale * scale * scale;
  const std::vector<double>& volumes = block_->skin.volumes;
  double rest = cell_.volume();
  for (const double volume : volumes) rest -= volume;
  for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
    const std::uint32_t body = block_->of_regions[r];
    mesh.regions[r].exact_volume = cube * (body == CellTriangles::matrix ? rest : volumes[body]);
  }
  for (std::size_t r = 0; r < mesh.regions.size() && !options_.pores; ++r) {
    const std::uint32_t body = block_->of_regions[r];
    mesh.regions[r].material =
        body == CellTriangles::matrix ? fabric_.cell->matrix : materials_.of_body[body];
  }
  mesh.materials = std::move(materials_.materials);
  mesh.physics = options_.physics;
  mesh.joining = options_.joining;

  step("finishing", 4);
  for (Message& note : complete(mesh, *block_, options_.order)) diagnostics_.add(located(note));
  if (options_.pores)
    if (Status kept = keep_pores(mesh); !kept) return located(kept.error());
  const Parallelepiped cell_mm(Box3(cell_.box.min() * scale, cell_.box.max() * scale), cell_.axes);
  if (Status complete = complete_cell(mesh, cell_mm, options_.periodic); !complete)
    return located(complete.error());
  if (options_.pores) add_face_patches(mesh);
  if (options_.layers.count > 0)
    if (Status added = add_layers(mesh, {options_.layers.count, scale * options_.layers.thickness}); !added)
      return located(added.error());
  if (Status joined = check_joining(mesh); !joined) return joined;
  measure(mesh);
  mesh.angles = angles_;
  if (options_.layers.count > 0) count_below(mesh);
  if (Status sound = check_elements(mesh, fabric_.units); !sound) return located(sound.error());
  return {};
}

Result<Mesh> CellMesher::run() {
  if (Status ready = prepare(); !ready) return ready.error();
  if (Status made = make_surfaces(); !made) return made.error();
  if (Status filled = fill_regions(); !filled) return filled.error();
  bond();
  Mesh mesh = assemble(*block_, tets_);
  mesh.title = fabric_.title.value_or("");
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
