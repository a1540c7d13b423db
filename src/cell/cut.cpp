#include "cell/cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cell/trim.h"
#include "core/wrapped.h"

namespace selvage::cell {

std::string name_of_face(int face) {
  return std::string(1, "xyz"[axis_of(face)]) + (is_high(face) ? " high" : " low");
}

Vec3 in_face(const Box3& box, int face, const Vec2& at) {
  Vec3 point;
  point[axis_of(face)] = plane_of(box, face);
  point[axes_in(face)[0]] = at.x();
  point[axes_in(face)[1]] = at.y();
  return point;
}

int edge_between(int face_a, int face_b) {
  const int axis = 3 - axis_of(face_a) - axis_of(face_b);
  int side = 0;
  for (const int face : {face_a, face_b})
    if (is_high(face)) side |= axis_of(face) == (axis + 1) % 3 ? 1 : 2;
  return 4 * axis + side;
}

std::array<int, 2> faces_of_edge(int edge) {
  const int axis = edge / 4, side = edge % 4;
  return {2 * ((axis + 1) % 3) + (side & 1), 2 * ((axis + 2) % 3) + (side >> 1)};
}

Vec3 edge_point(const Box3& box, int edge, double along) {
  Vec3 point;
  point[edge / 4] = along;
  for (const int face : faces_of_edge(edge)) point[axis_of(face)] = plane_of(box, face);
  return point;
}

Message in_space(Message message, const Parallelepiped& cell) {
  if (message.at) message.at = cell.axes.place(*message.at);
  return message;
}

namespace {

double into_domain(double value, double first, double last) {
  return value >= first && value <= last ? value : wrapped(value, first, last);
}

}  // namespace

Vec2 in_domain(const yarn::Body& body, const Vec2& parameters) {
  const nurbs::Surface& surface = body.surface;
  Vec2 result(into_domain(parameters.x(), surface.first_u(), surface.last_u()), parameters.y());
  if (body.closed_along) result.y() = into_domain(result.y(), surface.first_v(), surface.last_v());
  return result;
}

Vec2 periods(const yarn::Body& body) {
  const nurbs::Surface& surface = body.surface;
  return {surface.last_u() - surface.first_u(), surface.last_v() - surface.first_v()};
}

Vec2 beside(const yarn::Body& body, const Vec2& near, Vec2 parameters) {
  const Vec2 period = periods(body);
  for (int axis = 0; axis < (body.closed_along ? 2 : 1); ++axis)
    parameters[axis] += period[axis] * std::round((near[axis] - parameters[axis]) / period[axis]);
  return parameters;
}

Vec3 position(const yarn::Body& body, const Vec2& parameters) {
  const Vec2 q = in_domain(body, parameters);
  return nurbs::evaluate(body.surface, q.x(), q.y());
}

nurbs::SurfaceJet jet(const yarn::Body& body, const Vec2& parameters) {
  const Vec2 q = in_domain(body, parameters);
  return nurbs::evaluate_jet(body.surface, q.x(), q.y());
}

Result<Cut> cut(std::span<const yarn::Body> bodies, const Box3& box, double tolerance) {
  Cut result;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    Result<Cut> trimmed = trim(bodies[i], box, tolerance);
    if (!trimmed) return trimmed.error().of_yarn(bodies[i].name, bodies[i].place);
    for (const Message& note : trimmed->notes)
      result.notes.push_back(note.of_yarn(bodies[i].name, bodies[i].place));
    for (Piece& piece : trimmed->pieces) {
      piece.body = i;
      result.pieces.push_back(std::move(piece));
    }
  }
  if (result.pieces.empty())
    return error(Kind::geometry,
                 "no yarn's surface goes through the cell: it lies beside all of them, or whole inside one");
  return result;
}

ArcCurve::ArcCurve(const yarn::Body& body, const Parallelepiped& cell, const Arc& arc)
    : body_(&body), arc_(&arc), cell_(cell) {
  if (arc.face < face_count) {
    axis_ = axis_of(arc.face);
    plane_ = plane_of(cell.box, arc.face);
  }
  lengths_.push_back(0);
  points_.reserve(arc.parameters.size());
  for (const Vec2& q : arc.parameters) points_.push_back(position(q));
  for (std::size_t i = 1; i < points_.size(); ++i)
    lengths_.push_back(lengths_.back() + (points_[i] - points_[i - 1]).norm());
}

Vec3 ArcCurve::position(const Vec2& parameters) const {
  const Vec3 point = cell::position(*body_, parameters);
  return axis_ >= 0 ? cell_.with(point, axis_, plane_) : point;
}

ArcCurve::Foot ArcCurve::nearest(const Vec3& point) const {
  Foot best;
  for (std::size_t k = 0; k + 1 < points_.size(); ++k) {
    const double share = nearest_share(point, points_[k], points_[k + 1]);
    const double distance = (points_[k] + share * (points_[k + 1] - points_[k]) - point).norm();
    if (distance < best.distance) best = {lengths_[k] + share * (lengths_[k + 1] - lengths_[k]), distance};
  }
  return best;
}

Vec2 ArcCurve::at(double along) const {
  const auto after = std::lower_bound(lengths_.begin(), lengths_.end(), along);
  if (after == lengths_.end()) return arc_->parameters.back();
  const auto k = static_cast<std::size_t>(after - lengths_.begin());
  if (k == 0 || *after == along) return arc_->parameters[k];
  const double share = (along - lengths_[k - 1]) / (lengths_[k] - lengths_[k - 1]);
  const Vec2 from = arc_->parameters[k - 1], way = arc_->parameters[k] - from;
  const Vec3 on_chord = points_[k - 1] + share * (points_[k] - points_[k - 1]);
  const Vec3 chord = (points_[k] - points_[k - 1]).normalized();
  // Two equations: on the face (or along the end), and in the plane across the chord.
  Vec2 q = from + share * way;
  for (int step = 0; step < 20; ++step) {
    const nurbs::SurfaceJet s = jet(*body_, q);
    const Vec3 miss = s.position - on_chord;
    Eigen::Matrix2d slopes;
    Vec2 values(0, chord.dot(miss));
    slopes.row(1) << chord.dot(s.du), chord.dot(s.dv);
    if (arc_->along == Arc::Along::through) {
      values[0] = cell_.axes.own(s.position)[axis_] - plane_;
      slopes.row(0) << cell_.axes.own(s.du)[axis_], cell_.axes.own(s.dv)[axis_];
    } else {
      slopes.row(0) << 0, 1;
    }
    const Vec2 change = slopes.fullPivLu().solve(values);
    if (!change.allFinite() || change.norm() > 2 * way.norm()) break;
    q -= change;
    if (change.norm() <= 1e-14 * (1 + q.norm())) break;
  }
  return q;
}

}  // namespace selvage::cell
