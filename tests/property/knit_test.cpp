// Weft knits as topology: which loop passes through which, and from which side. Read from the centre lines
// and the text's stitches alone. Across each stitch a disc is spanned (its yarn from sinker to sinker, closed
// by a chord, filled by a fan of triangles), and the yarns of the courses above are counted where they pierce
// it, the way up to their heads and the way down each for itself:
//   - the first loop above on the same needle goes through every loop and tuck that the needle holds, from
//     the back to the face where it is knit, from the face to the back where it is purl, and returns the same
//     way;
//   - nothing else goes through: no tuck, no float, no loop of another needle or of a later course.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "fabric/yarn_spec.h"
#include "nurbs/measure.h"
#include "nurbs/spline.h"
#include "property/zoo.h"

namespace selvage::zoo {
namespace {

using fabric::Knit;
using Polyline = std::vector<Vec3>;

// The sign of a stitch, read on our own from the item: course and wale from 0, at the bottom left.
char sign_at(const Knit& knit, int course, int wale) {
  switch (knit.form) {
    case Knit::Form::jersey:
      return 'K';
    case Knit::Form::purl:
      return course % 2 == 0 ? 'K' : 'P';
    case Knit::Form::rib:
      return wale % (knit.rib_a + knit.rib_b) < knit.rib_a ? 'K' : 'P';
    case Knit::Form::full_cardigan:
      return "KPTT"[wale % 2 + 2 * ((course + wale) % 2)];
    case Knit::Form::half_cardigan:
      return "KPKT"[wale % 2 + 2 * (course % 2)];
    case Knit::Form::milano:
      return "KPKMMP"[wale % 2 + 2 * (course % 3)];
    case Knit::Form::half_milano:
      return "KPKM"[wale % 2 + 2 * (course % 2)];
    case Knit::Form::interlock:
    case Knit::Form::jacquard:
    case Knit::Form::chart:
      break;
  }
  const auto rows = static_cast<int>(knit.chart.size());
  const std::string& row = knit.chart[static_cast<std::size_t>(rows - 1 - course % rows)];
  return row[static_cast<std::size_t>(wale) % row.size()];
}

// A course is one yarn, and a wale one needle. (What is not: tests/unit/knit/knit_beds_test.cpp.)
bool is_simple(const Knit& knit) {
  return knit.form != Knit::Form::interlock && knit.form != Knit::Form::jacquard && !knit.feeds &&
         !knit.gating && knit.plating.empty();
}

bool is_loop(char sign) {
  return sign == 'K' || sign == 'P';
}

struct StitchYarn {
  Polyline points;       // from sinker to sinker
  std::size_t head = 0;  // the highest point
  Box3 box;
};

// The stitches of a course: its centre line, cut where it passes from wale to wale.
std::vector<StitchYarn> stitches_of(const nurbs::Curve& curve, int wales) {
  const std::vector<double> breaks = nurbs::breakpoints(curve.knots, curve.degree);
  Polyline all;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i)
    for (int k = 0; k < 10; ++k)
      all.push_back(nurbs::evaluate(curve, breaks[i] + (breaks[i + 1] - breaks[i]) * k / 10.0));
  all.push_back(nurbs::evaluate(curve, breaks.back()));
  const double left = all.front().x(), pitch = (all.back().x() - left) / wales;
  std::vector<StitchYarn> stitches(static_cast<std::size_t>(wales));
  for (const Vec3& point : all) {
    const auto wale = static_cast<std::size_t>(
        std::clamp(static_cast<int>(std::floor((point.x() - left) / pitch)), 0, wales - 1));
    StitchYarn& stitch = stitches[wale];
    stitch.points.push_back(point);
    stitch.box.extend(point);
    if (point.y() > stitch.points[stitch.head].y()) stitch.head = stitch.points.size() - 1;
  }
  return stitches;
}

// Twice the signed volume of the tetrahedron a b c d, thrice.
double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a);
}

// How often a piece of yarn goes through the disc across a stitch from the back (-z) to the face, less the
// other way.
int passes(const Polyline& yarn, std::size_t first, std::size_t last, const StitchYarn& across) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& point : across.points) middle += point;
  middle /= static_cast<double>(across.points.size());
  int count = 0;
  for (std::size_t s = first; s < last; ++s) {
    const Vec3 &from = yarn[s], &to = yarn[s + 1];
    Box3 step(from);
    step.extend(to);
    if (!across.box.intersects(step)) continue;
    for (std::size_t i = 0; i < across.points.size(); ++i) {
      const Vec3 &a = across.points[i], &b = across.points[(i + 1) % across.points.size()];
      const double before = volume(middle, a, b, from), after = volume(middle, a, b, to);
      if ((before > 0) == (after > 0)) continue;
      const double u = volume(from, to, middle, a), v = volume(from, to, a, b),
                   w = volume(from, to, b, middle);
      if ((u > 0) != (v > 0) || (v > 0) != (w > 0)) continue;
      // A stitch runs clockwise as seen from the face: its triangles look to the back.
      count += before > 0 ? 1 : -1;
    }
  }
  return count;
}

// What is wrong with the cloth. `knit`: what its text asks for; `courses`: its centre lines in order.
std::vector<std::string> faults_of(const Knit& knit, const std::vector<nurbs::Curve>& courses) {
  std::vector<std::vector<StitchYarn>> cloth;
  cloth.reserve(courses.size());
  for (const nurbs::Curve& curve : courses) cloth.push_back(stitches_of(curve, knit.wales));
  std::vector<std::string> faults;
  const auto compare = [&](int c, int w, int other_c, int other_w, int expected) {
    const StitchYarn& across = cloth[static_cast<std::size_t>(c)][static_cast<std::size_t>(w)];
    const StitchYarn& yarn = cloth[static_cast<std::size_t>(other_c)][static_cast<std::size_t>(other_w)];
    if (expected == 0 && !across.box.intersects(yarn.box)) return;
    const int up = passes(yarn.points, 0, yarn.head, across);
    const int down = passes(yarn.points, yarn.head, yarn.points.size() - 1, across);
    if (up != expected || down != -expected)
      faults.push_back(fmt::format("course {} wale {} goes {} and {} times through course {} wale {}, not {}",
                                   other_c + 1, other_w + 1, up, down, c + 1, w + 1, expected));
  };
  for (int c = 0; c < knit.courses; ++c)
    for (int w = 0; w < knit.wales; ++w) {
      int next = c + 1;
      while (next < knit.courses && !is_loop(sign_at(knit, next, w))) ++next;
      for (int other = c + 1; other < knit.courses; ++other)
        for (int v = std::max(0, w - 1); v <= std::min(knit.wales - 1, w + 1); ++v) {
          const bool goes_through = v == w && other == next && sign_at(knit, c, w) != 'M';
          const int way = sign_at(knit, other, v) == 'K' ? 1 : -1;
          compare(c, w, other, v, goes_through ? way : 0);
        }
    }
  return faults;
}

// A warning says that loops could not be parted.
std::vector<nurbs::Curve> courses_of(const fabric::Fabric& fabric, bool as_published = false,
                                     bool may_warn = false) {
  std::vector<nurbs::Curve> curves;
  fabric::BuildOptions options;
  options.as_published = as_published;
  Diagnostics diagnostics;
  const std::optional<fabric::YarnBuilder> builder =
      fabric::YarnBuilder::create(fabric, options, diagnostics);
  for (const Message& message : diagnostics.messages())
    if (message.severity > (may_warn ? Severity::warning : Severity::note))
      ADD_FAILURE() << to_string(message);
  if (!builder) return curves;
  for (std::size_t i = 0; i < builder->count(); ++i) {
    const Result<fabric::YarnPlan> plan = builder->plan(i);
    EXPECT_TRUE(plan.ok());
    if (plan.ok()) curves.push_back(plan->line.curve);
  }
  return curves;
}

const Knit& knit_of(const fabric::Fabric& fabric) {
  return std::get<Knit>(fabric.items.front());
}

std::string lines_of(const std::vector<std::string>& faults) {
  std::string text;
  for (const std::string& fault : faults) text += fault + "\n";
  return text;
}

fabric::Fabric charted(const std::string& rows, int courses, int wales, const std::string& method = "chord") {
  return fabric_of(
      fmt::format("fabric 1\nthread t\n diameter 1\nend\nknit\n thread t\n courses {}\n wales {}\n"
                  " method {}\n chart\n{}\n end\nend\n",
                  courses, wales, method, rows));
}

// The least distance of two places on the centre lines of a cloth that are on different courses, or farther
// apart along one of them than `apart`. By points at equal shares of every span, compared cube by cube:
// nothing of what moves the loops apart is used.
double least_distance(const std::vector<nurbs::Curve>& courses, double apart, double reach) {
  constexpr int looks = 48;  // in a span; between them a curve hides less than 2e-3 of its radius
  struct Place {
    Vec3 point;
    std::size_t course = 0;
    double along = 0;
  };
  std::map<std::array<long, 3>, std::vector<Place>> cubes;
  std::vector<Place> places;
  for (std::size_t c = 0; c < courses.size(); ++c) {
    const std::vector<double> breaks = nurbs::breakpoints(courses[c].knots, courses[c].degree);
    double along = 0;
    Vec3 last = courses[c].points.front();
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
      for (int i = 0; i <= looks; ++i) {
        const Vec3 point = nurbs::evaluate(courses[c], breaks[k] + (breaks[k + 1] - breaks[k]) * i / looks);
        along += (point - last).norm();
        last = point;
        places.push_back({point, c, along});
      }
  }
  const auto cube_of = [&](const Vec3& p) {
    return std::array<long, 3>{std::lround(p.x() / reach), std::lround(p.y() / reach),
                               std::lround(p.z() / reach)};
  };
  for (const Place& place : places) cubes[cube_of(place.point)].push_back(place);
  double least = reach;
  for (const Place& place : places) {
    const std::array<long, 3> middle = cube_of(place.point);
    for (long n = 0; n < 27; ++n) {
      const auto cube = cubes.find({middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1, middle[2] + n / 9 - 1});
      if (cube == cubes.end()) continue;
      for (const Place& other : cube->second)
        if (other.course != place.course || std::abs(other.along - place.along) > apart)
          least = std::min(least, (other.point - place.point).norm());
    }
  }
  return least;
}

// A chart of random stitches whose first course knits on every needle.
std::string random_chart(std::mt19937& random, int rows, int columns) {
  std::vector<std::string> chart(static_cast<std::size_t>(rows));
  const std::string signs = "KKKPPTM";
  for (std::string& row : chart)
    for (int column = 0; column < columns; ++column) row += signs[random() % signs.size()];
  for (char& sign : chart.back()) sign = is_loop(sign) ? sign : 'K';
  std::string text;
  for (const std::string& row : chart) text += (text.empty() ? "" : "\n") + row;
  return text;
}

TEST(KnitTopology, EveryLoopOfTheZooPassesThroughTheOneBelow) {
  std::size_t knits = 0;
  for (const ZooFabric* zoo : with<Knit>()) {
    if (zoo->fabric.items.size() != 1 || zoo->fabric.cell || !is_simple(knit_of(zoo->fabric))) continue;
    ++knits;
    const std::vector<std::string> faults = faults_of(knit_of(zoo->fabric), courses_of(zoo->fabric));
    EXPECT_TRUE(faults.empty()) << zoo->name << "\n" << lines_of(faults);
  }
  EXPECT_GE(knits, 8U);
}

// What no sample shows: stitches of the other bed above tucks, loops held for long, neighbours of all kinds.
TEST(KnitTopology, EveryChartThatCanBeDrawn) {
  const std::vector<std::string> charts = {
      "KK\nKT\nKT\nKT\nKT\nKT\nKT\nKK",          // held over six courses by tucks
      "KKK\nMKK\nMKM\nMKM\nMKK\nMKM\nMKM\nKKK",  // by floats
      "KPK\nTTK\nTMK\nPKK",                      // the next loop comes from the other side
      "PKP\nTTT\nKPK",
      "KT\nTP",
      "KTTK\nKKKK\nTKKT\nKKKK",
      "PPPP\nPMMP\nPTPT\nPPPP",
      "KPKP\nPKPK",
      "TKM\nKPT\nPKK",
  };
  for (const std::string& rows : charts) {
    const fabric::Fabric fabric = charted(rows, 9, 6);
    // Six tucks on one loop lie in one another as drawn: there is no way to part them.
    const bool may_warn = &rows == &charts.front();
    const std::vector<std::string> faults = faults_of(knit_of(fabric), courses_of(fabric, false, may_warn));
    EXPECT_TRUE(faults.empty()) << rows << "\n" << lines_of(faults);
  }
}

// Default: thicknesses of 1 with a hundredth between them.
TEST(KnitClearance, NoTwoLoopsOfTheZooTouch) {
  std::size_t knits = 0;
  for (const ZooFabric* zoo : with<Knit>()) {
    if (zoo->fabric.items.size() != 1) continue;
    ++knits;
    const double thickness = *fabric::smallest_size(zoo->fabric, zoo->fabric.threads.front());
    const double distance = least_distance(courses_of(zoo->fabric), 1.6 * thickness, 1.5 * thickness);
    const Knit& knit = knit_of(zoo->fabric);
    if (!is_simple(knit) || knit.course_pitch > 0 ||
        knit.unit) {  // a cut pile ends where its course would go on
      EXPECT_GE(distance, thickness) << zoo->name;
      continue;
    }
    EXPECT_GE(distance, 1.01 * thickness) << zoo->name;
    EXPECT_LT(distance, 1.03 * thickness) << zoo->name;
    // As published none of them is free of overlap: the oracle sees it.
    EXPECT_LT(least_distance(courses_of(zoo->fabric, true), 1.6 * thickness, 1.5 * thickness),
              0.999 * thickness)
        << zoo->name;
  }
  EXPECT_GE(knits, 11U);
}

TEST(KnitTopology, KnitsByName) {
  for (const std::string name : {"full-cardigan", "half-cardigan", "milano", "half-milano"}) {
    const fabric::Fabric fabric = fabric_of(fmt::format(
        "fabric 1\nthread t\n diameter 1\nend\nknit {}\n thread t\n courses 9\n wales 6\nend\n", name));
    const std::vector<std::string> faults = faults_of(knit_of(fabric), courses_of(fabric));
    EXPECT_TRUE(faults.empty()) << name << "\n" << lines_of(faults);
  }
}

TEST(KnitClearance, RandomChartsComeOutFreeAndPassThroughEachOtherAsPublished) {
  std::mt19937 random(20);
  const std::array<std::string, 3> methods = {"chord", "centripetal", "uniform"};
  for (int trial = 0; trial < 18; ++trial) {
    const int rows = 1 + static_cast<int>(random() % 4), columns = 1 + static_cast<int>(random() % 3);
    const std::string chart = random_chart(random, rows, columns);
    const int courses = rows + 1 + static_cast<int>(random() % 5), wales = 2 + static_cast<int>(random() % 4);
    const std::string& method = methods[static_cast<std::size_t>(trial) % 3];
    const fabric::Fabric fabric = charted(chart, courses, wales, method);
    const std::vector<nurbs::Curve> moved = courses_of(fabric);
    EXPECT_GE(least_distance(moved, 1.6, 1.5), 1.01) << chart << "\n"
                                                     << courses << " x " << wales << " " << method;
    const std::vector<std::string> before = faults_of(knit_of(fabric), courses_of(fabric, true));
    EXPECT_EQ(faults_of(knit_of(fabric), moved), before) << chart << " " << method;
  }
}

// Inside a cloth of any size the loops are those of the same small piece, moved; and that piece has what it
// needs on all sides.
TEST(KnitClearance, LargeClothsAreFreeAndPeriodic) {
  for (const std::string rows : {"K", "KT\nKP", "KMM\nMKM\nMMK"}) {
    const auto columns = static_cast<std::size_t>(rows.find('\n') == std::string::npos ? 1 : rows.find('\n'));
    const auto repeat = static_cast<std::size_t>(std::count(rows.begin(), rows.end(), '\n')) + 1;
    const fabric::Fabric fabric = charted(rows, 19, 20);
    const std::vector<nurbs::Curve> courses = courses_of(fabric);
    EXPECT_GE(least_distance(courses, 1.6, 1.5), 1.01) << rows;
    const std::vector<fabric::YarnPlan> plans = plans_of(fabric);
    const double step = 3.5 * static_cast<double>(repeat);
    for (std::size_t c = 6; c + 6 + repeat < plans.size(); ++c) {
      const std::vector<Vec3>&low = plans[c].points, &high = plans[c + repeat].points;
      ASSERT_EQ(low.size(), high.size());
      for (std::size_t i = 0; i < low.size(); ++i) {
        EXPECT_EQ(low[i].x(), high[i].x());
        EXPECT_EQ(low[i].z(), high[i].z());
        EXPECT_NEAR(high[i].y() - low[i].y(), step, 1e-13);
      }
      // Along a course: the points of a repeat of wales, found by their places in it.
      std::vector<std::size_t> starts;  // of wales
      for (std::size_t i = 0; i < low.size(); ++i)
        if (starts.size() < 21 && std::abs(low[i].x() - 4.0 * static_cast<double>(starts.size())) < 1.0 &&
            (starts.empty() || i > starts.back() + 1))
          starts.push_back(i);
      for (std::size_t w = 4; w + 4 + columns < starts.size(); ++w) {
        const Vec3 &a = low[starts[w]], &b = low[starts[w + columns]];
        EXPECT_NEAR(b.x() - a.x(), 4.0 * static_cast<double>(columns), 1e-13);
        EXPECT_EQ(a.z(), b.z());
      }
    }
  }
}

// The loops at the sides and in the first and last course are as free as those inside, whatever the cloth's
// size: few wales are solved with their edges, many as one. Yarn that is longer than as published by more
// than a little would be another cloth.
TEST(KnitClearance, JerseysOfAllSizesAreFree) {
  for (const std::string method : {"chord", "uniform", "centripetal"})
    for (const auto& [courses, wales] : std::vector<std::pair<int, int>>{
             {1, 1}, {2, 1}, {1, 2}, {3, 2}, {2, 6}, {1, 7}, {2, 7}, {4, 8}, {12, 20}}) {
      const std::string what = fmt::format("{} {} x {}", method, courses, wales);
      const fabric::Fabric fabric = charted("K", courses, wales, method);
      const std::vector<nurbs::Curve> lines = courses_of(fabric);
      EXPECT_GE(least_distance(lines, 1.6, 1.5), 1.01) << what;
      EXPECT_TRUE(faults_of(knit_of(fabric), lines).empty()) << what;
      double longest = 0, shortest = 1e9;
      const std::vector<nurbs::Curve> published = courses_of(fabric, true);
      for (std::size_t c = 0; c < lines.size(); ++c) {
        const double ratio = nurbs::arc_length(lines[c]) / nurbs::arc_length(published[c]);
        longest = std::max(longest, ratio);
        shortest = std::min(shortest, ratio);
      }
      EXPECT_LT(longest, 1.05) << what;
      EXPECT_GT(shortest, 0.97) << what;
    }
}

// The oracle sees what is wrong.
TEST(KnitTopology, FaultsAreSeen) {
  const fabric::Fabric fabric = charted("KKK\nKTK\nPKM\nKKK", 6, 6);
  const std::vector<nurbs::Curve> good = courses_of(fabric);
  ASSERT_TRUE(faults_of(knit_of(fabric), good).empty()) << lines_of(faults_of(knit_of(fabric), good));
  for (std::size_t c = 0; c < good.size(); ++c) {  // a course seen from the back
    std::vector<nurbs::Curve> bad = good;
    for (Vec3& point : bad[c].points) point.z() = -point.z();
    EXPECT_FALSE(faults_of(knit_of(fabric), bad).empty()) << "course " << c + 1 << " mirrored";
  }
  for (std::size_t row = 0; row < 4; ++row)  // another text
    for (std::size_t column = 0; column < 3; ++column)
      for (const char sign : std::string("KPTM")) {
        Knit other = knit_of(fabric);
        if (other.chart[row][column] == sign) continue;
        other.chart[row][column] = sign;
        // On the cloth's first course tuck, miss and loop differ in what they pass, not in what passes them.
        EXPECT_FALSE(faults_of(other, good).empty()) << "row " << row << " column " << column << " " << sign;
      }
  std::vector<nurbs::Curve> lifted = good;  // a course that is only laid on the cloth
  for (Vec3& point : lifted[2].points) point.z() += 4;
  EXPECT_FALSE(faults_of(knit_of(fabric), lifted).empty());
  std::vector<nurbs::Curve> shifted = good;  // its loops one wale further
  for (Vec3& point : shifted[2].points) point.x() += 4;
  EXPECT_FALSE(faults_of(knit_of(fabric), shifted).empty());
}

}  // namespace
}  // namespace selvage::zoo
