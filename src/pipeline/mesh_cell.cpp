#include "pipeline/meshing.h"

#include <fmt/format.h>

#include "cell_problem/cell_kind.h"
#include "fem/fibre.h"
#include "structured/voxel.h"
#include "tetrahedra/cell_mesher.h"

namespace selvage::pipeline {

namespace {

// Yarns are bonded where they are within this many times the gap that they keep.
constexpr double bond_reach = 1.5;

// Its load cases bend it.
bool is_bent(const Options& options, const ReadyCell& ready) {
  const std::optional<fem::CellKind> kind = fem::kind_of_cell(ready.periodic);
  return options.physics == fem::Physics::elastic && !options.pores &&
         (kind == fem::CellKind::beam || (kind == fem::CellKind::plate && options.matrix));
}

// Its stiffness is wanted: of a block, or of a beam or a plate.
bool is_strained(const Options& options, const ReadyCell& ready) {
  return is_bent(options, ready) ||
         (options.physics == fem::Physics::elastic && !options.pores && options.matrix &&
          fem::kind_of_cell(ready.periodic) == fem::CellKind::block);
}

// Of the elements.
int order_of(const Options& options, const ReadyCell& ready) {
  if (options.order > 0) return options.order;
  return options.joining != fem::Joining::cohesive && is_strained(options, ready) ? 2 : 1;
}

}  // namespace

std::optional<ReadyCell> prepare_cell(Job& job, fabric::Fabric& fabric, const fabric::YarnBuilder& builder) {
  const Options& options = job.options;
  if (options.periodic) snap_cell(job, fabric, builder);
  std::optional<std::vector<yarn::Body>> bodies = bodies_to_mesh(job, builder);
  if (!bodies) return std::nullopt;
  ReadyCell ready;
  ready.bodies = yarns_in_cell(job, fabric, std::move(*bodies));
  if (job.has_failed()) return std::nullopt;
  if (options.periodic) {
    const std::optional<std::array<bool, 3>> axes = periodic_axes(job, fabric, builder, ready.bodies);
    if (!axes) return std::nullopt;
    ready.periodic = *axes;
  }
  if (!check_free_faces(job, fabric, ready.bodies, ready.periodic)) return std::nullopt;
  if (options.voxels > 0) return ready;
  const std::optional<CellSize> size =
      check_cell_size(job, fabric, ready.bodies, order_of(options, ready), options.matrix);
  if (!size || !check_grazed_faces(job, fabric, ready.bodies) ||
      !check_cell_gaps(job, fabric, ready.bodies, job.gap))
    return std::nullopt;
  ready.size = *size;
  return ready;
}

namespace {

// What elements of order 1 cost. Bending is a quadratic displacement, which they follow by shearing.
void warn_of_stiff_elements(Job& job, const fabric::Fabric& fabric, const ReadyCell& ready) {
  if (!is_strained(job.options, ready)) return;
  const bool is_voxel = job.options.voxels > 0;
  if (!is_voxel && order_of(job.options, ready) == 2) return;
  const auto warn = [&](std::string text) {
    job.say(at_cell(fabric, warning(Kind::geometry, std::move(text))));
  };
  if (is_bent(job.options, ready)) {
    const char* what = fem::beam_axis(ready.periodic) ? "beam" : "plate";
    warn(is_voxel
             ? fmt::format("hexahedra of eight nodes make a {} too stiff in bending, the more the fewer "
                           "of them lie over its thickness: compare two of --voxel, or mesh it with "
                           "tetrahedra",
                           what)
             : fmt::format("tetrahedra of four nodes make a {0} too stiff in bending, by a fifth to a "
                           "third at usual sizes: --order 2, the default of {0}s, is right to a per cent",
                           what));
  } else if (!is_voxel) {
    warn(
        "tetrahedra of four nodes make a cell too stiff, by 2 to 5 % at usual sizes: --order 2, the default "
        "of cells "
        "with a matrix, is right to a few thousandths");
  }
}

// Elements of order 1 lock where the material keeps its volume.
void warn_of_locking(Job& job, const fabric::Fabric& fabric, const ReadyCell& ready, const fem::Mesh& mesh) {
  constexpr double locking = 0.49;  // Poisson's ratio
  if (job.options.voxels == 0 && order_of(job.options, ready) == 2) return;
  for (const fabric::Material& material : mesh.materials)
    if (const auto* same = std::get_if<fabric::IsotropicElastic>(&material.elastic);
        same != nullptr && same->poisson >= locking)
      job.say(warning(Kind::geometry,
                      fmt::format(
                          "material '{}' has nu = {:g}: {} lock from {:g} on and are far too stiff; mesh "
                          "the cell with tetrahedra of --order 2",
                          material.name, same->poisson,
                          job.options.voxels > 0 ? "hexahedra of eight nodes" : "tetrahedra of four nodes",
                          locking))
                  .placed(material.place, fabric.file));
}

Result<fem::Mesh> mesh_of(Job& job, const fabric::Fabric& fabric, const ReadyCell& ready,
                          Diagnostics& diagnostics) {
  const Options& given = job.options;
  if (given.voxels > 0)
    return fem::mesh_voxels(fabric, ready.bodies,
                            {.count = given.voxels,
                             .periodic = ready.periodic,
                             .matrix = given.matrix,
                             .physics = given.physics,
                             .threads = static_cast<int>(job.threads)},
                            diagnostics);
  fem::CellMeshOptions options{mesh_options(job)};
  options.sizes = ready.size.sizes;
  options.coarsest = ready.size.coarsest;
  options.growth = ready.size.growth;
  options.order = order_of(given, ready);
  options.joining = given.joining;
  options.matrix = given.matrix;
  options.pores = given.pores;
  options.layers = {given.layers, given.layer_thickness};
  if (given.bond) options.bond = bond_reach * job.gap;
  options.periodic = ready.periodic;
  options.physics = given.physics;
  options.tolerance = given.tolerance;
  return fem::mesh_cell(fabric, ready.bodies, options, diagnostics);
}

}  // namespace

MadeMesh mesh_of_cell(Job& job, const fabric::Fabric& fabric, const ReadyCell& ready,
                      Diagnostics& diagnostics) {
  warn_of_stiff_elements(job, fabric, ready);
  MadeMesh made{mesh_of(job, fabric, ready, diagnostics)};
  if (made.mesh) warn_of_locking(job, fabric, ready, *made.mesh);
  if (job.options.voxels == 0) made.estimate = ready.size.tetrahedra;
  if (made.mesh && job.options.chamis)
    if (Status derived = fem::derive_yarn_stiffness(*made.mesh, diagnostics); !derived)
      made.mesh = derived.error();
  return made;
}

Result<fem::Raster> raster_of_cell(Job& job, const fabric::Fabric& fabric, const ReadyCell& ready,
                                   Diagnostics& diagnostics) {
  return fem::rasterize(fabric, ready.bodies,
                        {.count = job.options.voxels,
                         .threads = static_cast<int>(job.threads),
                         .progress = job.progress_of("filling voxels")},
                        diagnostics);
}

}  // namespace selvage::pipeline
