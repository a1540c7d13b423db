// The load cases of a unit cell: linear static steps, all in one file by *CASE, each a run of its own.
#include "cell_problem/supports.h"
#include "core/columns.h"
#include "formats/k/deck.h"

namespace selvage::formats::k {
namespace {

constexpr std::size_t ramp_curve = 1, by_displacement = 2;  // LCID, VAD

// A solver runs them one after the other, when it is told CASE.
void write_case_list(TextBuffer& text, const fem::Mesh& mesh) {
  text << "$ Load cases: run with the word CASE (or CASE=1,2), else none of them is in force.\n";
  for (std::size_t k = 0; k < mesh.load_cases.size(); ++k) {
    const std::string number = std::to_string(k + 1);
    text << "$ " << number << ": " << mesh.load_cases[k].name << "\n*CASE\n";
    put_right(text, number, 10);
    text << "case" << number << "\n\n";
    put_integers(text, {k + 1});
  }
}

void write_controls(TextBuffer& text) {
  text << "*CONTROL_IMPLICIT_GENERAL\n";
  put_reals(text, {1, 1});
  text << "*CONTROL_IMPLICIT_SOLUTION\n";
  put_integers(text, {1});
  text << "*CONTROL_TERMINATION\n";
  put_reals(text, {1});
  text << "*DEFINE_CURVE\n";
  put_integers(text, {ramp_curve});
  put_reals(text, {0, 0}, 20);
  put_reals(text, {1, 1}, 20);
}

void write_supports(TextBuffer& text, const fem::Mesh& mesh) {
  text << "*BOUNDARY_SPC_NODE\n";
  for (const auto& [node, only] : fem::supports(mesh)) {
    const auto is_held = [&, only = only](int direction) { return !only || *only == direction ? 1U : 0U; };
    put_integers(text, {node + 1, 0, is_held(0), is_held(1), is_held(2), 0, 0, 0});
  }
  for (std::size_t d = 0; d < mesh.drivers.size(); ++d)
    put_integers(text, {mesh.number_of_driver(d) + 1, 0, 0, 1, 1, 0, 0, 0});
}

// Drivers at zero are held: a scale factor of zero may be read as the default, one.
void write_case(TextBuffer& text, const fem::Mesh& mesh, std::size_t k) {
  const fem::LoadCase& load = mesh.load_cases[k];
  text << "*CASE_BEGIN_" << k + 1 << '\n';
  bool is_first = true;
  for (std::size_t d = 0; d < mesh.drivers.size(); ++d) {
    if (!load.drivers[d] || *load.drivers[d] != 0) continue;
    if (is_first) text << "*BOUNDARY_SPC_NODE\n";
    is_first = false;
    put_integers(text, {mesh.number_of_driver(d) + 1, 0, 1, 0, 0, 0, 0, 0});
  }
  for (std::size_t d = 0; d < mesh.drivers.size(); ++d) {
    if (!load.drivers[d] || *load.drivers[d] == 0) continue;
    text << "*BOUNDARY_PRESCRIBED_MOTION_NODE\n";
    put_right(text, {mesh.number_of_driver(d) + 1, std::size_t{1}, by_displacement, ramp_curve}, 10);
    put_reals(text, {*load.drivers[d]});
  }
  if (load.temperature != 0) {
    const std::size_t heating = ramp_curve + k + 1;
    text << "*DEFINE_CURVE\n";
    put_integers(text, {heating});
    put_reals(text, {0, 0}, 20);
    put_reals(text, {1, load.temperature}, 20);
    text << "*LOAD_THERMAL_LOAD_CURVE\n";
    put_integers(text, {heating});
  }
  text << "*CASE_END_" << k + 1 << '\n';
}

}  // namespace

void write_cell_loading(TextBuffer& text, const fem::Mesh& mesh) {
  if (mesh.load_cases.empty()) return;
  write_case_list(text, mesh);
  write_controls(text);
  write_supports(text, mesh);
  for (std::size_t k = 0; k < mesh.load_cases.size(); ++k) write_case(text, mesh, k);
}

}  // namespace selvage::formats::k
