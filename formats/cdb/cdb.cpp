#include "formats/cdb/cdb.h"

#include <algorithm>
#include <cmath>

#include "core/columns.h"
#include "core/text_report.h"
#include "fem/materials.h"
#include "fem/sections.h"

namespace selvage::formats::cdb {
namespace {

int element_type(const fem::Mesh& mesh) {
  if (mesh.shape == fem::Mesh::Shape::hexahedron) return 185;
  return mesh.order == 1 ? 285 : 187;
}

void write_nodes(TextBuffer& text, const fem::Mesh& mesh) {
  const std::size_t count = mesh.nodes.size() + mesh.drivers.size();
  text << "NBLOCK,6,SOLID,";
  put_right(text, count, 10);
  text << ',';
  put_right(text, count, 10);
  text << "\n(3i9,6e21.13e3)\n";
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3& p = n < mesh.nodes.size() ? mesh.nodes[n] : mesh.drivers[n - mesh.nodes.size()].at;
    for (const std::size_t value : {n + 1, std::size_t{0}, std::size_t{0}}) put_right(text, value, 9);
    for (int k = 0; k < 3; ++k) put_right(text, scientific_text(p[k], 13), 21);
    text << '\n';
  }
  text << "N,R5.3,LOC,       -1,\n";
}

// LOCAL's angles turn about z, then about the new x, then about the new y: the frame is
// Rz(first) Rx(second) Ry(third).
std::array<double, 3> local_angles(const std::array<Vec3, 3>& axes) {
  constexpr double degrees = 180 / 3.14159265358979323846;
  const double sine = std::clamp(axes[1].z(), -1.0, 1.0);
  // Where the second axis is upright, only the sum of the other two counts.
  if (std::abs(sine) > 1 - 1e-14)
    return {std::atan2(axes[0].y(), axes[0].x()) * degrees, std::copysign(90.0, sine), 0};
  return {std::atan2(-axes[1].x(), axes[1].y()) * degrees, std::asin(sine) * degrees,
          std::atan2(-axes[0].z(), axes[2].z()) * degrees};
}

constexpr std::size_t first_local = 11;  // ANSYS keeps 0 to 10 for itself

void write_frames(TextBuffer& text, const fem::Frames& frames) {
  for (std::size_t k = 0; k < frames.axes.size(); ++k) {
    text << "LOCAL," << first_local + k << ",0,0,0,0";
    for (const double angle : local_angles(frames.axes[k])) text << ',' << angle;
    text << '\n';
  }
  text << "CSYS,0\n";
}

void write_element_head(TextBuffer& text, std::size_t material, std::size_t type, std::size_t system,
                        std::size_t nodes, std::size_t number) {
  // Material, type, real constants, section, coordinate system, alive, solid model, shape, number of nodes,
  // (not used), number.
  for (const std::size_t value : {material, type, type, std::size_t{1}, system, std::size_t{0},
                                  std::size_t{0}, std::size_t{0}, nodes, std::size_t{0}, number})
    put_right(text, value, 10);
}

void write_elements(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections,
                    const fem::Frames& frames) {
  std::vector<std::size_t> material(mesh.elements.size(), 0);
  for (const fem::Section& section : sections)
    for (const std::size_t e : section.elements) material[e] = section.material + 1;
  const std::size_t count = mesh.elements.size() + mesh.drivers.size();
  const auto nodes = static_cast<std::size_t>(mesh.nodes_per_element());
  text << "EBLOCK,19,SOLID,";
  put_right(text, count, 10);
  text << ',';
  put_right(text, count, 10);
  text << "\n(19i10)\n";
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const std::size_t frame = frames.of_element[e];
    write_element_head(text, material[e], 1, frame == fem::Frames::none ? 0 : first_local + frame - 1, nodes,
                       e + 1);
    for (std::size_t k = 0; k < nodes; ++k) {
      if (k == 8) text << '\n';
      put_right(text, mesh.elements[e][k] + 1, 10);
    }
    text << '\n';
  }
  for (std::size_t k = 0; k < mesh.drivers.size(); ++k) {
    write_element_head(text, 1, 2, 0, 1, mesh.elements.size() + k + 1);
    put_right(text, mesh.nodes.size() + k + 1, 10);
    text << '\n';
  }
  text << "        -1\n";
}

void write_component(TextBuffer& text, std::string_view name, bool is_nodes,
                     const std::vector<std::size_t>& members) {
  constexpr std::size_t per_row = 8;
  text << "CMBLOCK," << name << (is_nodes ? ",NODE," : ",ELEM,");
  put_right(text, members.size(), 8);
  text << "\n(8i10)\n";
  for (std::size_t k = 0; k < members.size(); ++k) {
    put_right(text, members[k] + 1, 10);
    if (k % per_row == per_row - 1 || k + 1 == members.size()) text << '\n';
  }
}

void write_components(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    std::vector<std::size_t> members;
    for (std::size_t e = mesh.regions[i].first_element; e < mesh.regions[i].last_element; ++e)
      members.push_back(e);
    all.insert(all.end(), members.begin(), members.end());
    write_component(text, fem::set_name(mesh, i), false, members);
  }
  for (const fem::Section& section : sections)
    if (section.name != fem::set_name(mesh, section.region))
      write_component(text, section.name, false, section.elements);
  write_component(text, "AllElements", false, all);  // ANSYS takes ALL for a word of its own
  for (const fem::NodeSet& set : fem::node_sets(mesh)) write_component(text, set.name, true, set.nodes);
  for (std::size_t k = 0; k < mesh.drivers.size(); ++k)
    write_component(text, mesh.drivers[k].name, true, {mesh.nodes.size() + k});
}

void write_material(TextBuffer& text, std::size_t number, const fabric::Material& material) {
  const fem::Orthotropic c = fem::orthotropic(material);
  auto put_constant = [&](std::string_view label, double value) {
    text << "MP," << label << ',' << number << ',' << value << '\n';
  };
  if (c.e1 == 0) return;  // not in use
  if (std::holds_alternative<fabric::IsotropicElastic>(material.elastic)) {
    put_constant("EX", c.e1);
    put_constant("PRXY", c.nu12);
  } else {
    const std::array<std::pair<std::string_view, double>, 9> constants = {{{"EX", c.e1},
                                                                           {"EY", c.e2},
                                                                           {"EZ", c.e3},
                                                                           {"PRXY", c.nu12},
                                                                           {"PRXZ", c.nu13},
                                                                           {"PRYZ", c.nu23},
                                                                           {"GXY", c.g12},
                                                                           {"GXZ", c.g13},
                                                                           {"GYZ", c.g23}}};
    for (const auto& [label, value] : constants) put_constant(label, value);
  }
  if (c.density) put_constant("DENS", *c.density);
  if (!c.expansion) return;
  put_constant("REFT", 0);
  put_constant("ALPX", (*c.expansion)[0]);
  if (c.isotropic) return;  // ANSYS takes ALPX for all three
  put_constant("ALPY", (*c.expansion)[1]);
  put_constant("ALPZ", (*c.expansion)[2]);
}

void write_materials(TextBuffer& text, const fem::Mesh& mesh) {
  const std::vector<std::string> names = fem::solver_names(mesh.materials);
  for (std::size_t i = 0; i < mesh.materials.size(); ++i) {
    text << "! material " << i + 1 << ": " << names[i] << '\n';
    write_material(text, i + 1, mesh.materials[i]);
  }
}

// Three terms a command; further ones by the command again with the same number.
void write_equations(TextBuffer& text, const fem::Mesh& mesh) {
  constexpr std::size_t per_command = 3;
  constexpr std::array<std::string_view, 3> labels = {"UX", "UY", "UZ"};
  for (std::size_t i = 0; i < mesh.equations.size(); ++i) {
    const fem::Equation& equation = mesh.equations[i];
    for (std::size_t t = 0; t < equation.size(); ++t) {
      if (t % per_command == 0) text << (t > 0 ? "\nCE," : "CE,") << i + 1 << ",0";
      text << ',' << equation[t].node + 1 << ',' << labels[static_cast<std::size_t>(equation[t].direction)]
           << ',' << equation[t].factor;
    }
    text << '\n';
  }
}

void write_types(TextBuffer& text, const fem::Mesh& mesh) {
  text << "ET,1," << element_type(mesh) << '\n';
  if (mesh.drivers.empty()) return;
  // A node without an element has no displacement: the drivers get a mass that weighs nothing.
  text << "ET,2,21\nKEYOPT,2,3,2\nR,2,1e-15\n";
}

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output) {
  const Result<std::vector<fem::Section>> sections = fem::sections(mesh);
  if (!sections) return sections.error();
  const fem::Frames frames = fem::frames(mesh, *sections);
  TextBuffer text(output);
  text << "/COM,ANSYS mesh archive by Selvage: mm, N, MPa, tonne, s. Read it with CDREAD,DB\n";
  for (std::size_t i = 0; i < mesh.regions.size(); ++i)
    if (mesh.regions[i].kind == fem::Region::Kind::yarn)
      text << "! " << fem::set_name(mesh, i) << " is yarn " << in_quotes(mesh.regions[i].name) << '\n';
  text << "/PREP7\n";
  write_types(text, mesh);
  write_nodes(text, mesh);
  write_frames(text, frames);
  write_elements(text, mesh, *sections, frames);
  write_components(text, mesh, *sections);
  write_materials(text, mesh);
  write_equations(text, mesh);
  text << "FINISH\n";
  if (Status done = text.finish(); !done) return done.error();
  WriteFacts facts;
  facts.entities = {{"nodes", mesh.nodes.size()},
                    {"SOLID" + std::to_string(element_type(mesh)), mesh.elements.size()},
                    {"coordinate systems", frames.axes.size()}};
  if (!mesh.equations.empty()) facts.entities["constraint equations"] = mesh.equations.size();
  return facts;
}

bool is_an_archive(std::string_view head) {
  return head.starts_with("/COM,ANSYS") || head.starts_with("!! Generated by pyansys");
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "cdb",
                                  .title = "ANSYS mesh archive",
                                  .extensions = {".cdb"},
                                  .sniff = is_an_archive,
                                  .write_mesh = write,
                                  .companion = &macro_descriptor};
  return self;
}

}  // namespace selvage::formats::cdb
