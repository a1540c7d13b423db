#include "formats/inp/inp.h"

#include <algorithm>
#include <cctype>

#include "formats/inp/deck.h"

namespace selvage::formats::inp {

std::string real(double value) {
  constexpr std::size_t most = 20;
  char buffer[64];
  char* end = write_number(buffer, value);
  for (int digits = 16; end - buffer > static_cast<std::ptrdiff_t>(most); --digits)
    end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, digits).ptr;
  return {buffer, end};
}

std::string yarn_name(std::size_t region) {
  return "Yarn" + std::to_string(region);
}

void write_set(TextBuffer& text, const std::vector<std::size_t>& nodes) {
  for (std::size_t i = 0; i < nodes.size(); ++i)
    text << nodes[i] + 1 << (i % 16 == 15 || i + 1 == nodes.size() ? "\n" : ", ");
}

namespace {

bool same_letters(const std::string& a, const std::string& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

// Names that every solver takes: letters, digits and underscores after a letter, at most 70, each only once
// (case does not count).
std::vector<std::string> material_names(const std::vector<fabric::Material>& materials) {
  std::vector<std::string> names;
  for (const fabric::Material& material : materials) {
    std::string name = material.name.substr(0, 70);
    for (char& letter : name)
      if (std::isalnum(static_cast<unsigned char>(letter)) == 0 || (letter & 0x80) != 0) letter = '_';
    if (name.empty() || std::isalpha(static_cast<unsigned char>(name.front())) == 0) name.insert(0, "M_");
    const std::string stem = name;
    for (int i = 2; std::any_of(names.begin(), names.end(),
                                [&](const std::string& other) { return same_letters(other, name); });
         ++i)
      name = stem + "_" + std::to_string(i);
    names.push_back(name);
  }
  return names;
}

void write_nodes(TextBuffer& text, const fem::Mesh& mesh) {
  text << "*NODE, NSET=AllNodes\n";
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec3& p = mesh.nodes[i];
    text << i + 1 << ", " << real(p.x()) << ", " << real(p.y()) << ", " << real(p.z()) << '\n';
  }
}

void write_elements(TextBuffer& text, const fem::Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    const fem::Region& region = mesh.regions[i];
    text << "** " << yarn_name(i) << " is yarn '" << region.name << "'\n";
    text << "*ELEMENT, TYPE=" << (mesh.order == 1 ? "C3D4" : "C3D10") << ", ELSET=" << yarn_name(i) << '\n';
    for (std::size_t e = region.first_element; e < region.last_element; ++e) {
      text << e + 1;
      for (int k = 0; k < mesh.nodes_per_element(); ++k)
        text << ", " << mesh.elements[e][static_cast<std::size_t>(k)] + 1;
      text << '\n';
    }
  }
}

void write_sets(TextBuffer& text, const fem::Mesh& mesh, const std::vector<Load>& loads) {
  text << "*ELSET, ELSET=All\n";
  for (std::size_t i = 0; i < mesh.regions.size(); ++i)
    text << yarn_name(i) << (i % 16 == 15 || i + 1 == mesh.regions.size() ? "\n" : ", ");
  for (const Load& load : loads) {
    text << "*NSET, NSET=" << load.start_set << '\n';
    write_set(text, load.start);
    text << "*NSET, NSET=" << load.end_set << '\n';
    write_set(text, load.end);
  }
}

void write_vectors(TextBuffer& text, const Vec3& along, const Vec3& across) {
  for (const double value : {along.x(), along.y(), along.z(), across.x(), across.y()})
    text << real(value) << ", ";
  text << real(across.z()) << '\n';
}

// Local axes 1 along the yarn, 2 across it, element by element. The distribution's name must not look like a
// Fortran real (CalculiX takes D1 for a number).
void write_orientation(TextBuffer& text, const fem::Mesh& mesh) {
  text << "** 1: along the yarn, 2: across it. (CalculiX warns that it does not know the table, and goes "
          "on.)\n"
          "*DISTRIBUTION TABLE, NAME=YARNTABLE\nCOORD3D, COORD3D\n"
          "*DISTRIBUTION, NAME=YARNDIST1, LOCATION=ELEMENT, TABLE=YARNTABLE\n, ";
  write_vectors(text, Vec3::UnitX(), Vec3::UnitY());
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    text << e + 1 << ", ";
    write_vectors(text, mesh.along[e], mesh.across[e]);
  }
  text << "*ORIENTATION, NAME=YARNORI, SYSTEM=RECTANGULAR\nYARNDIST1\n";
}

void write_elastic(TextBuffer& text, const fabric::Material& material) {
  if (const auto* same = std::get_if<fabric::IsotropicElastic>(&material.elastic)) {
    text << "*ELASTIC\n" << real(same->modulus) << ", " << real(same->poisson) << '\n';
    return;
  }
  if (const auto* two = std::get_if<fabric::TransverseElastic>(&material.elastic)) {
    const double g23 = two->e2 / (2 * (1 + two->nu23));
    text << "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n"
         << real(two->e1) << ", " << real(two->e2) << ", " << real(two->e2) << ", " << real(two->nu12) << ", "
         << real(two->nu12) << ", " << real(two->nu23) << ", " << real(two->g12) << ", " << real(two->g12)
         << ",\n"
         << real(g23) << '\n';
  }
}

void write_materials(TextBuffer& text, const fem::Mesh& mesh, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < mesh.materials.size(); ++i) {
    const fabric::Material& material = mesh.materials[i];
    text << "*MATERIAL, NAME=" << names[i] << '\n';
    write_elastic(text, material);
    if (material.density) text << "*DENSITY\n" << real(*material.density * 1e-9) << '\n';
    if (material.expansion)
      text << "*EXPANSION, TYPE=ORTHO\n"
           << real(material.expansion->along) << ", " << real(material.expansion->across) << ", "
           << real(material.expansion->across) << '\n';
  }
}

Status write_sections(TextBuffer& text, const fem::Mesh& mesh, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    const std::string& wanted = mesh.regions[i].material;
    const auto found =
        std::find_if(mesh.materials.begin(), mesh.materials.end(),
                     [&](const fabric::Material& material) { return material.name == wanted; });
    if (found == mesh.materials.end() || std::holds_alternative<std::monostate>(found->elastic)) {
      Message message = error(Kind::internal, "the yarn's material has no elastic constants");
      message.yarn = mesh.regions[i].name;
      return message;
    }
    text << "*SOLID SECTION, ELSET=" << yarn_name(i)
         << ", MATERIAL=" << names[static_cast<std::size_t>(found - mesh.materials.begin())]
         << ", ORIENTATION=YARNORI\n";
  }
  return {};
}

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output) {
  TextBuffer text(output);
  const std::vector<std::string> names = material_names(mesh.materials);
  const std::vector<Load> loads = plan_loads(mesh);
  text << "*HEADING\nSelvage: " << std::string_view(mesh.title).substr(0, 70)
       << "\n** Units: mm, N, MPa, tonne, s\n";
  write_nodes(text, mesh);
  write_elements(text, mesh);
  write_sets(text, mesh, loads);
  write_materials(text, mesh, names);
  write_orientation(text, mesh);
  if (Status written = write_sections(text, mesh, names); !written) return written.error();
  write_transforms(text, mesh, loads);
  write_step(text, mesh, loads);
  if (Status done = text.finish(); !done) return done.error();
  WriteFacts facts;
  facts.entities = {{"nodes", mesh.nodes.size()},
                    {mesh.order == 1 ? "C3D4" : "C3D10", mesh.elements.size()},
                    {"element sets", mesh.regions.size() + 1},
                    {"node sets", 2 * loads.size() + 1}};
  return facts;
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
                                  .write_mesh = write};
  return self;
}

}  // namespace selvage::formats::inp
