// What somebody changed in solids that OpenCASCADE wrote (IGES 186), whose faces are planes with and without
// holes, cylinders, cones, spheres, tori, surfaces of extrusion and of revolution of lines and splines:
// `check` or `diff` sees it, and neither sees anything where nothing was changed. SELVAGE_MUTATIONS: how many
// a solid (60).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <random>

#include "cad/compare.h"
#include "cad/judge.h"
#include "core/findings.h"
#include "formats/iges/occt_solids.h"
#include "formats/iges/reading.h"
#include "nurbs/restrict.h"

namespace selvage::test {

namespace {

using cad::Face;
using cad::Part;
using Random = std::mt19937_64;

std::size_t any(Random& random, std::size_t count) {
  return random() % count;
}

double between(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
}

Vec3 direction(Random& random) {
  Vec3 made;
  do made = Vec3(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1));
  while (made.norm() < 0.1 || made.norm() > 1);
  return made.normalized();
}

// One mutation; false: this face has nothing that it could change.
bool move_boundary(Random& random, Face& face, double size) {
  std::vector<cad::Edge*> edges;
  for (cad::Loop& loop : face.loops)
    for (cad::Edge& edge : loop.edges)
      if (!edge.curve.points.empty()) edges.push_back(&edge);
  if (edges.empty()) return false;
  const Vec3 shift = 1e-3 * size * direction(random);
  // What the file says of an edge it may say twice.
  cad::Edge& edge = *edges[any(random, edges.size())];
  edge.flat = {};
  for (Vec3& p : edge.curve.points) p += shift;
  return true;
}

bool move_knot(Random& random, Face& face) {
  const bool in_u = any(random, 2) == 0;
  std::vector<double>& knots = in_u ? face.surface.knots_u : face.surface.knots_v;
  const std::vector<double> breaks =
      nurbs::breakpoints(knots, in_u ? face.surface.degree_u : face.surface.degree_v);
  if (breaks.size() < 3) return false;
  const std::size_t k = 1 + any(random, breaks.size() - 2);
  const double to =
      std::lerp(breaks[k], breaks[any(random, 2) == 0 ? k - 1 : k + 1], between(random, 0.2, 0.6));
  std::ranges::replace(knots, breaks[k], to);
  return true;
}

// The largest distance of places of `a` from `b`, each from the nearest point of a grid by a search with ever
// smaller steps.
double sampled_distance(const nurbs::Surface& a, const nurbs::Surface& b) {
  const auto shares = [](double first, double last, int count) {
    std::vector<double> all;
    for (int i = 0; i <= count; ++i) all.push_back(std::lerp(first, last, static_cast<double>(i) / count));
    return all;
  };
  constexpr int fine = 40;
  const std::vector<double> us = shares(b.first_u(), b.last_u(), fine),
                            vs = shares(b.first_v(), b.last_v(), fine);
  const std::vector<Vec3> grid = nurbs::evaluate_grid(b, us, vs);
  double largest = 0;
  for (const Vec3& p :
       nurbs::evaluate_grid(a, shares(a.first_u(), a.last_u(), 13), shares(a.first_v(), a.last_v(), 13))) {
    const auto nearest =
        std::ranges::min_element(grid, {}, [&](const Vec3& q) { return (q - p).squaredNorm(); });
    const auto index = static_cast<std::size_t>(nearest - grid.begin());
    double u = us[index % us.size()], v = vs[index / us.size()], least = (*nearest - p).norm();
    for (double step = 1.0 / fine; step > 1e-10;) {
      bool is_nearer = false;
      for (const Vec2& way : {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1)}) {
        const double next_u =
                         std::clamp(u + step * way.x() * (b.last_u() - b.first_u()), b.first_u(), b.last_u()),
                     next_v =
                         std::clamp(v + step * way.y() * (b.last_v() - b.first_v()), b.first_v(), b.last_v()),
                     distance = (nurbs::evaluate(b, next_u, next_v) - p).norm();
        if (!(distance < least)) continue;
        u = next_u;
        v = next_v;
        least = distance;
        is_nearer = true;
      }
      if (!is_nearer) step /= 2;
    }
    largest = std::max(largest, least);
  }
  return largest;
}

// The same faces, in the other order and each with a knot more.
cad::Model refined(cad::Model model) {
  for (Part& part : model.parts) {
    for (Face& face : part.faces)
      face.surface =
          nurbs::refined(face.surface, {std::lerp(face.surface.first_v(), face.surface.last_v(), 0.37)});
    std::ranges::reverse(part.faces);
  }
  return model;
}

struct Verdict {
  int defects = 0, warnings = 0;
  bool is_different = false;
  std::string text;
};

Verdict verdict(const cad::Model& before, const cad::Model& after, double tolerance) {
  Verdict made;
  Findings findings;
  cad::judge(after, findings);
  made.defects = findings.defects();
  made.warnings = findings.warnings();
  for (const Message& message : findings.messages())
    if (message.severity != Severity::note) made.text += message.text + "\n";
  cad::CompareOptions options;
  options.tolerance = tolerance;
  const cad::Comparison compared = cad::compare({before, 0}, {after, 0}, options);
  made.is_different = !compared.differences.empty();
  for (const cad::Difference& difference : compared.differences)
    made.text += fmt::format("{} {}\n", name_of(difference.kind), difference.reach.at_least);
  return made;
}

TEST(MutatedFaces, AreFound) {
  const char* const given = std::getenv("SELVAGE_MUTATIONS");
  const int count = given != nullptr ? std::atoi(given) : 60;
  std::map<std::string, int> made;
  int harmless = 0;
  for (const OcctSample& sample : occt_solids()) {
    SCOPED_TRACE(sample.name);
    const IgesReading reading = read_iges(bytes_of(write_with_occt(sample.shape, true)));
    ASSERT_TRUE(reading.model) << reading.text();
    const cad::Model& model = *reading.model;
    ASSERT_EQ(model.parts.size(), 1U);
    ASSERT_EQ(model.parts[0].kind, Part::Kind::solid);
    const double size = cad::box_of(model.parts[0]).sizes().maxCoeff();
    // Untouched: with itself, and in another form.
    for (const bool is_refined : {false, true}) {
      const Verdict untouched = verdict(model, is_refined ? refined(model) : model, 1e-6 * size);
      EXPECT_EQ(untouched.defects, 0) << untouched.text;
      EXPECT_EQ(untouched.warnings, 0) << untouched.text;
      EXPECT_FALSE(untouched.is_different) << untouched.text;
    }
    for (int seed = 0; seed < count; ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      cad::Model after = model;
      Part& part = after.parts[0];
      const std::size_t number = any(random, part.faces.size());
      Face& face = part.faces[number];
      std::string what;
      bool must_be_found = true;
      switch (seed % 4) {
        case 0:
          what = "boundary moved";
          if (!move_boundary(random, face, size)) continue;
          break;
        case 1:
          what = "face dropped";
          part.faces.erase(part.faces.begin() + static_cast<std::ptrdiff_t>(number));
          break;
        case 2:
          what = "orientation turned";
          face.reversed = !face.reversed;
          break;
        default:
          // Arcs keep their shape whatever their knots: a face whose shape changes is looked for.
          what = "knot moved";
          must_be_found = false;
          for (std::size_t k = 0; k < part.faces.size() && !must_be_found; ++k) {
            const std::size_t next = (number + k) % part.faces.size();
            const nurbs::Surface& before = model.parts[0].faces[next].surface;
            part.faces[next].surface = before;
            if (move_knot(random, part.faces[next]))
              must_be_found = sampled_distance(part.faces[next].surface, before) > 2e-6 * size;
          }
          break;
      }
      ++(must_be_found ? made[what] : harmless);
      const Verdict found = verdict(model, after, 1e-6 * size);
      if (must_be_found) {
        EXPECT_TRUE(found.defects + found.warnings > 0 || found.is_different)
            << what << " in face " << number << ", seed " << seed;
      }
    }
  }
  for (const auto& [what, times] : made) RecordProperty(what, times);
  for (const char* const what : {"boundary moved", "face dropped", "orientation turned"})
    EXPECT_GT(made[what], count) << what;
  EXPECT_GT(made["knot moved"], count / 20);
}

}  // namespace

}  // namespace selvage::test
