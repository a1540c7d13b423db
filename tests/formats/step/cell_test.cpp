// Unit cells as STEP: OpenCASCADE finds valid solids, of which each yarn has the volume that is inside the
// cell and all fill it; gmsh meshes them conformally by samples/cell.geo.
#include <gtest/gtest.h>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <set>

#include "built.h"
#include "cell/cad_parts.h"
#include "cell/volume.h"
#include "core/source.h"
#include "formats/registry.h"
#include "nurbs/spline.h"
#include "places.h"
#include "reading.h"
#include "unit/core/scratch_folder.h"

namespace selvage {
namespace {

namespace fs = std::filesystem;

struct BuiltCell {
  Box3 box;
  std::vector<yarn::Body> bodies;
  cell::Cut cut;
  std::vector<double> inside;  // of each body
};

// A sample, or a text at an absolute path. With yarns so far apart, as a share of the thinnest section: the
// program's own default is 0.05.
BuiltCell build(const std::string& name, double gap = 0) {
  BuiltCell built;
  Diagnostics diagnostics;
  const fs::path path(name);
  Result<Source> source =
      Source::open(path.is_absolute() ? path : fs::path(places::samples()) / (name + ".txt"));
  EXPECT_TRUE(source.ok());
  const std::optional<fabric::Fabric> fabric = formats::txt::descriptor().read_fabric(*source, diagnostics);
  EXPECT_TRUE(fabric && fabric->cell) << name;
  built.box = Box3(fabric->cell->low, fabric->cell->high);
  fabric::BuildOptions options;
  options.gap = gap * fabric::smallest_section(*fabric).value_or(0);
  built.bodies = test::built(*fabric, options);
  Result<cell::Cut> cut = cell::cut(built.bodies, built.box, fabric::tolerance_of(*fabric, options));
  EXPECT_TRUE(cut.ok()) << to_string(cut.error());
  built.cut = std::move(*cut);
  const Result<cell::Division> division = cell::divide_faces(built.bodies, built.box, built.cut);
  EXPECT_TRUE(division.ok()) << to_string(division.error());
  built.inside = cell::volumes_inside(built.bodies, built.box, built.cut, *division);
  return built;
}

class StepFolder : public testing::Test {
 protected:
  std::vector<cad::Part> write(const BuiltCell& built) const {
    Result<std::vector<cad::Part>> parts =
        cell::cad_parts(built.bodies, built.box, built.cut,
                        {.matrix = true, .tolerance = 2e-8 * built.box.diagonal().norm()});
    EXPECT_TRUE(parts.ok()) << to_string(parts.error());
    Result<OutputFile> output = OutputFile::create(folder_ / "cell.stp");
    EXPECT_TRUE(output.ok());
    auto writer = formats::step::descriptor().open_bodies(*output, {});
    EXPECT_TRUE(writer.ok());
    for (const cad::Part& part : *parts) {
      Status added = (*writer)->add_part(part);
      EXPECT_TRUE(added.ok()) << to_string(added.error());
    }
    EXPECT_TRUE((*writer)->finish().ok());
    EXPECT_TRUE(output->commit().ok());
    return std::move(*parts);
  }

  const test::ScratchFolder scratch_;
  const fs::path& folder_ = scratch_.path();
};

class StepCell : public StepFolder, public testing::WithParamInterface<std::string> {};

class ValidSolids : public StepCell {};

TEST_P(ValidSolids, FillTheCell) {
  const BuiltCell built = build(GetParam());
  write(built);
  const tests::ReadFile file = tests::read_step((folder_ / "cell.stp").string(), true);
  ASSERT_TRUE(file.ok);
  double all = 0;
  std::map<std::string, double> by_name;
  for (const tests::ReadPart& part : file.parts) {
    EXPECT_TRUE(part.is_solid && part.valid) << part.name;
    EXPECT_EQ(part.free_edges, 0) << part.name;
    EXPECT_LE(part.tolerance, 1e-6) << part.name;
    all += part.volume;
    by_name[part.name.substr(0, part.name.find(".part"))] += part.volume;
  }
  EXPECT_NEAR(all / built.box.volume(), 1, 1e-6);
  std::size_t cut = 0;
  for (std::size_t i = 0; i < built.bodies.size(); ++i) {
    if (built.inside[i] == 0) continue;
    ++cut;
    // OpenCASCADE's adaptive quadrature of trimmed tubes is off by up to 5e-6 (0 to 1e-6 of whole ones).
    EXPECT_NEAR(by_name[built.bodies[i].name] / built.inside[i], 1, 1e-5) << built.bodies[i].name;
  }
  EXPECT_EQ(by_name.size(), cut + 1);
  EXPECT_EQ(by_name.count("matrix"), 1U);
}

INSTANTIATE_TEST_SUITE_P(, ValidSolids,
                         testing::Values("cell_plain", "twill_cell", "cell_satin5", "cell_orthogonal",
                                         "cell_jersey", "cell_tricot", "cell_straight", "cell_fibre",
                                         "cell_glass"));

// A yarn that touches no face of the box is a void of the matrix.
TEST_F(StepFolder, YarnInsideIsAVoidOfTheMatrix) {
  const fs::path text = folder_ / "within.txt";
  std::ofstream(text) << "fabric 1\ntolerance 0.00001\nthread r\n section circle 0.4\nend\nyarn y r\n path\n "
                         " 0.3 0.5 0.5\n  0.7 "
                         "0.5 0.5\n end\nend\ncell 0 0 0 1 1 1\nend\n";
  write(build(text.string()));
  const tests::ReadFile file = tests::read_step((folder_ / "cell.stp").string(), true);
  ASSERT_TRUE(file.ok);
  ASSERT_EQ(file.parts.size(), 2U);
  const double yarn = std::numbers::pi * 0.2 * 0.2 * 0.4;
  for (const auto& part : file.parts) {
    EXPECT_TRUE(part.valid) << part.name;
    EXPECT_NEAR(part.volume, part.name == "matrix" ? 1 - yarn : yarn, 1e-3 * yarn) << part.name;
  }
}

// Planes of all parts face out of the box.
class BoxFaces : public StepCell {};

TEST_P(BoxFaces, FaceOutwards) {
  const BuiltCell built = build(GetParam());
  std::size_t planes = 0;
  for (const cad::Part& part : write(built))
    for (const cad::Face& face : part.faces) {
      if (face.surface.degree_u != 1 || face.surface.degree_v != 1) continue;
      const nurbs::SurfaceJet jet =
          nurbs::evaluate_jet(face.surface, face.surface.first_u(), face.surface.first_v());
      const double out = jet.du.cross(jet.dv).dot(jet.position - built.box.center());
      EXPECT_GT(face.reversed ? -out : out, 0) << part.name;
      ++planes;
    }
  EXPECT_GE(planes, 8U);
}

INSTANTIATE_TEST_SUITE_P(, BoxFaces, testing::Values("cell_plain", "cell_straight"));

// The faces of the matrix on yarns are theirs, reversed.
class SharedFaces : public StepCell {};

TEST_P(SharedFaces, AreEqualToTheBit) {
  const std::vector<cad::Part> parts = write(build(GetParam()));
  ASSERT_EQ(parts.back().name, "matrix");
  std::map<std::set<int>, const cad::Face*> of_yarns;
  const auto edges_of = [](const cad::Face& face) {
    std::set<int> ids;
    for (const cad::Loop& loop : face.loops)
      for (const cad::Edge& edge : loop.edges) ids.insert(edge.id);
    return ids;
  };
  std::size_t curved = 0, shared = 0;
  for (const cad::Part& part : parts)
    for (const cad::Face& face : part.faces) {
      if (face.surface.degree_u == 1) continue;
      if (&part != &parts.back()) {
        of_yarns[edges_of(face)] = &face;
        ++curved;
        continue;
      }
      const auto twin = of_yarns.find(edges_of(face));
      ASSERT_NE(twin, of_yarns.end());
      EXPECT_EQ(twin->second->surface.points, face.surface.points);
      EXPECT_NE(twin->second->reversed, face.reversed);
      ++shared;
    }
  EXPECT_EQ(curved, shared);
  EXPECT_GT(curved, 0U);
}

INSTANTIATE_TEST_SUITE_P(, SharedFaces, testing::Values("cell_plain", "cell_jersey"));

// A mesh of gmsh.
struct Tetrahedra {
  std::vector<Vec3> nodes;
  std::vector<std::pair<int, std::array<int, 4>>> elements;  // with their volume
};

Tetrahedra read_mesh(const fs::path& path) {
  Tetrahedra mesh;
  std::ifstream in(path);
  std::map<long, int> node_of;
  std::string line;
  while (std::getline(in, line)) {
    std::size_t count = 0;
    if (line == "$Nodes" && in >> count)
      for (std::size_t i = 0; i < count; ++i) {
        long id = 0;
        Vec3 p;
        in >> id >> p.x() >> p.y() >> p.z();
        node_of[id] = static_cast<int>(mesh.nodes.size());
        mesh.nodes.push_back(p);
      }
    if (line == "$Elements" && in >> count)
      for (std::size_t i = 0; i < count; ++i) {
        long id = 0, type = 0, tags = 0, physical = 0, volume = 0;
        in >> id >> type >> tags >> physical >> volume;
        std::array<int, 4> corners{};
        const std::size_t corner_count = type == 4 ? 4 : type == 2 ? 3 : type == 1 ? 2 : 1;
        for (std::size_t k = 0; k < corner_count; ++k) {
          long node = 0;
          in >> node;
          corners[k] = node_of[node];
        }
        if (type == 4) mesh.elements.emplace_back(static_cast<int>(volume), corners);
      }
  }
  return mesh;
}

class GmshCell : public StepCell {
 protected:
  void fill(const std::string& options) const {
    fs::copy_file(fs::path(places::samples()) / "cell.geo", folder_ / "cell.geo",
                  fs::copy_options::overwrite_existing);
    const std::string command = "cd '" + folder_.string() + "' && timeout 1200 '" + places::gmsh() +
                                "' -save " + options + " cell.geo -format msh22 -o cell.msh > log 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0);
  }

  // Of each region, by gmsh's number: 1, 2, .. in the file's order.
  static std::map<int, double> volumes_of(const Tetrahedra& mesh) {
    std::map<int, double> volumes;
    for (const auto& element : mesh.elements) {
      const auto at = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(element.second[k])]; };
      volumes[element.first] += std::abs((at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0))) / 6;
    }
    return volumes;
  }

  static bool is_in_a_face(const Tetrahedra& mesh, const std::array<int, 3>& side, const Box3& box) {
    for (int face = 0; face < cell::face_count; ++face) {
      double most = 0;
      for (const int node : side)
        most = std::max(most, std::abs(mesh.nodes[static_cast<std::size_t>(node)][cell::axis_of(face)] -
                                       cell::plane_of(box, face)));
      if (most < 1e-6) return true;
    }
    return false;
  }

  // Every triangle has a tetrahedron on both sides, or lies in a face of the box.
  static void expect_conformal(const Tetrahedra& mesh, const Box3& box) {
    std::map<std::array<int, 3>, std::vector<int>> sides;
    for (const auto& [region, corners] : mesh.elements)
      for (std::size_t skip = 0; skip < 4; ++skip) {
        std::array<int, 3> side{};
        for (std::size_t k = 0, n = 0; k < 4; ++k)
          if (k != skip) side[n++] = corners[k];
        std::sort(side.begin(), side.end());
        sides[side].push_back(region);
      }
    std::size_t interface = 0, stray = 0;
    for (const auto& [side, regions] : sides) {
      ASSERT_LE(regions.size(), 2U);
      if (regions.size() == 2)
        interface += regions[0] != regions[1] ? 1 : 0;
      else
        stray += is_in_a_face(mesh, side, box) ? 0 : 1;
    }
    EXPECT_EQ(stray, 0U);
    EXPECT_GT(interface, 100U);
  }
};

// Edges so short that facets of neighbours do not cut each other; -clcurv: so many on a full turn.
const std::map<std::string, std::string> sizes = {{"cell_plain", "-clmax 0.3"},
                                                  {"twill_cell", "-clmax 0.2"},
                                                  {"cell_satin5", "-clmax 0.15"},
                                                  {"cell_orthogonal", "-clmax 0.3 -clcurv 12"},
                                                  {"cell_jersey", "-clmax 0.1 -clcurv 14"},
                                                  {"cell_tricot", "-clmax 0.1 -clcurv 12"},
                                                  {"cell_straight", "-clmax 0.1"},
                                                  {"cell_fibre", "-clmax 0.02"}};

TEST_P(GmshCell, IsMeshedConformally) {
  const BuiltCell built = build(GetParam(), 0.05);
  const std::vector<cad::Part> parts = write(built);
  for (const std::string options : {"", "-setnumber Mesh.RandomSeed 7"}) {
    if (!options.empty() && GetParam() != "cell_plain" && GetParam() != "cell_jersey") continue;
    fill(sizes.at(GetParam()) + " " + options);
    const Tetrahedra mesh = read_mesh(folder_ / "cell.msh");
    const std::map<int, double> volumes = volumes_of(mesh);
    ASSERT_EQ(volumes.size(), parts.size());
    std::map<std::string, double> by_name;
    double all = 0;
    for (const auto& [region, volume] : volumes) {
      const std::string& name = parts[static_cast<std::size_t>(region) - 1].name;
      by_name[name.substr(0, name.find(".part"))] += volume;
      all += volume;
    }
    EXPECT_NEAR(all / built.box.volume(), 1, 1e-9);
    // Facets cut off what is round: with some sixteen of them about a yarn 3 % of it, and a little more. The
    // matrix has what yarns lose, since all of it is the box.
    EXPECT_EQ(by_name.count("matrix"), 1U);
    for (std::size_t i = 0; i < built.bodies.size(); ++i)
      if (built.inside[i] > 0) {
        EXPECT_NEAR(by_name[built.bodies[i].name] / built.inside[i], 0.95, 0.05) << built.bodies[i].name;
      }
    expect_conformal(mesh, built.box);
  }
}

INSTANTIATE_TEST_SUITE_P(, GmshCell,
                         testing::Values("cell_plain", "twill_cell", "cell_satin5", "cell_orthogonal",
                                         "cell_jersey", "cell_tricot", "cell_straight", "cell_fibre"));

}  // namespace
}  // namespace selvage
