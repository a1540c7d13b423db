#include "fabric/knit_loop.h"

#include <algorithm>
#include <array>

namespace selvage::fabric {

namespace {

constexpr double depth = 1.5;  // of legs, sinkers and heads before or behind the middle plane
constexpr double middle = wale_spacing / 2;

// A point of the left half of a loop: x from the loop's middle, z for a knit loop.
constexpr std::array<double, 3> foot = {-1, 0, 0};
constexpr std::array<double, 3> leg = {-2, 3.5, depth};
constexpr std::array<double, 3> shoulder = {-3, 7, 0};
// Where own stitch and stitch above differ: the leg before it crosses the middle plane, and after.
constexpr std::array<double, 3> lower_leg = {-1.3, 1.75, 1.05};
constexpr std::array<double, 3> upper_leg = {-2.7, 5.25, -1.05};
// On the arm of a sinker that starts in the middle plane.
constexpr std::array<double, 3> arm = {-2.75, -1.75, -1};

// +1: knit, -1: purl.
double side_of(Stitch stitch) {
  return stitch == Stitch::purl ? -1.0 : 1.0;
}

// z of the sinker between a wale and the one on its left.
double sinker_z(const KnitField& field, long long course, long long wale) {
  const double left = side_of(field.chart.at(course, std::max(wale - 1, field.first_wale)));
  const double right = side_of(field.chart.at(course, std::min(wale, field.last_wale)));
  return left == right ? -depth * right : 0.0;
}

constexpr double sinker_y = -3;

}  // namespace

void add_stitch_points(const KnitField& field, long long course, long long wale, std::vector<Vec3>& points) {
  const double side = side_of(field.chart.at(course, wale));
  const double head = course < field.last_course ? side_of(field.chart.at(course + 1, wale)) : side;
  const double left_sinker = sinker_z(field, course, wale);
  const double right_sinker = sinker_z(field, course, wale + 1);
  points.emplace_back(0, sinker_y, left_sinker);
  const auto add = [&](const std::array<double, 3>& p, double mirror) {
    points.emplace_back(middle + mirror * p[0], p[1], side * p[2]);
  };
  if (left_sinker == 0.0) add(arm, 1);
  add(foot, 1);
  if (head == side) {
    add(leg, 1);
  } else {
    add(lower_leg, 1);
    add(upper_leg, 1);
  }
  add(shoulder, 1);
  points.emplace_back(middle, 10, -depth * head);
  add(shoulder, -1);
  if (head == side) {
    add(leg, -1);
  } else {
    add(upper_leg, -1);
    add(lower_leg, -1);
  }
  add(foot, -1);
  if (right_sinker == 0.0) add(arm, -1);
}

Vec3 last_sinker_point(const KnitField& field, long long course) {
  return {0, sinker_y, sinker_z(field, course, field.last_wale + 1)};
}

}  // namespace selvage::fabric
