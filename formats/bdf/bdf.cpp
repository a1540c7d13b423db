#include "formats/registry.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>

#include "cell_problem/supports.h"
#include "core/columns.h"
#include "fem/materials.h"
#include "fem/sections.h"

namespace selvage::formats::bdf {
namespace {

constexpr std::size_t narrow = 8, wide = 16;

// A number as Nastran's manual spells it: with a point, the exponent without a letter ("1.5-6").
std::string compact(const std::string& text) {
  const std::size_t cut = std::min(text.find('e'), text.size());
  std::string number = text.substr(0, cut);
  if (number.find('.') == std::string::npos) number += '.';
  if (cut == text.size()) return number;
  number += text[cut + 1];
  return number + text.substr(std::min(text.find_first_not_of('0', cut + 2), text.size() - 1));
}

// As many digits as sixteen characters hold.
std::string real(double value) {
  std::string text = compact(number_text(value));
  for (int digits = 16; text.size() > wide; --digits) {
    char buffer[max_number_length];
    char* end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, digits).ptr;
    text = compact(std::string(buffer, end));
  }
  return text;
}

// A card in large fields, four a line; an empty word is an empty field.
void put_card(TextBuffer& text, std::string_view name, const std::vector<std::string>& fields) {
  constexpr std::size_t per_line = 4;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (i % per_line == 0) put_left(text, i == 0 ? std::string(name) + "*" : "*", narrow);
    put_right(text, fields[i], wide);
    if (i % per_line == per_line - 1 || i + 1 == fields.size()) text << '\n';
  }
}

// A card of integers in small fields, eight a line. Lines that go on say so in their last field too: meshio
// wants that.
void put_small(TextBuffer& text, std::string_view name, const std::vector<std::size_t>& fields) {
  constexpr std::size_t per_line = 8;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (i % per_line == 0) put_left(text, i == 0 ? name : "+", narrow);
    put_right(text, fields[i], narrow);
    if (i + 1 == fields.size())
      text << '\n';
    else if (i % per_line == per_line - 1)
      text << "+\n";
  }
}

std::string word(std::size_t value) {
  return std::to_string(value);
}

// Sets are numbered in the case control: elements of the regions and sections, then nodes.
struct Sets {
  std::vector<fem::NamedSet> list;
  std::size_t of_elements = 0;  // the first ones
};

Sets sets_of(const fem::Mesh& mesh, const std::vector<fem::Section>& sections, const fem::DeckNames& names) {
  Sets sets = {.list = fem::element_sets(mesh, sections, names)};
  sets.of_elements = sets.list.size();
  for (fem::NamedSet& set : fem::node_sets(mesh, names)) sets.list.push_back(std::move(set));
  return sets;
}

// At most 72 columns a line, commas at the ends of lines that go on.
void write_sets(TextBuffer& text, const fem::Mesh& mesh, const Sets& sets) {
  constexpr std::size_t longest = 70;
  for (std::size_t i = 0; i < sets.list.size(); ++i) {
    const std::vector<std::size_t>& members = sets.list[i].members;
    if (i == 0) text << "$ Of elements:\n";
    if (i == sets.of_elements) text << "$ Of nodes:\n";
    text << "$ SET " << i + 1 << " is " << sets.list[i].name << '\n';
    if (i < mesh.regions.size()) {
      text << "SET " << i + 1 << " = " << members.front() + 1 << " THRU " << members.back() + 1 << '\n';
      continue;
    }
    std::string line = "SET " + word(i + 1) + " = ";
    for (std::size_t k = 0; k < members.size(); ++k) {
      std::string next = word(members[k] + 1);
      if (k + 1 < members.size()) next += ",";
      if (line.size() + next.size() > longest) {
        text << line << '\n';
        line = "     ";
      }
      line += next;
    }
    text << line << '\n';
  }
}

void write_case_control(TextBuffer& text, const fem::Mesh& mesh, const Sets& sets) {
  text << "SOL 101\nCEND\nTITLE = Selvage: " << std::string_view(mesh.title).substr(0, 50)
       << "\n$ Units: mm, N, MPa, tonne, s\nECHO = NONE\n";
  write_sets(text, mesh, sets);
  if (mesh.load_cases.empty()) {
    text << "BEGIN BULK\n";
    return;
  }
  const std::size_t drivers = sets.list.size() + 1;
  text << "$ SET " << drivers << " is the drivers\n"
       << "SET " << drivers << " = " << mesh.nodes.size() + 1 << " THRU " << mesh.numbered()
       << "\nMPC = 1\nTEMPERATURE(INITIAL) = 999\nDISPLACEMENT = " << drivers << "\nSPCFORCES = " << drivers
       << "\nSTRESS = NONE\n";
  for (std::size_t i = 0; i < mesh.load_cases.size(); ++i) {
    text << "SUBCASE " << i + 1 << "\n  LABEL = " << mesh.load_cases[i].name << "\n  SPC = " << i + 1 << '\n';
    if (mesh.load_cases[i].temperature != 0) text << "  TEMPERATURE(LOAD) = " << i + 1 << '\n';
  }
  text << "BEGIN BULK\n";
}

void write_nodes(TextBuffer& text, const fem::Mesh& mesh) {
  // Solids turn no node: rotations are held everywhere.
  put_left(text, "GRDSET", narrow);
  put_right(text, "456", 7 * narrow);
  text << '\n';
  for (std::size_t n = 0; n < mesh.numbered(); ++n) {
    const Vec3& p = mesh.place(n);
    put_card(text, "GRID", {word(n + 1), "", real(p.x()), real(p.y()), real(p.z())});
  }
}

// Properties: one for each section and direction in it. Their coordinate systems have the numbers of the
// frames.
class Properties {
 public:
  Properties(const fem::Mesh& mesh, const std::vector<fem::Section>& sections, const fem::Frames& frames) {
    of_element_.resize(mesh.elements.size());
    for (const fem::Section& section : sections)
      for (const std::size_t e : section.elements) {
        const auto [at, is_new] =
            numbers_.emplace(std::pair(section.name, frames.of_element[e]), list_.size() + 1);
        if (is_new) list_.push_back({section.name, section.material + 1, frames.of_element[e]});
        of_element_[e] = at->second;
      }
  }
  void write(TextBuffer& text) const {
    for (std::size_t k = 0; k < list_.size(); ++k) {
      if (k == 0 || list_[k].section != list_[k - 1].section) text << "$ " << list_[k].section << '\n';
      put_small(text, "PSOLID", {k + 1, list_[k].material, list_[k].system});
    }
  }
  [[nodiscard]] std::size_t of(std::size_t element) const { return of_element_[element]; }
  [[nodiscard]] std::size_t count() const { return list_.size(); }

 private:
  struct Property {
    std::string section;
    std::size_t material = 0, system = 0;
  };
  std::map<std::pair<std::string, std::uint32_t>, std::size_t> numbers_;
  std::vector<Property> list_;
  std::vector<std::size_t> of_element_;
};

const char* element_type(const fem::Mesh& mesh) {
  return mesh.shape == fem::Mesh::Shape::hexahedron ? "CHEXA" : "CTETRA";
}

void write_elements(TextBuffer& text, const fem::Mesh& mesh, const Properties& properties) {
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    std::vector<std::size_t> fields = {e + 1, properties.of(e)};
    for (const std::size_t node : mesh.different_nodes_of(e)) fields.push_back(node + 1);
    put_small(text, mesh.is_wedge(e) ? "CPENTA" : element_type(mesh), fields);
  }
}

// The origin, a point on axis 3 and one on axis 1.
void write_frames(TextBuffer& text, const fem::Frames& frames) {
  for (std::size_t k = 0; k < frames.axes.size(); ++k) {
    std::vector<std::string> fields = {word(k + 1), "", "0.", "0.", "0."};
    for (const int axis : {2, 0})
      for (int i = 0; i < 3; ++i) fields.push_back(real(frames.axes[k][static_cast<std::size_t>(axis)][i]));
    put_card(text, "CORD2R", fields);
  }
}

// MAT9's upper triangle, row by row; strains xx, yy, zz, xy, yz, zx.
std::vector<std::string> stiffness(const fem::Orthotropic& c) {
  Eigen::Matrix3d compliance;
  compliance << 1 / c.e1, -c.nu12 / c.e1, -c.nu13 / c.e1,  //
      -c.nu12 / c.e1, 1 / c.e2, -c.nu23 / c.e2,            //
      -c.nu13 / c.e1, -c.nu23 / c.e2, 1 / c.e3;
  Eigen::Matrix<double, 6, 6> g = Eigen::Matrix<double, 6, 6>::Zero();
  g.topLeftCorner<3, 3>() = compliance.inverse();
  g(3, 3) = c.g12;
  g(4, 4) = c.g23;
  g(5, 5) = c.g13;
  std::vector<std::string> fields;
  for (int i = 0; i < 6; ++i)
    for (int j = i; j < 6; ++j) fields.push_back(real(g(i, j)));
  return fields;
}

void write_materials(TextBuffer& text, const fem::Mesh& mesh) {
  const std::vector<std::string> names = fem::solver_names(mesh.materials);
  for (std::size_t i = 0; i < mesh.materials.size(); ++i) {
    const fem::Orthotropic c = fem::orthotropic(mesh.materials[i]);
    if (c.e1 == 0) continue;  // not in use
    text << "$ " << names[i] << '\n';
    const std::string density = c.density ? real(*c.density) : "";
    std::vector<std::string> fields = {word(i + 1)};
    const auto expansion = c.expansion.value_or(std::array<double, 3>{});
    if (c.isotropic) {
      fields.insert(fields.end(), {real(c.e1), "", real(c.nu12), density});
      if (c.expansion) fields.insert(fields.end(), {real(expansion[0]), "0."});
      put_card(text, "MAT1", fields);
      continue;
    }
    for (std::string& field : stiffness(c)) fields.push_back(std::move(field));
    fields.push_back(density);
    for (const double value : expansion) fields.push_back(real(value));
    fields.insert(fields.end(), {"0.", "0.", "0.", "0."});
    put_card(text, "MAT9", fields);
  }
}

// Two terms of three fields in two lines of four, the second with the first field empty.
void write_equations(TextBuffer& text, const fem::Mesh& mesh) {
  for (const fem::Equation& equation : mesh.equations) {
    std::vector<std::string> fields = {"1"};
    for (std::size_t t = 0; t < equation.size(); ++t) {
      if (t > 0 && t % 2 == 0) fields.insert(fields.end(), {"", ""});
      fields.insert(fields.end(),
                    {word(equation[t].node + 1), word(static_cast<std::size_t>(equation[t].direction) + 1),
                     real(equation[t].factor)});
    }
    put_card(text, "MPC", fields);
  }
}

void write_loads(TextBuffer& text, const fem::Mesh& mesh) {
  if (mesh.load_cases.empty()) return;
  put_card(text, "TEMPD", {"999", "0."});
  const std::vector<fem::NodeSupport> supports = fem::supports(mesh);
  for (std::size_t i = 0; i < mesh.load_cases.size(); ++i) {
    const fem::LoadCase& load = mesh.load_cases[i];
    text << "$ " << load.name << '\n';
    for (const auto& [node, only] : supports)
      put_card(text, "SPC1",
               {word(i + 1), only ? word(static_cast<std::size_t>(*only) + 1) : "123", word(node + 1)});
    for (std::size_t d = 0; d < mesh.drivers.size(); ++d) {
      const std::string node = word(mesh.number_of_driver(d) + 1);
      put_card(text, "SPC1", {word(i + 1), "23", node});
      if (load.drivers[d]) put_card(text, "SPC", {word(i + 1), node, "1", real(*load.drivers[d])});
    }
    if (load.temperature != 0) put_card(text, "TEMPD", {word(i + 1), real(load.temperature)});
  }
}

Result<WriteFacts> write(const fem::Mesh& mesh, OutputFile& output, const MeshFileOptions& /*options*/) {
  constexpr std::size_t most = 99'999'999;  // columns of eight
  if (mesh.numbered() > most || mesh.elements.size() > most)
    return error(Kind::limit, "Nastran numbers at most 99 999 999 nodes and elements");
  // They stand in comments only, where "$ SET 12345 is NAME" fits into 72 columns.
  const fem::DeckNames names(mesh, {.longest = 48, .also = "-"});
  const Result<std::vector<fem::Section>> sections = fem::sections(mesh, names);
  if (!sections) return sections.error();
  const fem::Frames frames = fem::frames(mesh, *sections);
  const Properties properties(mesh, *sections, frames);
  TextBuffer text(output);
  text << "$ Nastran bulk data by Selvage\n";
  fem::write_yarn_names(text, mesh, names, "$", 72);
  write_case_control(text, mesh, sets_of(mesh, *sections, names));
  write_nodes(text, mesh);
  write_elements(text, mesh, properties);
  properties.write(text);
  write_frames(text, frames);
  write_materials(text, mesh);
  write_equations(text, mesh);
  write_loads(text, mesh);
  text << "ENDDATA\n";
  Result<WriteFacts> facts = finished(text,
                                      {{"GRID", mesh.numbered()},
                                       {element_type(mesh), mesh.elements.size() - mesh.count_wedges()},
                                       {"PSOLID", properties.count()}},
                                      {{"CPENTA", mesh.count_wedges()}, {"MPC", mesh.equations.size()}});
  if (facts) facts->messages = fem::strengths_left_out(mesh.materials, "a Nastran deck");
  return facts;
}

bool is_bulk_data(std::string_view head) {
  return head.starts_with("$ Nastran") || head.starts_with("SOL ") || head.starts_with("BEGIN BULK");
}

}  // namespace

const Descriptor& descriptor() {
  static const Descriptor self = {.name = "bdf",
                                  .title = "Nastran bulk data",
                                  .extensions = {".bdf", ".nas"},
                                  .sniff = is_bulk_data,
                                  .write_mesh = write};
  return self;
}

}  // namespace selvage::formats::bdf
