#include "pipeline/scaling.h"

#include <array>
#include <numeric>

#include "cad/edges.h"
#include "yarn/ends.h"

namespace selvage::pipeline {

namespace {

// Whole tenths of a micrometre in one unit.
long long exact_size(Unit unit) {
  switch (unit) {
    case Unit::m:
      return 10'000'000;
    case Unit::cm:
      return 100'000;
    case Unit::mm:
      return 10'000;
    case Unit::um:
      return 10;
    case Unit::inch:
      return 254'000;
  }
  return 10'000;
}

struct Ratio {
  double up = 1, down = 1;
  double operator()(double value) const { return value * up / down; }
};

Ratio ratio(Unit from, Unit to) {
  const long long a = exact_size(from), b = exact_size(to), common = std::gcd(a, b);
  const long long up = a / common, down = b / common;
  return {static_cast<double>(up), static_cast<double>(down)};
}

}  // namespace

double converted(double value, Unit from, Unit to) {
  return ratio(from, to)(value);
}

void convert_lengths(yarn::Body& body, Unit from, Unit to) {
  if (from == to) return;
  const Ratio scale = ratio(from, to);
  const auto point = [&](Vec3& p) {
    for (double& x : p) x = scale(x);
  };
  // End faces that seal() made are made anew, so that they are what it would make of the converted yarn.
  const std::array<bool, 2> standard = {yarn::is_standard_end(body, false),
                                        yarn::is_standard_end(body, true)};
  for (nurbs::Surface* surface : {&body.surface, &body.start.surface, &body.end.surface})
    for (Vec3& p : surface->points) point(p);
  for (Vec3& p : body.axis.points) point(p);
  for (const bool last : {false, true})
    if (standard[last ? 1 : 0]) yarn::renew_end(body, last);
  point(body.start.origin);
  point(body.end.origin);
  for (double* length : {&body.length, &body.tube_error, &body.min_bend_radius, &body.resolution})
    *length = scale(*length);
  body.twist = Ratio{scale.down, scale.up}(body.twist);
  body.end_area = scale(scale(body.end_area));
  body.volume = scale(scale(scale(body.volume)));
  for (yarn::TightBend& bend : body.tight_bends) {
    point(bend.at);
    bend.radius = scale(bend.radius);
    bend.needed = scale(bend.needed);
  }
}

void convert_lengths(fabric::PieceShape& piece, Unit from, Unit to) {
  if (from == to) return;
  const Ratio scale = ratio(from, to);
  const auto point = [&](auto& p) {
    for (double& x : p) x = scale(x);
  };
  for (fabric::PieceEdge& edge : piece.edges) {
    for (Vec3& p : edge.curve.points) point(p);
    if (!edge.fit) continue;
    for (nurbs::Bezier* bezier : {&edge.fit->bezier.solved, &edge.fit->bezier.descended})
      for (Vec2& p : *bezier) point(p);
    for (fabric::FixedPoint& fixed : edge.fit->points) {
      point(fixed.at);
      fixed.error = scale(fixed.error);
      fixed.distance = scale(fixed.distance);
    }
  }
  piece.area = scale(scale(piece.area));
  piece.perimeter = scale(piece.perimeter);
  piece.box = fabric::box_of(piece.edges);
}

void convert_lengths(cad::Part& part, Unit from, Unit to) {
  if (from == to) return;
  const Ratio scale = ratio(from, to);
  const auto all = [&](std::vector<Vec3>& points) {
    for (Vec3& p : points)
      for (double& x : p) x = scale(x);
  };
  for (cad::Face& face : part.faces) {
    all(face.surface.points);
    for (cad::Edge& edge : cad::edges_of(face)) all(edge.curve.points);
  }
}

void convert_lengths(cad::NamedCurve& curve, Unit from, Unit to) {
  if (from == to) return;
  const Ratio scale = ratio(from, to);
  for (Vec3& p : curve.curve.points)
    for (double& x : p) x = scale(x);
}

}  // namespace selvage::pipeline
