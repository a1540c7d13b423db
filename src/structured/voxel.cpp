#include "structured/voxel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "cell/volume.h"
#include "cell_problem/complete_cell.h"
#include "core/units.h"
#include "fem/fibre.h"
#include "fem/materials.h"
#include "structured/voxel_grid.h"
#include "structured/yarn_columns.h"
#include "surface_mesh/cell_size.h"
#include "yarn/in_axes.h"

namespace selvage::fem {
namespace {

constexpr double most_hexahedra = 2e7;
constexpr std::int32_t no_yarn = -1;
constexpr double usual_error = 0.05;  // of the yarns' volume, relative

// Whose each voxel is, and where along that yarn about.
struct Owners {
  std::vector<std::int32_t> yarn;
  std::vector<double> v;
  std::size_t in_two = 0;
};

double distance_from_axis(const yarn::Body& body, const Vec3& point, double v, const ObliqueAxes& axes) {
  return axes.place(nurbs::evaluate(body.axis, v) - point).norm();
}

// Grid and bodies in the same coordinates, those of the axes.
Owners find_owners(const VoxelGrid& grid, std::span<const yarn::Body> bodies, const ObliqueAxes& axes) {
  Owners owners;
  owners.yarn.assign(grid.voxels(), no_yarn);
  owners.v.assign(grid.voxels(), std::numeric_limits<double>::quiet_NaN());
  const std::vector<double> xs = grid.middles(0), ys = grid.middles(1), zs = grid.middles(2);
  const double edge = grid.sides().x() / 2;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const yarn::Body& body = bodies[b];
    const Box3 box = yarn::bounds(body);
    if (box.max().x() < xs.front() || box.min().x() > xs.back() || box.max().y() < ys.front() ||
        box.min().y() > ys.back() || box.max().z() < zs.front() || box.min().z() > zs.back())
      continue;
    const auto columns = cross_yarn(body, xs, ys, edge);
    const double range = body.surface.last_v() - body.surface.first_v();
    for (std::size_t c = 0; c < columns.size(); ++c)
      for (std::size_t k = 0; k + 1 < columns[c].size(); k += 2) {
        const Crossing &in = columns[c][k], &out = columns[c][k + 1];
        const auto first = std::lower_bound(zs.begin(), zs.end(), in.z);
        for (auto z = first; z != zs.end() && *z < out.z; ++z) {
          const double share = (*z - in.z) / (out.z - in.z);
          double v = in.v + share * (out.v - in.v);
          if (body.closed_along && std::abs(out.v - in.v) > range / 2) v = share < 0.5 ? in.v : out.v;
          const std::size_t voxel = static_cast<std::size_t>(z - zs.begin()) * columns.size() + c;
          const std::int32_t before = owners.yarn[voxel];
          if (before != no_yarn) {
            ++owners.in_two;
            const Vec3 point(xs[c % xs.size()], ys[c / xs.size()], *z);
            if (distance_from_axis(bodies[static_cast<std::size_t>(before)], point, owners.v[voxel], axes) <=
                distance_from_axis(body, point, v, axes))
              continue;
          }
          owners.yarn[voxel] = static_cast<std::int32_t>(b);
          owners.v[voxel] = v;
        }
      }
  }
  return owners;
}

// Nodes are made in the order of the grid, those that a hexahedron needs.
class Builder {
 public:
  Builder(const VoxelGrid& grid, const ObliqueAxes& axes, double unit, Mesh& mesh)
      : grid_(grid),
        axes_(axes),
        unit_(unit),
        mesh_(mesh),
        nodes_((grid.count(0) + 1) * (grid.count(1) + 1) * (grid.count(2) + 1), no_node) {}

  void need(std::size_t voxel) {
    for (const std::size_t place : corners(voxel)) nodes_[place] = 0;
  }
  void number_nodes() {
    std::size_t place = 0;
    for (const double z : grid_.planes[2])
      for (const double y : grid_.planes[1])
        for (const double x : grid_.planes[0]) {
          if (nodes_[place] != no_node) {
            nodes_[place] = mesh_.nodes.size();
            mesh_.nodes.push_back(axes_.place({x * unit_, y * unit_, z * unit_}));
          }
          ++place;
        }
  }
  void add(std::size_t voxel) {
    std::array<std::size_t, 10> element{};
    const auto places = corners(voxel);
    for (std::size_t k = 0; k < 8; ++k) element[k] = nodes_[places[k]];
    mesh_.elements.push_back(element);
  }

 private:
  [[nodiscard]] std::array<std::size_t, 8> corners(std::size_t voxel) const {
    const std::size_t nx = grid_.count(0), ny = grid_.count(1);
    const std::size_t i = voxel % nx, j = voxel / nx % ny, k = voxel / (nx * ny);
    const std::size_t row = nx + 1, layer = row * (ny + 1);
    const std::size_t first = k * layer + j * row + i;
    return {first,         first + 1,         first + row + 1,         first + row,
            first + layer, first + layer + 1, first + layer + row + 1, first + layer + row};
  }

  const VoxelGrid& grid_;
  const ObliqueAxes& axes_;
  double unit_;
  Mesh& mesh_;
  std::vector<std::size_t> nodes_;
};

// The hexahedra of one region one after the other.
void add_region(Mesh& mesh, Builder& builder, Region region, const std::vector<std::size_t>& voxels) {
  region.first_element = mesh.elements.size();
  for (const std::size_t voxel : voxels) builder.add(voxel);
  region.last_element = mesh.elements.size();
  mesh.regions.push_back(std::move(region));
}

void fill_regions(Mesh& mesh, const VoxelGrid& grid, const ObliqueAxes& axes, const Owners& owners,
                  std::span<const yarn::Body> bodies, const MaterialChoice& choice, const std::string& matrix,
                  double unit) {
  std::vector<std::vector<std::size_t>> of_yarn(bodies.size());
  std::vector<std::size_t> of_matrix;
  Builder builder(grid, axes, unit, mesh);
  for (std::size_t voxel = 0; voxel < owners.yarn.size(); ++voxel) {
    const std::int32_t owner = owners.yarn[voxel];
    if (owner == no_yarn && matrix.empty()) continue;
    (owner == no_yarn ? of_matrix : of_yarn[static_cast<std::size_t>(owner)]).push_back(voxel);
    builder.need(voxel);
  }
  builder.number_nodes();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (of_yarn[b].empty()) continue;
    Region region;
    region.name = bodies[b].name;
    region.material = choice.of_body[b];
    add_region(mesh, builder, std::move(region), of_yarn[b]);
  }
  if (!matrix.empty() && !of_matrix.empty()) {
    Region region;
    region.kind = Region::Kind::matrix;
    region.name = "matrix";
    region.material = matrix;
    add_region(mesh, builder, std::move(region), of_matrix);
  }
  std::size_t next = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (of_yarn[b].empty()) continue;
    const Region& region = mesh.regions[next++];
    std::vector<double> parameters;
    for (const std::size_t voxel : of_yarn[b]) parameters.push_back(owners.v[voxel]);
    settle_parameters(mesh, region, bodies[b], parameters, unit);
    add_fibres(mesh, region, bodies[b], parameters, unit);
  }
}

// Every hexahedron is the same parallelepiped: all figures of quality are known.
void fill_quality(Mesh& mesh, const VoxelGrid& grid, const ObliqueAxes& axes, double unit) {
  const Vec3 sides = grid.sides();
  const double share = axes.are_of_space() ? 1 : axes.to_space().determinant();  // of the cuboid's volume
  double largest = 90;  // dihedral angle; the smallest one is beside it
  for (int axis = 0; axis < 3; ++axis) {
    const double cosine = std::abs(axes.normal(axis).dot(axes.normal((axis + 1) % 3)));
    largest = std::max(largest, 180 - std::acos(std::min(1.0, cosine)) * 180 / std::numbers::pi);
  }
  mesh.quality = {.min_dihedral = 180 - largest,
                  .max_dihedral = largest,
                  .max_aspect = sides.maxCoeff() / sides.minCoeff(),
                  .min_scaled_jacobian = share,
                  .mean_scaled_jacobian = share};
  for (Region& region : mesh.regions) {
    region.quality = mesh.quality;
    region.volume =
        share * static_cast<double>(region.last_element - region.first_element) * (unit * sides).prod();
  }
}

// How much of each yarn is in the box, file units cubed of the axes; nothing where it cannot be told (yarns
// that overlap in its faces).
std::vector<double> exact_volumes(std::span<const yarn::Body> bodies, const Box3& box) {
  const Result<cell::Cut> cut = cell::cut(bodies, box, 1e-3 * yarn::narrowest_section(bodies));
  if (!cut) return {};
  const Result<cell::Division> division = cell::divide_faces(bodies, box, *cut);
  if (!division) return {};
  return cell::volumes_inside(bodies, box, *cut, *division);
}

// File units cubed of the axes, as above.
double filled_volume(const VoxelGrid& grid, const Owners& owners) {
  const auto empty = std::count(owners.yarn.begin(), owners.yarn.end(), no_yarn);
  return grid.sides().prod() * static_cast<double>(owners.yarn.size() - static_cast<std::size_t>(empty));
}

// A count of voxels that fills the cell as the yarns do, found by doubling; with what it fills.
struct EnoughVoxels {
  int count = 0;
  double volume = 0;
};

std::optional<EnoughVoxels> find_enough_voxels(std::span<const yarn::Body> bodies, const Box3& box,
                                               const ObliqueAxes& axes, int count, double wanted) {
  for (count *= 2;; count *= 2) {
    const Result<VoxelGrid> grid = make_grid(box, count, most_hexahedra, "hexahedra");
    if (!grid) return std::nullopt;
    const double volume = filled_volume(*grid, find_owners(*grid, bodies, axes));
    if (std::abs(volume - wanted) <= usual_error * wanted) return EnoughVoxels{count, volume};
  }
}

std::optional<Message> too_few_voxels(std::span<const yarn::Body> bodies, const Box3& box,
                                      const ObliqueAxes& axes, int count, double filled,
                                      std::span<const double> volumes) {
  const double wanted = std::accumulate(volumes.begin(), volumes.end(), 0.0);
  if (volumes.empty() || std::abs(filled - wanted) <= usual_error * wanted) return std::nullopt;
  const double percent = 100 / box.volume();
  std::string text = fmt::format(
      "yarns fill {:.1f} % of the cell, and {:.1f} % of its voxels, which are too coarse: ", percent * wanted,
      percent * filled);
  const auto enough = find_enough_voxels(bodies, box, axes, count, wanted);
  text += enough ? fmt::format("--voxel {} fills {:.1f} %", enough->count, percent * enough->volume)
                 : "tetrahedra follow the yarns (without --voxel)";
  return warning(Kind::geometry, std::move(text));
}

// Yarns without a voxel though they are as large as one.
std::optional<Message> lost_yarns(std::span<const yarn::Body> bodies, const Box3& box, const Owners& owners,
                                  std::span<const double> volumes, double voxel) {
  std::vector<bool> has_voxel(bodies.size(), false);
  for (const std::int32_t yarn : owners.yarn)
    if (yarn != no_yarn) has_voxel[static_cast<std::size_t>(yarn)] = true;
  const yarn::Body* first = nullptr;
  std::size_t others = 0;
  double thinnest = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; b < volumes.size(); ++b) {
    if (has_voxel[b] || volumes[b] < voxel) continue;
    thinnest = std::min(thinnest, yarn::narrowest_section(bodies[b]));
    if (first == nullptr)
      first = &bodies[b];
    else
      ++others;
  }
  if (first == nullptr) return std::nullopt;
  constexpr double least = 2;  // voxels over a section
  return warning(Kind::geometry,
                 fmt::format("no voxel has its middle in yarn '{}'{}: --voxel {} or more", first->name,
                             others > 0 ? fmt::format(", nor in {} more", others) : std::string(),
                             std::ceil(least * box.sizes().maxCoeff() / thinnest)));
}

void fill_exact_volumes(Mesh& mesh, std::span<const yarn::Body> bodies, std::span<const double> volumes,
                        const Box3& box, const ObliqueAxes& axes, double unit) {
  if (volumes.empty()) return;
  const double cube = unit * unit * unit * (axes.are_of_space() ? 1 : axes.to_space().determinant());
  const double rest = box.volume() - std::accumulate(volumes.begin(), volumes.end(), 0.0);
  for (Region& region : mesh.regions) {
    const auto body = std::find_if(bodies.begin(), bodies.end(),
                                   [&](const yarn::Body& one) { return one.name == region.name; });
    region.exact_volume = cube * (region.kind == Region::Kind::matrix
                                      ? rest
                                      : volumes[static_cast<std::size_t>(body - bodies.begin())]);
  }
}

void say_overlaps(const Owners& owners, Diagnostics& diagnostics) {
  if (owners.in_two == 0) return;
  diagnostics.add(note(Kind::geometry, fmt::format("{} hexahedra lie in two yarns that overlap; each went to "
                                                   "the nearer centre line",
                                                   owners.in_two)));
}

}  // namespace

Result<Mesh> mesh_voxels(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                         const VoxelOptions& options, Diagnostics& diagnostics) {
  if (!fabric.cell) return error(Kind::geometry, "the file says no `cell` to mesh");
  const fabric::Cell& cell = *fabric.cell;
  const Box3 box(cell.low, cell.high);
  const auto at_cell = [&](const Message& message) { return message.placed(cell.place, fabric.file); };
  const Result<VoxelGrid> grid = make_grid(box, options.count, most_hexahedra, "hexahedra");
  if (!grid) return grid.error();
  Result<MaterialChoice> choice =
      choose_cell_materials(fabric, bodies, options.matrix, options.physics, diagnostics);
  if (!choice) return choice.error();
  const yarn::BodiesInAxes own(bodies, cell.axes);
  const Owners owners = find_owners(*grid, own.list(), cell.axes);
  if (std::all_of(owners.yarn.begin(), owners.yarn.end(), [](std::int32_t yarn) { return yarn == no_yarn; }))
    return at_cell(error(Kind::geometry, "no yarn enters the cell, or none is as thick as a hexahedron"));
  const std::vector<double> volumes = exact_volumes(own.list(), box);
  say_overlaps(owners, diagnostics);
  if (const auto coarse =
          too_few_voxels(own.list(), box, cell.axes, options.count, filled_volume(*grid, owners), volumes))
    diagnostics.add(at_cell(*coarse));
  if (const auto lost = lost_yarns(own.list(), box, owners, volumes, grid->sides().prod()))
    diagnostics.add(at_cell(*lost));

  const double unit = millimetres_per(fabric.units);
  Mesh mesh;
  mesh.shape = Mesh::Shape::hexahedron;
  mesh.title = fabric.title.value_or("");
  fill_regions(mesh, *grid, cell.axes, owners, bodies, *choice, options.matrix ? cell.matrix : "", unit);
  mesh.materials = std::move(choice->materials);
  mesh.physics = options.physics;
  fill_quality(mesh, *grid, cell.axes, unit);
  fill_exact_volumes(mesh, bodies, volumes, box, cell.axes, unit);
  if (Status done =
          complete_cell(mesh, {Box3(box.min() * unit, box.max() * unit), cell.axes}, options.periodic);
      !done)
    return at_cell(done.error());
  return mesh;
}

}  // namespace selvage::fem
