// Where the eye is: an orthographic camera that holds a whole fabric.
#pragma once

#include <optional>
#include <span>
#include <utility>

#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::view {

// top: looking along -z, x to the right, y up. bottom: along +z, x to the left, y up (the cloth turned over
// about y). front: along +y, x to the right, z up. back: along -y, x to the left, z up. side: along -x, y to
// the right, z up. iso: from above, the front and the right (along (-1, 1, -1)), z up: x and y run equally
// shortened, to the lower right and to the upper right. plan: as top, turned so that Eye::upright is upright.
enum class From { plan, top, bottom, front, back, side, iso };

// Where else: degrees about z from the front toward +x, and above the horizontal. (0, 0) is front, (90, 0)
// side, (180, 0) back, (0, 90) top.
struct Angles {
  double azimuth = 0, elevation = 0;
};

struct Eye {
  From from = From::plan;
  Vec3 upright = Vec3::UnitY();  // of plan, unit, across z
  std::optional<Angles> angles;  // instead
  double zoom = 1;               // the larger, the nearer the middle of the bodies
};

// What is upright in the plan of these yarns: their warp, else y, along which wales run. Where the first warp
// runs rather along x than along y that is -x, so that the plan shows a draft as its text does: the top row
// is the first weft, the left column the first warp.
Vec3 upright_of(std::span<const yarn::Body> bodies);

// Camera space: pixels; x to the right, y up, z toward the eye, the origin in the picture's centre.
class Camera {
 public:
  // Of the yarns' own space with another origin: a pixel is a file unit, x to the right, y up.
  explicit Camera(Vec3 origin) : turn_(Eigen::Matrix3d::Identity()), centre_(std::move(origin)) {}
  // With a zoom of 1 the bodies (not none) fill the picture but for a margin of 4 % of its smaller side.
  Camera(const Eye& eye, std::span<const yarn::Body> bodies, int width, int height);
  Camera(const Eye& eye, std::span<const Vec3> points, int width, int height);  // these points do

  [[nodiscard]] Vec3 to_picture(const Vec3& point) const { return scale_ * (turn_ * (point - centre_)); }
  [[nodiscard]] Vec3 direction(const Vec3& vector) const { return turn_ * vector; }
  [[nodiscard]] Vec3 toward_eye() const { return turn_.row(2).transpose(); }
  [[nodiscard]] double pixels_per_unit() const { return scale_; }

 private:
  // `seen`: in the turned axes.
  void hold(const Box3& seen, double zoom, int width, int height);

  Eigen::Matrix3d turn_;  // rows: right, up, toward the eye
  Vec3 centre_;
  double scale_ = 1;
};

}  // namespace selvage::view
