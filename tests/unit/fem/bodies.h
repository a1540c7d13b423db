// Yarns made by hand for the mesh tests: control grids whose shape is known.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "yarn/body.h"
#include "yarn/finish.h"
#include "yarn/grid.h"

namespace selvage::test {

// A closed quadratic through `round` control points a section, cubic along `sections` sections; point(angle,
// share) is the control point at an angle (radians, counter-clockwise seen along the yarn) and a share 0..1
// of the length.
inline yarn::Body grid_body(const std::string& name, int round, int sections,
                            const std::function<Vec3(double angle, double share)>& point, bool ring = false,
                            yarn::EndStyle ends = yarn::EndStyle::patch) {
  yarn::GridNet net;
  net.sections = sections;
  net.per_section = round;
  net.closed_along = ring;
  for (int j = 0; j < sections; ++j)
    for (int i = 0; i < round; ++i)
      net.points.push_back(
          point(2 * std::numbers::pi * i / round, static_cast<double>(j) / (ring ? sections : sections - 1)));
  yarn::Body body;
  body.name = name;
  if (Status filled = yarn::fill_from_grid(body, net); !filled) ADD_FAILURE() << filled.error().text;
  if (Status done = yarn::finish(body, ends); !done) ADD_FAILURE() << done.error().text;
  return body;
}

// A straight yarn along x of elliptic control polygon (nearly elliptic section) from `from`.
inline yarn::Body straight_tube(double width, double height, double length, int round = 24,
                                const Vec3& from = Vec3::Zero(), const std::string& name = "tube") {
  return grid_body(name, round, 6, [=](double angle, double share) {
    return Vec3(from + Vec3(length * share, width / 2 * std::cos(angle), height / 2 * std::sin(angle)));
  });
}

}  // namespace selvage::test
