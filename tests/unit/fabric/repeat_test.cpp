// The smallest repeats of constructions, and whether faces a repeat apart cut the yarns alike.
#include "fabric/repeat.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "construction/build.h"
#include "contact/contact.h"
#include "formats/registry.h"
#include "places.h"

namespace selvage::fabric {
namespace {

struct BuiltRepeat {
  Fabric fabric;
  std::optional<Repeat> repeat;
  std::vector<yarn::Body> bodies;
};

BuiltRepeat build(const Source& source, double gap = 0) {
  BuiltRepeat built;
  Diagnostics diagnostics;
  std::optional<Fabric> fabric = formats::txt::descriptor().read_fabric(source, diagnostics);
  EXPECT_TRUE(fabric.has_value());
  if (!fabric) return built;
  built.fabric = std::move(*fabric);
  BuildOptions options;
  options.gap = gap;
  const std::optional<YarnBuilder> builder = YarnBuilder::create(built.fabric, options, diagnostics);
  EXPECT_TRUE(builder.has_value());
  if (!builder) return built;
  built.repeat = builder->repeat();
  for (std::size_t i = 0; i < builder->count(); ++i) {
    Result<yarn::Body> body = builder->build(i);
    EXPECT_TRUE(body.ok());
    if (body) built.bodies.push_back(std::move(*body));
  }
  return built;
}

BuiltRepeat sample(const std::string& name, double gap = 0) {
  const Result<Source> source = Source::open(places::samples() + "/" + name);
  EXPECT_TRUE(source.ok()) << name;
  return source ? build(*source, gap) : BuiltRepeat{};
}

BuiltRepeat text(const std::string& statements) {
  return build(Source::from_memory(
      "fabric 1\nthread T\ndiameter 0.2\nend\nthread U\ndiameter 0.2\nend\n" + statements, "test.txt"));
}

std::string weave(const std::string& warp, const std::string& weft, const std::string& rest) {
  return "weave\nwarp " + warp + "\nweft " + weft + "\n" + rest + "\nend\n";
}

void expect_repeat(const BuiltRepeat& built, std::array<double, 3> wanted) {  // 0: none
  ASSERT_TRUE(built.repeat.has_value());
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ((*built.repeat)[k].has_value(), wanted[k] > 0) << k;
    EXPECT_NEAR((*built.repeat)[k].value_or(0), wanted[k], 1e-12 * wanted[k]) << k;
  }
}

TEST(Repeat, OfWeavesIsThatOfDraftsAndThreads) {
  expect_repeat(text(weave("T 4 pitch 0.7", "T 4 pitch 0.8", "draft plain")), {1.6, 1.4, 0});
  expect_repeat(text(weave("T 4 pitch 0.7", "T 4 pitch 0.7", "draft twill 3/1")), {2.8, 2.8, 0});
  expect_repeat(text(weave("T 5 pitch 1", "T 5 pitch 1", "draft satin 5/2")), {5, 5, 0});
  expect_repeat(text(weave("T 4 pitch 1", "T 4 pitch 1", "draft basket 2/2")), {4, 4, 0});
  // Three threads in turn over a draft of two; a thread named twice is one.
  expect_repeat(text(weave("T,U,U 6 pitch 1", "T,T 4 pitch 1", "draft plain")), {2, 6, 0});
  // A draft written twice over.
  expect_repeat(text(weave("T 4 pitch 1", "T 4 pitch 1", "draft\n1010\n0101\n1010\n0101\nend")), {2, 2, 0});
  const std::string straight = "profile straight\nlayers 2\n";
  expect_repeat(text(weave("T 6 pitch 1", "T 4 pitch 1",
                           straight + "binder U every 2 levels 3 0\nbinder U every 2 first 2 levels 0 3")),
                {2, 2, 0});
  expect_repeat(
      text(weave("T 6 pitch 1", "T 4 pitch 1",
                 straight + "binder U every 2 levels 3 3 0 0\nbinder U every 2 first 2 levels 3 3 0 0")),
      {4, 1, 0});
}

TEST(Repeat, OfKnitsIsThatOfChartsAndLappings) {
  // Loops are 4 diameters wide and 3.5 high.
  expect_repeat(text("knit jersey\nthread T\ncourses 2\nwales 2\nend\n"), {0.8, 0.7, 0});
  expect_repeat(text("knit rib 2x2\nthread T\ncourses 2\nwales 4\nend\n"), {3.2, 0.7, 0});
  expect_repeat(text("knit purl\nthread T\ncourses 2\nwales 2\nend\n"), {0.8, 1.4, 0});
  expect_repeat(text("warpknit tricot\nthread T\nwales 3 pitch 2\ncourses 3 pitch 1.5\nend\n"), {2, 3, 0});
  expect_repeat(text("warpknit\nbar T 1-0/1-2/1-0/1-2\nbar T 1-0/1-2/2-3/2-1\nwales 3 pitch 3\ncourses 3 "
                     "pitch 3\nend\n"),
                {3, 12, 0});
}

// The distance from a point to the nearest surface, from (0.3, v) on: Newton's method.
double distance_to(const std::vector<yarn::Body>& bodies, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const yarn::Body& body : bodies) {
    const nurbs::Surface& s = body.surface;
    constexpr int stations = 700;
    double u = 0.3, v = 0, nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= stations; ++k) {
      const double at = s.first_v() + (s.last_v() - s.first_v()) * k / stations;
      if (const double d = (nurbs::evaluate(s, u, at) - p).norm(); d < nearest) nearest = d, v = at;
    }
    for (int step = 0; step < 20; ++step) {
      const nurbs::SurfaceJet jet = nurbs::evaluate_jet(s, u, v);
      Eigen::Matrix<double, 3, 2> slopes;
      slopes << jet.du, jet.dv;
      const Vec2 move = (slopes.transpose() * slopes).ldlt().solve(slopes.transpose() * (p - jet.position));
      u = std::clamp(u + move.x(), s.first_u(), s.last_u());
      v = std::clamp(v + move.y(), s.first_v(), s.last_v());
    }
    least = std::min(least, (nurbs::evaluate(s, u, v) - p).norm());
  }
  return least;
}

// How far a surface is from itself a repeat further, where it passes the cell's low face across `axis`;
// relative to the repeat. Only yarns that run through the face: others have no counterpart in a single cell.
double misfit(const BuiltRepeat& built, int axis) {
  const Vec3 low = built.fabric.cell->low, high = built.fabric.cell->high;
  const double period = high[axis] - low[axis];
  double largest = -1;
  for (const yarn::Body& body : built.bodies) {
    const nurbs::Surface& s = body.surface;
    constexpr int stations = 1500;
    for (int k = 0; k <= stations; ++k) {
      Vec3 p = nurbs::evaluate(s, 0.3, s.first_v() + (s.last_v() - s.first_v()) * k / stations);
      if (std::abs(p[axis] - low[axis]) > 0.02 * period) continue;
      const int other = 1 - axis;
      if (p[other] < low[other] || p[other] > high[other]) continue;
      p[axis] += period;
      largest = std::max(largest, distance_to(built.bodies, p) / period);
    }
  }
  return largest;
}

TEST(Repeat, FacesOfACellCutItsYarnsAlike) {
  for (const char* name : {"cell_plain.txt", "twill_cell.txt", "cell_satin5.txt", "cell_orthogonal.txt",
                           "cell_jersey.txt", "cell_tricot.txt", "cell_glass.txt"})
    for (const int axis : {0, 1}) {
      const double off = misfit(sample(name), axis);
      EXPECT_GE(off, 0) << name << " has no yarn through the face";
      EXPECT_LE(off, 1e-9) << name << " across axis " << axis;
    }
}

TEST(Repeat, CellsOfTheSamplesAreOneRepeat) {
  for (const char* name : {"cell_plain.txt", "twill_cell.txt", "cell_satin5.txt", "cell_orthogonal.txt",
                           "cell_jersey.txt", "cell_tricot.txt", "cell_glass.txt"}) {
    const BuiltRepeat built = sample(name);
    const Vec3 size = built.fabric.cell->high - built.fabric.cell->low;
    expect_repeat(built, {size.x(), size.y(), 0});
    SCOPED_TRACE(name);
    const Box3 box(built.fabric.cell->low, built.fabric.cell->high);
    for (const int axis : {0, 1}) {
      EXPECT_FALSE(find_loose_end(built.bodies, box, axis, 1e-9 * size[axis]).has_value());
      // Half of it is none of theirs, but for straight yarns.
      Box3 half = box;
      half.max()[axis] -= 0.5 * size[axis];
      if (std::string(name) == "cell_orthogonal.txt") continue;
      EXPECT_TRUE(find_loose_end(built.bodies, half, axis, 1e-3 * size[axis]).has_value()) << axis;
    }
  }
}

TEST(Repeat, OfYarnsByHandIsFoundOnTheirCentreLines) {
  std::string waves;
  for (int yarn = 0; yarn < 8; ++yarn) {
    waves += "yarn wave" + std::to_string(yarn) + " T\npath\n";
    for (int k = 0; k <= 96; ++k)
      waves += std::to_string(0.125 * k) + " " + std::to_string(yarn * 0.75) + " " +
               std::to_string(0.3 * std::sin(2 * std::acos(-1.0) * k / 16 + std::acos(-1.0) * yarn)) + "\n";
    waves += "end\nend\n";
  }
  const BuiltRepeat built = text(waves);
  EXPECT_FALSE(built.repeat.has_value());
  const std::optional<double> along = repeat_of_lines(built.bodies, 0, 0.004);
  ASSERT_TRUE(along.has_value());
  EXPECT_NEAR(*along, 2.0, 0.01);
  const std::optional<double> beside = repeat_of_lines(built.bodies, 1, 0.004);
  ASSERT_TRUE(beside.has_value());
  EXPECT_NEAR(*beside, 1.5, 1e-6);
  // Straight yarns along x: any shift along it.
  const BuiltRepeat straight =
      text("yarn a T\npath\n0 0 0\n3 0 0\nend\nend\nyarn b T\npath\n0 1 0\n3 1 0\nend\nend\n");
  const std::optional<double> free = repeat_of_lines(straight.bodies, 0, 0.004);
  ASSERT_TRUE(free.has_value());
  EXPECT_EQ(*free, 0.0);
}

TEST(Gap, IsKeptByAllConstructionsOfCells) {
  // 5 % of the thinnest yarn.
  const std::pair<const char*, double> cells[] = {{"cell_plain.txt", 0.015},  {"twill_cell.txt", 0.007},
                                                  {"cell_satin5.txt", 0.015}, {"cell_orthogonal.txt", 0.01},
                                                  {"cell_jersey.txt", 0.01},  {"cell_tricot.txt", 0.005}};
  for (const auto& [name, gap] : cells) {
    const BuiltRepeat built = sample(name, gap);
    contact::ContactOptions options;
    options.reach = gap;
    const Result<contact::Contacts> found = contact::find_contacts(built.bodies, options);
    ASSERT_TRUE(found.ok());
    const Vec3 low = built.fabric.cell->low, high = built.fabric.cell->high;
    const double margin = 0.5 * (high - low).maxCoeff();
    for (const contact::Contact& contact : found->list) {
      bool near_cell = true;
      for (int k = 0; k < 2; ++k)
        near_cell = near_cell && contact.at[k] > low[k] - margin && contact.at[k] < high[k] + margin;
      EXPECT_TRUE(!near_cell || contact.gap >= gap) << name << " at " << contact.at.transpose();
    }
    // The cell holds them: its top and bottom are beyond all yarns.
    for (const yarn::Body& body : built.bodies)
      for (int k = 0; k <= 600; ++k)
        for (int i = 0; i < 24; ++i) {
          const nurbs::Surface& s = body.surface;
          const Vec3 p = nurbs::evaluate(s, s.first_u() + (s.last_u() - s.first_u()) * i / 24,
                                         s.first_v() + (s.last_v() - s.first_v()) * k / 600);
          if (p.x() < low.x() || p.x() > high.x() || p.y() < low.y() || p.y() > high.y()) continue;
          EXPECT_GT(p.z(), low.z()) << name;
          EXPECT_LT(p.z(), high.z()) << name;
        }
  }
}

// How many yarns along x have the low, and the high, face across y run along inside them.
std::array<std::size_t, 2> yarns_in_faces(const BuiltRepeat& built) {
  constexpr int axis = 1;
  const Box3 box(built.fabric.cell->low, built.fabric.cell->high);
  std::array<std::size_t, 2> counts{};
  for (const yarn::Body& body : built.bodies) {
    if (body.role == yarn::Role::weft) continue;
    Box3 inside;
    for (const double s : {0.3, 0.4, 0.5, 0.6}) {  // its sections in the middle of the cloth
      const double t = body.surface.first_v() + s * (body.surface.last_v() - body.surface.first_v());
      for (int i = 0; i < 64; ++i)
        inside.extend(nurbs::evaluate(
            body.surface, body.surface.first_u() + (body.surface.last_u() - body.surface.first_u()) * i / 64,
            t));
    }
    counts[0] += inside.min()[axis] < box.min()[axis] && inside.max()[axis] > box.min()[axis] ? 1 : 0;
    counts[1] += inside.min()[axis] < box.max()[axis] && inside.max()[axis] > box.max()[axis] ? 1 : 0;
  }
  return counts;
}

std::string binders_in_every_gap(const std::string& cell) {
  return "thread s\nsection racetrack 1.3 0.35\nend\nthread b\nsection ellipse 0.45 0.18\nend\n"
         "weave\nwarp s 4 pitch 2.1\nweft s 6 pitch 2.5\nprofile straight\nlayers 2\n"
         "binder b every 2 levels 0 1 2 3 2 1\nbinder b every 2 first 2 levels 3 2 1 0 1 2\nend\n"
         "cell " +
         cell + "\nperiodic x y\nend\n";
}

// Four warps have three gaps between them, and the fourth is the one at the cell's faces.
TEST(Repeat, YarnsInTheFacesOfAPeriodicCellAreThere) {
  const BuiltRepeat edge = text(binders_in_every_gap("0 0 -1.2  15 8.4 1.2"));
  EXPECT_EQ(yarns_in_faces(edge), (std::array<std::size_t, 2>{1, 1}));
  const BuiltRepeat inside = text(binders_in_every_gap("0 1.05 -1.2  15 9.45 1.2"));
  // Faces in the middle of warps, both layers.
  EXPECT_EQ(yarns_in_faces(inside), (std::array<std::size_t, 2>{2, 2}));
  // The same cloth: a cell's volume of binder is that of a cell shifted by half a pitch.
  const auto binder_volume = [](const BuiltRepeat& built) {
    const Box3 box(built.fabric.cell->low, built.fabric.cell->high);
    double volume = 0.0;
    for (const yarn::Body& body : built.bodies) {
      if (body.role != yarn::Role::binder) continue;
      const double across =
          nurbs::evaluate(body.axis, 0.5 * (body.axis.first_parameter() + body.axis.last_parameter())).y();
      const double half = 0.5 * 0.45, low = std::max(across - half, box.min().y()),
                   high = std::min(across + half, box.max().y());
      // Share of an ellipse between two lines across its width.
      const auto below = [&](double y) {
        const double x = std::clamp((y - across) / half, -1.0, 1.0);
        return 0.5 + (std::asin(x) + x * std::sqrt(1.0 - x * x)) / 3.14159265358979323846;
      };
      if (high > low) volume += (below(high) - below(low)) * body.volume / body.length;
    }
    return volume;
  };
  EXPECT_NEAR(binder_volume(edge), binder_volume(inside), 1e-9 * binder_volume(inside));
  // Names are those of one yarn each, and those in the cloth keep theirs.
  std::set<std::string> names;
  for (const yarn::Body& body : edge.bodies) EXPECT_TRUE(names.insert(body.name).second) << body.name;
  EXPECT_TRUE(names.contains("binder_3") && names.contains("binder_5"));
}

// Copies that are missing in a face itself are missed.
TEST(Repeat, AMissingCopyInAFaceIsFound) {
  const BuiltRepeat cloth = text(
      "yarn a T\npath\n0 1 0\n4 1 0\nend\nend\nyarn b T\npath\n0 2 0\n4 2 0\nend\nend\n"
      "yarn c T\npath\n0 3 0\n4 3 0\nend\nend\n");
  const double margin = 0.05;
  const Box3 box(Vec3(1, 1 - margin, -1), Vec3(2, 4 + margin, 1));
  const auto missing = find_missing_copy(cloth.bodies, box, 1, 1.0, 0.004);
  ASSERT_TRUE(missing.has_value());
  EXPECT_NEAR(missing->at.y(), 4.0, 1e-12);
  EXPECT_FALSE(
      find_missing_copy(cloth.bodies, Box3(Vec3(1, 1 - margin, -1), Vec3(2, 3 + margin, 1)), 1, 1.0, 0.004));
}

}  // namespace
}  // namespace selvage::fabric
