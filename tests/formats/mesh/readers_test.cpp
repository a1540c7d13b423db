// The three mesh formats as gmsh and meshio read them.
#include <cmath>
#include <map>

#include "fem/quality.h"
#include "formats/mesh/programs.h"
#include "formats/registry.h"
#include "places.h"

namespace selvage {
namespace {

using test::Folder;
using test::run;
using test::save;
using test::straight_tube;

fem::Mesh two_yarns(int order) {
  return test::mesh_of({},
                       {straight_tube(1, 1, 3, 24, Vec3::Zero(), "warp1"),
                        straight_tube(0.8, 0.4, 2, 24, Vec3(0, 3, 0), "weft \"2\" -- <b>")},
                       {.size = 0.25, .order = order});
}

double volume_of(const fem::Mesh& mesh) {
  return mesh.regions[0].volume + mesh.regions[1].volume;
}

std::size_t triangles_of(const fem::Mesh& mesh) {
  std::size_t count = 0;
  for (const fem::Region& region : mesh.regions)
    count += region.side_faces.size() + region.start_faces.size() + region.end_faces.size();
  return count;
}

// "name value" lines of read_mesh.py; further words make part of the name.
std::map<std::string, double> facts_of(const Folder& folder, const std::string& file) {
  const std::string words =
      run(folder, places::system_python() + " " + places::tests() + "/formats/mesh/read_mesh.py " + file);
  std::map<std::string, double> facts;
  std::istringstream lines(words);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t cut = line.rfind(' ');
    char* end = nullptr;
    const double value = cut == std::string::npos ? 0 : std::strtod(line.c_str() + cut + 1, &end);
    if (end != nullptr && *end == 0) facts[line.substr(0, cut)] = value;
  }
  EXPECT_TRUE(facts.contains("volume")) << words;
  return facts;
}

TEST(MeshReaders, MeshioSeesTheSameMeshInEveryFormat) {
  for (const int order : {1, 2}) {
    const fem::Mesh mesh = two_yarns(order);
    const Folder folder;
    for (const formats::Descriptor* format :
         {&formats::inp::descriptor(), &formats::msh::descriptor(), &formats::vtu::descriptor()}) {
      const std::string file = "mesh" + std::string(format->extensions.front());
      save(mesh, *format, folder / file);
      std::map<std::string, double> facts = facts_of(folder, file);
      EXPECT_EQ(facts["nodes"], static_cast<double>(mesh.nodes.size())) << file;
      EXPECT_EQ(facts["tets"], static_cast<double>(mesh.elements.size())) << file;
      // Integrated by meshio's own order of nodes.
      EXPECT_NEAR(facts["volume"], volume_of(mesh), 1e-11) << file;
      EXPECT_GT(facts["smallest"], 0) << file;
      if (format->name == "inp") {
        EXPECT_EQ(facts["set warp1_Start"], static_cast<double>(mesh.regions[0].start_nodes.size()));
        EXPECT_EQ(facts["set weft__2__--__b__End"], static_cast<double>(mesh.regions[1].end_nodes.size()));
      }
      if (format->name == "msh") {
        EXPECT_EQ(facts["triangles"], static_cast<double>(triangles_of(mesh)));
        EXPECT_EQ(facts["group warp1"], 3);
        EXPECT_EQ(facts["group warp1_start"], 2);
      }
      if (format->name == "vtu") {
        EXPECT_NEAR(facts["along_x"], 1, 1e-12);
        EXPECT_NEAR(facts["along_across"], 0, 1e-12);
        EXPECT_EQ(facts["yarns"], 2);
        EXPECT_NEAR(facts["jacobian"], mesh.quality.min_scaled_jacobian, 1e-6);
      }
    }
  }
}

// Counts by Gmsh's element types in a file that gmsh itself wrote after reading ours.
std::map<int, std::size_t> types_after_gmsh(const Folder& folder, const std::string& file) {
  run(folder, places::gmsh() + " " + file + " -save -format msh22 -o again.msh");
  std::istringstream lines(test::text_of(folder / "again.msh"));
  std::map<int, std::size_t> types;
  std::string line;
  while (std::getline(lines, line) && line != "$Elements") {
  }
  std::getline(lines, line);  // their number
  int number = 0, type = 0;
  while (std::getline(lines, line) && std::istringstream(line) >> number >> type) ++types[type];
  return types;
}

// The number behind `words` in a program's output.
double number_after(const std::string& output, const std::string& words) {
  const std::size_t at = output.find(words);
  EXPECT_NE(at, std::string::npos) << output;
  return at == std::string::npos ? 0 : std::strtod(output.c_str() + at + words.size(), nullptr);
}

TEST(MeshReaders, GmshReadsBothOrders) {
  for (const int order : {1, 2}) {
    const fem::Mesh mesh = two_yarns(order);
    const Folder folder;
    save(mesh, formats::msh::descriptor(), folder / "mesh.msh");
    std::map<int, std::size_t> types = types_after_gmsh(folder, "mesh.msh");
    EXPECT_EQ(types[order == 1 ? 4 : 11], mesh.elements.size());
    EXPECT_EQ(types[order == 1 ? 2 : 9], triangles_of(mesh));
    EXPECT_EQ(types.size(), 2U);
    std::ofstream(folder / "measure.geo") << "Merge \"mesh.msh\";\n"
                                             "Plugin(MeshVolume).Dimension = 3;\n"
                                             "Plugin(MeshVolume).PhysicalGroup = 2;\n"
                                             "Plugin(MeshVolume).Run;\n"
                                             "Plugin(AnalyseMeshQuality).JacobianDeterminant = 1;\n"
                                             "Plugin(AnalyseMeshQuality).Run;\n";
    const std::string words = run(folder, places::gmsh() + " measure.geo - -v 4");
    // Gmsh's volume is that of the corners.
    double corners = 0;
    for (std::size_t e = mesh.regions[1].first_element; e < mesh.regions[1].last_element; ++e) {
      const auto& element = mesh.elements[e];
      const Vec3& p = mesh.nodes[element[0]];
      corners +=
          (mesh.nodes[element[1]] - p).cross(mesh.nodes[element[2]] - p).dot(mesh.nodes[element[3]] - p) / 6;
    }
    EXPECT_NEAR(number_after(words, "(physical 2 | dimension 3): "), corners, 1e-5 * corners);
    // Exchanged midside nodes would fold elements.
    EXPECT_GT(number_after(words, "minJ      = "), 0) << words;
  }
}

TEST(MeshReaders, PhysicalGroupsOfGmsh) {
  const fem::Mesh mesh = two_yarns(1);
  const Folder folder;
  save(mesh, formats::msh::descriptor(), folder / "mesh.msh");
  run(folder, places::gmsh() + " mesh.msh -save -format msh22 -o again.msh");
  const std::string again = test::text_of(folder / "again.msh");
  for (const char* name : {"2 1 \"warp1_side\"", "2 2 \"warp1_start\"", "2 3 \"warp1_end\"", "3 1 \"warp1\""})
    EXPECT_NE(again.find(name), std::string::npos) << name;
}

TEST(MeshReaders, SameMeshSameBytes) {
  const fem::Mesh one = two_yarns(2), two = two_yarns(2);
  for (const formats::Descriptor* format :
       {&formats::inp::descriptor(), &formats::msh::descriptor(), &formats::vtu::descriptor()}) {
    Result<OutputFile> a = OutputFile::in_memory(), b = OutputFile::in_memory();
    ASSERT_TRUE(format->write_mesh(one, *a, {}).ok());
    ASSERT_TRUE(format->write_mesh(two, *b, {}).ok());
    EXPECT_EQ(*a->contents(), *b->contents()) << format->name;
    EXPECT_TRUE(format->sniff != nullptr && format->sniff(a->contents()->substr(0, 4096)));
  }
}

}  // namespace
}  // namespace selvage
