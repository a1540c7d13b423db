#include "formats/registry.h"

#include "core/columns.h"
#include "core/text_report.h"
#include "fem/materials.h"
#include "fem/sections.h"
#include "formats/inp/deck.h"

namespace selvage::formats::inp {

std::string real(double value) {
  return number_text(value, 20);
}

void write_set(TextBuffer& text, const std::vector<std::size_t>& nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i)
    text << nodes[i] + 1 << (i % 16 == 15 || i + 1 == nodes.size() ? "\n" : ", ");
}

namespace {

// Abaqus demands a *DISTRIBUTION TABLE before the distribution, of which CalculiX knows nothing and warns. A
// keyword line of Abaqus begins with a star that may stand after blanks, but in CalculiX's heading only a
// star in the first column ends it: so the one reads the table, and the other takes it for words of the
// heading.
void write_heading(TextBuffer& text, const fem::Mesh& mesh) {
  text << "*HEADING\nSelvage: " << std::string_view(mesh.title).substr(0, 70)
       << "\n *DISTRIBUTION TABLE, NAME=YARNTABLE\nCOORD3D, COORD3D\n";
}

void write_node(TextBuffer& text, std::size_t number, const Vec3& p) {
  text << number << ", " << real(p.x()) << ", " << real(p.y()) << ", " << real(p.z()) << '\n';
}

// One block, for meshio knows no second one: drivers, which are no part of AllNodes, stand at its end.
void write_nodes(TextBuffer& text, const fem::Mesh& mesh) {
  text << (mesh.drivers.empty() ? "*NODE, NSET=AllNodes\n" : "*NODE\n");
  for (std::size_t n = 0; n < mesh.numbered(); ++n) write_node(text, n + 1, mesh.place(n));
  if (mesh.drivers.empty()) return;
  text << "*NSET, NSET=AllNodes, GENERATE\n1, " << mesh.nodes.size() << ", 1\n";
  for (std::size_t k = 0; k < mesh.drivers.size(); ++k)
    text << "*NSET, NSET=" << mesh.drivers[k].name << '\n' << mesh.number_of_driver(k) + 1 << '\n';
  text << "*NSET, NSET=Drivers, GENERATE\n" << mesh.nodes.size() + 1 << ", " << mesh.numbered() << ", 1\n";
}

// Those of heat transfer begin with a D.
std::string_view element_type(const fem::Mesh& mesh) {
  const bool conducts = mesh.physics != fem::Physics::elastic;
  if (mesh.shape == fem::Mesh::Shape::hexahedron) return conducts ? "DC3D8" : "C3D8";
  if (mesh.order == 1) return conducts ? "DC3D4" : "C3D4";
  return conducts ? "DC3D10" : "C3D10";
}

void write_elements(TextBuffer& text, const fem::Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    const fem::Region& region = mesh.regions[i];
    const std::string name = fem::set_name(mesh, i);
    if (region.kind == fem::Region::Kind::yarn)
      text << "** " << name << " is yarn " << in_quotes(region.name) << '\n';
    text << "*ELEMENT, TYPE=" << element_type(mesh) << ", ELSET=" << name << '\n';
    for (std::size_t e = region.first_element; e < region.last_element; ++e) {
      text << e + 1;
      for (const std::size_t node : mesh.nodes_of(e)) text << ", " << node + 1;
      text << '\n';
    }
  }
}

void write_element_sets(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections) {
  text << "*ELSET, ELSET=All\n";
  for (std::size_t i = 0; i < mesh.regions.size(); ++i)
    text << fem::set_name(mesh, i) << (i % 16 == 15 || i + 1 == mesh.regions.size() ? "\n" : ", ");
  for (const fem::Section& section : sections) {
    if (section.name == fem::set_name(mesh, section.region)) continue;
    text << "*ELSET, ELSET=" << section.name << '\n';
    write_set(text, section.elements);
  }
}

void write_node_sets(TextBuffer& text, const std::vector<fem::NamedSet>& sets) {
  for (const fem::NamedSet& set : sets) {
    text << "*NSET, NSET=" << set.name << '\n';
    write_set(text, set.members);
  }
}

void write_vectors(TextBuffer& text, const Vec3& along, const Vec3& across) {
  for (const double value : {along.x(), along.y(), along.z(), across.x(), across.y()})
    text << real(value) << ", ";
  text << real(across.z()) << '\n';
}

// Yarns have an orientation in any case, for the material that somebody may give them later.
bool is_oriented(const fem::Mesh& mesh, const fem::Section& section) {
  return mesh.regions[section.region].kind == fem::Region::Kind::yarn ||
         !fem::is_isotropic(mesh.materials[section.material], mesh.physics);
}

// Local axes 1 along the yarn, 2 across it, element by element. The distribution's name must not look like a
// Fortran real (CalculiX takes D1 for a number).
void write_orientation(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections) {
  text << "** 1: along the yarn, 2: across it\n*DISTRIBUTION, NAME=YARNDIST1, LOCATION=ELEMENT, "
          "TABLE=YARNTABLE\n, ";
  write_vectors(text, Vec3::UnitX(), Vec3::UnitY());
  for (const fem::Section& section : sections) {
    if (!is_oriented(mesh, section)) continue;
    for (const std::size_t e : section.elements) {
      text << e + 1 << ", ";
      write_vectors(text, mesh.along[e], mesh.across[e]);
    }
  }
  text << "*ORIENTATION, NAME=YARNORI, SYSTEM=RECTANGULAR\nYARNDIST1\n";
}

void write_elastic(TextBuffer& text, const fabric::Material& material) {
  const fem::Orthotropic c = fem::orthotropic(material);
  if (std::holds_alternative<fabric::IsotropicElastic>(material.elastic)) {
    text << "*ELASTIC\n" << real(c.e1) << ", " << real(c.nu12) << '\n';
    return;
  }
  text << "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n";
  for (const double constant : {c.e1, c.e2, c.e3, c.nu12, c.nu13, c.nu23, c.g12, c.g13})
    text << real(constant) << ", ";
  text << '\n' << real(c.g23) << '\n';
}

// Every physics is one of heat conduction to the solver.
void write_conductivity(TextBuffer& text, const fem::Mesh& mesh, const fabric::Material& material) {
  const auto& [along, across] = *(material.*fem::transport_law(mesh.physics).member);
  if (along == across)
    text << "*CONDUCTIVITY\n" << real(along) << '\n';
  else
    text << "*CONDUCTIVITY, TYPE=ORTHO\n"
         << real(along) << ", " << real(across) << ", " << real(across) << '\n';
}

void write_units(TextBuffer& text, const fem::Mesh& mesh) {
  if (mesh.physics == fem::Physics::elastic) {
    text << "** Units: mm, N, MPa, tonne, s\n";
    return;
  }
  const fem::TransportLaw& law = fem::transport_law(mesh.physics);
  text << "** Physics: " << law.word << "\n** Lengths in mm. *CONDUCTIVITY: the " << law.property << ", "
       << law.unit;
  if (mesh.physics == fem::Physics::conduction)
    text << ", which is mW/(mm K): fluxes in mW/mm2\n";
  else
    text << "; temperature: the " << law.potential << '\n';
}

void write_materials(TextBuffer& text, const fem::Mesh& mesh, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < mesh.materials.size(); ++i) {
    const fabric::Material& material = mesh.materials[i];
    text << "*MATERIAL, NAME=" << names[i] << '\n';
    if (mesh.physics != fem::Physics::elastic) {
      write_conductivity(text, mesh, material);
      continue;
    }
    if (!std::holds_alternative<std::monostate>(material.elastic)) write_elastic(text, material);
    const fem::Orthotropic constants = fem::orthotropic(material);
    if (constants.density) text << "*DENSITY\n" << real(*constants.density) << '\n';
    if (constants.expansion) {
      const auto& [one, two, three] = *constants.expansion;
      if (constants.isotropic)
        text << "*EXPANSION\n" << real(one) << '\n';
      else
        text << "*EXPANSION, TYPE=ORTHO\n" << real(one) << ", " << real(two) << ", " << real(three) << '\n';
    }
  }
}

void write_sections(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections,
                    const std::vector<std::string>& names) {
  for (const fem::Section& section : sections)
    text << "*SOLID SECTION, ELSET=" << section.name << ", MATERIAL=" << names[section.material]
         << (is_oriented(mesh, section) ? ", ORIENTATION=YARNORI\n" : "\n");
}

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output) {
  const Result<std::vector<fem::Section>> sections = fem::sections(mesh);
  if (!sections) return sections.error();
  TextBuffer text(output);
  const std::vector<std::string> names = fem::solver_names(mesh.materials);
  const bool touches = mesh.physics == fem::Physics::elastic;
  const fem::ContactSurfaces contact = touches ? fem::contact_surfaces(mesh) : fem::ContactSurfaces{};
  const std::vector<Load> loads = mesh.cell ? std::vector<Load>() : plan_loads(mesh);
  const std::vector<fem::NamedSet> sets = mesh.cell ? fem::node_sets(mesh) : sets_of(loads);
  write_heading(text, mesh);
  write_units(text, mesh);
  write_nodes(text, mesh);
  write_elements(text, mesh);
  write_element_sets(text, mesh, *sections);
  write_node_sets(text, sets);
  write_contact_surfaces(text, mesh, contact);
  write_materials(text, mesh, names);
  write_orientation(text, mesh, *sections);
  write_sections(text, mesh, *sections, names);
  write_contact_pairs(text, mesh, contact);
  if (mesh.cell) {
    write_cell_conditions(text, mesh);
    write_cell_steps(text, mesh);
  } else {
    write_transforms(text, mesh, loads);
    write_step(text, mesh, loads);
  }
  return finished(text,
                  {{"nodes", mesh.nodes.size()},
                   {std::string(element_type(mesh)), mesh.elements.size()},
                   {"element sets", mesh.regions.size() + 1},
                   {"node sets", sets.size() + 1 + mesh.drivers.size()}},
                  {{"equations", mesh.equations.size()},
                   {"contact pairs", contact.pairs.size()},
                   {"steps", mesh.load_cases.size()}});
}

bool looks_like_a_deck(std::string_view head) {
  return head.starts_with("*HEADING") || head.starts_with("*Heading") || head.starts_with("*NODE");
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "inp",
                                  .title = "Abaqus and CalculiX input deck",
                                  .extensions = {".inp"},
                                  .sniff = looks_like_a_deck,
                                  .write_mesh = write,
                                  .carries_transport = true,
                                  .is_usual = true};
  return self;
}

}  // namespace selvage::formats::inp
