// The exact tube as functions along its path.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "yarn/frame.h"
#include "yarn/outline.h"
#include "yarn/size_profile.h"
#include "yarn/tube.h"

namespace selvage::yarn {

// Rows of equally many vectors, one after the other.
class RowTable {
 public:
  RowTable() = default;
  RowTable(std::size_t rows, std::size_t columns) { resize(rows, columns); }
  // What it holds is lost.
  void resize(std::size_t rows, std::size_t columns) {
    columns_ = columns;
    vectors_.resize(rows * columns);
  }
  [[nodiscard]] std::size_t rows() const { return columns_ == 0 ? 0 : vectors_.size() / columns_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::span<const Vec3> row(std::size_t i) const { return {&vectors_[i * columns_], columns_}; }
  [[nodiscard]] std::span<Vec3> row(std::size_t i) { return {&vectors_[i * columns_], columns_}; }

 private:
  std::size_t columns_ = 0;
  std::vector<Vec3> vectors_;
};

// What a deviation along the path may cost at one place: a point that slides along the surface has not left
// it.
struct Slide {
  Vec3 tangent;     // of the path
  double slip = 0;  // sine of the largest angle between the tangent and the surface, round the section
  double bend = 0;  // the largest curvature of the surface along the path
};

// The exact surface, seen as a few vector-valued functions of t that are blended round the section with
// constant coefficients: for an affine section C, a W/2 and b H/2; otherwise the path of every control point.
class Channels {
 public:
  Channels(const FrameField& frames, const SizeProfile& sizes, const TubeSpec& spec, double twist,
           int pieces);

  [[nodiscard]] const Outline& outline() const { return unit_; }
  // Vectors of a row of values.
  [[nodiscard]] std::size_t width() const { return affine_ ? 3 : unit_.points.size() - 1; }

  // Exact values at t, as many as `width`; `slopes`, where wanted, get the derivatives.
  Slide sample(double t, std::span<Vec3> values, std::span<Vec3> slopes = {}) const;

  // The largest length that a row of deviations has anywhere round the section.
  [[nodiscard]] double largest(std::span<const Vec3> deviation) const;
  // No less, and sooner known.
  [[nodiscard]] double bound(std::span<const Vec3> deviation) const {
    if (affine_)
      return deviation[0].norm() +
             extent_ * std::sqrt(deviation[1].squaredNorm() + deviation[2].squaredNorm());
    // Round the section it is a convex blend of its values at the control points.
    double found = 0.0;
    for (const Vec3& at_point : deviation) found = std::max(found, at_point.squaredNorm());
    return std::sqrt(found);
  }

  // The control point of column i (the last column is the first) from a row of control values.
  [[nodiscard]] Vec3 blend(std::span<const Vec3> control, std::size_t i) const {
    if (!affine_) return control[i % control.size()];
    const Vec2& p = unit_.points[i];
    return control[0] + p.x() * control[1] + p.y() * control[2];
  }

  // Do sections of every size on the way have the same knots?
  [[nodiscard]] bool has_common_knots() const;

 private:
  [[nodiscard]] std::vector<Vec2> control_at(const SizeProfile::Values& v) const;
  [[nodiscard]] std::vector<Vec2> control_slope(const SizeProfile::Jet& size) const;

  const FrameField& frames_;
  const SizeProfile& sizes_;
  const TubeSpec& spec_;
  double twist_;
  int pieces_;
  bool affine_ = true;
  bool is_round_ = false;  // a turn of the section does not move its surface
  double reach_ = 0;       // of the section's control points from the path, by its larger size
  Outline unit_;
  Eigen::ArrayX2d round_;  // points of it, two a span
  double extent_ = 0;      // their largest distance from the middle
};

}  // namespace selvage::yarn
