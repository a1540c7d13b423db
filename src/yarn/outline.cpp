#include "yarn/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/overloaded.h"
#include "core/plane.h"
#include "nurbs/interpolate.h"
#include "yarn/ends.h"
#include "yarn/grid.h"

namespace selvage::yarn {

namespace {

using std::numbers::pi;

// A knot of the outline's first quarter (from the +x extreme to the +y extreme): the shape's point and
// tangent there.
struct Joint {
  Vec2 point, tangent;
  bool is_double = false;  // a corner, or a place where the knots shall not depend on the size
};

// ---- the quarters of each shape
// ----------------------------------------------------------------------------------

// Round the circle of this centre and radius from one angle to another.
void add_arc(std::vector<Joint>& joints, const Vec2& centre, double radius, double from, double to,
             int pieces) {
  for (int i = 0; i <= pieces; ++i) {
    const double a = from + (to - from) * i / pieces;
    // The quarter's ends lie on the axes exactly.
    const double c = std::abs(a - pi / 2) < 1e-15 ? 0.0 : std::cos(a);
    joints.push_back({centre + radius * Vec2(c, std::sin(a)), Vec2(-std::sin(a), c)});
  }
}

std::vector<Joint> lens_quarter(const SectionSize& size, int pieces) {
  const double a = 0.5 * size.width, h = 0.5 * size.height;
  const auto [radius, half_angle] = lens_arc(size);
  std::vector<Joint> joints;
  add_arc(joints, Vec2(0.0, h - radius), radius, pi / 2 - half_angle, pi / 2, pieces);
  joints.front().point = Vec2(a, 0.0);
  joints.front().is_double = true;
  joints.back().point = Vec2(0.0, h);
  return joints;
}

std::vector<Joint> racetrack_quarter(const SectionSize& size, int pieces, bool varying) {
  const double a = 0.5 * size.width, h = 0.5 * size.height, r = std::min(a, h);
  std::vector<Joint> joints;
  if (h > a) {  // upright: the straight side first
    joints.push_back({Vec2(a, 0.0), Vec2(0.0, 1.0)});
    add_arc(joints, Vec2(0.0, h - r), r, 0.0, pi / 2, pieces);
    joints[1].is_double = varying;
  } else {
    add_arc(joints, Vec2(a - r, 0.0), r, 0.0, pi / 2, pieces);
    joints.back().is_double = varying;
    joints.push_back({Vec2(0.0, h), Vec2(-1.0, 0.0)});
    if (a == h && !varying) joints.pop_back();
  }
  return joints;
}

// The power section's quarter of size (2, 2) and its tangent.
Vec2 power_point(double exponent, double a) {
  return {a >= pi / 2 ? 0.0 : std::cos(a), std::pow(std::sin(a), exponent)};
}
Vec2 power_tangent(double exponent, double a) {
  if (a <= 0.0) {
    if (exponent < 2.0) return {0.0, 1.0};
    return exponent == 2.0 ? Vec2(-1.0, 2.0) : Vec2(-1.0, 0.0);
  }
  const double s = std::sin(a), c = a >= pi / 2 ? 0.0 : std::cos(a);
  return Vec2(-s, exponent * std::pow(s, exponent - 1.0) * c).normalized();
}

// Where the tangents at two joints meet; between parallel ones (a straight edge) the middle.
Vec2 meeting_point(const Joint& a, const Joint& b) {
  const double denominator = cross(a.tangent, b.tangent);
  const Vec2 step = b.point - a.point;
  if (std::abs(denominator) <= 1e-12 * a.tangent.norm() * b.tangent.norm()) return 0.5 * (a.point + b.point);
  return a.point + cross(step, b.tangent) / denominator * a.tangent;
}

// The distance from p to the power curve between two angles (size 2, 2), as the vector from the nearest
// point.
Vec2 from_power_curve(double exponent, const Vec2& p, double from, double to) {
  double best = std::numeric_limits<double>::infinity(), at = from, step = (to - from) / 8.0;
  for (int i = 0; i <= 8; ++i) {
    const double a = from + i * step, d = (p - power_point(exponent, a)).squaredNorm();
    if (d < best) {
      best = d;
      at = a;
    }
  }
  for (int i = 0; i < 60; ++i) {  // golden enough: halve the step round the best place
    step *= 0.6;
    for (const double a : {at - step, at + step}) {
      if (a < from || a > to) continue;
      const double d = (p - power_point(exponent, a)).squaredNorm();
      if (d < best) {
        best = d;
        at = a;
      }
    }
  }
  return p - power_point(exponent, at);
}

double power_piece_error(double exponent, double from, double to) {
  const Joint a{power_point(exponent, from), power_tangent(exponent, from)},
      b{power_point(exponent, to), power_tangent(exponent, to)};
  const Vec2 middle = meeting_point(a, b);
  double largest = 0.0;
  for (double t : {0.2, 0.35, 0.5, 0.65, 0.8}) {
    const Vec2 p = (1 - t) * (1 - t) * a.point + 2 * t * (1 - t) * middle + t * t * b.point;
    largest = std::max(largest, from_power_curve(exponent, p, from, to).norm());
  }
  return largest;
}

// Angles of the power quarter's joints: the worst piece is halved until there are enough.
std::vector<double> power_angles(double exponent, int pieces) {
  std::vector<double> angles = {0.0, pi / 2};
  if (exponent > 2.0)
    angles.insert(angles.begin() + 1, std::atan(std::sqrt(exponent - 2.0)));  // its inflection
  std::vector<double> errors;
  for (std::size_t i = 0; i + 1 < angles.size(); ++i)
    errors.push_back(power_piece_error(exponent, angles[i], angles[i + 1]));
  while (static_cast<int>(angles.size()) < pieces + 1) {
    const auto worst = std::max_element(errors.begin(), errors.end()) - errors.begin();
    const auto k = static_cast<std::size_t>(worst);
    const double from = angles[k], to = angles[k + 1];
    // Geometric toward the tip, where the curve is not analytic.
    const double middle = from == 0.0 ? to * 0.35 : 0.5 * (from + to);
    angles.insert(angles.begin() + worst + 1, middle);
    errors[k] = power_piece_error(exponent, from, middle);
    errors.insert(errors.begin() + worst + 1, power_piece_error(exponent, middle, to));
  }
  return angles;
}

std::vector<Joint> power_quarter(const Power& shape, const SectionSize& size, int pieces) {
  std::vector<Joint> joints;
  const Eigen::Array2d half(0.5 * size.width, 0.5 * size.height);
  for (double a : power_angles(shape.exponent, pieces)) {
    Joint joint{power_point(shape.exponent, a), power_tangent(shape.exponent, a)};
    joint.point = joint.point.array() * half;
    joint.tangent = joint.tangent.array() * half;
    joints.push_back(joint);
  }
  joints.front().is_double = shape.exponent >= 2.0;
  return joints;
}

// ---- from a quarter to the closed outline
// ------------------------------------------------------------------------

// Knot spans of a quarter: a simple knot lies where its joint divides the control polygon's edge (a property
// of quadratic B-splines); behind a double one the spans begin anew. The seam and the top are symmetric.
std::vector<double> quarter_spans(const std::vector<Joint>& joints, const std::vector<Vec2>& control) {
  std::vector<double> spans(control.size(), 1.0);
  for (std::size_t i = 1; i < control.size(); ++i) {
    const double before = (joints[i].point - control[i - 1]).norm(),
                 after = (control[i] - joints[i].point).norm();
    spans[i] = joints[i].is_double ? 1.0 : spans[i - 1] * after / before;
  }
  const auto [low, high] = std::minmax_element(spans.begin(), spans.end());
  if (*high - *low < 1e-9 * *high) std::fill(spans.begin(), spans.end(), 1.0);
  return spans;
}

Outline assemble(const std::vector<Joint>& joints) {
  std::vector<Vec2> control;
  for (std::size_t i = 0; i + 1 < joints.size(); ++i)
    control.push_back(meeting_point(joints[i], joints[i + 1]));
  const std::vector<double> spans = quarter_spans(joints, control);
  const std::size_t k = control.size();
  // Cumulative knots of a quarter, 0 .. 1.
  std::vector<double> sums(k + 1, 0.0);
  for (std::size_t i = 0; i < k; ++i) sums[i + 1] = sums[i] + spans[i];
  Outline outline;
  outline.knots = {0.0, 0.0, 0.0};
  outline.points = {joints.front().point};
  const auto mirrored = [](const Vec2& p, int quarter) {
    return Vec2(quarter == 1 || quarter == 2 ? -p.x() : p.x(), quarter >= 2 ? -p.y() : p.y());
  };
  for (int quarter = 0; quarter < 4; ++quarter) {
    const bool backward = quarter % 2 == 1;
    for (std::size_t i = 0; i < k; ++i) {
      const std::size_t piece = backward ? k - 1 - i : i;
      const std::size_t end = backward ? piece : piece + 1;  // the joint after this piece
      outline.points.push_back(mirrored(control[piece], quarter));
      const double share = backward ? 1.0 - sums[end] / sums[k] : sums[end] / sums[k];
      const double knot = i + 1 == k ? 0.25 * (quarter + 1) : 0.25 * (quarter + share);
      if (quarter == 3 && i + 1 == k) break;
      outline.knots.push_back(knot);
      if (joints[end].is_double) {
        outline.knots.push_back(knot);
        outline.points.push_back(mirrored(joints[end].point, quarter));
      }
    }
  }
  outline.points.push_back(outline.points.front());
  outline.knots.insert(outline.knots.end(), 3, 1.0);
  return outline;
}

Outline loop7_outline(const SectionSize& size) {
  // Four different control points, 0 .. 270 degrees.
  const nurbs::Curve curve = nurbs::closed_uniform(
      {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(-1, 0, 0), Vec3(0, -1, 0)}, {}, 3, [](int i) { return i / 4.0; });
  // Mean radius over the angle, by the rectangle rule on a periodic function.
  constexpr int samples = 720;
  double sum = 0.0, turned = 0.0;
  Vec3 before = nurbs::evaluate(curve, 0.0);
  for (int i = 1; i <= samples; ++i) {
    const Vec3 here = nurbs::evaluate(curve, static_cast<double>(i) / samples);
    const double angle = std::atan2(before.cross(here).z(), before.dot(here));
    sum += angle * 0.5 * (before.norm() + here.norm());
    turned += angle;
    before = here;
  }
  const double scale = turned / sum;
  Outline outline;
  outline.degree = 3;
  outline.knots = curve.knots;
  for (const Vec3& p : curve.points)
    outline.points.emplace_back(0.5 * size.width * scale * p.x(), 0.5 * size.height * scale * p.y());
  outline.points.back() = outline.points.front();
  return outline;
}

Outline polygon_outline(const Polygon& shape, const SectionSize& size) {
  std::vector<Vec2> corners = shape.corners;
  const SectionSize own = nominal_size(shape);
  for (Vec2& c : corners) c = c.array() * Eigen::Array2d(size.width / own.width, size.height / own.height);
  if (twice_area(corners) < 0.0) std::reverse(corners.begin(), corners.end());
  while (corners.size() < 4) {  // a triangle gets a corner on its longest edge: a patch has four
    std::size_t longest = 0;
    const auto edge = [&](std::size_t i) { return (corners[(i + 1) % corners.size()] - corners[i]).norm(); };
    for (std::size_t i = 1; i < corners.size(); ++i)
      if (edge(i) > edge(longest)) longest = i;
    corners.insert(corners.begin() + static_cast<std::ptrdiff_t>(longest) + 1,
                   0.5 * (corners[longest] + corners[(longest + 1) % corners.size()]));
  }
  const auto start = std::max_element(corners.begin(), corners.end(), [](const Vec2& a, const Vec2& b) {
    return a.x() != b.x() ? a.x() < b.x() : std::abs(a.y()) > std::abs(b.y());
  });
  std::rotate(corners.begin(), start, corners.end());
  double total = 0.0, run = 0.0;
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) total += (corners[(i + 1) % n] - corners[i]).norm();
  Outline outline;
  outline.knots = {0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& to = corners[(i + 1) % n];
    outline.points.push_back(corners[i]);
    outline.points.emplace_back(0.5 * (corners[i] + to));
    run += (to - corners[i]).norm();
    if (i + 1 < n) outline.knots.insert(outline.knots.end(), 2, run / total);
  }
  outline.points.push_back(corners.front());
  outline.knots.insert(outline.knots.end(), 3, 1.0);
  outline.quarters = find_quarters(as_curve(outline)).value_or(outline.quarters);
  return outline;
}

// The vector from the nearest point of the exact shape (or from one that is nearly so) to p, a point of the
// first quadrant.
Vec2 from_shape(const Section& section, const SectionSize& size, const Vec2& p) {
  const double a = 0.5 * size.width, h = 0.5 * size.height;
  const auto from_circle = [](const Vec2& q, const Vec2& centre, double radius) -> Vec2 {
    const Vec2 d = q - centre;
    return d * (1.0 - radius / d.norm());
  };
  const auto from_ellipse = [&]() -> Vec2 {
    const Vec2 away = from_circle({p.x() / a, p.y() / h}, Vec2::Zero(), 1.0);
    return {away.x() * a, away.y() * h};
  };
  return std::visit(Overloaded{
                        [&](const Circle&) { return from_ellipse(); },
                        [&](const Ellipse&) { return from_ellipse(); },
                        [&](const Lenticular&) {
                          const double radius = lens_arc(size).radius;
                          return from_circle(p, Vec2(0.0, h - radius), radius);
                        },
                        [&](const Racetrack&) {
                          const double r = std::min(a, h);
                          const Vec2 centre(std::min(p.x(), a - r), std::min(p.y(), h - r));
                          return from_circle(p, centre, r);
                        },
                        [&](const Power& power) -> Vec2 {
                          if (power.exponent == 1.0) return from_ellipse();
                          const Vec2 unit(p.x() / a, p.y() / h);
                          const Vec2 away = from_power_curve(power.exponent, unit, 0.0, pi / 2);
                          return {away.x() * a, away.y() * h};
                        },
                        // Exact.
                        [&](const Loop7&) -> Vec2 { return Vec2::Zero(); },
                        [&](const Polygon&) -> Vec2 { return Vec2::Zero(); },
                    },
                    section);
}

// The uniform periodic cubic of 4 `pieces` control points on a circle, cut open at the +x extreme, brought to
// the exact area: of eight points it is round to 5.8e-4 of its radius.
Outline ellipse_outline(const Section& section, const SectionSize& size, int pieces) {
  const int count = 4 * pieces;
  std::vector<Vec3> corners;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * pi * i / count;
    corners.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  const nurbs::Curve curve =
      nurbs::closed_uniform(corners, {}, 3, [count](int i) { return static_cast<double>(i) / count; });
  Outline outline{curve.degree, curve.knots, {}};
  for (const Vec3& p : curve.points) outline.points.emplace_back(p.x(), p.y());
  // The same numbers on both sides of both axes.
  const auto n = outline.points.size();
  outline.points.front().y() = 0.0;
  for (std::size_t i = 0; 2 * i < n; ++i)
    outline.points[n - 1 - i] = {outline.points[i].x(), -outline.points[i].y()};
  if (n % 2 == 1) outline.points[n / 2].y() = 0.0;
  const double scale = std::sqrt(area(section, size) /
                                 (0.25 * size.width * size.height * area_vector(as_curve(outline)).norm()));
  for (Vec2& p : outline.points)
    p = p.array() * Eigen::Array2d(0.5 * size.width * scale, 0.5 * size.height * scale);
  return outline;
}

}  // namespace

nurbs::Curve as_curve(const Outline& outline) {
  nurbs::Curve curve{outline.degree, outline.knots, {}, {}};
  for (const Vec2& p : outline.points) curve.points.emplace_back(p.x(), p.y(), 0.0);
  return curve;
}

LensArc lens_arc(const SectionSize& size) {
  const double a = 0.5 * size.width, h = 0.5 * size.height;
  return {(a * a + h * h) / (2.0 * h), 2.0 * std::atan2(h, a)};
}

Outline make_outline(const Section& section, const SectionSize& size, int pieces, bool varying) {
  pieces = std::max(pieces, 1);
  return std::visit(Overloaded{
                        [&](const Circle&) { return ellipse_outline(section, size, pieces); },
                        [&](const Ellipse&) { return ellipse_outline(section, size, pieces); },
                        [&](const Lenticular&) { return assemble(lens_quarter(size, pieces)); },
                        [&](const Racetrack&) { return assemble(racetrack_quarter(size, pieces, varying)); },
                        [&](const Power& power) {
                          return power.exponent == 1.0 ? ellipse_outline(section, size, pieces)
                                                       : assemble(power_quarter(power, size, pieces));
                        },
                        [&](const Loop7&) { return loop7_outline(size); },
                        [&](const Polygon& polygon) { return polygon_outline(polygon, size); },
                    },
                    section);
}

double outline_error(const Section& section, const SectionSize& size, const Outline& outline) {
  if (is_exact(section)) return 0.0;
  const nurbs::Curve curve = as_curve(outline);
  const std::vector<double> breaks = nurbs::breakpoints(outline.knots, outline.degree);
  constexpr int samples = 16;
  double largest = 0.0;
  for (std::size_t k = 0; k + 1 < breaks.size() && breaks[k] < 0.25;
       ++k)  // the other quarters mirror the first
    for (int i = 0; i <= samples; ++i) {
      const Vec3 p = nurbs::evaluate(curve, breaks[k] + (breaks[k + 1] - breaks[k]) * i / samples);
      largest = std::max(largest, from_shape(section, size, Vec2(p.x(), p.y()).cwiseAbs()).norm());
    }
  // Between two of 17 samples of a parabola's smooth deviation hides less than this share of it.
  return 1.02 * largest;
}

double loop7_out_of_roundness() {
  const nurbs::Curve curve = as_curve(loop7_outline({2.0, 2.0}));
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (int i = 0; i <= 4096; ++i) {
    const double r = nurbs::evaluate(curve, i / 4096.0).norm();
    low = std::min(low, r);
    high = std::max(high, r);
  }
  return high - low;  // of a mean radius of 1
}

}  // namespace selvage::yarn
