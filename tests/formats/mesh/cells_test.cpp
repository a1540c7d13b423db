// The formats of a unit cell's mesh, read by other programs and by parsers of the documented layouts.
#include <map>

#include "built.h"
#include "cell_problem/contact_surfaces.h"
#include "formats/mesh/cell_mesh.h"
#include "formats/mesh/programs.h"
#include "formats/registry.h"
#include "places.h"
#include "tetrahedra/cell_mesher.h"

namespace selvage {
namespace {

using test::Folder;
using test::run;
using test::save;

std::vector<fem::Mesh> cells() {
  return {test::brick_cell(), test::tetrahedra_cell(1), test::tetrahedra_cell(2),
          test::tetrahedra_cell(2, true)};
}

// The lines "name number" that a script prints.
std::map<std::string, double> facts_in(const std::string& words) {
  std::map<std::string, double> facts;
  std::istringstream lines(words);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t cut = line.rfind(' ');
    if (cut != std::string::npos) facts[line.substr(0, cut)] = std::strtod(line.c_str() + cut + 1, nullptr);
  }
  return facts;
}

std::string script(const Folder& folder, const std::string& command) {
  return run(folder, places::system_python() + " " + places::tests() + "/formats/" + command);
}

void save_all(const fem::Mesh& mesh, const Folder& folder) {
  for (const formats::Descriptor* format :
       {&formats::inp::descriptor(), &formats::cdb::descriptor(), &formats::cdb::macro_descriptor(),
        &formats::k::descriptor(), &formats::bdf::descriptor(), &formats::msh::descriptor(),
        &formats::vtu::descriptor(), &formats::unv::descriptor()})
    save(mesh, *format, folder / ("cell" + std::string(format->extensions.front())));
}

// Every number of the other decks is that of the Abaqus deck, to the digits that the columns have room for.
TEST(CellDecks, EveryNumberIsTheAbaqusDecks) {
  for (const fem::Mesh& mesh : cells()) {
    const Folder folder;
    save_all(mesh, folder);
    for (const std::string other : {"cell.cdb 12", "cell.bdf 11.5", "cell.k 4.5"}) {
      const std::string words = script(folder, "decks/compare.py cell.inp " + other);
      EXPECT_NE(words.find("\nequal"), std::string::npos) << other << "\n" << words;
      const std::map<std::string, double> facts = facts_in(words);
      if (!facts.contains("loads")) continue;
      EXPECT_EQ(facts.at("nodes"), static_cast<double>(mesh.nodes.size() + mesh.drivers.size())) << other;
      EXPECT_EQ(facts.at("elements"), static_cast<double>(mesh.elements.size())) << other;
      EXPECT_EQ(facts.at("axes"), static_cast<double>(mesh.regions[0].last_element)) << other;
      EXPECT_EQ(facts.at("equations"), static_cast<double>(mesh.equations.size())) << other;
      EXPECT_EQ(facts.at("loads"), 7) << other;
      EXPECT_GE(facts.at("sets"), 6 + 8 + 2) << other;
    }
  }
}

// The same nodes, elements and sets from every format that meshio knows, and the nodes and elements of the
// UNV by gmsh.
TEST(CellDecks, MeshioAndGmshReadTheSameMesh) {
  for (const fem::Mesh& mesh : cells()) {
    const Folder folder;
    save_all(mesh, folder);
    const std::string words = script(folder, "decks/read_all.py cell");
    EXPECT_NE(words.find("\nequal"), std::string::npos) << words;
  }
}

// Gmsh lists the periodic points, curves and surfaces, with nodes that are each other's image.
TEST(CellDecks, GmshListsPeriodicEntities) {
  for (const fem::Mesh& mesh : cells()) {
    const Folder folder;
    save(mesh, formats::msh::descriptor(), folder / "cell.msh");
    const std::string words = script(folder, "decks/periodic.py cell.msh");
    const std::map<std::string, double> facts = facts_in(words);
    ASSERT_TRUE(facts.contains("periodic surfaces")) << words;
    // Three high faces: the one across the yarn in two parts, and these are bounded by its square.
    EXPECT_EQ(facts.at("periodic surfaces"), 4) << words;
    EXPECT_EQ(facts.at("periodic curves"), 10) << words;  // nine edges of the box, the yarn's outline
    EXPECT_EQ(facts.at("periodic points"), 8) << words;   // seven corners, one on the outline
    EXPECT_LT(facts.at("largest miss"), 1e-12) << words;
    EXPECT_EQ(facts.at("nodes on high faces"), facts.at("nodes with an image")) << words;
    EXPECT_EQ(facts.at("volumes"), 2) << words;
  }
}

// A plate of a plain weave as the mesher makes it: thousands of directions, five regions, curvatures.
TEST(CellDecks, EveryNumberOfAPlainWeave) {
  const Result<Source> source = Source::open(places::samples() + "/cell_plain.txt");
  ASSERT_TRUE(source.ok());
  Diagnostics diagnostics;
  const auto fabric = formats::txt::descriptor().read_fabric(*source, diagnostics);
  ASSERT_TRUE(fabric);
  const std::vector<yarn::Body> bodies = test::built(*fabric);
  fem::CellMeshOptions options;
  options.size = 0.3;
  options.periodic = {true, true, false};
  const Result<fem::Mesh> mesh = fem::mesh_cell(*fabric, bodies, options, diagnostics);
  ASSERT_TRUE(mesh.ok()) << to_string(mesh.error());
  ASSERT_EQ(mesh->load_cases.size(), 7U);
  const Folder folder;
  save_all(*mesh, folder);
  std::string words = script(folder, "decks/compare.py cell.inp cell.cdb 12");
  EXPECT_NE(words.find("\nequal"), std::string::npos) << words;
  std::map<std::string, double> facts = facts_in(words);
  ASSERT_TRUE(facts.contains("axes")) << words;
  EXPECT_EQ(facts.at("elements"), static_cast<double>(mesh->elements.size()));
  EXPECT_GT(facts.at("axes"), 1000);
  words = script(folder, "decks/periodic.py cell.msh");
  facts = facts_in(words);
  ASSERT_TRUE(facts.contains("periodic surfaces")) << words;
  // Two high faces, each with two yarns' ends and the matrix; their outlines, and edges of the box.
  EXPECT_EQ(facts.at("periodic surfaces"), 6) << words;
  EXPECT_GE(facts.at("periodic curves"), 4 + 5) << words;
  EXPECT_LT(facts.at("largest miss"), 1e-12) << words;
}

TEST(CellDecks, SameMeshSameBytes) {
  const fem::Mesh one = test::tetrahedra_cell(2, true), two = test::tetrahedra_cell(2, true);
  for (const formats::Descriptor* format :
       {&formats::inp::descriptor(), &formats::cdb::descriptor(), &formats::cdb::macro_descriptor(),
        &formats::k::descriptor(), &formats::bdf::descriptor(), &formats::msh::descriptor(),
        &formats::vtu::descriptor(), &formats::unv::descriptor()}) {
    Result<OutputFile> a = OutputFile::in_memory(), b = OutputFile::in_memory();
    ASSERT_TRUE(format->write_mesh(one, *a, {}).ok());
    ASSERT_TRUE(format->write_mesh(two, *b, {}).ok());
    EXPECT_EQ(*a->contents(), *b->contents()) << format->name;
    if (format->sniff != nullptr) {
      EXPECT_TRUE(format->sniff(a->contents()->substr(0, 4096))) << format->name;
    }
  }
}

// Cut yarns without a matrix: their sides are surfaces of contact, what the cell's faces cut is not, and
// there is no step.
TEST(CellDecks, CutYarnsHaveContactSurfaces) {
  fem::Mesh mesh = test::brick_cell();
  mesh.regions.pop_back();
  mesh.elements.resize(mesh.regions[0].last_element);
  mesh.load_cases.clear();
  const fem::ContactSurfaces contact = fem::contact_surfaces(mesh);
  ASSERT_EQ(contact.surfaces.size(), 1U);
  EXPECT_EQ(contact.surfaces[0].whole.size(), 16U);  // four bricks in a row
  EXPECT_EQ(contact.surfaces[0].upper.size(), 4U);
  EXPECT_EQ(contact.surfaces[0].lower.size(), 4U);
  EXPECT_TRUE(contact.pairs.empty());
  Result<OutputFile> output = OutputFile::in_memory();
  ASSERT_TRUE(formats::inp::descriptor().write_mesh(mesh, *output, {}).ok());
  const std::string deck = *output->contents();
  EXPECT_NE(deck.find("*SURFACE, NAME=warp__1__Upper, TYPE=ELEMENT\n1, S2\n2, S2\n3, S2\n4, S2\n"),
            std::string::npos);
  EXPECT_EQ(deck.find("\n*STEP"), std::string::npos);
}

// Without load cases there is nothing for the macro to solve.
TEST(CellDecks, MacroNeedsLoadCases) {
  fem::Mesh mesh = test::brick_cell();
  mesh.load_cases.clear();
  Result<OutputFile> output = OutputFile::in_memory();
  const auto facts = formats::cdb::macro_descriptor().write_mesh(mesh, *output, {});
  ASSERT_FALSE(facts.ok());
  EXPECT_EQ(facts.error().kind, Kind::unsupported);
}

}  // namespace
}  // namespace selvage
