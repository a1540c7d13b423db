// Names in decks, against the rules of the solvers as they are written here.
#include "fem/names.h"

#include <gtest/gtest.h>

#include <cctype>
#include <set>

#include "fem/materials.h"

namespace selvage {
namespace {

using Names = std::vector<std::string>;

std::string upper(std::string name) {
  for (char& letter : name) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  return name;
}

bool is_ascii_alphanumeric(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

// A letter, then letters, digits, underscores and what is in `also`; unique without regard to case.
void expect_identifiers(const Names& names, std::size_t longest, const std::string& also) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    ASSERT_FALSE(name.empty());
    EXPECT_LE(name.size(), longest) << name;
    EXPECT_TRUE(is_ascii_alphanumeric(name[0]) && (name[0] < '0' || name[0] > '9')) << name;
    for (const char c : name)
      EXPECT_TRUE(is_ascii_alphanumeric(c) || c == '_' || also.find(c) != std::string::npos) << name;
    EXPECT_TRUE(seen.insert(upper(name)).second) << name << " twice";
  }
}

// So many x, twice.
std::string long_name(std::size_t first, const std::string& between, std::size_t second,
                      const std::string& end) {
  std::string name(first, 'x');
  name += between;
  name.append(second, 'x');
  return name += end;
}

const Names awkward = {"a b",
                       "a_b",
                       "A",
                       "a",
                       long_name(99, "", 0, "1"),
                       long_name(99, "", 0, "2"),
                       "7",
                       "",
                       "all",
                       "A_2",
                       "Ähre",
                       "été",
                       "a\nb",
                       "*$,&",
                       "\xFF\xFE",
                       "ALL",
                       "a.b",
                       "warp-1\t",
                       std::string(10000, 'y'),
                       "Y_"};

TEST(SolverNames, IdentifiersAreLegalUniqueAndTheSameAgain) {
  for (const std::size_t longest : {24U, 32U, 80U}) {
    const fem::NameRule rule = {.longest = longest, .also = "-", .taken = {"ALL"}};
    const Names names = fem::unique_names(awkward, rule);
    ASSERT_EQ(names.size(), awkward.size());
    expect_identifiers(names, longest, "-");
    EXPECT_EQ(names, fem::unique_names(awkward, rule));
    for (const std::string& name : names) EXPECT_NE(upper(name), "ALL");
  }
}

// What a solver takes stays as it is, whoever stands before it; of the others as much as fits.
TEST(SolverNames, AreReadable) {
  const Names names = fem::unique_names(awkward, {.longest = 32});
  EXPECT_EQ(names[0], "a_b_2");
  EXPECT_EQ(names[1], "a_b");
  EXPECT_EQ(names[2], "A");
  EXPECT_EQ(names[3], "a_3");  // A_2 is another's
  EXPECT_EQ(names[4], long_name(20, "__", 9, "1"));
  EXPECT_EQ(names[5], long_name(20, "__", 9, "2"));
  EXPECT_EQ(names[6], "Y_7");
  EXPECT_EQ(names[9], "A_2");
  EXPECT_EQ(names[10], "Y__hre");
  EXPECT_EQ(names[17], "warp_1_");
}

// Titles keep what can be seen. A letter of several bytes is not cut in two.
TEST(SolverNames, TextKeepsWhatCanBeSeen) {
  const fem::NameRule rule = {.longest = 20, .is_text = true, .unfit = "*$,&"};
  const Names names =
      fem::unique_names({"a b", "été", "*$,&", " a ", "A B", "ééééééééééééééé", "a\nb"}, rule);
  EXPECT_EQ(names, (Names{"a b", "été", "____", "_a_", "A B_2", "éééééé__ééé", "a_b"}));
}

// With what is put behind them too: no yarn takes another one's end.
TEST(SolverNames, EndingsCount) {
  const Names own = {"a", "a_End", "A_start", std::string(40, 'z')};
  const Names names = fem::unique_names(own, {.longest = 32, .endings = {"_Start", "_End"}});
  Names all = names;
  for (const std::string& name : names)
    for (const char* ending : {"_Start", "_End"}) all.push_back(name + ending);
  expect_identifiers(all, 32, "");
  EXPECT_EQ(names[0], "a");
}

TEST(SolverNames, ManyAlikeTakeNoTime) {
  const Names names = fem::unique_names(Names(20000, "Schuß"), {.longest = 32});
  expect_identifiers(names, 32, "");
  EXPECT_EQ(names.back(), "Schu__20000");
}

TEST(SolverNames, OfMaterials) {
  std::vector<fabric::Material> materials(3);
  materials[0].name = "fibre 1";
  materials[1].name = "Fibre-1";
  materials[2].name = "1st";
  EXPECT_EQ(fem::solver_names(materials), (Names{"fibre_1", "Fibre_1_2", "M_1st"}));
}

// The nodes that drive a cell have names of their own, of every physics.
TEST(SolverNames, YarnsCalledAsDrivers) {
  fem::Mesh mesh;
  for (const char* name : {"ConstraintsDriver3", "curvaturedriver0", "GradientDriver1", "GradientDriver7"})
    mesh.regions.emplace_back().name = name;
  mesh.cell.emplace();
  const fem::DeckNames names(mesh, {.longest = 32});
  EXPECT_EQ(names.of(0), "ConstraintsDriver3_2");
  EXPECT_EQ(names.of(1), "curvaturedriver0_2");
  EXPECT_EQ(names.of(2), "GradientDriver1_2");
  EXPECT_EQ(names.of(3), "GradientDriver7");
}

// A yarn called as a part of the deck, sections and ends of yarns whose names look like theirs.
// What belongs to an interface is called after its first region; a number tells those between yarns apart.
TEST(SolverNames, OfInterfaces) {
  fem::Mesh mesh;
  for (const char* name : {"a", "a_Side", "a_Cohesive2", "matrix"}) {
    fem::Region region;
    region.name = name;
    mesh.regions.push_back(region);
  }
  mesh.regions.back().kind = fem::Region::Kind::matrix;
  mesh.interfaces.resize(4);
  constexpr std::array<std::array<std::size_t, 2>, 4> regions = {{{0, 1}, {0, 2}, {0, 3}, {1, 2}}};
  for (std::size_t i = 0; i < regions.size(); ++i) {
    mesh.interfaces[i].first = regions[i][0];
    mesh.interfaces[i].second = regions[i][1];
  }
  const fem::DeckNames names(mesh, {.longest = 40});
  EXPECT_EQ(names.of_interface(mesh, 0, "_Side"), "a_Side1");
  EXPECT_EQ(names.of_interface(mesh, 1, "_Cohesive"), "a_Cohesive2");
  EXPECT_EQ(names.of_interface(mesh, 2, "_Side"), "a_Side");
  Names all;
  for (std::size_t r = 0; r < mesh.regions.size(); ++r) all.push_back(names.of(r));
  for (std::size_t i = 0; i < mesh.interfaces.size(); ++i)
    for (const std::string_view ending : fem::interface_endings)
      all.push_back(names.of_interface(mesh, i, ending));
  expect_identifiers(all, 40, "");
}

TEST(SolverNames, OfAMesh) {
  fem::Mesh mesh;
  for (const char* name : {"matrix", "a", "a_Section1", "facea", "Corner9", "matrix"}) {
    fem::Region region;
    region.name = name;
    region.first_element = mesh.element_material.size();
    mesh.element_material.insert(mesh.element_material.end(), {0, 1});
    region.last_element = mesh.element_material.size();
    mesh.regions.push_back(region);
  }
  mesh.regions.back().kind = fem::Region::Kind::matrix;
  mesh.cell.emplace();
  const fem::DeckNames names(mesh, {.longest = 32});
  Names all = {"FaceA", "Corner1", "All"};
  for (std::size_t i = 0; i < mesh.regions.size(); ++i) {
    all.push_back(names.of(i));
    for (std::size_t k = 0; k < 2; ++k) all.push_back(names.of_section(i, k));
  }
  expect_identifiers(all, 32, "");
  EXPECT_EQ(names.of(5), "Matrix");
  EXPECT_EQ(names.of(0), "matrix_2");
  EXPECT_EQ(names.of(1), "a");
  EXPECT_EQ(names.of(4), "Corner9");

  Result<OutputFile> output = OutputFile::in_memory();
  TextBuffer text(*output);
  mesh.regions[1].name = "a\nb ";
  mesh.regions[1].name.append(90, 'x');
  fem::write_yarn_names(text, mesh, names, "$", 40);
  ASSERT_TRUE(text.finish().ok());
  EXPECT_EQ(*output->contents(), "$ matrix_2 is yarn 'matrix'\n$ a is yarn\n$ 'a\\nb " +
                                     long_name(31, "'\n$ '", 36, "'\n$ '") +
                                     long_name(23, "", 0,
                                               "'\n$ a_Section1_2 is yarn 'a_Section1'\n"
                                               "$ facea_2 is yarn 'facea'\n"));
}

}  // namespace
}  // namespace selvage
