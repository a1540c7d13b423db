// The cloth that the benchmarks of files write and read.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "yarn/ends.h"

namespace selvage::benchmarks {

// A yarn of 18 x 16 control points that waves through a cloth: coordinates with all their digits, knots as
// methods.md has them, two patch ends. Yarn k differs from its neighbours in place and phase, and in
// the height of its waves where one is given.
class Cloth {
 public:
  Cloth() {
    body_.surface.count_u = 18;
    body_.surface.count_v = 16;
    for (int i = 0; i < 3; ++i) body_.surface.knots_u.push_back(0);
    for (int i = 1; i < 16; ++i) body_.surface.knots_u.push_back(i / 16.0);
    for (int i = 0; i < 3; ++i) body_.surface.knots_u.push_back(1);
    for (int i = 0; i < 3; ++i) body_.surface.knots_v.push_back(0);
    for (int i = 0; i <= 13; ++i) body_.surface.knots_v.push_back(i);
    for (int i = 0; i < 3; ++i) body_.surface.knots_v.push_back(13);
    body_.surface.points.resize(18 * 16);
    body_.quarters = {0, 0.25, 0.5, 0.75};
  }

  const yarn::Body& yarn(int k, double height = 0.1317) {
    const bool weft = k % 2 == 1;
    const double place = 0.5137 * (k / 2 + 0.5), phase = std::numbers::pi * (k / 2 % 2);
    for (int j = 0; j < 16; ++j) {
      const double along = 8.2193 * j / 15, z = height * std::cos(along * 6.1152 + phase);
      for (int i = 0; i < 18; ++i) {
        // The clamped form of 16 points round: the seam is the midpoint of an edge.
        const double turn = i == 0 || i == 17 ? -0.5 : i - 1.0;
        const double reach = i == 0 || i == 17 ? std::cos(std::numbers::pi / 16) : 1.0;
        const double angle = 2 * std::numbers::pi * turn / 16;
        const double across = place + 0.2011 * reach * std::cos(angle),
                     up = z + 0.1003 * reach * std::sin(angle);
        Vec3& point = body_.surface.points[static_cast<std::size_t>(j * 18 + i)];
        point = weft ? Vec3(-across, along, up) : Vec3(along, across, up);
      }
      body_.surface.point(17, j) = body_.surface.point(0, j);
    }
    body_.name = fmt::format("{}_{}", weft ? "weft" : "warp", k / 2 + 1);
    body_.role = weft ? yarn::Role::weft : yarn::Role::warp;
    body_.color = weft ? yarn::Color{0, 120, 255} : yarn::Color{200, 205, 0};
    for (const bool last : {false, true}) {
      yarn::EndFace& end = last ? body_.end : body_.start;
      end.style = yarn::EndStyle::patch;
      end.surface = yarn::coons_patch(yarn::end_quarters(body_, last));
      end.inward = !last;
    }
    return body_;
  }

 private:
  yarn::Body body_;
};

}  // namespace selvage::benchmarks
