// What other people's programs make of our files: OpenCASCADE reads closed valid solids, gmsh meshes every
// yarn.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "formats/iges/bodies.h"
#include "formats/iges/files.h"
#include "formats/iges/occt_reader.h"
#include "places.h"

namespace selvage::test {
namespace {

using yarn::EndStyle;

// OpenCASCADE reads into millimetres.
void expect_solids(const OcctReading& reading, const std::vector<yarn::Body>& bodies, Unit units = Unit::mm) {
  EXPECT_EQ(reading.load_fails, 0);
  EXPECT_EQ(reading.load_warnings, 0);
  ASSERT_EQ(reading.solids.size(), bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    SCOPED_TRACE(bodies[i].name);
    const OcctSolid& solid = reading.solids[i];
    EXPECT_TRUE(solid.valid);
    EXPECT_TRUE(solid.closed);
    EXPECT_EQ(solid.free_edges, 0);
    const double volume = bodies[i].volume * std::pow(millimetres_per(units), 3);
    EXPECT_NEAR(solid.volume, volume, 1e-4 * volume);  // BRepGProp is no better than 2e-5 on some of them
    EXPECT_LE(solid.tolerance, 1e-4 * std::cbrt(volume));
  }
}

class Occt : public testing::TestWithParam<EndStyle> {};

TEST_P(Occt, SewsSurfacesToSolids) {
  const std::vector<yarn::Body> bodies = plain_weave(GetParam());
  const auto file = write_iges("surfaces.igs", bodies);
  for (const double sewing : {1e-6, 1e-4, 1e-3}) {
    SCOPED_TRACE(sewing);
    const OcctReading reading = read_with_occt(file, sewing);
    EXPECT_EQ(reading.roots, 4);
    EXPECT_EQ(reading.faces, 12);
    expect_solids(reading, bodies);
  }
}

TEST_P(Occt, ReadsSolidsAsTheyAre) {
  const std::vector<yarn::Body> bodies = plain_weave(GetParam());
  const OcctReading reading = read_with_occt(write_iges("solids.igs", bodies, solids()), 0);
  EXPECT_EQ(reading.roots, 4);
  EXPECT_EQ(reading.solids_in_file, 4);
  expect_solids(reading, bodies);
}

TEST_P(Occt, ReadsYarnsThatRunTheOtherWayRound) {
  const std::vector<yarn::Body> bodies = {wave("r", {.reversed = true}, GetParam())};
  expect_solids(read_with_occt(write_iges("reversed.igs", bodies), 1e-6), bodies);
  expect_solids(read_with_occt(write_iges("reversed-solid.igs", bodies, solids()), 0), bodies);
}

INSTANTIATE_TEST_SUITE_P(, Occt, testing::Values(EndStyle::patch, EndStyle::fan, EndStyle::planar),
                         [](const auto& chosen) { return std::string(yarn::name_of(chosen.param)); });

TEST(OcctReads, OpenTubes) {
  const OcctReading reading = read_with_occt(write_iges("open.igs", plain_weave(EndStyle::none)), 0);
  EXPECT_EQ(reading.load_fails + reading.load_warnings, 0);
  EXPECT_EQ(reading.faces, 4);
}

TEST(OcctReads, Rings) {
  const std::vector<yarn::Body> bodies = {ring("ring")};
  expect_solids(read_with_occt(write_iges("ring-solid.igs", bodies, solids()), 0), bodies);
  expect_solids(read_with_occt(write_iges("ring.igs", bodies), 1e-6), bodies);
}

TEST(OcctReads, RationalYarns) {
  for (const EndStyle ends : {EndStyle::patch, EndStyle::planar}) {
    const std::vector<yarn::Body> bodies = {wave("r", {.weight_step = 0.37}, ends)};
    expect_solids(read_with_occt(write_iges("rational.igs", bodies), 1e-6), bodies);
    expect_solids(read_with_occt(write_iges("rational-solid.igs", bodies, solids()), 0), bodies);
  }
}

// The same yarns in every unit: lengths, and the resolution that OpenCASCADE takes as its tolerance, must
// fit.
TEST(OcctReads, EveryUnit) {
  for (const Unit units : all_units) {
    SCOPED_TRACE(std::string(name_of(units)));
    const double scale = 1 / millimetres_per(units);
    const Wave shape{
        .length = 4 * scale, .width = 0.4 * scale, .height = 0.2 * scale, .amplitude = 0.15 * scale};
    const std::vector<yarn::Body> bodies = {wave("w", shape, EndStyle::patch)};
    expect_solids(read_with_occt(write_iges("units.igs", bodies, surfaces(units)), 1e-6), bodies, units);
    expect_solids(read_with_occt(write_iges("units-solid.igs", bodies, solids(units)), 0), bodies, units);
  }
}

TEST(OcctReads, Samples) {
  for (const char* name : {"plain4_grid.txt", "plain4_path.txt", "ring.txt"}) {
    SCOPED_TRACE(name);
    formats::SurfaceOptions options;
    const std::vector<yarn::Body> bodies = sample(name, EndStyle::patch, &options.units);
    expect_solids(read_with_occt(write_iges("sample.igs", bodies, options), 1e-6), bodies, options.units);
    options.yarns_are_solids = true;
    expect_solids(read_with_occt(write_iges("sample-solid.igs", bodies, options), 0), bodies, options.units);
  }
}

// Tetrahedra and their volume, by gmsh's number of the CAD volume.
struct Meshed {
  int tetrahedra = 0;
  double volume = 0;
};

std::map<int, Meshed> volumes_of(const std::filesystem::path& msh) {
  std::map<int, Meshed> volumes;
  std::map<int, Vec3> nodes;
  std::ifstream file(msh);
  std::string line;
  while (std::getline(file, line)) {
    int count = 0;
    if (line == "$Nodes") {
      file >> count;
      for (int i = 0, number = 0; i < count; ++i) {
        Vec3 p;
        file >> number >> p.x() >> p.y() >> p.z();
        nodes[number] = p;
      }
    } else if (line == "$Elements") {
      std::getline(file, line);
      for (count = std::stoi(line); count > 0 && std::getline(file, line); --count) {
        std::istringstream words(line);
        int number = 0, type = 0, tags = 0, physical = 0, entity = 0, tag = 0;
        words >> number >> type >> tags >> physical >> entity;
        for (int i = 2; i < tags; ++i) words >> tag;
        if (type != 4) continue;
        std::array<int, 4> n{};
        for (int& node : n) words >> node;
        const Vec3 a = nodes[n[0]];
        Meshed& volume = volumes[entity];
        ++volume.tetrahedra;
        volume.volume += std::abs((nodes[n[1]] - a).dot((nodes[n[2]] - a).cross(nodes[n[3]] - a))) / 6;
      }
    }
  }
  return volumes;
}

// Gmsh exits with 0 even when it made nothing, so the tetrahedra are counted, and their volume is that of the
// yarns: a mesh inside the curved surface, a few percent smaller at this size.
void expect_meshed(const std::filesystem::path& file, const std::vector<yarn::Body>& bodies, bool sew,
                   double size = 0.12, double scale = 1) {
  const std::filesystem::path msh = file.string() + ".msh";
  std::string command = places::gmsh() + " -3 -format msh2 -clmax " + std::to_string(size) + " " +
                        file.string() + " -o " + msh.string();
  if (sew) command += " -setnumber Geometry.OCCSewFaces 1 -setnumber Geometry.OCCMakeSolids 1";
  const Output output = run(command);
  const std::map<int, Meshed> volumes = volumes_of(msh);
  ASSERT_EQ(volumes.size(), bodies.size()) << output.text;
  std::size_t i = 0;
  for (const auto& [number, meshed] : volumes) {
    const double volume = bodies[i++].volume * scale;
    EXPECT_GT(meshed.tetrahedra, 0);
    EXPECT_LT(meshed.volume, 1.001 * volume);
    EXPECT_GT(meshed.volume, 0.9 * volume);
  }
}

class Gmsh : public testing::TestWithParam<EndStyle> {};

TEST_P(Gmsh, MeshesSolidsAsTheyAre) {
  const std::vector<yarn::Body> bodies = plain_weave(GetParam());
  expect_meshed(write_iges("solids.igs", bodies, solids()), bodies, false);
}

INSTANTIATE_TEST_SUITE_P(, Gmsh, testing::Values(EndStyle::patch, EndStyle::fan, EndStyle::planar),
                         [](const auto& chosen) { return std::string(yarn::name_of(chosen.param)); });

// A fan as a bare surface is known not to mesh: its pole is not an edge of anything.
class GmshSewing : public testing::TestWithParam<EndStyle> {};

TEST_P(GmshSewing, MeshesEveryYarn) {
  const std::vector<yarn::Body> bodies = plain_weave(GetParam());
  expect_meshed(write_iges("surfaces.igs", bodies), bodies, true);
  const std::vector<yarn::Body> reversed = {wave("a", {.reversed = true}, GetParam()),
                                            wave("b", {.y = 1, .reversed = true}, GetParam())};
  expect_meshed(write_iges("reversed.igs", reversed), reversed, true);
}

INSTANTIATE_TEST_SUITE_P(, GmshSewing, testing::Values(EndStyle::patch, EndStyle::planar),
                         [](const auto& chosen) { return std::string(yarn::name_of(chosen.param)); });

TEST(GmshMeshes, Samples) {
  for (const char* name : {"plain4_grid.txt", "plain4_path.txt"}) {
    SCOPED_TRACE(name);
    formats::SurfaceOptions options;
    const std::vector<yarn::Body> bodies = sample(name, EndStyle::patch, &options.units);
    expect_meshed(write_iges("sample.igs", bodies, options), bodies, true);
    options.yarns_are_solids = true;
    expect_meshed(write_iges("sample-solid.igs", bodies, options), bodies, false);
  }
}

TEST(GmshMeshes, Rings) {
  const std::vector<yarn::Body> bodies = sample("ring.txt", EndStyle::patch);
  expect_meshed(write_iges("ring-solid.igs", bodies, solids()), bodies, false, 0.25);
}

}  // namespace
}  // namespace selvage::test
