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
#include <cmath>

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
    case Knit::Form::chart:
      break;
  }
  const auto rows = static_cast<int>(knit.chart.size());
  const std::string& row = knit.chart[static_cast<std::size_t>(rows - 1 - course % rows)];
  return row[static_cast<std::size_t>(wale) % row.size()];
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

std::vector<nurbs::Curve> courses_of(const fabric::Fabric& fabric) {
  std::vector<nurbs::Curve> curves;
  for (const fabric::YarnPlan& plan : plans_of(fabric)) curves.push_back(plan.line.curve);
  return curves;
}

const Knit& knit_of(const fabric::Fabric& fabric) {
  return std::get<Knit>(fabric.items.front());
}

std::string text_of(const std::vector<std::string>& faults) {
  std::string text;
  for (const std::string& fault : faults) text += fault + "\n";
  return text;
}

fabric::Fabric charted(const std::string& rows, int courses, int wales) {
  return fabric_of(
      fmt::format("fabric 1\nthread t\n diameter 1\nend\nknit\n thread t\n courses {}\n wales {}\n"
                  " chart\n{}\n end\nend\n",
                  courses, wales, rows));
}

TEST(KnitTopology, EveryLoopOfTheZooPassesThroughTheOneBelow) {
  std::size_t knits = 0;
  for (const ZooFabric* zoo : with<Knit>()) {
    if (zoo->fabric.items.size() != 1 || zoo->fabric.cell) continue;
    ++knits;
    const std::vector<std::string> faults = faults_of(knit_of(zoo->fabric), courses_of(zoo->fabric));
    EXPECT_TRUE(faults.empty()) << zoo->name << "\n" << text_of(faults);
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
    const std::vector<std::string> faults = faults_of(knit_of(fabric), courses_of(fabric));
    EXPECT_TRUE(faults.empty()) << rows << "\n" << text_of(faults);
  }
}

// The oracle sees what is wrong.
TEST(KnitTopology, FaultsAreSeen) {
  const fabric::Fabric fabric = charted("KKK\nKTK\nPKM\nKKK", 6, 6);
  const std::vector<nurbs::Curve> good = courses_of(fabric);
  ASSERT_TRUE(faults_of(knit_of(fabric), good).empty()) << text_of(faults_of(knit_of(fabric), good));
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
