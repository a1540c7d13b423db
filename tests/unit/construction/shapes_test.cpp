// Yarns that are planned alike: swept once, and the same as if each were swept for itself.
#include <gtest/gtest.h>

#include "construction/build.h"
#include "yarn/ends.h"
#include "yarn/finish.h"

namespace selvage::fabric {
namespace {

Fabric jersey(int courses, int wales) {
  Fabric fabric;
  fabric.file = "test.txt";
  Thread thread;
  thread.name = "t";
  thread.diameter = 0.183;
  fabric.threads = {thread};
  Knit knit;
  knit.place = {5, 1};
  knit.threads = {"t"};
  knit.courses = courses;
  knit.wales = wales;
  fabric.items = {std::move(knit)};
  return fabric;
}

YarnBuilder shape_builder_of(const Fabric& fabric, const BuildOptions& options) {
  Diagnostics diagnostics;
  std::optional<YarnBuilder> builder = YarnBuilder::create(fabric, options, diagnostics);
  EXPECT_TRUE(builder.has_value());
  return std::move(*builder);
}

// As published every course is the same.
TEST(Shapes, CoursesOfAJerseyAreOne) {
  const Fabric fabric = jersey(5, 3);
  for (const bool full_digits : {false, true}) {
    BuildOptions options;
    options.as_published = true;
    options.full_digits = full_digits;
    const YarnBuilder builder = shape_builder_of(fabric, options);
    const DecimalGrid grid = full_digits ? DecimalGrid() : DecimalGrid(1e-4 * 0.183e-3);
    std::vector<yarn::Body> bodies;
    for (std::size_t i = 0; i < builder.count(); ++i) {
      Result<yarn::Body> body = builder.build(i);
      ASSERT_TRUE(body.ok());
      bodies.push_back(std::move(*body));
    }
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      EXPECT_EQ(bodies[i].shape, 1U);
      EXPECT_EQ(bodies[i].name, "course_" + std::to_string(i + 1));
      // Courses of the published loops stand 7 r apart.
      EXPECT_NEAR(bodies[i].at.y() - bodies[0].at.y(), static_cast<double>(i) * 7 * 0.0915, 1e-12);
      const Vec3 way = bodies[i].at - bodies[0].at;
      for (std::size_t k = 0; k < bodies[i].surface.points.size(); ++k) {
        const Vec3 moved = bodies[0].surface.points[k] + way;
        EXPECT_LT((bodies[i].surface.points[k] - moved).norm(), grid.reach() + 1e-14);
      }
      EXPECT_EQ(bodies[i].volume, bodies[0].volume);
      EXPECT_LE(bodies[i].tube_error, 0.183e-3);
    }
  }
}

// In any order, by any builder.
TEST(Shapes, WhatIsKeptChangesNoBody) {
  const Fabric fabric = jersey(6, 4);
  const YarnBuilder all = shape_builder_of(fabric, {});
  for (std::size_t i = 0; i < all.count(); ++i) {
    const Result<yarn::Body> known = all.build(i), alone = shape_builder_of(fabric, {}).build(i);
    ASSERT_TRUE(known.ok() && alone.ok());
    EXPECT_TRUE(known->surface == alone->surface) << i;
    EXPECT_TRUE(known->axis == alone->axis) << i;
    EXPECT_TRUE(known->start.surface == alone->start.surface && known->end.surface == alone->end.surface)
        << i;
    EXPECT_EQ(known->start.origin, alone->start.origin) << i;
    EXPECT_EQ(known->volume, alone->volume) << i;
  }
}

// As `relax` does it with what it has moved.
TEST(Shapes, ABodyThatIsFinishedAnewIsAShapeOfItsOwn) {
  const Fabric fabric = jersey(3, 2);
  const YarnBuilder builder = shape_builder_of(fabric, {});
  Result<yarn::Body> body = builder.build(1);
  ASSERT_TRUE(body.ok());
  ASSERT_NE(body->shape, 0U);
  body->surface.points[body->surface.points.size() / 2].z() += 0.01;
  ASSERT_TRUE(yarn::finish(*body, yarn::EndStyle::patch).ok());
  EXPECT_EQ(body->shape, 0U);
  EXPECT_EQ(body->at, Vec3(Vec3::Zero()));
}

TEST(Shapes, MovedEndsAreTheStandardOnes) {
  const Fabric fabric = jersey(3, 2);
  for (const yarn::EndStyle style : {yarn::EndStyle::patch, yarn::EndStyle::fan, yarn::EndStyle::planar}) {
    BuildOptions options;
    options.ends = style;
    const YarnBuilder builder = shape_builder_of(fabric, options);
    for (std::size_t i = 0; i < builder.count(); ++i) {
      const Result<yarn::Body> body = builder.build(i);
      ASSERT_TRUE(body.ok());
      for (const bool last : {false, true}) {
        EXPECT_TRUE(yarn::is_standard_end(*body, last)) << i;
        EXPECT_LT(yarn::flatness(yarn::end_curve(*body, last), (last ? body->end : body->start).origin,
                                 (last ? body->end : body->start).normal),
                  1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace selvage::fabric
