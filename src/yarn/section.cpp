#include "yarn/section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/overloaded.h"
#include "core/plane.h"
#include "yarn/ends.h"
#include "yarn/outline.h"

namespace selvage::yarn {

namespace {

using std::numbers::pi;

bool edges_cross(const std::vector<Vec2>& p) {
  const auto side = [](const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - a); };
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;  // neighbours
      const Vec2 &a = p[i], &b = p[i + 1], &c = p[j], &d = p[(j + 1) % n];
      if (side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0) {
        const bool parallel = side(a, b, c) == 0.0 && side(a, b, d) == 0.0;
        if (!parallel) return true;
        const Vec2 along = b - a;
        const double lo = std::min((c - a).dot(along), (d - a).dot(along)),
                     hi = std::max((c - a).dot(along), (d - a).dot(along));
        if (hi >= 0.0 && lo <= along.squaredNorm()) return true;
      }
    }
  return false;
}

Status check_polygon(const std::vector<Vec2>& corners) {
  if (corners.size() < 3) return error(Kind::geometry, "a polygon section needs at least three corners");
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (corners[i] == corners[(i + 1) % corners.size()])
      return error(Kind::geometry, fmt::format("corners {} and {} of the polygon section are equal", i + 1,
                                               (i + 1) % corners.size() + 1));
  if (twice_area(corners) == 0.0) return error(Kind::geometry, "the polygon section has no area");
  if (edges_cross(corners)) return error(Kind::geometry, "the edges of the polygon section cross");
  return {};
}

}  // namespace

SectionSize nominal_size(const Section& section) {
  return std::visit(Overloaded{
                        [](const Circle& s) {
                          return SectionSize{s.diameter, s.diameter};
                        },
                        [](const Loop7& s) {
                          return SectionSize{s.diameter, s.diameter};
                        },
                        [](const Polygon& s) {
                          Eigen::AlignedBox2d box;
                          for (const Vec2& c : s.corners) box.extend(c);
                          return SectionSize{box.sizes().x(), box.sizes().y()};
                        },
                        [](const auto& s) {
                          return SectionSize{s.width, s.height};
                        },
                    },
                    section);
}

Section with_lengths(const Section& section, const std::function<double(double)>& change) {
  return std::visit(Overloaded{
                        [&](const Circle& s) -> Section { return Circle{change(s.diameter)}; },
                        [&](const Loop7& s) -> Section { return Loop7{change(s.diameter)}; },
                        [&](Polygon s) -> Section {
                          for (Vec2& c : s.corners) c = {change(c.x()), change(c.y())};
                          return s;
                        },
                        [&](auto s) -> Section {
                          s.width = change(s.width);
                          s.height = change(s.height);
                          return s;
                        },
                    },
                    section);
}

double area(const Section& section, const SectionSize& size) {
  const double w = size.width, h = size.height;
  return std::visit(
      Overloaded{
          [&](const Circle&) { return pi / 4.0 * w * h; },
          [&](const Ellipse&) { return pi / 4.0 * w * h; },
          [&](const Lenticular&) {
            const LensArc arc = lens_arc(size);
            return arc.radius * arc.radius * (2.0 * arc.half_angle - std::sin(2.0 * arc.half_angle));
          },
          [&](const Racetrack&) {
            const double d = std::min(w, h), straight = std::max(w, h) - d;
            return pi / 4.0 * d * d + straight * d;
          },
          // 4 (w/2)(h/2) times the integral of sin^(n+1) over a quarter turn.
          [&](const Power& s) {
            return w * h * 0.5 * std::sqrt(pi) * std::tgamma(0.5 * s.exponent + 1.0) /
                   std::tgamma(0.5 * s.exponent + 1.5);
          },
          [&](const Loop7& s) { return area_vector(as_curve(make_outline(s, size, 1, false))).norm(); },
          [&](const Polygon& s) {
            const SectionSize own = nominal_size(section);
            return 0.5 * std::abs(twice_area(s.corners)) * (w / own.width) * (h / own.height);
          },
      },
      section);
}

Status check_section(const Section& section, const SectionSize& size) {
  const auto is_size = [](double v) { return std::isfinite(v) && v > 0.0; };
  if (const auto* polygon = std::get_if<Polygon>(&section))
    if (Status s = check_polygon(polygon->corners); !s) return s;
  if (!is_size(size.width) || !is_size(size.height))
    return error(Kind::geometry, fmt::format("a section of {} x {} has no size", size.width, size.height));
  if (const auto* power = std::get_if<Power>(&section))
    if (!(power->exponent >= 0.1 && power->exponent <= 10.0))
      return error(Kind::geometry,
                   fmt::format("the exponent {} of a power section is outside 0.1 .. 10", power->exponent));
  return {};
}

// What a new shape is, too, has to be thought about.
static_assert(std::variant_size_v<Section> == 7);

bool is_affine(const Section& section) {
  return !std::holds_alternative<Lenticular>(section) && !std::holds_alternative<Racetrack>(section);
}

bool is_exact(const Section& section) {
  return std::holds_alternative<Polygon>(section) || std::holds_alternative<Loop7>(section);
}

}  // namespace selvage::yarn
