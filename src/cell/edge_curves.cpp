#include "cell/edge_curves.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "nurbs/restrict.h"
#include "nurbs/roots.h"
#include "nurbs/turn.h"

namespace selvage::cell {

namespace {

Vec3 flat_point(const Vec2& q) {
  return {q.x(), q.y(), 0};
}

// Control points of the cubic with these ends and derivatives, over a parameter of length h.
std::array<Vec3, 4> hermite(const Vec3& a, const Vec3& da, const Vec3& b, const Vec3& db, double h) {
  return {a, a + h / 3 * da, b - h / 3 * db, b};
}

Vec3 bezier_at(const std::array<Vec3, 4>& b, double t) {
  const double s = 1 - t;
  return s * s * s * b[0] + 3 * s * s * t * b[1] + 3 * s * t * t * b[2] + t * t * t * b[3];
}

// Cubics end to end as one curve: where two have one derivative, the control point at their joint goes.
class Chain {
 public:
  void add(const std::array<Vec3, 4>& cubic, double length, bool smooth) {
    if (curve_.points.empty()) {
      curve_.knots.assign(4, 0.0);
      curve_.points.push_back(cubic[0]);
    } else {
      const double joint = end_;
      curve_.knots.insert(curve_.knots.end(), smooth ? 2 : 3, joint);
      if (smooth) curve_.points.pop_back();
    }
    curve_.points.insert(curve_.points.end(), cubic.begin() + 1, cubic.end());
    end_ += length;
  }
  nurbs::Curve finish() {
    curve_.knots.insert(curve_.knots.end(), 4, end_);
    return std::move(curve_);
  }

 private:
  nurbs::Curve curve_;
  double end_ = 0;
};

constexpr int most_halvings = 24;

// A knot that is as near as rounding, else the value: spans of no length are no curve.
double at_knot(double value, const std::vector<double>& knots) {
  const auto next = std::lower_bound(knots.begin(), knots.end(), value);
  const double enough = 1e-9 * (knots.back() - knots.front());
  if (next != knots.end() && *next - value <= enough) return *next;
  if (next != knots.begin() && value - *(next - 1) <= enough) return *(next - 1);
  return value;
}

}  // namespace

ArcPath::ArcPath(const yarn::Body& body, const Box3& box, const Arc& arc, bool closed)
    : body_(&body), arc_(&arc), closed_(closed) {
  if (arc.face < face_count) axis_ = axis_of(arc.face);
  if (arc.along == Arc::Along::through) {
    curve_.emplace(body, box, arc);
    length_ = curve_->length();
  } else {
    length_ = std::abs(arc.parameters.back().x() - arc.parameters.front().x());
  }
  gain_ = arc.parameters.back() - arc.parameters.front();
}

double ArcPath::along_of(std::size_t index) const {
  return curve_ ? curve_->lengths()[index]
                : std::abs(arc_->parameters[index].x() - arc_->parameters.front().x());
}

Vec2 ArcPath::at(double along) const {
  Vec2 shift = Vec2::Zero();
  if (closed_ && along > length_) {
    along -= length_;
    shift = gain_;
  }
  if (curve_) return curve_->at(std::clamp(along, 0.0, length_)) + shift;
  const Vec2 first = arc_->parameters.front();
  return Vec2(first.x() + std::copysign(along, gain_.x()), first.y()) + shift;
}

Vec3 ArcPath::position(double along) const {
  return place(along).at;
}

ArcPath::Place ArcPath::place(double along) const {
  const Vec2 q = at(along);
  return {q, curve_ ? curve_->position(q) : cell::position(*body_, q)};
}

double ArcPath::crossing(int axis, double value, double from, double to) const {
  nurbs::FalsePosition root{from, at(from)[axis] - value, to, at(to)[axis] - value};
  if (root.at_from == 0) return from;
  if (root.at_to == 0) return to;
  for (int step = 0; step < 100 && root.to - root.from > 1e-15 * (1 + length_); ++step) {
    // Halved where it does not come nearer.
    double middle = root.from + (root.to - root.from) * root.at_from / (root.at_from - root.at_to);
    if (step % 8 == 7 || !(middle > root.from && middle < root.to)) middle = 0.5 * (root.from + root.to);
    const double miss = at(middle)[axis] - value;
    if (miss == 0 || std::abs(miss) < 1e-15 * (1 + std::abs(value))) return middle;
    root.take(middle, miss);
  }
  return 0.5 * (root.from + root.to);
}

// Seen from a place a little beside, since the surface may have an edge along a knot line here.
ArcPath::Way ArcPath::way(const Place& here, const Vec2& beside, const Vec3& chord) const {
  const nurbs::SurfaceJet s = jet(*body_, here.parameters + 1e-6 * (beside - here.parameters));
  const Vec3 normal = s.du.cross(s.dv);
  Vec3 along = normal.cross(Vec3::Unit(axis_));
  // Where the surface touches the face, the chord is all there is.
  if (!(along.norm() > 1e-7 * normal.norm())) along = chord;
  along[axis_] = 0;
  along.normalize();
  if (along.dot(chord) < 0) along = -along;
  Eigen::Matrix<double, 3, 2> slopes;
  slopes << s.du, s.dv;
  return {along, slopes.colPivHouseholderQr().solve(along)};
}

ArcPath::Span ArcPath::span(double from, double to) const {
  Span made;
  made.from = from;
  made.to = to;
  made.first = place(from);
  made.last = place(to);
  const Vec3 middle = position(0.5 * (from + to));
  const double chord = (made.last.at - made.first.at).norm();
  // Of the fourth order, from one chord and two.
  made.length = (4 * ((middle - made.first.at).norm() + (made.last.at - middle).norm()) - chord) / 3;
  const double step = 1e-3 * (to - from);
  const Place second = place(from + step), before = place(to - step);
  made.out = way(made.first, second.parameters, second.at - made.first.at);
  made.in = way(made.last, before.parameters, made.last.at - before.at);
  return made;
}

bool ArcPath::is_near(const Span& span, double tolerance) const {
  const Vec3 chord = span.last.at - span.first.at;
  if (span.out.space.dot(chord) < 0.5 * chord.norm() || span.in.space.dot(chord) < 0.5 * chord.norm())
    return false;
  const auto space = hermite(span.first.at, span.out.space, span.last.at, span.in.space, span.length);
  const auto flat = hermite(flat_point(span.first.parameters), flat_point(span.out.flat),
                            flat_point(span.last.parameters), flat_point(span.in.flat), span.length);
  for (const double t : {0.25, 0.5, 0.75}) {
    const Vec3 q = bezier_at(flat, t);
    if ((cell::position(*body_, {q.x(), q.y()}) - bezier_at(space, t)).norm() > tolerance) return false;
  }
  return true;
}

void ArcPath::divide(double from, double to, double tolerance, int depth, std::vector<Span>& spans) const {
  Span made = span(from, to);
  const bool is_short = made.length <= 10 * tolerance || depth >= most_halvings;
  if (is_short || is_near(made, tolerance)) {
    spans.push_back(made);
    return;
  }
  const double middle = 0.5 * (from + to);
  divide(from, middle, tolerance, depth + 1, spans);
  divide(middle, to, tolerance, depth + 1, spans);
}

// Where the arc crosses the surface's knots, across which it is less smooth, and its ends.
std::vector<double> ArcPath::breaks(double from, double to) const {
  const nurbs::Surface& surface = body_->surface;
  const std::array<std::vector<double>, 2> lines = {nurbs::breakpoints(surface.knots_u, surface.degree_u),
                                                    nurbs::breakpoints(surface.knots_v, surface.degree_v)};
  std::vector<double> kept = {from, to};
  for (const double round : {0.0, length_})
    for (std::size_t i = 0; i < arc_->parameters.size(); ++i)
      if (const double along = along_of(i) + round; along > from && along < to) kept.push_back(along);
  std::sort(kept.begin(), kept.end());
  std::vector<double> found = {from};
  for (std::size_t i = 1; i < kept.size(); ++i) {
    const Vec2 a = at(kept[i - 1]), b = at(kept[i]);
    for (int axis = 0; axis < 2; ++axis) {
      const std::vector<double>& values = lines[static_cast<std::size_t>(axis)];
      const double period = values.back() - values.front();
      const double low = std::min(a[axis], b[axis]), high = std::max(a[axis], b[axis]);
      for (double turn = std::floor((low - values.front()) / period); values.front() + turn * period < high;
           turn += 1)
        for (const double value : values)
          if (const double line = value + turn * period; line > low && line < high)
            found.push_back(crossing(axis, line, kept[i - 1], kept[i]));
    }
  }
  std::sort(found.begin(), found.end());
  const double least = 1e-4 * (to - from);
  std::vector<double> result = {from};
  for (const double along : found)
    if (along > result.back() + least && along < to - least) result.push_back(along);
  result.push_back(to);
  return result;
}

EdgeCurves ArcPath::row(double from, double to) const {
  const nurbs::Surface& surface = body_->surface;
  const bool backward = gain_.x() < 0;
  const Vec2 a = at(from), b = at(to);
  double low = std::min(a.x(), b.x()), high = std::max(a.x(), b.x());
  const double period = surface.last_u() - surface.first_u();
  // Whole periods to the domain: the stretch does not cross the seam.
  const double shift = period * std::floor((0.5 * (low + high) - surface.first_u()) / period);
  EdgeCurves edge;
  edge.space =
      nurbs::restricted(nurbs::boundary_row(surface, arc_->along == Arc::Along::end),
                        std::max(low - shift, surface.first_u()), std::min(high - shift, surface.last_u()));
  const double t0 = edge.space.first_parameter(), t1 = edge.space.last_parameter();
  edge.flat = nurbs::segment(Vec3(t0 + shift, a.y(), 0), Vec3(t1 + shift, a.y(), 0), t0, t1);
  if (backward) edge = {nurbs::reversed(edge.space), nurbs::reversed(edge.flat)};
  return edge;
}

EdgeCurves ArcPath::curves(double from, double to, double tolerance) const {
  if (!curve_) return row(from, to);
  std::vector<Span> spans;
  const std::vector<double> stops = breaks(from, to);
  for (std::size_t i = 1; i < stops.size(); ++i) divide(stops[i - 1], stops[i], tolerance, 0, spans);
  // One derivative where two spans have the same up to rounding; else a corner.
  std::vector<bool> smooth(spans.size(), false);
  for (std::size_t i = 1; i < spans.size(); ++i) {
    Way &in = spans[i - 1].in, &out = spans[i].out;
    smooth[i] = (in.space - out.space).norm() < 1e-5 && (in.flat - out.flat).norm() < 1e-5 * in.flat.norm();
    if (!smooth[i]) continue;
    in = {(in.space + out.space).normalized(), 0.5 * (in.flat + out.flat)};
    out = in;
  }
  Chain space, flat;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const Span& s = spans[i];
    space.add(hermite(s.first.at, s.out.space, s.last.at, s.in.space, s.length), s.length, smooth[i]);
    flat.add(hermite(flat_point(s.first.parameters), flat_point(s.out.flat), flat_point(s.last.parameters),
                     flat_point(s.in.flat), s.length),
             s.length, smooth[i]);
  }
  EdgeCurves edge{space.finish(), flat.finish()};
  // The face's own coordinate to the bit, whatever the sums were rounded to.
  for (Vec3& p : edge.space.points) p[axis_] = spans.front().first.at[axis_];
  return edge;
}

EdgeCurves line_of_constant_u(const nurbs::Surface& surface, double u, double v0, double v1) {
  v0 = at_knot(v0, surface.knots_v);
  v1 = at_knot(v1, surface.knots_v);
  const bool at_end = u >= surface.last_u();
  nurbs::Surface beside = at_end ? nurbs::restricted(surface, surface.first_u(), surface.last_u(), v0, v1)
                                 : nurbs::restricted(surface, u, surface.last_u(), v0, v1);
  EdgeCurves edge;
  edge.space = nurbs::boundary_column(beside, at_end);
  edge.flat = nurbs::segment(Vec3(u, v0, 0), Vec3(u, v1, 0), v0, v1);
  return edge;
}

}  // namespace selvage::cell
