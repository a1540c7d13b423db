// STEP files in gmsh, as they are (no sewing): it must find every yarn as a volume of the right size and fill
// it.
#include <gtest/gtest.h>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "bodies.h"
#include "formats/registry.h"
#include "places.h"
#include "unit/core/scratch_folder.h"

namespace selvage {
namespace {

using yarn::EndStyle;
namespace fs = std::filesystem;

// gmsh exits with 0 even when it made no tetrahedron: so its results are read, not its exit code.
struct Volume {
  double cad = 0;  // of the B-rep, mm^3; gmsh takes OpenCASCADE's default quadrature, which is off by 1e-3 or
                   // so where a yarn has few sections
  double mesh = 0;  // of its tetrahedra, mm^3
  int tetrahedra = 0;
};

class Gmsh : public ::testing::Test {
 protected:
  void write(const std::vector<yarn::Body>& bodies, Unit unit = Unit::mm) const {
    Result<OutputFile> output = OutputFile::create(folder_ / "fabric.stp");
    ASSERT_TRUE(output.ok());
    formats::SurfaceOptions options;
    options.units = unit;
    auto writer = formats::step::descriptor().open_bodies(*output, options);
    ASSERT_TRUE(writer.ok()) << to_string(writer.error());
    for (const yarn::Body& body : bodies) {
      Status added = (*writer)->add(body);
      ASSERT_TRUE(added.ok()) << to_string(added.error());
    }
    ASSERT_TRUE((*writer)->finish().ok());
    ASSERT_TRUE(output->commit().ok());
  }

  void run(const std::string& arguments, const std::string& log) const {
    const std::string command =
        "cd '" + folder_.string() + "' && '" + places::gmsh() + "' " + arguments + " > " + log + " 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << arguments;
  }

  // By gmsh's number of the volume: 1, 2, .. in the file's order.
  std::map<int, Volume> mesh(double size) const {
    std::map<int, Volume> volumes;
    std::ofstream(folder_ / "mass.geo") << "SetFactory(\"OpenCASCADE\");\n"
                                           "v() = ShapeFromFile(\"fabric.stp\");\n"
                                           "w() = Volume{:};\n"
                                           "For i In {0:#w()-1}\n"
                                           "  m() = Mass Volume{w(i)};\n"
                                           "  Printf(\"%g %.16g\", w(i), m(0)) >> \"mass.txt\";\n"
                                           "EndFor\n";
    fs::remove(folder_ / "mass.txt");  // it is appended to
    run("mass.geo -parse_and_exit", "mass.log");
    std::ifstream masses(folder_ / "mass.txt");
    int number = 0;
    double mass = 0;
    while (masses >> number >> mass) volumes[number].cad = mass;
    run("fabric.stp -3 -format msh2 -save_all -clmax " + std::to_string(size) + " -o fabric.msh", "mesh.log");
    read_mesh(volumes);
    return volumes;
  }

  void read_mesh(std::map<int, Volume>& volumes) const {
    std::ifstream file(folder_ / "fabric.msh");
    std::map<int, Vec3> nodes;
    std::string line;
    int count = 0;
    while (std::getline(file, line)) {
      if (line == "$Nodes") {
        for (file >> count; count > 0; --count) {
          int number = 0;
          Vec3 p;
          file >> number >> p.x() >> p.y() >> p.z();
          nodes[number] = p;
        }
      } else if (line == "$Elements") {
        file >> count;
        std::getline(file, line);
        for (; count > 0 && std::getline(file, line); --count) {
          std::istringstream words(line);
          int number = 0, type = 0, tags = 0, physical = 0, volume = 0, n[4];
          words >> number >> type >> tags >> physical >> volume;
          if (type != 4) continue;
          for (int skip = 2; skip < tags; ++skip) words >> number;
          for (int& node : n) words >> node;
          const Vec3 a = nodes.at(n[0]);
          Volume& filled = volumes[volume];
          filled.mesh += (nodes.at(n[1]) - a).cross(nodes.at(n[2]) - a).dot(nodes.at(n[3]) - a) / 6;
          ++filled.tetrahedra;
        }
      }
    }
  }

  const test::ScratchFolder scratch_;
  const fs::path& folder_ = scratch_.path();
};

TEST_F(Gmsh, EveryYarnIsFilled) {
  for (EndStyle style : {EndStyle::patch, EndStyle::planar, EndStyle::fan}) {
    const std::vector<yarn::Body> bodies = {tests::wave("first", style),
                                            tests::wave("second", style, 1.0, {3, 0, 0}),
                                            tests::wave("small", style, 0.5, {6, 0, 0})};
    write(bodies);
    const std::map<int, Volume> volumes = mesh(0.15);
    ASSERT_EQ(volumes.size(), bodies.size()) << name_of(style);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Volume& volume = volumes.at(static_cast<int>(i) + 1);
      EXPECT_NEAR(volume.cad / bodies[i].volume, 1.0, 1e-3) << bodies[i].name << " " << name_of(style);
      EXPECT_GT(volume.tetrahedra, 0) << bodies[i].name << " " << name_of(style);
      EXPECT_NEAR(volume.mesh / bodies[i].volume, 1.0, 0.2) << bodies[i].name << " " << name_of(style);
    }
  }
}

TEST_F(Gmsh, EveryUnit) {
  for (Unit unit : all_units) {
    const double millimetres = millimetres_per(unit);
    const yarn::Body body = tests::wave("yarn", EndStyle::patch, 1.0 / millimetres);
    write({body}, unit);
    const std::map<int, Volume> volumes = mesh(0.3);
    ASSERT_EQ(volumes.size(), 1U) << name_of(unit);
    EXPECT_NEAR(volumes.at(1).cad / (body.volume * std::pow(millimetres, 3)), 1.0, 1e-3) << name_of(unit);
    EXPECT_GT(volumes.at(1).tetrahedra, 0) << name_of(unit);
  }
}

TEST_F(Gmsh, RingIsFilled) {
  const yarn::Body body = tests::ring("ring", 1.0, 5.0);
  write({body});
  const std::map<int, Volume> volumes = mesh(0.4);
  ASSERT_EQ(volumes.size(), 1U);
  EXPECT_NEAR(volumes.at(1).cad / body.volume, 1.0, 1e-3);
  EXPECT_NEAR(volumes.at(1).mesh / body.volume, 1.0, 0.1);
  EXPECT_GT(volumes.at(1).tetrahedra, 0);
}

// Flat facets on a curved surface miss a share of the volume that falls with the square of their size.
TEST_F(Gmsh, MeshVolumeConvergesToOurs) {
  const yarn::Body body = tests::wave("yarn", EndStyle::patch);
  write({body});
  const double coarse = 0.16;
  std::vector<double> errors;
  for (double size : {coarse, coarse / 2, coarse / 4})
    errors.push_back(std::abs(mesh(size).at(1).mesh / body.volume - 1.0));
  EXPECT_LT(errors[2], 5e-3);
  EXPECT_GT(std::log2(errors[0] / errors[2]) / 2, 1.8) << errors[0] << " " << errors[1] << " " << errors[2];
}

}  // namespace
}  // namespace selvage
