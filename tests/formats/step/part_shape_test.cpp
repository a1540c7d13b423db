// What OpenCASCADE made is held against what the part says.
#include "formats/step/part_shape.h"

#include <gtest/gtest.h>

#include "unit/cad/surfaces.h"

namespace selvage::formats::step {

namespace {

cad::Part trimmed(double u0, double u1) {
  cad::Part part;
  part.faces.push_back(test::face_of(test::sheet(), {test::rectangle(u0, u1, 0.1, 0.3)}));
  return part;
}

TEST(PartShape, AFaceOnTheOtherSideOfItsBoundaryIsRefused) {
  const cad::Part part = trimmed(0.1, 0.3);
  EXPECT_EQ(flaw_of(build_part(part, 1e-6), part).value_or("none"), "none");
  const std::optional<std::string> flaw = flaw_of(build_part(trimmed(0.5, 0.9), 1e-6), part);
  ASSERT_TRUE(flaw);
  EXPECT_NE(flaw->find("takes what is beyond the boundary of its face 1 for it"), std::string::npos) << *flaw;
}

// In the middle of half a cylinder two of its quarters meet.
TEST(PartShape, APlaceOnAKnotIsFound) {
  const nurbs::Surface round = test::cylinder(0.0169, 0.0236);
  const double u = round.first_u(), length = round.last_u() - u;
  cad::Part part;
  part.faces.push_back(test::face_of(
      round, {test::rectangle(u + length / 2, u + length, 0.1 * round.last_v(), 0.9 * round.last_v())}));
  EXPECT_EQ(flaw_of(build_part(part, 1e-9), part).value_or("none"), "none");
}

// A face whose area was measured in the file has to have it again.
TEST(PartShape, AFaceOfAnotherAreaIsRefused) {
  cad::Part part = trimmed(0.1, 0.3);
  const PartShape built = build_part(part, 1e-6);
  part.faces[0].area = 0.4;  // ten times that of the flat sheet below the wavy one
  const std::optional<std::string> flaw = flaw_of(built, part);
  ASSERT_TRUE(flaw);
  EXPECT_NE(flaw->find("has an area of 0.4, and OpenCASCADE makes it"), std::string::npos) << *flaw;
}

}  // namespace

}  // namespace selvage::formats::step
