// What drives a unit cell: nodes whose displacement is a strain, equations, and a step for each load case.
#include <algorithm>

#include "formats/inp/deck.h"

namespace selvage::formats::inp {
namespace {

bool changes_temperature(const fem::Mesh& mesh) {
  return std::any_of(mesh.load_cases.begin(), mesh.load_cases.end(),
                     [](const fem::LoadCase& load) { return load.temperature != 0; });
}

}  // namespace

void write_drivers(TextBuffer& text, const fem::Mesh& mesh) {
  for (std::size_t k = 0; k < mesh.drivers.size(); ++k) {
    const Vec3& p = mesh.drivers[k].at;
    text << "*NODE, NSET=" << mesh.drivers[k].name << '\n'
         << mesh.nodes.size() + k + 1 << ", " << real(p.x()) << ", " << real(p.y()) << ", " << real(p.z())
         << '\n';
  }
  if (mesh.drivers.empty()) return;
  text << "*NSET, NSET=Drivers\n";
  for (std::size_t k = 0; k < mesh.drivers.size(); ++k)
    text << mesh.drivers[k].name << (k + 1 < mesh.drivers.size() ? ", " : "\n");
}

void write_cell_conditions(TextBuffer& text, const fem::Mesh& mesh) {
  constexpr std::size_t per_row = 4;
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
    text << "** " << load.name << "\n*STEP\n*STATIC\n*BOUNDARY, OP=NEW\n"
         << mesh.cell->corners[0] + 1 << ", 1, 3\n";
    for (std::size_t k = 0; k < load.drivers.size(); ++k)
      if (load.drivers[k]) text << mesh.drivers[k].name << ", 1, 1, " << real(*load.drivers[k]) << '\n';
    if (is_heated) text << "*TEMPERATURE\nAllNodes, " << real(load.temperature) << '\n';
    // The force on a driver is the stress times the volume of the cell.
    for (const fem::Driver& driver : mesh.drivers) text << "*NODE PRINT, NSET=" << driver.name << "\nU, RF\n";
    text << "*NODE FILE\nU\n*EL FILE\nS, E\n*END STEP\n";
  }
}

}  // namespace selvage::formats::inp
