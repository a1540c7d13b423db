#include "formats/registry.h"

#include <algorithm>

#include "core/columns.h"
#include "fem/materials.h"
#include "fem/sections.h"
#include "formats/k/deck.h"
#include "formats/k/explicit.h"
#include "formats/k/interfaces.h"

namespace selvage::formats::k {

std::string real(double value, std::size_t width) {
  std::string text = number_text(value, width - 1);
  if (const std::size_t cut = text.find("e-0"); cut != std::string::npos) {
    text = number_text(value, width);
    if (const std::size_t again = text.find("e-0"); again != std::string::npos) text.erase(again + 2, 1);
    if (text.size() > width - 1) text = number_text(value, width - 1);
  }
  return text;
}

void put_reals(TextBuffer& text, std::initializer_list<double> values, std::size_t width) {
  for (const double value : values) put_right(text, real(value, width), width);
  text << '\n';
}

void put_integers(TextBuffer& text, std::initializer_list<std::size_t> values) {
  put_right(text, values, 10);
  text << '\n';
}

void write_nodes(TextBuffer& text, const fem::Mesh& mesh) {
  text << "*NODE\n$    nid               x               y               z\n";
  for (std::size_t n = 0; n < mesh.numbered(); ++n) {
    const Vec3& p = mesh.place(n);
    put_right(text, n + 1, 8);
    put_reals(text, {p.x(), p.y(), p.z()}, 16);
  }
}

void write_list(TextBuffer& text, std::string_view keyword, std::size_t number, std::string_view name,
                const std::vector<std::size_t>& members) {
  text << '*' << keyword << "_TITLE\n" << name << '\n';
  put_integers(text, {number});
  put_numbers(text, members, 10, 8);
}

namespace {

// Parts are sections of one material: 1, 2, ..
void write_parts(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections) {
  // 10: tetrahedron of 4 nodes, 16: of 10 nodes, 2: brick, fully integrated (of voxels), 1: of one point.
  const bool is_brick = mesh.shape == fem::Mesh::Shape::hexahedron;
  const std::size_t form = is_brick ? (mesh.cell ? 2 : 1) : mesh.order == 1 ? 10 : 16;
  if (mesh.count_wedges() > 0) {
    text << "$ Wedges are sorted out of the bricks (ESORT).\n*CONTROL_SOLID\n";
    put_integers(text, {1});
  }
  text << "*SECTION_SOLID\n";
  put_integers(text, {1, form});
  for (std::size_t i = 0; i < sections.size(); ++i) {
    text << "*PART\n" << sections[i].name << '\n';
    put_integers(text, {i + 1, 1, sections[i].material + 1});
  }
}

void write_materials(TextBuffer& text, const fem::Mesh& mesh) {
  const std::vector<std::string> names = fem::solver_names(mesh.materials);
  for (std::size_t i = 0; i < mesh.materials.size(); ++i) {
    const fem::Orthotropic c = fem::orthotropic(mesh.materials[i]);
    if (c.e1 == 0) continue;  // not in use
    // LS-DYNA wants a density; without a wave it means nothing.
    const double density = c.density.value_or(1e-9);
    const bool is_elastic = std::holds_alternative<fabric::IsotropicElastic>(mesh.materials[i].elastic);
    text << (is_elastic ? "*MAT_ELASTIC_TITLE\n" : "*MAT_ORTHOTROPIC_ELASTIC_TITLE\n") << names[i] << '\n';
    put_right(text, i + 1, 10);
    if (is_elastic) {
      put_reals(text, {density, c.e1, c.nu12});
      continue;
    }
    // Poisson's ratios ba, ca, cb: those of the compliance's lower half. Axes by two vectors (AOPT 2), which
    // the elements have each for themselves.
    put_reals(text,
              {density, c.e1, c.e2, c.e3, c.nu12 * c.e2 / c.e1, c.nu13 * c.e3 / c.e1, c.nu23 * c.e3 / c.e2});
    put_reals(text, {c.g12, c.g23, c.g13, 2});
    put_reals(text, {0, 0, 0, 1, 0, 0});
    put_reals(text, {0, 0, 0, 0, 1, 0});
  }
}

void write_expansions(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections) {
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const fem::Orthotropic c = fem::orthotropic(mesh.materials[sections[i].material]);
    if (!c.expansion) continue;
    const auto& [one, two, three] = *c.expansion;
    text << "*MAT_ADD_THERMAL_EXPANSION\n";
    put_right(text, i + 1, 10);
    for (const double value : {one, two, three}) {
      put_right(text, std::size_t{0}, 10);
      put_right(text, real(value, 10), 10);
      if (c.isotropic) break;  // of all directions
    }
    text << '\n';
  }
}

// A wedge as LS-DYNA has it: a quadrilateral, and over it two nodes that are repeated.
std::vector<std::size_t> solid_nodes(const fem::Mesh& mesh, std::size_t e) {
  std::vector<std::size_t> n = mesh.different_nodes_of(e);
  if (mesh.is_wedge(e)) return {n[0], n[1], n[4], n[3], n[2], n[2], n[5], n[5]};
  return n;
}

void write_element(TextBuffer& text, const fem::Mesh& mesh, std::size_t e, std::size_t part) {
  const std::vector<std::size_t> nodes = solid_nodes(mesh, e);
  put_right(text, {e + 1, part}, 8);
  if (nodes.size() == 10) text << '\n';
  // A tetrahedron of four nodes repeats its last one.
  for (std::size_t n = 0; n < std::max<std::size_t>(nodes.size(), 8); ++n)
    put_right(text, nodes[std::min(n, nodes.size() - 1)] + 1, 8);
  text << '\n';
}

void write_elements(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections) {
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const bool has_axes = !fem::orthotropic(mesh.materials[sections[i].material]).isotropic;
    text << (has_axes ? "*ELEMENT_SOLID_ORTHO\n" : "*ELEMENT_SOLID\n");
    for (const std::size_t e : sections[i].elements) {
      write_element(text, mesh, e, i + 1);
      if (!has_axes) continue;
      for (const Vec3* axis : {&mesh.along[e], &mesh.across[e]})
        put_reals(text, {axis->x(), axis->y(), axis->z()}, 16);
    }
  }
}

void write_sets(TextBuffer& text, const fem::Mesh& mesh, const std::vector<fem::Section>& sections,
                const fem::DeckNames& names) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    std::vector<std::size_t> parts;
    for (std::size_t s = 0; s < sections.size(); ++s)
      if (sections[s].region == i) parts.push_back(s);
    all.insert(all.end(), parts.begin(), parts.end());
    write_list(text, "SET_PART_LIST", i + 1, names.of(i), parts);
  }
  write_list(text, "SET_PART_LIST", mesh.regions.size() + 1, "All", all);
  std::size_t number = 0;
  for (const fem::NamedSet& set : fem::node_sets(mesh, names))
    write_list(text, "SET_NODE_LIST", ++number, set.name, set.members);
  for (std::size_t d = 0; d < mesh.drivers.size(); ++d)
    write_list(text, "SET_NODE_LIST", ++number, mesh.drivers[d].name, {mesh.number_of_driver(d)});
}

void write_equations(TextBuffer& text, const fem::Mesh& mesh) {
  if (mesh.equations.empty()) return;
  text << "*CONSTRAINED_MULTIPLE_GLOBAL\n";
  put_integers(text, {1});
  for (const fem::Equation& equation : mesh.equations) {
    put_integers(text, {equation.size()});
    for (const fem::Term& term : equation) {
      put_right(text, {term.node + 1, static_cast<std::size_t>(term.direction) + 1}, 10);
      put_reals(text, {term.factor});
    }
  }
}

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output, const MeshFileOptions& options) {
  constexpr std::size_t most = 99'999'999;  // columns of eight
  if (mesh.numbered() > most || mesh.elements.size() + mesh.cohesive_elements() > most)
    return error(Kind::limit,
                 "an LS-DYNA file in standard format numbers at most 99 999 999 nodes and elements");
  // Titles are text. A star or a dollar sign would begin a keyword or a comment, a comma free format, an
  // ampersand a parameter.
  const fem::DeckNames names(mesh, {.longest = 70, .is_text = true, .unfit = "*$,&"});
  const Result<std::vector<fem::Section>> sections = fem::sections(mesh, names);
  if (!sections) return sections.error();
  TextBuffer text(output);
  text << "*KEYWORD\n*TITLE\nSelvage: " << std::string_view(mesh.title).substr(0, 70)
       << "\n$ Units: mm, N, MPa, tonne, s\n";
  fem::write_yarn_names(text, mesh, names, "$", 80);
  write_nodes(text, mesh);
  write_parts(text, mesh, *sections);
  write_cohesive_parts(text, mesh, names, sections->size());
  write_materials(text, mesh);
  write_cohesive_materials(text, mesh);
  write_expansions(text, mesh, *sections);
  write_elements(text, mesh, *sections);
  write_cohesive_elements(text, mesh, sections->size());
  write_sets(text, mesh, *sections, names);
  write_tied_contact(text, mesh, names);
  write_equations(text, mesh);
  if (options.forming != nullptr)
    write_forming(text, *options.forming,
                  {.nodes = mesh.numbered(),
                   .elements = mesh.elements.size(),
                   .parts = sections->size(),
                   .sections = 1,
                   .materials = mesh.materials.size(),
                   .node_sets = fem::node_sets(mesh, names).size() + mesh.drivers.size()},
                  false);
  else
    write_cell_loading(text, mesh);
  text << "*END\n";
  Result<WriteFacts> facts = finished(
      text, {{"nodes", mesh.nodes.size()}, {"solids", mesh.elements.size()}, {"parts", sections->size()}},
      {{"constraints", mesh.equations.size()}, {"cohesive solids", mesh.cohesive_elements()}});
  if (facts)
    facts->messages = fem::strengths_left_out(mesh.materials, "an LS-DYNA file of elastic materials");
  return facts;
}

bool is_a_keyword_file(std::string_view head) {
  return head.starts_with("*KEYWORD");
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "k",
                                  .title = "LS-DYNA keyword file",
                                  .extensions = {".k"},
                                  .sniff = is_a_keyword_file,
                                  .write_mesh = write,
                                  .write_beams = write_beams,
                                  .carries_forming = true,
                                  .order_of_surfaces = 2,
                                  .order_of_cohesive = 1};
  return self;
}

}  // namespace selvage::formats::k
