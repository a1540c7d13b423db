// What drives a unit cell: nodes whose displacement is a strain, or whose temperature a gradient, equations,
// and a step for each load case.
#include <algorithm>

#include "cell_problem/supports.h"
#include "formats/inp/deck.h"

namespace selvage::formats::inp {
namespace {

bool conducts(const fem::Mesh& mesh) {
  return mesh.physics != fem::Physics::elastic;
}

// Degrees of freedom of a node, as the solver counts them: displacements from 1, the temperature is 11.
constexpr int temperature = 11;
int first_unknown(const fem::Mesh& mesh) {
  return conducts(mesh) ? temperature : 1;
}
int last_unknown(const fem::Mesh& mesh) {
  return conducts(mesh) ? temperature : 3;
}

bool changes_temperature(const fem::Mesh& mesh) {
  return std::any_of(mesh.load_cases.begin(), mesh.load_cases.end(),
                     [](const fem::LoadCase& load) { return load.temperature != 0; });
}

}  // namespace

std::vector<std::size_t> dependent_nodes(const fem::Mesh& mesh) {
  std::vector<std::size_t> nodes;
  for (const fem::Equation& equation : mesh.equations) nodes.push_back(equation.front().node);
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

void write_cell_conditions(TextBuffer& text, const fem::Mesh& mesh) {
  constexpr std::size_t per_row = 4;
  const auto corner = [&](const Vec3& p) { text << real(p.x()) << ' ' << real(p.y()) << ' ' << real(p.z()); };
  text << "** Cell: ";  // opposite corners of a box; of an oblique one a corner and its three edges
  const Parallelepiped cell = mesh.cell->shape();
  corner(cell.axes.place(cell.box.min()));
  text << ' ';
  if (cell.axes.are_of_space()) corner(cell.box.max());
  for (int axis = 0; axis < 3 && !cell.axes.are_of_space(); ++axis) {
    corner(cell.edge(axis));
    text << (axis < 2 ? " " : "");
  }
  text << '\n';
  if (!mesh.equations.empty()) text << "*EQUATION\n";
  for (const fem::Equation& equation : mesh.equations) {
    text << equation.size() << '\n';
    for (std::size_t i = 0; i < equation.size(); ++i) {
      const fem::Term& term = equation[i];
      text << term.node + 1 << ", " << first_unknown(mesh) + term.direction << ", " << real(term.factor)
           << (i % per_row == per_row - 1 || i + 1 == equation.size() ? "\n" : ", ");
    }
  }
  if (changes_temperature(mesh)) text << "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nAllNodes, 0\n";
}

void write_cell_steps(TextBuffer& text, const fem::Mesh& mesh) {
  const bool is_heated = changes_temperature(mesh);
  const int first = first_unknown(mesh), last = last_unknown(mesh);
  const std::vector<fem::NodeSupport> supports = fem::supports(mesh);
  for (const fem::LoadCase& load : mesh.load_cases) {
    text << "** " << load.name << "\n*STEP\n"
         << (conducts(mesh) ? "*HEAT TRANSFER, STEADY STATE\n1, 1" : "*STATIC") << "\n*BOUNDARY, OP=NEW\n";
    for (const auto& [node, only] : supports)
      text << node + 1 << ", " << first + only.value_or(0) << ", " << (only ? first + *only : last) << '\n';
    for (std::size_t k = 0; k < load.drivers.size(); ++k)
      if (load.drivers[k])
        text << mesh.drivers[k].name << ", " << first << ", " << first << ", " << real(*load.drivers[k])
             << '\n';
    if (is_heated) text << "*TEMPERATURE\nAllNodes, " << real(load.temperature) << '\n';
    // The force on a driver is the stress times the volume of the cell; the flux into it, the mean flux.
    if (conducts(mesh))
      text << "*NODE PRINT, NSET=Drivers\nNT, RFL\n*NODE PRINT, NSET=Dependent\nRFL\n"
              "*NODE FILE\nNT\n*EL FILE\nHFL\n*END STEP\n";
    else
      text << "*NODE PRINT, NSET=Drivers\nU, RF\n*NODE PRINT, NSET=Dependent\nRF\n"
              "*NODE FILE\nU\n*EL FILE\nS, E\n*END STEP\n";
  }
}

}  // namespace selvage::formats::inp
