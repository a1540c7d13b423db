#include "formats/iges/bodies.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "yarn/finish.h"
#include "yarn/grid.h"

namespace selvage::test {

namespace {

using std::numbers::pi;

yarn::Body built(const std::string& name, const yarn::GridNet& net, yarn::EndStyle ends) {
  yarn::Body body;
  body.name = name;
  Status status = yarn::fill_from_grid(body, net);
  if (status.ok()) status = yarn::finish(body, ends);
  if (!status.ok()) {
    std::fprintf(stderr, "a test's own yarn cannot be built: %s\n", to_string(status.error()).c_str());
    std::abort();
  }
  return body;
}

}  // namespace

yarn::Body wave(const std::string& name, const Wave& shape, yarn::EndStyle ends) {
  yarn::GridNet net;
  net.sections = shape.sections;
  net.per_section = shape.round;
  for (int j = 0; j < shape.sections; ++j) {
    const double x = shape.length * j / (shape.sections - 1);
    const double angle = 2 * pi * j / (shape.sections - 1) + shape.phase;
    const double slope = 2 * pi / shape.length * shape.amplitude * -std::sin(angle);
    const Vec3 centre(x, shape.y, shape.amplitude * std::cos(angle));
    const Vec3 across = Vec3::UnitY(), up = Vec3(-slope, 0, 1).normalized();
    for (int i = 0; i < shape.round; ++i) {
      const double turn = 2 * pi * i / shape.round * (shape.reversed ? -1 : 1);
      net.points.push_back(centre + 0.5 * shape.width * std::cos(turn) * across +
                           0.5 * shape.height * std::sin(turn) * up);
      if (shape.weight_step > 0) net.weights.push_back(1 + shape.weight_step * (i % 2));
    }
  }
  return built(name, net, ends);
}

yarn::Body ring(const std::string& name) {
  yarn::GridNet net;
  net.sections = 12;
  net.per_section = 16;
  net.closed_along = true;
  for (int j = 0; j < net.sections; ++j) {
    const double along = 2 * pi * j / net.sections;
    const Vec3 out(std::cos(along), std::sin(along), 0);
    for (int i = 0; i < net.per_section; ++i) {
      const double turn = -2 * pi * i / net.per_section;
      net.points.push_back((5 + 0.5 * std::cos(turn)) * out + 0.5 * std::sin(turn) * Vec3::UnitZ());
    }
  }
  return built(name, net, yarn::EndStyle::patch);
}

std::vector<yarn::Body> plain_weave(yarn::EndStyle ends) {
  std::vector<yarn::Body> bodies;
  for (int i = 0; i < 2; ++i) {
    bodies.push_back(wave("warp" + std::to_string(i + 1), {.y = 1.0 + 2 * i, .phase = (i - 0.5) * pi}, ends));
    bodies.back().role = yarn::Role::warp;
    bodies.back().color = {200, 0, 0};
  }
  for (int i = 0; i < 2; ++i) {
    // Turned by a quarter about z; the other phase, so that warp and weft pass each other.
    yarn::GridNet net;
    const Wave shape{.y = 1.0 + 2 * i, .phase = (i - 0.5) * pi};
    const yarn::Body model = wave("weft" + std::to_string(i + 1), shape, ends);
    net.sections = model.surface.count_v;
    net.per_section = model.surface.count_u;
    net.open_round = true;
    for (const Vec3& p : model.surface.points) net.points.emplace_back(-p.y() + 4, p.x(), p.z());
    bodies.push_back(built(model.name, net, ends));
    bodies.back().role = yarn::Role::weft;
    bodies.back().color = {0, 120, 255};
  }
  return bodies;
}

}  // namespace selvage::test
