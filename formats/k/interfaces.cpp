#include "formats/k/interfaces.h"

#include <array>
#include <vector>

#include "core/columns.h"
#include "fem/materials.h"
#include "formats/k/deck.h"

namespace selvage::formats::k {
namespace {

constexpr std::size_t cohesive_section = 2;

void write_segments(TextBuffer& text, const fem::Mesh& mesh, const fem::Interface& interface,
                    std::size_t number, const std::string& name,
                    fem::FacingSides::Side fem::FacingSides::*which) {
  static constexpr std::array<std::array<std::size_t, 3>, 4> quarters = {
      {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
  static constexpr std::array<std::array<std::size_t, 3>, 1> whole = {{{0, 1, 2}}};
  text << "*SET_SEGMENT_TITLE\n" << name << '\n';
  put_integers(text, {number});
  const auto put = [&](const auto& triangles, const auto& n) {
    for (const auto& t : triangles) put_integers(text, {n[t[0]] + 1, n[t[1]] + 1, n[t[2]] + 1, n[t[2]] + 1});
  };
  for (const fem::FacingSides& facing : interface.sides) {
    if (mesh.order == 1)
      put(whole, (facing.*which).nodes);
    else
      put(quarters, (facing.*which).nodes);
  }
}

}  // namespace

void write_cohesive_parts(TextBuffer& text, const fem::Mesh& mesh, const fem::DeckNames& names,
                          std::size_t parts) {
  if (mesh.joining != fem::Joining::cohesive) return;
  text << "*SECTION_SOLID\n";
  put_integers(text, {cohesive_section, 21});
  for (std::size_t i = 0; i < mesh.interfaces.size(); ++i) {
    text << "*PART\n" << names.of_interface(mesh, i, "_Cohesive") << '\n';
    put_integers(text, {parts + i + 1, cohesive_section, mesh.materials.size() + mesh.interfaces[i].law + 1});
  }
}

void write_cohesive_materials(TextBuffer& text, const fem::Mesh& mesh) {
  constexpr double light = 1e-12;  // tonne/mm2: without a wave it means nothing
  const std::vector<std::string> names = fem::solver_names(mesh.materials, mesh.laws);
  for (std::size_t i = 0; i < mesh.laws.size(); ++i) {
    const fem::CohesiveLaw& law = mesh.laws[i];
    text << (law.fracture ? "*MAT_COHESIVE_MIXED_MODE_TITLE\n" : "*MAT_COHESIVE_ELASTIC_TITLE\n")
         << names[mesh.materials.size() + i] << '\n';
    put_right(text, mesh.materials.size() + i + 1, 10);
    // Density, of an area; how many points of integration have to fail. Mixed mode: the power law with the
    // exponent 1.
    if (law.fracture) {
      const auto& [strength, energy] = *law.fracture;
      put_reals(text, {light, 1, 1, law.stiffness.normal, law.stiffness.shear, energy.normal, energy.shear});
      put_reals(text, {1, strength.normal, strength.shear});
    } else {
      put_reals(text, {light, 1, 0, law.stiffness.shear, law.stiffness.normal});
    }
  }
}

void write_cohesive_elements(TextBuffer& text, const fem::Mesh& mesh, std::size_t parts) {
  if (mesh.joining != fem::Joining::cohesive) return;
  text << "*ELEMENT_SOLID\n";
  std::size_t number = mesh.elements.size();
  for (std::size_t i = 0; i < mesh.interfaces.size(); ++i)
    for (const fem::FacingSides& facing : mesh.interfaces[i].sides) {
      put_right(text, {++number, parts + i + 1}, 8);
      for (const auto* side : {&facing.first.nodes, &facing.second.nodes})
        for (const std::size_t k : {0, 1, 2, 2}) put_right(text, (*side)[k] + 1, 8);
      text << '\n';
    }
}

void write_tied_contact(TextBuffer& text, const fem::Mesh& mesh, const fem::DeckNames& names) {
  if (mesh.joining != fem::Joining::surfaces) return;
  for (std::size_t i = 0; i < mesh.interfaces.size(); ++i) {
    const auto name = [&](std::string_view ending) { return names.of_interface(mesh, i, ending); };
    write_segments(text, mesh, mesh.interfaces[i], 2 * i + 1, name("_Side"), &fem::FacingSides::first);
    write_segments(text, mesh, mesh.interfaces[i], 2 * i + 2, name("_Facing"), &fem::FacingSides::second);
    text << "*CONTACT_TIED_SURFACE_TO_SURFACE_OFFSET_ID\n";
    put_right(text, i + 1, 10);
    text << name("_Tied") << '\n';
    put_integers(text, {2 * i + 1, 2 * i + 2, 0, 0});
    text << "\n\n";
  }
}

}  // namespace selvage::formats::k
