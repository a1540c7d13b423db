#include "pipeline/scaling.h"

#include <array>
#include <numeric>

#include "cad/edges.h"
#include "yarn/ends.h"

namespace selvage::pipeline {

namespace {

struct Ratio {
  double up = 1, down = 1;
  double operator()(double value) const { return value * up / down; }
  template <class Point>
  void apply(Eigen::MatrixBase<Point>& p) const {
    for (double& x : p.derived()) x = (*this)(x);
  }
  template <class Points>
  void apply_to_all(Points& points) const {
    for (auto& p : points) apply(p);
  }
};

Ratio ratio(Unit from, Unit to) {
  const std::int64_t a = exact_size(from), b = exact_size(to), common = std::gcd(a, b);
  const std::int64_t up = a / common, down = b / common;
  return {static_cast<double>(up), static_cast<double>(down)};
}

}  // namespace

double converted(double value, Unit from, Unit to) {
  return ratio(from, to)(value);
}

void convert_lengths(yarn::Body& body, Unit from, Unit to) {
  if (from == to) return;
  const Ratio scale = ratio(from, to);
  // End faces that seal() made are made anew, so that they are what it would make of the converted yarn.
  const std::array<bool, 2> standard = {yarn::is_standard_end(body, false),
                                        yarn::is_standard_end(body, true)};
  for (nurbs::Surface* surface : {&body.surface, &body.start.surface, &body.end.surface})
    scale.apply_to_all(surface->points);
  scale.apply_to_all(body.axis.points);
  for (const bool last : {false, true})
    if (standard[last ? 1 : 0]) yarn::renew_end(body, last);
  scale.apply(body.at);
  scale.apply(body.start.origin);
  scale.apply(body.end.origin);
  for (double* length :
       {&body.length, &body.tube_error, &body.tolerance, &body.min_bend_radius, &body.resolution})
    *length = scale(*length);
  body.twist = Ratio{scale.down, scale.up}(body.twist);
  body.end_area = scale(scale(body.end_area));
  body.volume = scale(scale(scale(body.volume)));
  for (yarn::TightBend& bend : body.tight_bends) {
    scale.apply(bend.at);
    bend.radius = scale(bend.radius);
    bend.needed = scale(bend.needed);
  }
}

void convert_lengths(fabric::PieceShape& piece, Unit from, Unit to) {
  if (from == to) return;
  const Ratio scale = ratio(from, to);
  for (fabric::PieceEdge& edge : piece.edges) {
    scale.apply_to_all(edge.curve.points);
    if (!edge.fit) continue;
    for (nurbs::Bezier* bezier : {&edge.fit->bezier.solved, &edge.fit->bezier.descended})
      scale.apply_to_all(*bezier);
    for (fabric::FixedPoint& fixed : edge.fit->points) {
      scale.apply(fixed.at);
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
  part.kernel_scale = scale(part.kernel_scale);
  for (cad::Face& face : part.faces) {
    scale.apply_to_all(face.surface.points);
    for (cad::Edge& edge : cad::boundary_edges_of(face)) scale.apply_to_all(edge.curve.points);
    if (face.area) *face.area = scale(scale(*face.area));
  }
}

void convert_lengths(cad::NamedCurve& curve, Unit from, Unit to) {
  if (from != to) ratio(from, to).apply_to_all(curve.curve.points);
}

}  // namespace selvage::pipeline
