#include "formats/registry.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/columns.h"
#include "core/readable.h"
#include "fem/materials.h"
#include "formats/inp/deck.h"
#include "formats/inp/mesh_reader.h"
#include "formats/inp/options.h"
#include "formats/inp/reader.h"

namespace selvage::formats::inp {

std::string real(double value) {
  return number_text(value, 20);
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

// Comments, for Abaqus evaluates strengths (*FAIL STRESS, Hashin's *DAMAGE INITIATION) in elements of plane
// stress only, and CalculiX knows none: scripts/homogenize reads them.
void write_strength(TextBuffer& text, const fabric::Material& material) {
  const auto put = [&](std::string_view kind, std::initializer_list<double> values) {
    text << "** Strength: " << kind;
    for (const double value : values) text << ' ' << real(value);
  };
  if (const auto* same = std::get_if<fabric::IsotropicStrength>(&material.strength)) {
    put("isotropic", {same->tension, same->compression});
    if (same->shear) text << ' ' << real(*same->shear);
    text << '\n';
  }
  if (const auto* two = std::get_if<fabric::TransverseStrength>(&material.strength)) {
    put("transverse", {two->tension, two->compression});
    if (const auto& a = two->across)
      for (const double value : {a->tension, a->compression, a->s12, a->s23}) text << ' ' << real(value);
    text << '\n';
  }
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
    write_strength(text, material);
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

// Of bricks with reduced integration the hourglass control is said in an explicit step.
void write_sections(TextBuffer& text, const Deck& deck, const std::vector<std::string>& names) {
  const bool is_controlled = deck.forming != nullptr && deck.element == "C3D8R";
  if (is_controlled) text << "*SECTION CONTROLS, NAME=YarnControls, HOURGLASS=ENHANCED\n";
  for (const fem::Section& section : deck.sections)
    text << "*SOLID SECTION, ELSET=" << section.name << ", MATERIAL=" << names[section.material]
         << (is_oriented(deck.mesh, section) ? ", ORIENTATION=YARNORI" : "")
         << (is_controlled ? ", CONTROLS=YarnControls\n" : "\n");
}

// The line by which a deck takes in its mesh. CalculiX finds no name with a blank or a comma, nor a longer
// one.
Result<std::string> inclusion_of(const std::string& file) {
  constexpr std::size_t longest = 124;
  const bool is_plain = std::all_of(file.begin(), file.end(), [](unsigned char letter) {
    return letter > ' ' && letter != 0x7F && letter != ',' && letter != '"' && letter != '\'';
  });
  if (is_plain && file.size() <= longest) return "*INCLUDE, INPUT=" + file + "\n";
  return error(
      Kind::unsupported,
      fmt::format("the deck has to include its mesh '{}', and no solver finds a file by a name with a "
                  "blank, a comma or a quote, or of more than {} bytes: name it otherwise with -o, or "
                  "leave out {}",
                  shortened(file), longest, option::split_deck.name));
}

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output, const MeshFileOptions& options) {
  const Result<Deck> deck = plan_deck(mesh, options);
  if (!deck) return deck.error();
  const bool is_split = !options.companion.empty();
  const Result<std::string> inclusion = is_split ? inclusion_of(options.companion) : std::string();
  if (!inclusion) return inclusion.error();
  TextBuffer text(output);
  write_heading(text, mesh);
  write_names(text, *deck);
  if (is_split)
    text << *inclusion;
  else
    write_mesh_part(text, *deck);
  write_model_part(text, *deck);
  return finished(text, is_split ? EntityCounts() : counts_of_mesh(*deck),
                  {{"equations", mesh.equations.size()},
                   {"contact pairs", options.forming == nullptr ? deck->contact.pairs.size() : 0},
                   {"steps", mesh.load_cases.size()}});
}

bool looks_like_a_deck(std::string_view head) {
  return head.starts_with("*HEADING") || head.starts_with("*Heading") || head.starts_with("*NODE");
}

}  // namespace

fem::DeckNames names_of(const fem::Mesh& mesh) {
  fem::NameRule rule = {.longest = 80, .also = "-"};
  const bool has_matrix = std::any_of(mesh.regions.begin(), mesh.regions.end(), [](const fem::Region& one) {
    return one.kind == fem::Region::Kind::matrix;
  });
  if (!has_matrix) rule.endings = {"_Surface", "_Upper", "_Lower"};
  if (!mesh.cell) rule.endings.insert(rule.endings.end(), {"_Low", "_High"});
  return {mesh, std::move(rule)};
}

// Those of heat transfer begin with a D; of second order explicit steps have the modified tetrahedron alone.
// Voxels are integrated in full: hourglasses would bend a cell.
static std::string_view element_type(const fem::Mesh& mesh, const MeshFileOptions& options) {
  const bool conducts = mesh.physics != fem::Physics::elastic;
  if (mesh.shape == fem::Mesh::Shape::hexahedron)
    return conducts ? "DC3D8" : mesh.cell ? "C3D8" : options.own.text(option::brick);
  if (mesh.order == 1) return conducts ? "DC3D4" : "C3D4";
  if (conducts) return "DC3D10";
  return options.forming != nullptr ? "C3D10M" : options.own.text(option::tetrahedron);
}

Result<Deck> plan_deck(const fem::Mesh& mesh, const MeshFileOptions& options) {
  const std::string_view tetrahedron = options.own.text(option::tetrahedron);
  if (tetrahedron != option::tetrahedron.preset && mesh.order == 1)
    return error(Kind::unsupported,
                 fmt::format("{} {} has ten nodes, and this mesh has four a tetrahedron: say --order 2",
                             option::tetrahedron.name, tetrahedron));
  const fem::DeckNames names = names_of(mesh);
  Result<std::vector<fem::Section>> sections = fem::sections(mesh, names);
  if (!sections) return sections.error();
  const bool touches = mesh.physics == fem::Physics::elastic;
  Deck deck = {mesh,
               names,
               std::move(*sections),
               touches ? fem::contact_surfaces(mesh) : fem::ContactSurfaces{},
               {},
               {},
               element_type(mesh, options),
               "C3D6",
               options.forming};
  if (mesh.cell) {
    deck.node_sets = fem::node_sets(mesh, names);
    return deck;
  }
  deck.loads = plan_loads(mesh, names);
  for (const Load& load : deck.loads) {
    deck.node_sets.push_back({load.start_set, load.start});
    deck.node_sets.push_back({load.end_set, load.end});
  }
  return deck;
}

void write_names(TextBuffer& text, const Deck& deck) {
  write_units(text, deck.mesh);
  fem::write_yarn_names(text, deck.mesh, deck.names, "**", 120);
}

void write_model_part(TextBuffer& text, const Deck& deck) {
  const fem::Mesh& mesh = deck.mesh;
  const std::vector<std::string> materials = fem::solver_names(mesh.materials);
  write_materials(text, mesh, materials);
  text << "*ORIENTATION, NAME=YARNORI, SYSTEM=RECTANGULAR\nYARNDIST1\n";
  write_sections(text, deck, materials);
  if (deck.forming != nullptr) {
    write_rigid_bodies(text, mesh, *deck.forming);
    write_amplitudes(text, *deck.forming);
    write_explicit_step(text, *deck.forming);
    return;
  }
  write_cohesive_materials(text, deck);
  write_contact_pairs(text, deck);
  write_ties(text, deck);
  if (mesh.cell) {
    write_cell_conditions(text, mesh);
    write_cell_steps(text, mesh);
  } else {
    write_transforms(text, mesh, deck.loads);
    write_step(text, mesh, deck.loads);
  }
}

const Descriptor& descriptor() {
  static const Descriptor self = {
      .name = "inp",
      .title = "Abaqus and CalculiX input deck",
      .extensions = {".inp"},
      .sniff = looks_like_a_deck,
      .read_mesh = read_mesh,
      .read_deck = read_deck,
      .write_mesh = write,
      .write_beams = write_beams,
      .carries_forming = true,
      .carries_transport = true,
      .order_of_surfaces = 2,
      .order_of_cohesive = 1,
      .companion = {.format = mesh_descriptor, .ending = "_mesh", .asked_by = &option::split_deck},
      .options = option::all(),
      .is_usual = true};
  return self;
}

}  // namespace selvage::formats::inp
