// The stiffness of unit cells by CalculiX and scripts/homogenize, against what is known of it.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "built.h"
#include "cell_problem/complete_cell.h"
#include "fem/faces.h"
#include "formats/mesh/programs.h"
#include "formats/registry.h"
#include "places.h"
#include "structured/voxel.h"
#include "tetrahedra/cell_mesher.h"

namespace selvage {
namespace {

using Json = nlohmann::json;

struct Wanted {
  double size = 0;
  int order = 1;
  int voxels = 0;  // 0: tetrahedra
};

// A straight elliptical yarn along x through a cell of 1 x 1 x 0.7, or a fibre in a square.
std::string cell_text(const std::string& yarn_elastic, const std::string& periodic,
                      const std::string& section = "ellipse 0.8 0.5",
                      const std::string& path = "-0.5 0.5 0.35\n 1.5 0.5 0.35",
                      const std::string& cell = "0 0 0  1 1 0.7",
                      const std::string& matrix_elastic = "isotropic 3400 0.35") {
  return "fabric 1\ntolerance 0.0002\nmaterial tow\n elastic " + yarn_elastic +
         "\n expansion 60e-6 60e-6\nend\nmaterial resin\n elastic " + matrix_elastic +
         "\n expansion 60e-6 60e-6\nend\nthread T\n section " + section +
         "\n material tow\nend\nyarn tow T\n path\n " + path + "\n end\nend\ncell " + cell +
         "\n matrix resin\n periodic " + periodic + "\nend\n";
}

fem::Mesh cell_mesh(const std::string& text, const Wanted& wanted) {
  Diagnostics diagnostics;
  const std::optional<fabric::Fabric> fabric =
      formats::txt::descriptor().read_fabric(Source::from_memory(text, "cell.txt"), diagnostics);
  EXPECT_TRUE(fabric.has_value());
  if (!fabric) return {};
  const std::vector<yarn::Body> bodies = test::built(*fabric);
  const std::array<bool, 3> periodic = fabric->cell->periodic;
  fem::CellMeshOptions options{{.size = wanted.size, .order = wanted.order}};
  options.periodic = periodic;
  Result<fem::Mesh> mesh =
      wanted.voxels > 0
          ? fem::mesh_voxels(*fabric, bodies, {.count = wanted.voxels, .periodic = periodic}, diagnostics)
          : fem::mesh_cell(*fabric, bodies, options, diagnostics);
  EXPECT_TRUE(mesh.ok()) << to_string(mesh.error());
  return mesh.ok() ? std::move(*mesh) : fem::Mesh{};
}

std::string run_script(const test::Folder& folder, const std::string& arguments) {
  return test::run(folder, places::system_python() + " " + places::scripts() + "/homogenize.py " + arguments);
}

Json homogenized(const fem::Mesh& mesh, const std::string& solver = "direct") {
  const test::Folder folder;
  test::save(mesh, formats::inp::descriptor(), folder / "cell.inp");
  const std::string words = run_script(folder, "cell.inp --bounds --json - --solver " + solver);
  Json result = Json::parse(words, nullptr, false);
  EXPECT_FALSE(result.is_discarded()) << words;
  if (result.is_discarded()) return Json::object();
  EXPECT_TRUE(result["warnings"].empty()) << result["warnings"];
  EXPECT_LT(result["asymmetry"].get<double>(), 1e-5);
  return result;
}

double number(const Json& result, const std::string& group, const std::string& name) {
  return result[group][name].get<double>();
}

Eigen::MatrixXd stiffness(const Json& result) {
  Eigen::MatrixXd matrix(6, 6);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      matrix(i, j) = result["stiffness"][static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return matrix;
}

double yarn_share(const fem::Mesh& mesh) {
  double yarns = 0, all = 0;
  for (const fem::Region& region : mesh.regions) {
    all += region.volume;
    if (region.kind == fem::Region::Kind::yarn) yarns += region.volume;
  }
  return yarns / all;
}

// E = 3400, nu = 0.35: an isotropic stiffness in the order xx yy zz xy xz yz.
Eigen::MatrixXd resin() {
  const double e = 3400, nu = 0.35, g = e / (2 * (1 + nu)), lame = e * nu / ((1 + nu) * (1 - 2 * nu));
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(6, 6);
  matrix.topLeftCorner(3, 3).setConstant(lame);
  for (int i = 0; i < 3; ++i) {
    matrix(i, i) += 2 * g;
    matrix(i + 3, i + 3) = g;
  }
  return matrix;
}

TEST(Homogenize, OneMaterialEverywhereComesBack) {
  const std::string text = cell_text("isotropic 3400 0.35", "x y z");
  for (const Wanted& wanted : {Wanted{.size = 0.3}, Wanted{.size = 0.3, .order = 2}, Wanted{.voxels = 10}}) {
    const fem::Mesh mesh = cell_mesh(text, wanted);
    const Json result = homogenized(mesh);
    EXPECT_LT((stiffness(result) - resin()).cwiseAbs().maxCoeff(), 1e-6 * resin().maxCoeff());
    for (const char* name : {"alpha_xx", "alpha_yy", "alpha_zz"})
      EXPECT_NEAR(number(result, "expansion", name), 60e-6, 60e-6 * 2e-6);
  }
}

// Bending is a quadratic displacement: with straight edges ten-node tetrahedra hold it exactly if, and only
// if, their midside nodes stand in the right order.
TEST(Homogenize, TenNodesHoldAPlatesBendingExactly) {
  fem::Mesh mesh = cell_mesh(cell_text("isotropic 3400 0.35", "x y"), {.size = 0.4, .order = 2});
  for (const auto& element : mesh.elements)
    for (std::size_t k = 0; k < 6; ++k)
      mesh.nodes[element[4 + k]] =
          (mesh.nodes[element[fem::edge_ends[k][0]]] + mesh.nodes[element[fem::edge_ends[k][1]]]) / 2;
  const Status again =  // the conditions are those of the places
      fem::complete_cell(mesh, Box3(mesh.cell->low, mesh.cell->high), {true, true, false});
  ASSERT_TRUE(again.ok());
  const Json result = homogenized(mesh);
  EXPECT_EQ(result["kind"], "plate");
  const double e = 3400, nu = 0.35, h = 0.7, q = e / (1 - nu * nu);
  Eigen::MatrixXd plane = Eigen::MatrixXd::Zero(3, 3);
  plane << q, nu * q, 0, nu * q, q, 0, 0, 0, e / (2 * (1 + nu));
  Eigen::MatrixXd exact = Eigen::MatrixXd::Zero(6, 6);
  exact.topLeftCorner(3, 3) = h * plane;
  exact.bottomRightCorner(3, 3) = h * h * h / 12 * plane;
  const Eigen::MatrixXd got = stiffness(result);
  EXPECT_LT((got - exact).topRows(3).cwiseAbs().maxCoeff(), 1e-6 * exact.maxCoeff());
  EXPECT_LT((got - exact).bottomRightCorner(3, 3).cwiseAbs().maxCoeff(),
            1e-6 * exact.bottomRightCorner(3, 3).maxCoeff());
}

TEST(Homogenize, AStraightYarnFollowsTheRuleOfMixtures) {
  const std::string text = cell_text("transverse 51500 17500 0.26 5800 0.31", "x y z");
  const double exact_share = std::acos(-1.0) / 4 * 0.8 * 0.5 / 0.7;
  for (const Wanted& wanted : {Wanted{.size = 0.1}, Wanted{.voxels = 20}}) {
    const fem::Mesh mesh = cell_mesh(text, wanted);
    const double share = yarn_share(mesh);
    EXPECT_NEAR(share, exact_share, 0.02);
    const Json result = homogenized(mesh);
    const double mixed = share * 51500 + (1 - share) * 3400;
    EXPECT_NEAR(number(result, "engineering", "E1"), mixed, 0.005 * mixed);
  }
}

TEST(Homogenize, ConjugateGradientsComeNear) {
  const fem::Mesh mesh =
      cell_mesh(cell_text("transverse 51500 17500 0.26 5800 0.31", "x y"), {.size = 0.4, .order = 2});
  const Json exact = homogenized(mesh), near = homogenized(mesh, "iterative");
  EXPECT_LT((stiffness(exact) - stiffness(near)).cwiseAbs().maxCoeff(), 1e-6 * stiffness(exact).maxCoeff());
  for (const char* name : {"alpha_xx", "alpha_yy"})
    EXPECT_NEAR(number(near, "expansion", name), number(exact, "expansion", name),
                1e-3 * number(exact, "expansion", name));
}

TEST(Homogenize, SaysWhatIsWrong) {
  const test::Folder folder;
  EXPECT_EQ(run_script(folder, "nothing.inp"), "homogenize: nothing.inp: no such file\n");
  std::ofstream(folder / "other.inp") << "*HEADING\nanother deck\n*NODE\n1, 0, 0, 0\n";
  EXPECT_NE(run_script(folder, "other.inp").find("no unit cell with load cases"), std::string::npos);
  fem::Mesh mesh = cell_mesh(cell_text("isotropic 3400 0.35", "x y z"), {.voxels = 4});
  test::save(mesh, formats::inp::descriptor(), folder / "cell.inp");
  EXPECT_NE(run_script(folder, "cell.inp --ccx no-such-program").find("no-such-program is not installed"),
            std::string::npos);
  mesh.nodes[mesh.elements[0][6]] = mesh.nodes[mesh.elements[0][0]];  // an element turned inside out
  test::save(mesh, formats::inp::descriptor(), folder / "cell.inp");
  EXPECT_NE(run_script(folder, "cell.inp").find("CalculiX stopped: "), std::string::npos);
}

// Boron in aluminium, 47 % in squares. Published: E2 = 144 GPa, G23 = 45.9 (C. T. Sun, R. S. Vaidya,
// Composites Science and Technology 56 (1996) 171-179); E1 = 214, E2 = 143, G12 = 54.2, G23 = 45.7,
// nu12 = 0.195 (Z. Xia, Y. Zhang, F. Ellyin, Int. J. Solids Structures 40 (2003) 1907-1921).
TEST(Homogenize, SquarePackedFibresAgreeWithPublishedValues) {
  const std::string text =
      cell_text("isotropic 379300 0.1", "x y z", "circle 0.14", "-0.1 0.0905 0.0905\n 0.15 0.0905 0.0905",
                "0 0 0  0.05 0.181 0.181", "isotropic 68300 0.3");
  const Json result = homogenized(cell_mesh(text, {.size = 0.03, .order = 2}));
  EXPECT_NEAR(number(result, "engineering", "E1"), 214e3, 0.02 * 214e3);
  for (const char* name : {"E2", "E3"})
    EXPECT_NEAR(number(result, "engineering", name), 143.5e3, 0.02 * 143e3);
  EXPECT_NEAR(number(result, "engineering", "G12"), 54.2e3, 0.02 * 54.2e3);
  EXPECT_NEAR(number(result, "engineering", "G23"), 45.7e3, 0.02 * 45.7e3);
  EXPECT_NEAR(number(result, "engineering", "nu12"), 0.195, 0.02 * 0.195);
}

// The root mean square error of the displacements that CalculiX finds inside when all faces follow the
// gradient of exp(a x) sin(b y) cos(c z), a^2 = b^2 + c^2: harmonic, so it is in equilibrium in any isotropic
// material.
double error_inside(fem::Mesh mesh) {
  mesh.equations.clear();
  mesh.drivers.clear();
  mesh.load_cases.clear();
  const auto exact = [](const Vec3& p) {
    const double b = 2, c = 1.5, a = std::sqrt(b * b + c * c), grows = std::exp(a * p.x());
    return Vec3(a * grows * std::sin(b * p.y()) * std::cos(c * p.z()),
                b * grows * std::cos(b * p.y()) * std::cos(c * p.z()),
                -c * grows * std::sin(b * p.y()) * std::sin(c * p.z()));
  };
  const test::Folder folder;
  test::save(mesh, formats::inp::descriptor(), folder / "smooth.inp");
  const fem::UnitCell& cell = *mesh.cell;
  std::ofstream deck(folder / "smooth.inp", std::ios::app);
  deck.precision(15);
  deck << "*STEP\n*STATIC\n*BOUNDARY\n";
  std::vector<bool> is_inside(mesh.nodes.size(), true);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Vec3& p = mesh.nodes[n];
    if ((p.array() > cell.low.array()).all() && (p.array() < cell.high.array()).all()) continue;
    is_inside[n] = false;
    const Vec3 u = exact(p);
    for (int i = 0; i < 3; ++i) deck << n + 1 << ", " << i + 1 << ", " << i + 1 << ", " << u[i] << '\n';
  }
  deck << "*NODE PRINT, NSET=AllNodes\nU\n*END STEP\n";
  deck.close();
  std::istringstream lines(test::solve_without_warning(folder, "smooth"));
  double sum = 0;
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream row(line);
    std::size_t number = 0;
    Vec3 u;
    if (!(row >> number >> u.x() >> u.y() >> u.z()) || number > is_inside.size() || !is_inside[number - 1])
      continue;
    sum += (u - exact(mesh.nodes[number - 1])).squaredNorm();
    ++count;
  }
  EXPECT_GT(count, 0U);
  return std::sqrt(sum / static_cast<double>(count));
}

// Displacements of quadratic elements err by the third power of their size.
TEST(Homogenize, TenNodesConvergeAsQuadraticElementsDo) {
  const std::string text = cell_text("isotropic 3400 0.35", "x y z");
  std::vector<double> steps, errors;
  for (const double size : {0.2, 0.14, 0.1}) {
    const fem::Mesh mesh = cell_mesh(text, {.size = size, .order = 2});
    // The mean size that was made counts, not the one that was asked for.
    steps.push_back(std::cbrt(0.7 / static_cast<double>(mesh.elements.size())));
    errors.push_back(error_inside(mesh));
  }
  const double order = std::log(errors.front() / errors.back()) / std::log(steps.front() / steps.back());
  EXPECT_NEAR(order, 3, 0.5) << errors[0] << ' ' << errors[1] << ' ' << errors[2] << " at " << steps[0] << ' '
                             << steps[1] << ' ' << steps[2];
  EXPECT_GT(errors[0], errors[1]);
  EXPECT_GT(errors[1], errors[2]);
}

}  // namespace
}  // namespace selvage
