// Yarns equal up to a rigid motion.
#include "yarn/congruence.h"

#include <gtest/gtest.h>

#include <numbers>

#include "yarn/finish.h"
#include "yarn/grid.h"

namespace selvage::yarn {
namespace {

using std::numbers::pi;

// A bar that bends and rises, so that no motion but the identity brings it onto itself.
Body made(EndStyle ends) {
  GridNet net;
  net.sections = 9;
  net.per_section = 10;
  for (int j = 0; j < net.sections; ++j)
    for (int i = 0; i < net.per_section; ++i) {
      const double a = 2 * pi * i / net.per_section, t = 0.3 * j;
      net.points.emplace_back(2.0 * j, std::cos(a) + 0.2 * t * t, 0.5 * std::sin(a) + 0.1 * t * t * t);
    }
  Body body;
  body.name = "y";
  EXPECT_TRUE(fill_from_grid(body, net).ok());
  EXPECT_TRUE(finish(body, ends).ok());
  return body;
}

Body moved(Body body, const Eigen::Matrix3d& rotation, const Vec3& offset) {
  for (nurbs::Surface* surface : {&body.surface, &body.start.surface, &body.end.surface})
    for (Vec3& p : surface->points) p = rotation * p + offset;
  for (EndFace* end : {&body.start, &body.end}) {
    end->origin = rotation * end->origin + offset;
    end->normal = rotation * end->normal;
  }
  return body;
}

Eigen::Matrix3d turn(double angle, const Vec3& axis) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

TEST(Congruence, FindsTheMotion) {
  for (const EndStyle ends : {EndStyle::patch, EndStyle::fan, EndStyle::planar, EndStyle::none}) {
    const Body body = made(ends);
    const double size = bounds(body).diagonal().norm();
    for (const Eigen::Matrix3d& rotation :
         {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turn(pi, Vec3::UnitZ()), turn(1.1, {1, 2, 3}),
          turn(pi, {1, 1, 0})}) {
      const Vec3 offset(17.3, -4.1, 0.07);
      const Body other = moved(body, rotation, offset);
      EXPECT_TRUE(are_alike(invariants_of(body), invariants_of(other), 1e-12 * size));
      const std::optional<Congruence> found = congruence(body, other, 1e-12 * size);
      ASSERT_TRUE(found);
      EXPECT_LT((found->motion.rotation - rotation).cwiseAbs().maxCoeff(), 1e-13);
      EXPECT_LT((found->motion.offset - offset).norm(), 1e-12);
      EXPECT_LT(found->deviation, 1e-12 * size);
      EXPECT_EQ(found->motion.is_translation(), rotation.isIdentity());
    }
  }
}

TEST(Congruence, AMirrorImageIsNone) {
  const Body body = made(EndStyle::patch);
  const Eigen::Matrix3d mirror = Vec3(1, 1, -1).asDiagonal();
  Body image = moved(body, mirror, Vec3::Zero());
  EXPECT_TRUE(are_alike(invariants_of(body), invariants_of(image), 1e-9));
  EXPECT_FALSE(congruence(body, image, 1e-9));
}

TEST(Congruence, TheDeviationIsWhatIsLeft) {
  const Body body = made(EndStyle::patch);
  Body other = moved(body, Eigen::Matrix3d::Identity(), {5, 0, 0});
  other.surface.points[40].z() += 3e-8;
  EXPECT_FALSE(congruence(body, other, 2e-8));
  const std::optional<Congruence> found = congruence(body, other, 1e-7);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->deviation, 3e-8, 1e-14);
  // A knot that moved moves the surface, though its control points stay.
  Body knotted = body;
  knotted.surface.knots_v[6] += 1e-6;
  EXPECT_FALSE(congruence(body, knotted, 1e-9));
  const std::optional<Congruence> near = congruence(body, knotted, 1e-3);
  ASSERT_TRUE(near);
  double largest = 0;
  for (int k = 0; k <= 400; ++k) {
    const double v = body.surface.first_v() + (body.surface.last_v() - body.surface.first_v()) * k / 400;
    largest = std::max(
        largest, (nurbs::evaluate(body.surface, 0.2, v) - nurbs::evaluate(knotted.surface, 0.2, v)).norm());
  }
  EXPECT_GT(largest, 1e-8);
  EXPECT_GE(near->deviation, largest);
  EXPECT_LT(near->deviation, 200 * largest);
  // An end face counts as well as the body, and so does its kind.
  Body capped = body;
  capped.end.surface.points[7].x() += 1e-3;
  EXPECT_FALSE(congruence(body, capped, 1e-6));
  EXPECT_FALSE(congruence(body, made(EndStyle::fan), 1e-3));
}

}  // namespace
}  // namespace selvage::yarn
