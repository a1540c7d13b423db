#include "view/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::view {

namespace {

constexpr double margin = 0.04;

Eigen::Matrix3d axes_of(From from, const Vec3& upright) {
  Vec3 right = Vec3::UnitX(), up = Vec3::UnitZ();
  if (from == From::plan) up = upright, right = upright.cross(Vec3::UnitZ());
  if (from == From::top) up = Vec3::UnitY();
  if (from == From::bottom) right = -Vec3::UnitX(), up = Vec3::UnitY();
  if (from == From::back) right = -Vec3::UnitX();
  if (from == From::side) right = Vec3::UnitY();
  if (from == From::iso) {
    right = Vec3(1, 1, 0).normalized();
    up = Vec3(-1, 1, 2).normalized();
  }
  Eigen::Matrix3d axes;
  axes << right.transpose(), up.transpose(), right.cross(up).transpose();
  return axes;
}

Eigen::Matrix3d axes_of(const Angles& angles) {
  const double radians = std::numbers::pi / 180.0, turn = angles.azimuth * radians,
               tilt = angles.elevation * radians;
  const Vec3 right(std::cos(turn), std::sin(turn), 0),
      toward(std::cos(tilt) * std::sin(turn), -std::cos(tilt) * std::cos(turn), std::sin(tilt));
  Eigen::Matrix3d axes;
  axes << right.transpose(), toward.cross(right).transpose(), toward.transpose();
  return axes;
}

Eigen::Matrix3d axes_of(const Eye& eye) {
  return eye.angles ? axes_of(*eye.angles) : axes_of(eye.from, eye.upright);
}

}  // namespace

Vec3 upright_of(std::span<const yarn::Body> bodies) {
  const auto is_warp = [](const yarn::Body& body) { return body.role == yarn::Role::warp; };
  const auto warp = std::find_if(bodies.begin(), bodies.end(), is_warp);
  if (warp == bodies.end() || warp->axis.points.empty()) return Vec3::UnitY();
  const Vec3 way = warp->axis.points.back() - warp->axis.points.front();
  return std::abs(way.x()) > std::abs(way.y()) ? Vec3(-Vec3::UnitX()) : Vec3(Vec3::UnitY());
}

Camera::Camera(const Eye& eye, std::span<const yarn::Body> bodies, int width, int height)
    : turn_(axes_of(eye)) {
  Box3 seen;
  for (const yarn::Body& body : bodies)
    for (const Vec3& p : body.surface.points) seen.extend(turn_ * p);
  hold(seen, eye.zoom, width, height);
}

Camera::Camera(const Eye& eye, std::span<const Vec3> points, int width, int height) : turn_(axes_of(eye)) {
  Box3 seen;
  for (const Vec3& p : points) seen.extend(turn_ * p);
  hold(seen, eye.zoom, width, height);
}

void Camera::hold(const Box3& seen, double zoom, int width, int height) {
  centre_ = turn_.transpose() * seen.center();
  const double rim = 2.0 * margin * std::min(width, height);
  const double unit =  // file units a pixel
      std::max(seen.sizes().x() / (width - rim), seen.sizes().y() / (height - rim));
  scale_ = zoom * (unit > 0.0 ? 1.0 / unit : 1.0);
}

}  // namespace selvage::view
