#include "formats/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/columns.h"
#include "fem/materials.h"
#include "fem/sections.h"
#include "formats/cdb/deck.h"
#include "formats/cdb/interfaces.h"
#include "formats/cdb/pores.h"

namespace selvage::formats::cdb {
namespace {

int element_type(const fem::Mesh& mesh) {
  if (mesh.shape == fem::Mesh::Shape::hexahedron) return 185;
  return mesh.order == 1 ? 285 : 187;
}

void write_nodes(TextBuffer& text, const fem::Mesh& mesh) {
  std::vector<Vec3> places;
  for (std::size_t n = 0; n < mesh.numbered(); ++n) places.push_back(mesh.place(n));
  write_node_block(text, places);
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

void write_elements(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections,
                    const fem::Frames& frames) {
  const std::vector<std::size_t> materials = fem::element_materials(mesh, sections);
  open_block(text, "EBLOCK,19,SOLID,", mesh.elements.size() + mesh.drivers.size() + mesh.cohesive_elements(),
             "(19i10)");
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const std::size_t frame = frames.of_element[e];
    const std::span<const std::size_t> nodes = mesh.nodes_of(e);
    write_element_head(text, {.material = materials[e] + 1,
                              .system = frame == fem::Frames::none ? 0 : first_local + frame - 1,
                              .nodes = nodes.size(),
                              .number = e + 1});
    put_numbers(text, nodes, 10, 8);
  }
  for (std::size_t k = 0; k < mesh.drivers.size(); ++k) {
    write_element_head(text, {.type = 2, .nodes = 1, .number = mesh.elements.size() + k + 1});
    put_right(text, mesh.number_of_driver(k) + 1, 10);
    text << '\n';
  }
  write_cohesive_elements(text, mesh);
  text << "        -1\n";
}

void write_components(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections,
                      const fem::DeckNames& names) {
  for (const fem::NamedSet& set : fem::element_sets(mesh, sections, names)) write_component(text, set, false);
  fem::NamedSet all{"AllElements", std::vector<std::size_t>(mesh.elements.size())};  // ALL is a word of ANSYS
  std::iota(all.members.begin(), all.members.end(), std::size_t{0});
  write_component(text, all, false);
  for (const fem::NamedSet& set : fem::node_sets(mesh, names)) write_component(text, set, true);
  for (std::size_t k = 0; k < mesh.drivers.size(); ++k)
    write_component(text, {mesh.drivers[k].name, {mesh.number_of_driver(k)}}, true);
  write_interface_components(text, mesh, names);
}

// Fibres' are not, for a card wants those across, too.
bool has_card(const fabric::Material& material) {
  const auto* two = std::get_if<fabric::TransverseStrength>(&material.strength);
  return two == nullptr || two->across;
}

std::vector<Message> fibre_strengths_left_out(const fem::Mesh& mesh) {
  const auto found = std::find_if_not(mesh.materials.begin(), mesh.materials.end(), has_card);
  if (found == mesh.materials.end()) return {};
  return {
      warning(Kind::unsupported,
              fmt::format("ANSYS's card of strengths wants those across the yarn, too, which '{}' does not "
                          "say: give its line `strength` YT, YC and S12, or --yarn-stiffness chamis",
                          found->name))};
}

// Limits of stress along x, y and z (compression negative), and in shear xy, yz, xz. What is alike in all
// directions and says none in shear breaks there by its principal stresses.
void write_strength(TextBuffer& text, std::size_t number, const fabric::Material& material) {
  std::array<double, 9> limits{};
  if (const auto* same = std::get_if<fabric::IsotropicStrength>(&material.strength)) {
    const double shear = same->shear.value_or(std::min(same->tension, same->compression));
    limits = {same->tension, -same->compression, same->tension, -same->compression,
              same->tension, -same->compression, shear,         shear,
              shear};
  } else if (const auto* two = std::get_if<fabric::TransverseStrength>(&material.strength);
             two != nullptr && two->across) {
    const auto& [yt, yc, s12, s23] = *two->across;
    limits = {two->tension, -two->compression, yt, -yc, yt, -yc, s12, s23, s12};
  } else {
    return;
  }
  text << "TB,FCLI," << number << ",1,20,1";
  for (std::size_t i = 0; i < limits.size(); ++i) {
    if (i % 6 == 0) text << "\nTBDATA," << i + 1;
    text << ',' << limits[i];
  }
  text << '\n';
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
    write_strength(text, i + 1, mesh.materials[i]);
  }
  write_cohesive_materials(text, mesh);
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
  write_interface_types(text, mesh);
  if (mesh.drivers.empty()) return;
  // A node without an element has no displacement: the drivers get a mass that weighs nothing.
  text << "ET,2,21\nKEYOPT,2,3,2\nR,2,1e-15\n";
}

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output, const MeshFileOptions& /*options*/) {
  if (!mesh.patches.empty()) return write_pores(mesh, output);
  const fem::DeckNames names(mesh, {.longest = 32, .taken = {"ALL", "STAT", "DEFA"}});
  const Result<std::vector<fem::Section>> sections = fem::sections(mesh, names);
  if (!sections) return sections.error();
  const fem::Frames frames = fem::frames(mesh, *sections);
  TextBuffer text(output);
  text << "/COM,ANSYS mesh archive by Selvage: mm, N, MPa, tonne, s. Read it with CDREAD,DB\n";
  fem::write_yarn_names(text, mesh, names, "!", 100);
  text << "/PREP7\n";
  write_types(text, mesh);
  write_nodes(text, mesh);
  write_frames(text, frames);
  write_elements(text, mesh, *sections, frames);
  write_components(text, mesh, *sections, names);
  write_materials(text, mesh);
  write_equations(text, mesh);
  write_bonded_contact(text, mesh, names);
  text << "FINISH\n";
  Result<WriteFacts> facts =
      finished(text,
               {{"nodes", mesh.nodes.size()},
                {"SOLID" + std::to_string(element_type(mesh)), mesh.elements.size()},
                {"coordinate systems", frames.axes.size()}},
               {{"constraint equations", mesh.equations.size()},
                {"INTER" + std::to_string(cohesive_element(mesh)), mesh.cohesive_elements()}});
  if (facts) facts->messages = fibre_strengths_left_out(mesh);
  return facts;
}

bool is_an_archive(std::string_view head) {
  return head.starts_with("/COM,ANSYS") || head.starts_with("!! Generated by pyansys");
}

}  // namespace

void open_block(TextBuffer& text, std::string_view command, std::size_t count, std::string_view form) {
  text << command;
  put_right(text, count, 10);
  text << ',';
  put_right(text, count, 10);
  text << '\n' << form << '\n';
}

void write_node_block(TextBuffer& text, const std::vector<Vec3>& places) {
  open_block(text, "NBLOCK,6,SOLID,", places.size(), "(3i9,6e21.13e3)");
  for (std::size_t n = 0; n < places.size(); ++n) {
    put_right(text, {n + 1, 0, 0}, 9);
    for (const double x : places[n]) put_right(text, scientific_text(x, 13), 21);
    text << '\n';
  }
  text << "N,R5.3,LOC,       -1,\n";
}

void write_element_head(TextBuffer& text, const ElementHead& head) {
  // Material, type, real constants, section, coordinate system, alive, solid model, shape, number of nodes,
  // (not used), number.
  put_right(
      text,
      {head.material, head.type, head.type, head.section, head.system, 0, 0, 0, head.nodes, 0, head.number},
      10);
}

void write_component(TextBuffer& text, const fem::NamedSet& set, bool is_nodes) {
  text << "CMBLOCK," << set.name << (is_nodes ? ",NODE," : ",ELEM,");
  put_right(text, set.members.size(), 8);
  text << "\n(8i10)\n";
  put_numbers(text, set.members, 10, 8);
}

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "cdb",
                                  .title = "ANSYS mesh archive",
                                  .extensions = {".cdb"},
                                  .sniff = is_an_archive,
                                  .write_mesh = write,
                                  .write_beams = write_beams,
                                  .order_of_surfaces = 2,
                                  .order_of_cohesive = 2,
                                  .order_of_pores = 2,
                                  .companion = {.format = macro_descriptor, .is_of_load_cases = true}};
  return self;
}

}  // namespace selvage::formats::cdb
