// The Abaqus deck, judged by CalculiX.
#include "formats/registry.h"

#include <cmath>

#include "cell_problem/contact_surfaces.h"
#include "construction/build.h"
#include "formats/inp/deck.h"
#include "formats/mesh/cell_mesh.h"
#include "formats/mesh/programs.h"
#include "places.h"

namespace selvage {
namespace {

using test::Folder;
using test::grid_body;
using test::mesh_of;
using test::run;
using test::save;
using test::solve;
using test::solve_without_warning;
using test::total_force;

fabric::Fabric fabric_with(const decltype(fabric::Material::elastic)& elastic) {
  fabric::Fabric fabric;
  fabric.title = "test";
  fabric.materials.resize(1);
  fabric.materials[0].name = "fibre 1";
  fabric.materials[0].density = 2.55;
  fabric.materials[0].elastic = elastic;
  fabric.materials[0].expansion = fabric::Expansion{5e-6, 9e-6};
  return fabric;
}

yarn::Body straight(const Vec3& direction, double length) {
  const Vec3 d = direction.normalized(), x = d.unitOrthogonal(), y = d.cross(x);
  yarn::Body body = grid_body("straight", 24, 6, [=](double a, double s) {
    return Vec3(Vec3(0.3, -0.2, 0.1) + length * s * d + 0.5 * (std::cos(a) * x + std::sin(a) * y));
  });
  body.material = "fibre 1";
  return body;
}

// A straight yarn that is free to contract: the force at the pulled end is E A / L times the displacement.
void expect_tension(const Vec3& direction, const decltype(fabric::Material::elastic)& elastic,
                    double modulus) {
  const double length = 5, displacement = 0.001 * length;
  for (const int order : {1, 2}) {
    const fem::Mesh mesh =
        mesh_of(fabric_with(elastic), {straight(direction, length)}, {.size = 0.25, .order = order});
    const Folder folder;
    save(mesh, formats::inp::descriptor(), folder / "tension.inp");
    const std::string dat = solve(folder, "tension");
    const double expected = modulus * mesh.regions[0].volume / length / length * displacement;
    const Vec3 force = total_force(dat, "STRAIGHT_END");
    EXPECT_NEAR(force.dot(direction.normalized()), expected, 1e-3 * expected) << "order " << order;
    EXPECT_LT((force - force.dot(direction.normalized()) * direction.normalized()).norm(), 1e-3 * expected);
    EXPECT_LT((force + total_force(dat, "STRAIGHT_START")).norm(), 1e-5 * expected);
  }
}

TEST(InpDeck, TensionIsModulusTimesStrain) {
  expect_tension({1, 0, 0}, fabric::IsotropicElastic{72400, 0.22}, 72400);
  expect_tension({0, 0, -1}, fabric::IsotropicElastic{72400, 0.22}, 72400);
}

// The modulus is the one along the yarn, wherever that points: orientation element by element.
TEST(InpDeck, TensionAlongATiltedOrthotropicYarn) {
  expect_tension({1, 1, 0.3}, fabric::TransverseElastic{230000, 15000, 0.2, 24000, 0.25}, 230000);
  expect_tension({0, 1, 0}, fabric::TransverseElastic{230000, 15000, 0.2, 24000, 0.25}, 230000);
}

// A displacement field of second order is exact in ten-node elements with straight edges, so CalculiX must
// find its very energy. With any two midside nodes exchanged it does not.
TEST(InpDeck, TenNodesAreInCalculixOrder) {
  yarn::GridNet net;
  const double length = 2, width = 1, height = 0.6;
  net.sections = 4;
  net.per_section = 4;
  net.degree_round = 1;
  for (int j = 0; j < 4; ++j)
    for (const Vec2& corner : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)})
      net.points.emplace_back(length * j / 3, width / 2 * corner.x(), height / 2 * corner.y());
  yarn::Body body;
  body.name = "bar";
  body.material = "fibre 1";
  ASSERT_TRUE(yarn::fill_from_grid(body, net).ok());
  ASSERT_TRUE(yarn::finish(body, yarn::EndStyle::planar).ok());
  const double modulus = 1000, nu = 0.25;
  const fem::Mesh mesh =
      mesh_of(fabric_with(fabric::IsotropicElastic{modulus, nu}), {body}, {.size = 0.3, .order = 2});
  ASSERT_NEAR(mesh.regions[0].volume, length * width * height, 1e-12);
  const Folder folder;
  save(mesh, formats::inp::descriptor(), folder / "bar.inp");
  std::string deck = test::text_of(folder / "bar.inp");
  deck.resize(deck.find("*STEP"));
  std::ofstream patch(folder / "patch.inp");
  patch << deck << "*STEP\n*STATIC\n*BOUNDARY\n";
  const double scale = 1e-3;
  patch.precision(15);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Vec3& p = mesh.nodes[i];
    const Vec3 u = scale * Vec3(p.x() * p.x(), p.x() * p.y(), p.y() * p.z());
    for (int k = 0; k < 3; ++k)
      patch << i + 1 << ", " << k + 1 << ", " << k + 1 << ", " << formats::inp::real(u[k]) << '\n';
  }
  patch << "*EL PRINT, ELSET=All, TOTALS=ONLY\nELSE\n*END STEP\n";
  patch.close();
  const std::string dat = solve(folder, "patch");
  const std::size_t at = dat.find("total internal energy");
  ASSERT_NE(at, std::string::npos) << dat;
  const double energy = std::stod(dat.substr(dat.find('\n', at)));
  // Strains 2x, x, y and shears y (xy), z (yz), times the scale; x from 0 to length, y and z about 0.
  const double lambda = modulus * nu / ((1 + nu) * (1 - 2 * nu)), mu = modulus / (2 * (1 + nu));
  const double xx = length * length / 3, yy = width * width / 12, zz = height * height / 12;
  const double trace = 9 * xx + yy, squares = 5 * xx + yy + (yy + zz) / 2;
  const double expected = scale * scale * length * width * height * (lambda / 2 * trace + mu * squares);
  EXPECT_NEAR(energy, expected, 1e-5 * expected);
}

TEST(InpDeck, RingRuns) {
  yarn::Body ring = grid_body(
      "ring", 16, 16,
      [](double a, double s) {
        const double r = 3 + 0.5 * std::cos(a), turn = 2 * std::numbers::pi * s;
        return Vec3(r * std::cos(turn), r * std::sin(turn), -0.5 * std::sin(a));
      },
      true);
  const fem::Mesh mesh = mesh_of({}, {ring}, {});
  const Folder folder;
  save(mesh, formats::inp::descriptor(), folder / "ring.inp");
  const std::string dat = solve(folder, "ring");
  const Vec3 low = total_force(dat, "RING_LOW"), high = total_force(dat, "RING_HIGH");
  EXPECT_GT(high.norm(), 0.1);
  EXPECT_LT((low + high).norm(), 1e-5 * high.norm());
}

std::vector<yarn::Body> bodies_of(const fabric::Fabric& fabric) {
  Diagnostics diagnostics;
  const auto builder = fabric::YarnBuilder::create(fabric, {}, diagnostics);
  std::vector<yarn::Body> bodies;
  for (std::size_t i = 0; builder && i < builder->count(); ++i) {
    Result<yarn::Body> body = builder->build(i);
    if (body) bodies.push_back(std::move(*body));
  }
  return bodies;
}

// Those of a cell share their nodes: nothing of one can be held alone. Nor is a ring of one point stretched
// for ever.
TEST(InpDeck, RegionsWithoutNodesOfTheirOwnGetNoLoad) {
  fem::Mesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 2, 2}, {2, 2, 2}};
  mesh.elements = {{0, 1, 2, 3}};
  mesh.regions.resize(2);
  mesh.regions[0].last_element = 1;
  EXPECT_TRUE(formats::inp::plan_loads(mesh, formats::inp::names_of(mesh)).empty());
  mesh.regions[1].name = "ring";
  mesh.regions[1].first_node = 4;
  mesh.regions[1].last_node = 6;
  const std::vector<formats::inp::Load> loads = formats::inp::plan_loads(mesh, formats::inp::names_of(mesh));
  ASSERT_EQ(loads.size(), 1U);
  EXPECT_EQ(loads[0].start_set, "ring_Low");
  EXPECT_EQ(loads[0].start, (std::vector<std::size_t>{4, 5}));
  EXPECT_EQ(loads[0].pull, 0.0);
}

TEST(InpDeck, PlainWeaveOfFourYarnsRuns) {
  for (const std::string name : {"plain4_grid", "plain4_path"})
    for (const int order : {1, 2}) {
      const Result<Source> source = Source::open(places::samples() + "/" + name + ".txt");
      ASSERT_TRUE(source.ok());
      Diagnostics diagnostics;
      const auto fabric = formats::txt::descriptor().read_fabric(*source, diagnostics);
      ASSERT_TRUE(fabric);
      const std::vector<yarn::Body> bodies = bodies_of(*fabric);
      ASSERT_EQ(bodies.size(), 4U);
      const fem::Mesh mesh = mesh_of(*fabric, bodies, {.size = 0.1, .order = order});
      const Folder folder;
      save(mesh, formats::inp::descriptor(), folder / "weave.inp");
      const std::string dat = solve(folder, "weave");
      for (std::size_t yarn = 0; yarn < 4; ++yarn) {
        std::string set = mesh.regions[yarn].name;  // which fits
        for (char& letter : set) letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
        const Vec3 start = total_force(dat, set + "_START"), end = total_force(dat, set + "_END");
        EXPECT_GT(end.norm(), 1e-3) << name << " yarn " << yarn;
        EXPECT_LT((start + end).norm(), 1e-4 * end.norm()) << name << " yarn " << yarn;
        // Crimp makes the yarn softer than a straight one, E A times the strain.
        const fem::Region& region = mesh.regions[yarn];
        EXPECT_LT(end.norm(), 10000 * 0.001 * region.volume / bodies[yarn].length);
      }
    }
}

// A homogeneous cell under each unit strain, and heated with all strains zero, has one stress everywhere:
// that of its material.
TEST(InpDeck, UnitCellHasTheStressOfItsMaterial) {
  const double modulus = 3400, nu = 0.35, expansion = 6e-5;
  const double lambda = modulus * nu / ((1 + nu) * (1 - 2 * nu)), mu = modulus / (2 * (1 + nu));
  for (fem::Mesh mesh : {test::brick_cell(), test::tetrahedra_cell(1), test::tetrahedra_cell(2)}) {
    mesh.regions[0].material = "resin";
    // Stresses are printed in the local axes.
    mesh.along.assign(mesh.elements.size(), Vec3::UnitX());
    mesh.across.assign(mesh.elements.size(), Vec3::UnitY());
    const Folder folder;
    save(mesh, formats::inp::descriptor(), folder / "cell.inp");
    test::ask_for_stresses(folder / "cell.inp");
    const auto stresses = test::stresses_by_step(solve_without_warning(folder, "cell"));
    ASSERT_EQ(stresses.size(), 7U);
    for (std::size_t load = 0; load < 7; ++load) {
      ASSERT_GE(stresses[load].size(), mesh.elements.size());
      for (const auto& stress : stresses[load])
        for (std::size_t k = 0; k < 6; ++k) {
          double expected = 0;
          if (load == 6) expected = k < 3 ? -(3 * lambda + 2 * mu) * expansion : 0;
          if (load < 6 && load == k) expected = k < 3 ? (lambda + 2 * mu) * 1e-3 : mu * 1e-3;
          if (load < 3 && k < 3 && load != k) expected = lambda * 1e-3;
          EXPECT_NEAR(stress[k], expected, 2e-6) << "load " << load << ", " << k;
        }
    }
  }
}

// Two bins of material in one region, orientations and expansion of a yarn: the deck runs without a warning.
TEST(InpDeck, UnitCellOfSeveralMaterialsRuns) {
  const fem::Mesh mesh = test::tetrahedra_cell(2, true);
  const Folder folder;
  save(mesh, formats::inp::descriptor(), folder / "cell.inp");
  test::ask_for_stresses(folder / "cell.inp");
  const auto stresses = test::stresses_by_step(solve_without_warning(folder, "cell"));
  ASSERT_EQ(stresses.size(), 7U);
  // In the yarn's first elements, along x as the strain: nearly E1 times it.
  const auto [low, high] = std::minmax_element(stresses[0].begin(), stresses[0].end());
  EXPECT_GT((*high)[0], 0.98 * 57.5);
  EXPECT_LT((*high)[0], 1.1 * 57.5 / 0.99);
  EXPECT_GT((*low)[0], 3.4);
}

// Two straight yarns one over the other, a twentieth of their diameter apart, and a third one far away:
// surfaces of all, one pair. The areas are those of the sides that look up, down and anywhere; with the marks
// taken away CalculiX runs the deck with contact, and the upper yarn does not change what it carries.
TEST(InpDeck, ContactSurfacesAndPairs) {
  const fem::Mesh mesh = test::mesh_of(fabric_with(fabric::IsotropicElastic{1000, 0.3}),
                                       {test::straight_tube(1, 1, 3, 24, Vec3::Zero(), "low"),
                                        test::straight_tube(1, 1, 3, 24, Vec3(0, 0, 1.05), "high"),
                                        test::straight_tube(1, 1, 3, 24, Vec3(0, 2, 0), "far")},
                                       {.size = 0.25, .order = 1});
  const fem::ContactSurfaces contact = fem::contact_surfaces(mesh);
  ASSERT_EQ(contact.surfaces.size(), 3U);
  EXPECT_EQ(contact.pairs, (std::vector<std::array<std::size_t, 2>>{{0, 1}}));
  for (std::size_t i = 0; i < 3; ++i) {
    const fem::ContactSurface& surface = contact.surfaces[i];
    EXPECT_EQ(surface.whole.size(), mesh.regions[i].side_faces.size());
    Vec3 whole = Vec3::Zero(), upper = Vec3::Zero(), lower = Vec3::Zero();
    for (const fem::OuterSide& side : surface.whole) whole += fem::area_vector(mesh, side.nodes);
    for (const fem::OuterSide& side : surface.upper) upper += fem::area_vector(mesh, side.nodes);
    for (const fem::OuterSide& side : surface.lower) lower += fem::area_vector(mesh, side.nodes);
    // With the ends it is closed.
    for (const auto* faces : {&mesh.regions[i].start_faces, &mesh.regions[i].end_faces})
      for (const auto& f : *faces)
        whole += (mesh.nodes[f[1]] - mesh.nodes[f[0]]).cross(mesh.nodes[f[2]] - mesh.nodes[f[0]]) / 2;
    EXPECT_LT(whole.norm(), 1e-12);
    // The shadow of the yarn: its diameter times its length.
    EXPECT_NEAR(upper.z(), 3.0, 0.1);
    EXPECT_NEAR(lower.z(), -3.0, 0.1);
  }
  const Folder folder;
  save(mesh, formats::inp::descriptor(), folder / "far.inp");
  run(folder, "sed 's/^\\*\\*~//' far.inp > contact.inp");
  const std::string alone = solve_without_warning(folder, "far"), touching = solve(folder, "contact");
  // Newton's iterations are in the .cvg, under the same head.
  EXPECT_GT(test::text_of(folder / "contact.cvg").size(), test::text_of(folder / "far.cvg").size());
  for (const char* set : {"HIGH_END", "FAR_END"})
    EXPECT_LT((total_force(alone, set) - total_force(touching, set)).norm(),
              1e-3 * total_force(alone, set).norm());
}

// CalculiX reads twenty characters of a number.
TEST(InpDeck, NumbersFitTwentyCharacters) {
  for (const double value : {0.1, -1.0 / 3, -1.2345678901234567e-5, -9.8765432109876543e-101, 6.02214076e23,
                             0.0, -0.00041234567890123456, 123456789.123456789}) {
    const std::string text = formats::inp::real(value);
    EXPECT_LE(text.size(), 20U) << text;
    EXPECT_NEAR(std::stod(text), value, 2e-13 * std::abs(value)) << text;
  }
  EXPECT_EQ(std::stod(formats::inp::real(0.1)), 0.1);
}

TEST(InpDeck, NamesAndRows) {
  fabric::Fabric fabric = fabric_with(fabric::IsotropicElastic{1000, 0.3});
  fabric.materials.push_back(fabric.materials[0]);
  fabric.materials[1].name = "Fibre-1";  // the same letters in a deck
  std::vector<yarn::Body> bodies = {straight({1, 0, 0}, 2), straight({1, 0, 0}, 2)};
  bodies[1].material = "Fibre-1";
  const fem::Mesh mesh = mesh_of(fabric, bodies, {.size = 0.3, .order = 2});
  const Folder folder;
  save(mesh, formats::inp::descriptor(), folder / "names.inp");
  std::istringstream deck(test::text_of(folder / "names.inp"));
  std::string line;
  std::size_t materials = 0, sections = 0;
  while (std::getline(deck, line)) {
    EXPECT_LE(std::count(line.begin(), line.end(), ','), 15) << line;
    EXPECT_LE(line.size(), 256U);
    if (line == "*MATERIAL, NAME=fibre_1" || line == "*MATERIAL, NAME=Fibre_1_2") ++materials;
    if (line.starts_with("*SOLID SECTION")) ++sections;
  }
  EXPECT_EQ(materials, 2U);
  EXPECT_EQ(sections, 2U);
}

}  // namespace
}  // namespace selvage
