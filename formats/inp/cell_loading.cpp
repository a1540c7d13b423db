// What drives a unit cell: nodes whose displacement is a strain, equations, and a step for each load case.
#include <algorithm>

#include "fem/complete_cell.h"
#include "formats/inp/deck.h"

namespace selvage::formats::inp {
namespace {

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
  text << "** Cell: ";
  corner(mesh.cell->low);
  text << ' ';
  corner(mesh.cell->high);
  text << '\n';
  if (!mesh.equations.empty()) text << "*EQUATION\n";
  for (const fem::Equation& equation : mesh.equations) {
    text << equation.size() << '\n';
    for (std::size_t i = 0; i < equation.size(); ++i) {
      const fem::Term& term = equation[i];
      text << term.node + 1 << ", " << term.direction + 1 << ", " << real(term.factor)
           << (i % per_row == per_row - 1 || i + 1 == equation.size() ? "\n" : ", ");
    }
  }
  if (changes_temperature(mesh)) text << "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nAllNodes, 0\n";
}

void write_cell_steps(TextBuffer& text, const fem::Mesh& mesh) {
  const bool is_heated = changes_temperature(mesh);
  for (const fem::LoadCase& load : mesh.load_cases) {
    text << "** " << load.name << "\n*STEP\n*STATIC\n*BOUNDARY, OP=NEW\n";
    if (const auto held = fem::held_node(mesh)) text << *held + 1 << ", 1, 3\n";
    for (std::size_t k = 0; k < load.drivers.size(); ++k)
      if (load.drivers[k]) text << mesh.drivers[k].name << ", 1, 1, " << real(*load.drivers[k]) << '\n';
    if (is_heated) text << "*TEMPERATURE\nAllNodes, " << real(load.temperature) << '\n';
    // The force on a driver is the stress times the volume of the cell. CalculiX prints none at a driver
    // itself, which no element has: it follows from those on the nodes that depend on it.
    text << "*NODE PRINT, NSET=Drivers\nU, RF\n*NODE PRINT, NSET=Dependent\nRF\n";
    text << "*NODE FILE\nU\n*EL FILE\nS, E\n*END STEP\n";
  }
}

}  // namespace selvage::formats::inp
