#include "unit/cad/surfaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::test {

namespace {

using nurbs::Curve;
using nurbs::Surface;

template <class Change>
Surface along_v(const Surface& surface, const Change& change) {
  Surface out = surface;
  for (int i = 0; i < surface.count_u; ++i) {
    const Curve curve = change(nurbs::control_column(surface, i));
    out.knots_v = curve.knots;
    out.count_v = static_cast<int>(curve.points.size());
    if (i == 0) {
      out.points.assign(curve.points.size() * static_cast<std::size_t>(out.count_u), Vec3::Zero());
      if (surface.is_rational()) out.weights.assign(out.points.size(), 1);
    }
    for (int j = 0; j < out.count_v; ++j) {
      out.points[out.index(i, j)] = curve.points[static_cast<std::size_t>(j)];
      if (surface.is_rational()) out.weights[out.index(i, j)] = curve.weights[static_cast<std::size_t>(j)];
    }
  }
  return out;
}

std::vector<double> clamped_uniform(int degree, int count) {
  std::vector<double> knots(static_cast<std::size_t>(degree + 1), 0.0);
  for (int k = 1; k < count - degree; ++k) knots.push_back(static_cast<double>(k) / (count - degree));
  knots.insert(knots.end(), static_cast<std::size_t>(degree + 1), 1.0);
  return knots;
}

// A clamped bicubic surface, whose control point (i, j) is place(i, j).
template <class Place>
Surface bicubic(int count_u, int count_v, const Place& place) {
  Surface s;
  s.degree_u = s.degree_v = 3;
  s.count_u = count_u;
  s.count_v = count_v;
  s.knots_u = clamped_uniform(3, count_u);
  s.knots_v = clamped_uniform(3, count_v);
  for (int j = 0; j < count_v; ++j)
    for (int i = 0; i < count_u; ++i) s.points.push_back(place(i, j));
  return s;
}

}  // namespace

Surface cylinder(double radius, double height, double x, double y) {
  Surface s;
  s.degree_u = 2;
  s.degree_v = 1;
  s.count_u = 9;
  s.count_v = 2;
  s.knots_u = {0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1};
  s.knots_v = {0, 0, 1, 1};
  const int steps_x[] = {1, 1, 0, -1, -1, -1, 0, 1, 1}, steps_y[] = {0, 1, 1, 1, 0, -1, -1, -1, 0};
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 9; ++i) {
      s.points.emplace_back(x + radius * steps_x[i], y + radius * steps_y[i], height * j);
      s.weights.push_back(i % 2 == 0 ? 1.0 : std::numbers::sqrt2 / 2);
    }
  return s;
}

Surface wavy_tube(double y) {
  return bicubic(18, 16, [&](int i, int j) {
    const double angle = 2 * std::numbers::pi * (i == 17 ? 0 : i) / 17.0;
    return Vec3(j * 0.2, y + 0.2 * std::cos(angle) * (1 + 0.1 * std::sin(2.0 * j)),
                0.1 * std::sin(angle) + 0.3 * std::sin(0.5 * j));
  });
}

Surface sheet() {
  return bicubic(
      7, 6, [](int i, int j) { return Vec3(i / 6.0, j / 5.0, 0.2 * std::sin(1.3 * i) * std::cos(0.9 * j)); });
}

Surface swapped(const Surface& surface) {
  Surface s = surface;
  std::swap(s.degree_u, s.degree_v);
  std::swap(s.count_u, s.count_v);
  std::swap(s.knots_u, s.knots_v);
  for (int j = 0; j < s.count_v; ++j)
    for (int i = 0; i < s.count_u; ++i) {
      s.points[s.index(i, j)] = surface.point(j, i);
      if (s.is_rational()) s.weights[s.index(i, j)] = surface.weight(j, i);
    }
  return s;
}

Surface backward_v(const Surface& surface) {
  return along_v(surface, [](const Curve& curve) { return nurbs::reversed(curve); });
}

Surface stretched(const Surface& surface, double scale, double shift) {
  Surface s = surface;
  for (double& knot : s.knots_u) knot = scale * knot + shift;
  return s;
}

Surface refined_v(const Surface& surface, const std::vector<double>& knots) {
  return along_v(surface, [&](Curve curve) {
    for (const double knot : knots) curve = nurbs::insert_knot(curve, knot);
    return curve;
  });
}

Surface cut_v(const Surface& surface, double v0, double v1) {
  return along_v(surface, [&](const Curve& curve) { return nurbs::sub_curve(curve, v0, v1); });
}

Surface reseamed(const Surface& surface, double at) {
  const Surface turned = swapped(surface);
  const double first = turned.first_v(), last = turned.last_v();
  return swapped(along_v(turned, [&](const Curve& curve) {
    Curve start = nurbs::sub_curve(curve, at, last);
    const Curve rest = nurbs::sub_curve(curve, first, at);
    const auto ends = static_cast<std::ptrdiff_t>(curve.degree + 1);
    start.knots.pop_back();  // the old seam keeps as many knots as the degree
    for (auto knot = rest.knots.begin() + ends; knot != rest.knots.end(); ++knot)
      start.knots.push_back(*knot + last - first);
    start.points.insert(start.points.end(), rest.points.begin() + 1, rest.points.end());
    if (curve.is_rational())
      start.weights.insert(start.weights.end(), rest.weights.begin() + 1, rest.weights.end());
    return start;
  }));
}

Curve straight(const Vec3& from, const Vec3& to) {
  return {1, {0, 0, 1, 1}, {from, to}, {}};
}

cad::Loop rectangle(double u0, double u1, double v0, double v1, bool turned) {
  std::array<Vec3, 4> at = {Vec3(u0, v0, 0), Vec3(u1, v0, 0), Vec3(u1, v1, 0), Vec3(u0, v1, 0)};
  if (turned) std::swap(at[1], at[3]);
  cad::Loop loop;
  for (std::size_t i = 0; i < 4; ++i) loop.edges.push_back({{}, straight(at[i], at[(i + 1) % 4]), -1});
  return loop;
}

cad::Face face_of(const Surface& surface, std::vector<cad::Loop> loops) {
  cad::Face face;
  face.surface = surface;
  face.loops = std::move(loops);
  return face;
}

cad::Part part_of(const std::string& name, const std::vector<Surface>& surfaces) {
  cad::Part part;
  part.name = name;
  for (const Surface& surface : surfaces) {
    cad::Face& face = part.faces.emplace_back();
    face.surface = surface;
    face.name = name;
  }
  return part;
}

}  // namespace selvage::test
