#include "formats/tg3/section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/bounds.h"

namespace selvage::formats::tg3 {

namespace {

constexpr double full_turn = 2 * std::numbers::pi;
constexpr double same_t = 1e-9;  // of two parameters

// The polyline through the points, closed, whose point i has the parameter at[i] < 1.
Vec2 on_polygon(const std::vector<Vec2>& points, const std::vector<double>& at, double t) {
  const auto above = std::upper_bound(at.begin(), at.end(), t);
  const std::size_t i = above == at.begin() ? 0 : static_cast<std::size_t>(above - at.begin()) - 1;
  const double next = i + 1 < at.size() ? at[i + 1] : 1.0;
  const double share = next > at[i] ? std::clamp((t - at[i]) / (next - at[i]), 0.0, 1.0) : 0.0;
  return points[i] + share * (points[(i + 1) % points.size()] - points[i]);
}

Section straight(std::vector<Vec2> points, std::vector<double> at) {
  Section section;
  section.corners = at;
  section.is_straight = true;
  section.point = [points = std::move(points), at = std::move(at)](double t) {
    return on_polygon(points, at, t);
  };
  return section;
}

// The parameter of each point by the length of the outline up to it.
std::vector<double> by_length(const std::vector<Vec2>& points) {
  std::vector<double> at = {0.0};
  for (std::size_t i = 0; i < points.size(); ++i)
    at.push_back(at.back() + (points[(i + 1) % points.size()] - points[i]).norm());
  for (double& t : at) t /= at.back() > 0 ? at.back() : 1.0;
  at.pop_back();
  return at;
}

}  // namespace

Section ellipse(double width, double height) {
  return {.point = [=](double t) -> Vec2 {
            return {width / 2 * std::cos(full_turn * t), height / 2 * std::sin(full_turn * t)};
          },
          .corners = {}};
}

Section power_ellipse(double width, double height, double power, double offset) {
  Section section;
  section.point = [=](double t) -> Vec2 {
    const double cosine = std::cos(full_turn * t), sine = std::sin(full_turn * t);
    const double reach = cosine >= 0 ? width / 2 - offset : width / 2 + offset;
    return {offset + reach * cosine, std::copysign(height / 2 * std::pow(std::abs(sine), power), sine)};
  };
  // Above 1 the flanks are hollow; beside the offset both sides bend differently.
  if (power > 1) section.corners = {0.0, 0.5};
  if (offset != 0) section.corners = {0.0, 0.25, 0.5, 0.75};
  return section;
}

Section lenticular(double width, double height, double distortion) {
  Section section;
  section.corners = {0.0, 0.5};
  section.point = [=](double t) -> Vec2 {
    const bool is_upper = t < 0.5;
    // The arc's rise over the tips.
    const double rise = height / 2 + (is_upper ? -distortion : distortion);
    const double radius = (width * width / 4 + rise * rise) / (2 * rise);
    const double half_angle = std::asin(std::min(1.0, width / 2 / radius));
    const double angle = (is_upper ? 1 - 4 * t : 4 * t - 3) * half_angle;
    const double over_tips = radius * std::cos(angle) - (radius - rise);
    return {radius * std::sin(angle), distortion + (is_upper ? over_tips : -over_tips)};
  };
  return section;
}

Section rectangle(double width, double height) {
  const std::vector<Vec2> points = {{width / 2, 0},
                                    {width / 2, height / 2},
                                    {-width / 2, height / 2},
                                    {-width / 2, -height / 2},
                                    {width / 2, -height / 2}};
  return straight(points, by_length(points));
}

Section bezier(std::vector<Vec2> points) {
  const std::size_t count = points.size() / 3;
  Section section;
  for (std::size_t i = 0; i < count; ++i)
    section.corners.push_back(static_cast<double>(i) / static_cast<double>(count));
  section.point = [points = std::move(points), count](double t) -> Vec2 {
    const double scaled = std::clamp(t, 0.0, 1.0) * static_cast<double>(count);
    const std::size_t i = std::min(static_cast<std::size_t>(scaled), count - 1);
    const double s = scaled - static_cast<double>(i), r = 1 - s;
    return r * r * r * points[3 * i] + 3 * r * r * s * points[3 * i + 1] + 3 * r * s * s * points[3 * i + 2] +
           s * s * s * points[(3 * i + 3) % points.size()];
  };
  return section;
}

Section polygon(std::vector<Vec2> points, bool keeps_points) {
  Section section = straight(points, by_length(points));
  if (keeps_points) section.kept = std::move(points);
  return section;
}

Section rotated(Section section, double angle) {
  const Eigen::Rotation2Dd turn(angle);
  for (Vec2& point : section.kept) point = turn * point;
  section.point = [inner = std::move(section.point), turn](double t) -> Vec2 { return turn * inner(t); };
  return section;
}

Section scaled(Section section, const Vec2& factors) {
  for (Vec2& point : section.kept) point = point.cwiseProduct(factors);
  section.point = [inner = std::move(section.point), factors](double t) -> Vec2 {
    return inner(t).cwiseProduct(factors);
  };
  return section;
}

Result<Section> hybrid(std::vector<double> divisions, std::vector<Section> sections) {
  // Of division k the part from it to the next one; the last goes round to the first.
  const auto part_at = [divisions](double t) {
    const auto above = std::upper_bound(divisions.begin(), divisions.end(), t);
    return (static_cast<std::size_t>(above - divisions.begin()) + divisions.size() - 1) % divisions.size();
  };
  Section whole;
  whole.corners = divisions;
  whole.is_straight = std::ranges::all_of(sections, &Section::is_straight);
  for (std::size_t k = 0; k < sections.size(); ++k) {
    const Section& before = sections[(k + sections.size() - 1) % sections.size()];
    const Vec2 from = before.point(divisions[k]), to = sections[k].point(divisions[k]);
    if ((to - from).norm() > 1e-6 * std::max(to.norm(), from.norm()))
      return error(
          Kind::geometry,
          fmt::format("the parts of this section do not meet at the division {}: one is at ({}, {}), the "
                      "other at ({}, {}); give them the same size there",
                      divisions[k], from.x(), from.y(), to.x(), to.y()));
    for (const double corner : sections[k].corners)
      if (part_at(corner) == k) whole.corners.push_back(corner);
  }
  std::ranges::sort(whole.corners);
  whole.point = [part_at, sections = std::move(sections)](double t) { return sections[part_at(t)].point(t); };
  return whole;
}

std::vector<double> corners_of(std::span<const Section* const> sections) {
  std::vector<double> all;
  for (const Section* const section : sections)
    all.insert(all.end(), section->corners.begin(), section->corners.end());
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end(), [](double a, double b) { return b - a < same_t; }),
            all.end());
  if (!all.empty() && all.front() + 1 - all.back() < same_t) all.pop_back();
  return all;
}

Vec2 sizes_of(const Section& section) {
  std::vector<Vec2> points;
  constexpr int samples = 256;
  points.reserve(samples + section.corners.size());
  for (int i = 0; i < samples; ++i) points.push_back(section.point(static_cast<double>(i) / samples));
  for (const double corner : section.corners) points.push_back(section.point(corner));
  return bounds_of(points).sizes();
}

double area_of(const Section& section, int samples) {
  std::vector<double> corners = section.corners;
  if (corners.empty()) corners = {0.0, 0.25, 0.5, 0.75};
  double twice = 0;
  Vec2 last = section.point(corners.front());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const double from = corners[k], to = k + 1 < corners.size() ? corners[k + 1] : corners.front() + 1;
    for (int i = 1; i <= samples; ++i) {
      const double t = from + (to - from) * i / samples;
      const Vec2 next = section.point(t < 1 ? t : t - 1);
      twice += last.x() * next.y() - last.y() * next.x();
      last = next;
    }
  }
  return twice / 2;
}

}  // namespace selvage::formats::tg3
