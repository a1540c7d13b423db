#include "tetrahedra/worker.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "core/module.h"
#include "core/sanitized.h"
#include "places.h"
#include "surface_mesh/skin.h"
#include "tetrahedra/mesh_check.h"
#include "unit/fem/bodies.h"

namespace selvage::fem {
namespace {

namespace fs = std::filesystem;

fs::path tetgen() {
  return find_worker("selvage-tetgen").value();
}

struct Surface {
  std::vector<Vec3> points;
  std::vector<Triangle> triangles;
  [[nodiscard]] TetgenJob job() const { return {.points = points, .triangles = triangles}; }
};

void add_cube(Surface& surface, const Vec3& low) {
  const auto first = static_cast<std::uint32_t>(surface.points.size());
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0), Vec3(0, 0, 1),
                        Vec3(1, 0, 1), Vec3(1, 1, 1), Vec3(0, 1, 1)})
    surface.points.push_back(low + p);
  for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 3, 2}, Triangle{4, 5, 6}, Triangle{4, 6, 7},
                            Triangle{0, 1, 5}, Triangle{0, 5, 4}, Triangle{1, 2, 6}, Triangle{1, 6, 5},
                            Triangle{2, 3, 7}, Triangle{2, 7, 6}, Triangle{3, 0, 4}, Triangle{3, 4, 7}})
    surface.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

Surface cube() {
  Surface surface;
  add_cube(surface, Vec3::Zero());
  return surface;
}

Surface tube() {
  const yarn::Body body = test::straight_tube(1, 1, 3);
  Result<Skin> skin = make_skin(body, 0.02);
  return {skin->nodes.points, skin->surface.triangles};
}

// A program of the test's own in the worker's place.
class Stand {
 public:
  explicit Stand(const std::string& script)
      : path_(fs::temp_directory_path() / fs::path("selvage-stand-XXXXXX")) {
    std::string name = path_.string();
    const int descriptor = ::mkstemp(name.data());
    path_ = name;
    const std::string text = "#!/bin/sh\n" + script + "\n";
    EXPECT_EQ(::write(descriptor, text.data(), text.size()), static_cast<ssize_t>(text.size()));
    ::fchmod(descriptor, 0700);
    ::close(descriptor);
  }
  ~Stand() { fs::remove(path_); }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// A library that goes on calling its own functions is found out before it meshes anything.
TEST(TetgenWorker, LibraryWhoseFunctionsAreNotReplacedIsRefused) {
  if (sanitized) GTEST_SKIP() << "the library takes its memory past the sanitizer there";
  const Surface surface = cube();
  const Result<TetMesh> mesh = run_tetgen(places::programs() + "/tetgen_unreplaced", surface.job(), {});
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().kind, Kind::internal);
  EXPECT_NE(mesh.error().text.find("does not take its random numbers from the worker"), std::string::npos)
      << mesh.error().text;
}

TEST(TetgenWorker, Cube) {
  const Surface surface = cube();
  Result<TetMesh> mesh = run_tetgen(tetgen(), surface.job(), {});
  ASSERT_TRUE(mesh.ok()) << mesh.error().text;
  double volume = 0;
  for (const auto& cell : mesh->cells) {
    const Vec3& p = mesh->points[cell[0]];
    const double six =
        (mesh->points[cell[1]] - p).cross(mesh->points[cell[2]] - p).dot(mesh->points[cell[3]] - p);
    EXPECT_GT(six, 0);
    volume += six / 6;
  }
  EXPECT_NEAR(volume, 1, 1e-14);
}

TEST(TetgenWorker, CrossingFacetsAreAnErrorWithAPlace) {
  Surface surface = cube();
  add_cube(surface, {0.5, 0.4, 0.3});
  const Result<TetMesh> mesh = run_tetgen(tetgen(), surface.job(), {});
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().kind, Kind::geometry);
  EXPECT_NE(mesh.error().text.find("cross"), std::string::npos);
  ASSERT_TRUE(mesh.error().at);
  EXPECT_TRUE(Box3(Vec3(0, 0, 0), Vec3(1.5, 1.4, 1.3)).contains(*mesh.error().at));
}

// As where a box cuts a yarn in two.
TEST(TetgenWorker, ARegionInTwoPieces) {
  Surface surface = cube();
  add_cube(surface, {3, 0, 0});
  const Result<TetMesh> mesh = run_tetgen(tetgen(), surface.job(), {});
  ASSERT_TRUE(mesh.ok()) << to_string(mesh.error());
  std::array<double, 2> volumes{};
  for (const auto& cell : mesh->cells) {
    const Vec3& p = mesh->points[cell[0]];
    const double volume =
        (mesh->points[cell[1]] - p).cross(mesh->points[cell[2]] - p).dot(mesh->points[cell[3]] - p) / 6;
    volumes[p.x() > 2 ? 1 : 0] += volume;
  }
  EXPECT_NEAR(volumes[0], 1, 1e-12);
  EXPECT_NEAR(volumes[1], 1, 1e-12);
  EXPECT_EQ(mesh->regions, std::vector<std::uint32_t>(mesh->cells.size(), 0));
}

TEST(TetgenWorker, BadSurfacesNeverReachTetgen) {
  const fs::path nobody = "/nonexistent";  // starting it would be another error
  Surface open = cube();
  open.triangles.pop_back();
  EXPECT_EQ(run_tetgen(nobody, open.job(), {}).error().kind, Kind::geometry);
  ASSERT_TRUE(run_tetgen(nobody, open.job(), {}).error().at);

  Surface turned = cube();
  std::swap(turned.triangles[3][0], turned.triangles[3][1]);
  EXPECT_EQ(run_tetgen(nobody, turned.job(), {}).error().kind, Kind::geometry);

  Surface inside_out = cube();
  for (Triangle& t : inside_out.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(run_tetgen(nobody, inside_out.job(), {}).error().kind, Kind::geometry);

  Surface not_a_number = cube();
  not_a_number.points[6].z() = std::nan("");
  EXPECT_EQ(run_tetgen(nobody, not_a_number.job(), {}).error().kind, Kind::geometry);

  Surface out_of_range = cube();
  out_of_range.triangles[0][0] = 99;
  EXPECT_EQ(run_tetgen(nobody, out_of_range.job(), {}).error().kind, Kind::internal);

  EXPECT_EQ(run_tetgen(nobody, cube().job(), {}).error().kind, Kind::internal);  // no program
}

TEST(TetgenWorker, TooLittleMemoryIsALimit) {
  if (sanitized) GTEST_SKIP() << "limits of memory are not held with sanitizers";
  Surface surface = tube();
  const Result<TetMesh> mesh = run_tetgen(tetgen(), surface.job(), {.timeout = 300, .memory = 50});
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().kind, Kind::limit);
  EXPECT_NE(mesh.error().text.find("--memory"), std::string::npos);
}

TEST(TetgenWorker, TooLittleTimeIsALimit) {
  Surface surface = tube();
  const Result<TetMesh> mesh = run_tetgen(tetgen(), surface.job(), {.timeout = 0.01, .memory = 8192});
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().kind, Kind::limit);
  EXPECT_NE(mesh.error().text.find("--timeout"), std::string::npos);
}

TEST(TetgenWorker, HangingWorkerAndItsChildrenAreKilled) {
  char name[] = "/tmp/selvage-child-XXXXXX";
  ::close(::mkstemp(name));
  const Stand hanging("sleep 1000 & echo $! > " + std::string(name) + "; wait");
  const Result<TetMesh> mesh = run_tetgen(hanging.path(), cube().job(), {.timeout = 1});
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().kind, Kind::limit);
  pid_t child = 0;
  std::ifstream(name) >> child;
  fs::remove(name);
  ASSERT_GT(child, 0);
  // Dead, perhaps not yet collected by init; the signal may need a moment to arrive.
  std::string state;
  for (int tries = 0; tries < 500; ++tries) {
    std::ifstream status("/proc/" + std::to_string(child) + "/stat");
    if (!(status >> state >> state >> state) || state == "Z" || state == "X") return;
    ::usleep(10'000);
  }
  FAIL() << "the worker's child lives on in state " << state;
}

TEST(TetgenWorker, ACrashIsAnError) {
  const Stand crashing("echo 'last words' >&2; kill -SEGV $$");
  const Result<TetMesh> mesh = run_tetgen(crashing.path(), cube().job(), {});
  ASSERT_FALSE(mesh.ok());
  EXPECT_EQ(mesh.error().kind, Kind::internal);
  EXPECT_NE(mesh.error().text.find("crashed"), std::string::npos);
  EXPECT_NE(mesh.error().text.find("last words"), std::string::npos);
}

TEST(TetgenWorker, GarbageIsAnError) {
  for (const char* script : {"exit 0", "exit 3", "echo garbage", "head -c 1000000 /dev/zero", "cat"}) {
    const Stand garbage(script);
    const Result<TetMesh> mesh = run_tetgen(garbage.path(), cube().job(), {});
    ASSERT_FALSE(mesh.ok()) << script;
    EXPECT_EQ(mesh.error().kind, Kind::internal) << script;
  }
}

// A pyramid over a square whose two diagonals part it in the surface and in the cells: between them is a flat
// cell, the sign of whose volume is rounding. Turned by itself it would show the same side as its neighbours.
TEST(TetgenWorker, AllCellsAreTurnedRoundOrNone) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, -1e-13}, {0.5, 0.5, 1}};
  const std::vector<Triangle> triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const std::vector<Sides> sides(triangles.size());
  const std::vector<std::array<std::uint32_t, 4>> cells = {{0, 1, 3, 4}, {1, 2, 3, 4}, {2, 0, 1, 3}};
  TetMesh mesh{.points = points, .cells = cells, .regions = {}};
  ASSERT_TRUE(find_regions(mesh, points, triangles, sides).ok());
  EXPECT_EQ(mesh.cells, cells);
  for (auto& cell : mesh.cells) std::swap(cell[2], cell[3]);
  ASSERT_TRUE(find_regions(mesh, points, triangles, sides).ok());
  EXPECT_EQ(mesh.cells, cells);
}

}  // namespace
}  // namespace selvage::fem
