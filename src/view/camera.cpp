#include "view/camera.h"

#include <algorithm>

namespace selvage::view {

namespace {

constexpr double margin = 0.04;

Eigen::Matrix3d axes_of(From from) {
  Vec3 right = Vec3::UnitX(), up = Vec3::UnitZ();
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

}  // namespace

Camera::Camera(From from, std::span<const yarn::Body> bodies, int width, int height) : turn_(axes_of(from)) {
  Box3 seen;
  for (const yarn::Body& body : bodies)
    for (const Vec3& p : body.surface.points) seen.extend(turn_ * p);
  centre_ = turn_.transpose() * seen.center();
  const double rim = 2.0 * margin * std::min(width, height);
  const double unit =  // file units a pixel
      std::max(seen.sizes().x() / (width - rim), seen.sizes().y() / (height - rim));
  scale_ = unit > 0.0 ? 1.0 / unit : 1.0;
}

}  // namespace selvage::view
