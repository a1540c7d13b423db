#include "cell_problem/periodicity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>

#include "cell_problem/cell_kind.h"
#include "cell_problem/supports.h"

namespace selvage::fem {
namespace {

constexpr double unit_strain = 0.001;  // and 1/mm
constexpr double unit_gradient = 1;    // a mm

// The displacement, or the potential, of a place (from the cell's middle) that each driver makes: column d is
// driver d's.
using Modes = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 6>;

Modes block_modes(const Vec3& p) {
  Modes modes = Modes::Zero(3, 6);
  modes.col(0) = Vec3(p.x(), 0, 0);
  modes.col(1) = Vec3(0, p.y(), 0);
  modes.col(2) = Vec3(0, 0, p.z());
  modes.col(3) = Vec3(p.y(), p.x(), 0) / 2;
  modes.col(4) = Vec3(p.z(), 0, p.x()) / 2;
  modes.col(5) = Vec3(0, p.z(), p.y()) / 2;
  return modes;
}

Modes plate_modes(const Vec3& p) {
  Modes modes = Modes::Zero(3, 6);
  modes.col(0) = Vec3(p.x(), 0, 0);
  modes.col(1) = Vec3(0, p.y(), 0);
  modes.col(2) = Vec3(p.y(), p.x(), 0) / 2;
  modes.col(3) = Vec3(p.z() * p.x(), 0, -p.x() * p.x() / 2);
  modes.col(4) = Vec3(0, p.z() * p.y(), -p.y() * p.y() / 2);
  modes.col(5) = Vec3(p.z() * p.y(), p.z() * p.x(), -p.x() * p.y()) / 2;
  return modes;
}

// Of a beam along `a`: stretch, twist, and the bendings in which the strain along it grows with each of the
// other axes, in their order.
Modes beam_modes(const Vec3& p, int a) {
  Modes modes = Modes::Zero(3, 4);
  const Vec3 axis = Vec3::Unit(a);
  modes.col(0) = p[a] * axis;
  modes.col(1) = p[a] * axis.cross(p);
  Eigen::Index column = 2;
  for (int b = 0; b < 3; ++b)
    if (b != a) modes.col(column++) = p[b] * p[a] * axis - p[a] * p[a] / 2 * Vec3::Unit(b);
  return modes;
}

// What drives a cell: drivers with their load cases, and what each of them makes.
struct Drive {
  std::vector<std::string> drivers, cases;
  double value = 0;  // of the driver in its load case
  bool is_heated = false;
  std::function<Modes(const Vec3&)> modes;
};

Drive drive_of_beam(int axis) {
  Drive drive{{},
              {fmt::format("stretch {}", "xyz"[axis]), fmt::format("twist {}", "xyz"[axis])},
              unit_strain,
              true,
              [axis](const Vec3& p) { return beam_modes(p, axis); }};
  for (int across = 0; across < 3; ++across)
    if (across != axis) drive.cases.push_back(fmt::format("bending {}{}", "xyz"[axis], "xyz"[across]));
  for (std::size_t d = 0; d < drive.cases.size(); ++d)
    drive.drivers.push_back(fmt::format("BeamDriver{}", d));
  return drive;
}

Drive drive_by_gradients(Eigen::Index axes) {
  Drive drive{
      {}, {}, unit_gradient, false, [axes](const Vec3& p) { return Modes(p.head(axes).transpose()); }};
  for (Eigen::Index axis = 0; axis < axes; ++axis) {
    drive.drivers.push_back(fmt::format("GradientDriver{}", axis));
    drive.cases.push_back(fmt::format("gradient {}", "xyz"[axis]));
  }
  return drive;
}

Drive drive_of(Physics physics, const std::array<bool, 3>& periodic) {
  const bool plate = kind_of_cell(periodic) == CellKind::plate;
  if (physics != Physics::elastic) return drive_by_gradients(plate ? 2 : 3);
  if (const std::optional<int> beam = beam_axis(periodic)) return drive_of_beam(*beam);
  if (plate)
    return {{"ConstraintsDriver0", "ConstraintsDriver1", "ConstraintsDriver3", "CurvatureDriver0",
             "CurvatureDriver1", "CurvatureDriver2"},
            {"strain xx", "strain yy", "strain xy", "curvature xx", "curvature yy", "curvature xy"},
            unit_strain,
            true,
            plate_modes};
  return {{"ConstraintsDriver0", "ConstraintsDriver1", "ConstraintsDriver2", "ConstraintsDriver3",
           "ConstraintsDriver4", "ConstraintsDriver5"},
          {"strain xx", "strain yy", "strain zz", "strain xy", "strain xz", "strain yz"},
          unit_strain,
          true,
          block_modes};
}

// A place from the middle of the cell; on the faces of a box half its sides to the bit.
Vec3 from_middle(const Parallelepiped& cell, const Vec3& at) {
  const Vec3 half = cell.box.sizes() / 2;
  Vec3 p = cell.axes.own(at) - (cell.box.max() + cell.box.min()) / 2;
  for (int axis = 0; axis < 3; ++axis)
    if (const int side = cell.side_of(at, axis); side != 0) p[axis] = side * half[axis];
  return cell.axes.place(p);
}

void add_drivers(Mesh& mesh, const std::vector<std::string>& names) {
  const Box3 bounds = mesh.cell->shape().bounds();
  for (std::size_t d = 0; d < names.size(); ++d)
    mesh.drivers.push_back(
        {.name = names[d],
         .at = bounds.max() + bounds.sizes().x() * (0.1 + 0.05 * static_cast<double>(d)) * Vec3::UnitX()});
}

// The unknowns of `node` (less that of `lowest`, where it is another one) = what the drivers make of the way
// between.
void add_equations(Mesh& mesh, std::size_t node, std::size_t lowest, const Modes& modes) {
  for (int direction = 0; direction < modes.rows(); ++direction) {
    Equation equation = {{.node = node, .direction = direction, .factor = 1}};
    if (lowest != node) equation.push_back({.node = lowest, .direction = direction, .factor = -1});
    for (std::size_t d = 0; d < mesh.drivers.size(); ++d) {
      const double factor = modes(direction, static_cast<Eigen::Index>(d));
      if (factor != 0) equation.push_back({.node = mesh.nodes.size() + d, .direction = 0, .factor = -factor});
    }
    mesh.equations.push_back(std::move(equation));
  }
}

bool is_on_faces(const Parallelepiped& cell, const Vec3& p) {
  return cell.side_of(p, 0) != 0 || cell.side_of(p, 1) != 0 || cell.side_of(p, 2) != 0;
}

// From the node that another one depends on to that: along periodic axes only, however their other
// coordinates were rounded.
Vec3 way_between(const Parallelepiped& cell, const std::array<bool, 3>& periodic, const Vec3& from,
                 const Vec3& to) {
  Vec3 way = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis)
    if (periodic[static_cast<std::size_t>(axis)])
      way += (cell.side_of(to, axis) - cell.side_of(from, axis)) / 2 * cell.edge(axis);
  return way;
}

// The parts that elements and conditions do not connect, each by its least node.
std::vector<std::size_t> find_parts(Groups& groups, std::size_t nodes) {
  std::vector<std::size_t> parts;
  for (std::size_t n = 0; n < nodes; ++n)
    if (groups.of(n) == n) parts.push_back(n);
  return parts;
}

std::string region_with(const Mesh& mesh, Groups& groups, std::size_t part) {
  for (const Region& region : mesh.regions)
    for (std::size_t e = region.first_element; e < region.last_element; ++e)
      if (groups.of(mesh.elements[e][0]) == part) return region.name;
  return "";
}

// What no condition ties is free to turn and to go, whatever the ends of a beam do.
Status check_held_by_ends(const Mesh& mesh, Groups& groups, const std::vector<std::size_t>& parts) {
  std::vector<bool> is_held(mesh.nodes.size(), false);
  for (const Equation& equation : mesh.equations) is_held[groups.of(equation.front().node)] = true;
  for (const std::size_t part : parts) {
    if (is_held[part]) continue;
    return error(Kind::geometry,
                 fmt::format("a part of '{}' reaches neither end of this cell, which is periodic "
                             "along one axis: nothing holds it; put it into a matrix "
                             "(--matrix), or leave it out",
                             region_with(mesh, groups, part)))
        .at_point(mesh.nodes[part]);
  }
  return {};
}

void add_load_cases(Mesh& mesh, const Drive& drive) {
  for (std::size_t d = 0; d < mesh.drivers.size(); ++d) {
    LoadCase load;
    load.name = drive.cases[d];
    load.drivers.assign(mesh.drivers.size(), 0.0);
    load.drivers[d] = drive.value;
    mesh.load_cases.push_back(std::move(load));
  }
  if (drive.is_heated)
    mesh.load_cases.push_back({.name = "thermal",
                               .drivers = std::vector<std::optional<double>>(mesh.drivers.size(), 0.0),
                               .temperature = 1});
}

}  // namespace

Status add_conditions(Mesh& mesh, const std::vector<std::size_t>& lowest) {
  mesh.drivers.clear();
  mesh.equations.clear();
  mesh.load_cases.clear();
  const Parallelepiped cell = mesh.cell->shape();
  const std::optional<CellKind> kind = kind_of_cell(mesh.cell->periodic);
  const bool all_round = kind == CellKind::piece;
  if (!kind)
    return error(Kind::unsupported,
                 "a cell is periodic along one axis (a beam), along x and y (a plate), along x, y and z (a "
                 "block), or not at all");
  if (kind == CellKind::beam && mesh.physics != Physics::elastic)
    return error(Kind::unsupported,
                 "a cell that conducts is periodic along x and y, along x, y and z, or not at all");
  const Drive drive = drive_of(mesh.physics, mesh.cell->periodic);
  add_drivers(mesh, drive.drivers);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (all_round && is_on_faces(cell, mesh.nodes[n]))
      add_equations(mesh, n, n, drive.modes(from_middle(cell, mesh.nodes[n])));
    if (lowest[n] == n) continue;
    const Vec3 &lowest_at = mesh.nodes[lowest[n]], from = from_middle(cell, lowest_at);
    const Vec3 way = way_between(cell, mesh.cell->periodic, lowest_at, mesh.nodes[n]);
    add_equations(mesh, n, lowest[n], drive.modes(from + way) - drive.modes(from));
  }
  const bool with_matrix = std::any_of(mesh.regions.begin(), mesh.regions.end(), [](const Region& region) {
    return region.kind == Region::Kind::matrix;
  });
  Groups groups = connected_nodes(mesh);
  const std::vector<std::size_t> parts = find_parts(groups, mesh.nodes.size());
  if (parts.size() > 1 && with_matrix)
    return error(Kind::geometry,
                 fmt::format("the cell falls into {} parts that nothing connects", parts.size()));
  if (kind == CellKind::beam)
    if (Status held = check_held_by_ends(mesh, groups, parts); !held) return held;
  if (parts.size() == 1 || kind == CellKind::beam) add_load_cases(mesh, drive);
  return {};
}

}  // namespace selvage::fem
