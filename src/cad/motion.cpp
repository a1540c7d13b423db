#include "cad/motion.h"

#include <cmath>
#include <numbers>

#include "yarn/rigid_fit.h"

namespace selvage::cad {

std::optional<Motion> motion_between(const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                                     double near) {
  if (from.empty() || from.size() != to.size()) return std::nullopt;
  const Vec3 a = yarn::mean_of(from), b = yarn::mean_of(to);
  const auto fits = [&](const Eigen::Matrix3d& turn) {
    for (std::size_t k = 0; k < from.size(); ++k)
      if ((turn * (from[k] - a) - (to[k] - b)).squaredNorm() > near * near) return false;
    return true;
  };
  Motion motion;
  motion.shift = b - a;
  if (fits(Eigen::Matrix3d::Identity())) return motion;
  const Eigen::Matrix3d turn = yarn::best_rotation(from, to);
  if (!fits(turn)) return std::nullopt;
  const Eigen::AngleAxisd rotation(turn);
  motion.angle = rotation.angle() * 180 / std::numbers::pi;
  motion.axis = rotation.axis();
  return motion;
}

}  // namespace selvage::cad
