// Yarns as beams with their sections, in a deck that Abaqus takes (B31), or CalculiX (B32R), or as trusses
// (T3D2).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/materials.h"
#include "formats/inp/deck.h"
#include "formats/inp/options.h"
#include "structured/beams.h"

namespace selvage::formats::inp {
namespace {

using Shape = fem::BeamSection::Shape;

// Beams of one yarn with one section and, nearly, one direction n1: a section of the deck.
struct Group {
  std::size_t region = 0, section = 0;
  Vec3 n1 = Vec3::Zero();
  std::vector<std::size_t> elements;
};

// Solvers make n1 perpendicular to each beam: does that give the beam's own?
bool serves(const fem::BeamModel& beams, const Group& group, std::size_t element) {
  constexpr double near = 0.9998, steepest = 0.7;  // cosines: one degree; to the beam
  if (beams.section_of[element] != group.section) return false;
  if (beams.are_trusses) return true;
  const Vec3& along = beams.mesh.along[element];
  if (std::abs(group.n1.dot(along)) > steepest) return false;
  if (beams.sections[group.section].shape == Shape::circle) return true;
  return (group.n1 - along * along.dot(group.n1)).normalized().dot(beams.mesh.across[element]) > near;
}

std::vector<Group> groups_of(const fem::BeamModel& beams) {
  std::vector<Group> groups;
  for (std::size_t i = 0; i < beams.mesh.regions.size(); ++i) {
    const std::size_t first = groups.size();
    const fem::Region& region = beams.mesh.regions[i];
    for (std::size_t e = region.first_element; e < region.last_element; ++e) {
      const auto known = std::find_if(groups.begin() + static_cast<std::ptrdiff_t>(first), groups.end(),
                                      [&](const Group& group) { return serves(beams, group, e); });
      if (known != groups.end())
        known->elements.push_back(e);
      else
        groups.push_back({i, beams.section_of[e], beams.mesh.across[e], {e}});
    }
  }
  return groups;
}

std::string_view beam_type(const fem::BeamModel& beams, bool for_calculix) {
  return beams.are_trusses ? "T3D2" : for_calculix ? "B32R" : "B31";
}

std::string name_of_group(std::size_t k) {
  return "Beams" + std::to_string(k + 1);
}

// CalculiX has round sections on beams of three nodes only: there the middles of all beams come behind the
// nodes.
void write_beam_elements(TextBuffer& text, const fem::BeamModel& beams, const fem::DeckNames& names,
                         const std::vector<Group>& groups, bool for_calculix, const fem::Forming* forming) {
  const fem::Mesh& mesh = beams.mesh;
  text << (forming == nullptr ? "*NODE, NSET=AllNodes\n" : "*NODE\n");
  const bool has_middles = for_calculix && !beams.are_trusses;
  const auto write_node = [&](std::size_t number, const Vec3& p) {
    text << number << ", " << real(p.x()) << ", " << real(p.y()) << ", " << real(p.z()) << '\n';
  };
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) write_node(n + 1, mesh.nodes[n]);
  for (std::size_t e = 0; has_middles && e < mesh.elements.size(); ++e)
    write_node(mesh.nodes.size() + e + 1,
               (mesh.nodes[mesh.elements[e][0]] + mesh.nodes[mesh.elements[e][1]]) / 2);
  if (forming != nullptr) {
    write_rigid_nodes(text, mesh, *forming);
    text << "*NSET, NSET=AllNodes, GENERATE\n1, " << mesh.nodes.size() << ", 1\n";
  }
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    text << "*ELEMENT, TYPE=" << beam_type(beams, for_calculix) << ", ELSET=" << names.of(i) << '\n';
    for (std::size_t e = mesh.regions[i].first_element; e < mesh.regions[i].last_element; ++e) {
      text << e + 1 << ", " << mesh.elements[e][0] + 1 << ", ";
      if (has_middles) text << mesh.nodes.size() + e + 1 << ", ";
      text << mesh.elements[e][1] + 1 << '\n';
    }
  }
  text << "*ELSET, ELSET=All\n";
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) text << names.of(i) << '\n';
  for (std::size_t k = 0; k < groups.size(); ++k) {
    text << "*ELSET, ELSET=" << name_of_group(k) << '\n';
    write_set(text, groups[k].elements);
  }
  for (const fem::NamedSet& set : fem::node_sets(mesh, names)) {
    text << "*NSET, NSET=" << set.name << '\n';
    write_set(text, set.members);
  }
}

void write_reals(TextBuffer& text, std::initializer_list<double> values) {
  bool is_first = true;
  for (const double value : values) {
    text << (is_first ? "" : ", ") << real(value);
    is_first = false;
  }
  text << '\n';
}

void write_section_head(TextBuffer& text, std::string_view shape, std::size_t group,
                        const std::string& material) {
  text << "*BEAM SECTION, SECTION=" << shape << ", ELSET=" << name_of_group(group)
       << ", MATERIAL=" << material << '\n';
}

// A section that Abaqus knows by name where the material is isotropic, else by its constants.
void write_abaqus_section(TextBuffer& text, std::size_t k, const Group& group, const fem::BeamSection& s,
                          const fabric::Material& material, const std::string& name) {
  const bool is_isotropic = std::holds_alternative<fabric::IsotropicElastic>(material.elastic);
  if (is_isotropic && s.shape == Shape::circle) {
    write_section_head(text, "CIRC", k, name);
    write_reals(text, {(s.width + s.height) / 4});
    return write_reals(text, {group.n1.x(), group.n1.y(), group.n1.z()});
  }
  if (is_isotropic && s.shape == Shape::rectangle) {
    write_section_head(text, "RECT", k, name);
    write_reals(text, {s.width, s.height});
    return write_reals(text, {group.n1.x(), group.n1.y(), group.n1.z()});
  }
  const fem::BeamModuli moduli = fem::beam_moduli(material);
  text << "*BEAM GENERAL SECTION, SECTION=GENERAL, ELSET=" << name_of_group(k);
  if (const auto density = fem::orthotropic(material).density) text << ", DENSITY=" << real(*density);
  text << '\n';
  write_reals(text, {s.area, s.i11, 0, s.i22, s.torsion});
  write_reals(text, {group.n1.x(), group.n1.y(), group.n1.z()});
  write_reals(text, {moduli.young, moduli.shear});
}

// CalculiX knows rectangles and, by two thicknesses, ellipses. Of an ellipse it integrates a little less than
// the second moments (version 2.20, measured with cantilevers): thicknesses make up for that.
void write_calculix_section(TextBuffer& text, std::size_t k, const Group& group, const fem::BeamSection& s,
                            const std::string& name) {
  constexpr double integrated = 0.9758;
  double width = s.width, height = s.height;
  if (s.shape != Shape::rectangle) {
    const double ratio = std::sqrt(s.i22 / s.i11);
    height = std::pow(64 / std::numbers::pi * s.i11 / ratio / integrated, 0.25);
    width = ratio * height;
  }
  write_section_head(text, s.shape == Shape::rectangle ? "RECT" : "CIRC", k, name);
  write_reals(text, {width, height});
  write_reals(text, {group.n1.x(), group.n1.y(), group.n1.z()});
}

// Of what beams know: the modulus along the yarn. Their torsion in CalculiX follows from Poisson's ratio.
void write_beam_materials(TextBuffer& text, const fem::Mesh& mesh, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < mesh.materials.size(); ++i) {
    const fem::Orthotropic c = fem::orthotropic(mesh.materials[i]);
    text << "*MATERIAL, NAME=" << names[i] << "\n*ELASTIC\n" << real(c.e1) << ", " << real(c.nu12) << '\n';
    if (c.density) text << "*DENSITY\n" << real(*c.density) << '\n';
    if (c.expansion) text << "*EXPANSION\n" << real((*c.expansion)[0]) << '\n';
  }
}

void write_beam_sections(TextBuffer& text, const fem::BeamModel& beams, const std::vector<Group>& groups,
                         bool for_calculix) {
  const fem::Mesh& mesh = beams.mesh;
  const std::vector<std::string> names = fem::solver_names(mesh.materials);
  write_beam_materials(text, mesh, names);
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const fem::BeamSection& section = beams.sections[groups[k].section];
    const std::size_t m = fem::material_of(mesh, mesh.regions[groups[k].region]);
    if (beams.are_trusses)
      text << "*SOLID SECTION, ELSET=" << name_of_group(k) << ", MATERIAL=" << names[m] << '\n'
           << real(section.area) << '\n';
    else if (for_calculix)
      write_calculix_section(text, k, groups[k], section, names[m]);
    else
      write_abaqus_section(text, k, groups[k], section, mesh.materials[m], names[m]);
  }
}

// Radii, and the pairs as general contact of Abaqus/Explicit: as comments, for the step is a linear one.
void write_contacts(TextBuffer& text, const fem::BeamModel& beams, const fem::DeckNames& names) {
  text << "** Contact radius of each yarn, half of its thickness:\n";
  for (std::size_t i = 0; i < beams.radii.size(); ++i)
    text << "**   " << names.of(i) << ": " << real(beams.radii[i]) << '\n';
  if (beams.contacts.empty()) return;
  text << "** Contact pairs: yarns that touch or nearly do, with the least gap between their surfaces (< 0: "
          "overlap)\n** and the number of places. For Abaqus/Explicit take the marks **~ away.\n";
  for (const fem::BeamContact& contact : beams.contacts)
    text << "** pair: " << names.of(contact.a) << ", " << names.of(contact.b) << ": " << real(contact.gap)
         << ", " << contact.places << '\n';
  for (std::size_t i = 0; i < beams.radii.size(); ++i)
    text << "**~*SURFACE, NAME=" << names.of(i) << "_Surface, TYPE=ELEMENT\n**~" << names.of(i) << ",\n";
  text << "**~*CONTACT\n**~*CONTACT INCLUSIONS\n";
  for (const fem::BeamContact& contact : beams.contacts)
    text << "**~" << names.of(contact.a) << "_Surface, " << names.of(contact.b) << "_Surface\n";
}

void write_beam_step(TextBuffer& text, const fem::BeamModel& beams) {
  if (beams.are_trusses) {
    text << "** No step: chains of trusses have no stiffness across until they are tight; --deck explicit "
            "writes one.\n";
    return;
  }
  text
      << "** A small tension to begin with: every yarn is clamped at its start (a ring at one node), and its "
         "end (the\n** node across) pulled by a thousandth of its length.\n*STEP\n*STATIC\n*BOUNDARY\n";
  for (const fem::BeamEnds& ends : fem::beam_ends(beams)) {
    text << ends.held + 1 << ", 1, 6\n";
    for (int k = 0; k < 3; ++k)
      text << ends.pulled + 1 << ", " << k + 1 << ", " << k + 1 << ", " << real(ends.pull[k]) << '\n';
  }
  text << "*NODE FILE\nU, RF\n*EL FILE\nS, E\n*END STEP\n";
}

// General contact knows each yarn by its surface, with the thickness that the circle of its contact radius
// has.
void write_explicit_beams(TextBuffer& text, const fem::BeamModel& beams, const fem::DeckNames& names,
                          const fem::Forming& forming) {
  std::vector<ContactThickness> thicknesses;
  for (std::size_t i = 0; i < beams.radii.size(); ++i) {
    thicknesses.push_back({names.of(i) + "_Surface", 2 * beams.radii[i]});
    text << "*SURFACE, NAME=" << thicknesses.back().surface << ", TYPE=ELEMENT\n" << names.of(i) << ",\n";
  }
  write_rigid_parts(text, beams.mesh, forming);
  write_rigid_bodies(text, beams.mesh, forming);
  write_amplitudes(text, forming);
  write_explicit_step(text, forming, thicknesses);
}

}  // namespace

Result<WriteFacts> write_beams(const fem::BeamModel& beams, OutputFile& output,
                               const MeshFileOptions& options) {
  const std::vector<Group> groups = groups_of(beams);
  std::vector<std::string> taken;
  for (std::size_t k = 0; k < groups.size(); ++k) taken.push_back(name_of_group(k));
  const fem::DeckNames names(
      beams.mesh,
      {.longest = 80, .also = "-", .taken = {taken.begin(), taken.end()}, .endings = {"_Surface"}});
  const bool for_calculix = options.own.text(option::solver) == "calculix";
  if (for_calculix && options.forming != nullptr)
    return error(Kind::unsupported,
                 "CalculiX has no general contact of beams: leave out --solver calculix, or --deck explicit");
  TextBuffer text(output);
  text << "*HEADING\nSelvage: " << std::string_view(beams.mesh.title).substr(0, 70)
       << "\n** Units: mm, N, MPa, tonne, s. Sections as " << (for_calculix ? "CalculiX" : "Abaqus")
       << " has them (--solver)\n";
  fem::write_yarn_names(text, beams.mesh, names, "**", 120);
  write_beam_elements(text, beams, names, groups, for_calculix, options.forming);
  write_beam_sections(text, beams, groups, for_calculix);
  if (options.forming != nullptr) {
    write_explicit_beams(text, beams, names, *options.forming);
  } else {
    write_contacts(text, beams, names);
    write_beam_step(text, beams);
  }
  Result<WriteFacts> facts =
      finished(text,
               {{"nodes", beams.mesh.nodes.size()},
                {std::string(beam_type(beams, for_calculix)), beams.mesh.elements.size()},
                {beams.are_trusses ? "areas" : "beam sections", groups.size()}},
               {{"contact pairs", beams.contacts.size()}});
  if (facts) facts->messages = fem::strengths_left_out(beams.mesh.materials, "an Abaqus deck of beams");
  return facts;
}

}  // namespace selvage::formats::inp
