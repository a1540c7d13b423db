// The borders of faces in space, whatever they are made of: the sides of a surface's range, or the edges of
// its loops.
#pragma once

#include <vector>

#include "cad/model.h"

namespace selvage::cad {

// One piece of a face's border, with points on it.
class Border {
 public:
  // `side`: of those of a whole surface (sides_of); -1: an edge of a loop.
  explicit Border(nurbs::Curve curve, int side = -1);

  [[nodiscard]] double length() const { return length_; }  // of the polygon through points()
  // Evenly in the parameter over each span, ends included: at least nine.
  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }
  // Where points()[i] is between first and last parameter, 0 to 1.
  [[nodiscard]] double share(std::size_t i) const { return (parameters_[i] - first_) / (last_ - first_); }
  // Holds the curve, between points() too.
  [[nodiscard]] const Box3& box() const { return box_; }
  [[nodiscard]] int side() const { return side_; }

  // The distance of `p`: at `hint` (0 to 1, from first to last) or its mirror image where that is at most
  // `enough`, else the least, by Newton's method from those of points() that are nearer than those beside
  // them. Where it is more than `most` only that is sure of the result.
  [[nodiscard]] double distance(const Vec3& p, double hint, double enough, double most) const;

 private:
  [[nodiscard]] double refined(const Vec3& p, std::size_t nearest) const;

  nurbs::Curve curve_;
  int side_;
  double first_ = 0, last_ = 0, length_ = 0;
  double step_ = 0;  // longest distance between two points
  std::vector<double> parameters_;
  std::vector<Vec3> points_;
  Box3 box_;
};

// The sides of an untrimmed face (0 to 3 in that order), or its loops' edges. Edges without a curve in space
// (poles, or parameters only) are left out.
std::vector<Border> borders_of(const Face& face);

}  // namespace selvage::cad
