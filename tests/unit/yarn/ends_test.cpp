// End faces: edges equal to the body's, areas, folds.
#include "yarn/ends.h"

#include <gtest/gtest.h>

#include <numbers>

#include "nurbs/measure.h"
#include "yarn/finish.h"
#include "yarn/tube.h"

namespace selvage::yarn {
namespace {

using std::numbers::pi;

Body bar(const Section& section, const SectionSize& size, EndStyle ends) {
  PathRows rows;
  rows.points = {{1, 2, 3}, {4, 2.5, 3.2}, {6, 2, 3}};
  Body body;
  body.name = "bar";
  TubeSpec spec;
  spec.section = section;
  spec.sizes = {{0.0, size, 0.0}};
  spec.tolerance = 1e-4;
  EXPECT_TRUE(sweep(body, *make_centre_line(rows), spec).ok());
  const Status s = finish(body, ends);
  EXPECT_TRUE(s.ok()) << (s.ok() ? "" : to_string(s.error()));
  return body;
}

TEST(EndsTest, PatchEdgesAreTheBodysQuarters) {
  for (const auto& [section, size] :
       std::vector<std::pair<Section, SectionSize>>{{Circle{}, {1, 1}},
                                                    {Ellipse{}, {0.8, 0.2}},
                                                    {Lenticular{}, {1.0, 0.5}},
                                                    {Power{1, 1, 0.6}, {0.8, 0.5}}}) {
    const Body body = bar(section, size, EndStyle::patch);
    ASSERT_EQ(body.start.style, EndStyle::patch);
    for (bool last : {false, true}) {
      EXPECT_LT(end_gap(body, last), 4e-15);
      const EndFace& face = last ? body.end : body.start;
      // Every point of the flat end's patch lies in its plane.
      for (const Vec3& p : face.surface.points) EXPECT_NEAR((p - face.origin).dot(face.normal), 0.0, 1e-13);
      // Its outward flux is that of the plane: area times height over the origin.
      const double flux = nurbs::volume_flux(face.surface, Vec3::Zero()) * (face.inward ? -1 : 1);
      EXPECT_NEAR(flux, body.end_area * face.origin.dot(face.normal) / 3, 1e-6);
    }
  }
}

TEST(EndsTest, FanHasTheBodysOwnNumbers) {
  const Body body = bar(Circle{}, {1, 1}, EndStyle::fan);
  const nurbs::Surface& fan = body.end.surface;
  ASSERT_EQ(fan.count_u, body.surface.count_u);
  ASSERT_EQ(fan.count_v, 4);
  for (int i = 0; i < fan.count_u; ++i) {
    EXPECT_EQ(fan.point(i, 0), body.surface.point(i, body.surface.count_v - 1));
    EXPECT_EQ(fan.point(i, 3), body.end.origin);
  }
  EXPECT_EQ(end_gap(body, true), 0.0);
}

TEST(EndsTest, NormalsPointOutOfTheYarn) {
  for (EndStyle style : {EndStyle::patch, EndStyle::fan, EndStyle::planar}) {
    const Body body = bar(Ellipse{}, {0.8, 0.2}, style);
    EXPECT_LT(body.start.normal.x(), -0.9);
    EXPECT_GT(body.end.normal.x(), 0.9);
    if (style == EndStyle::planar) continue;
    for (const EndFace* face : {&body.start, &body.end}) {
      const nurbs::SurfaceJet jet = nurbs::evaluate_jet(face->surface, 0.4, 0.4);
      EXPECT_GT(jet.du.cross(jet.dv).dot(face->normal) * (face->inward ? -1 : 1), 0.0);
    }
  }
}

// At a cusp the fan's two derivatives have one direction, and their product is rounding.
TEST(EndsTest, AFanOnASectionWithCuspsIsOriented) {
  for (const double exponent : {1.2, 1.5, 1.9, 2.0, 2.01, 2.5, 3.0}) {
    const Section section = Power{0.39, 0.18, exponent};
    const Body fans = bar(section, {0.39, 0.18}, EndStyle::fan),
               planes = bar(section, {0.39, 0.18}, EndStyle::planar);
    EXPECT_NEAR(fans.volume, planes.volume, 1e-9 * planes.volume) << exponent;
    for (const EndFace* face : {&fans.start, &fans.end}) {
      const double flux = nurbs::volume_flux(face->surface, Vec3::Zero()) * (face->inward ? -1 : 1);
      EXPECT_NEAR(flux, fans.end_area * face->origin.dot(face->normal) / 3, 1e-9) << exponent;
    }
  }
}

TEST(EndsTest, AConcaveSectionFoldsThePatchAndGetsAPlaneAndAWarning) {
  // A deep U.
  const Polygon u{{{1, -1}, {1, 1}, {0.8, 1}, {0.8, -0.8}, {-0.8, -0.8}, {-0.8, 1}, {-1, 1}, {-1, -1}}};
  const Body body = bar(u, nominal_size(u), EndStyle::patch);
  EXPECT_EQ(body.start.style, EndStyle::planar);
  ASSERT_FALSE(body.messages.empty());
  EXPECT_EQ(body.messages.front().severity, Severity::warning);
  EXPECT_NEAR(body.end_area, 4 - 1.6 * 1.8, 1e-9);
}

TEST(EndsTest, LongSectionsDoNotFold) {
  EXPECT_EQ(bar(Racetrack{}, {1.4, 0.16}, EndStyle::patch).start.style, EndStyle::patch);
  EXPECT_EQ(bar(Lenticular{}, {1.7, 0.14}, EndStyle::patch).start.style, EndStyle::patch);
}

TEST(EndsTest, AMovedEndFaceIsAGap) {
  Body body = bar(Circle{}, {1, 1}, EndStyle::patch);
  for (Vec3& p : body.end.surface.points) p += 1e-6 * body.end.normal;
  EXPECT_NEAR(end_gap(body, true), 1e-6, 1e-12);
  EXPECT_LT(end_gap(body, false), 1e-14);
}

}  // namespace
}  // namespace selvage::yarn
