// A yarn's skin as a grid of quadrilaterals in camera space, as fine as a picture needs and no finer.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "view/camera.h"
#include "yarn/body.h"

namespace selvage::view {

using Vec3f = Eigen::Vector3f;

// The point (column, row) is points[row * columns + column]; columns run round the section, counter-clockwise
// about the path, rows along the path. The last column stands where the first does, and in a ring the last
// row too, to the bit: the skin is closed. Two columns, or two rows, may stand at one place where the surface
// has an edge: they differ in their normals.
struct Skin {
  std::size_t columns = 0, rows = 0;
  std::vector<Vec3f> points;   // pixels
  std::vector<Vec3f> normals;  // outward, unit
  std::vector<double> places;  // of each row: v on the surface
  // Of the fibres, in turns about the path: a fibre is where around[column] - along[row] keeps its value.
  std::vector<double> around, along;
  // Outline points of the two ends, each closed by a fan about one further point (after the grid's in
  // `points`); none for a ring.
  bool has_ends = true;
  Vec3f start_normal = Vec3f::Zero(), end_normal = Vec3f::Zero();
  double size = 0;         // diameter of the circle with the mean section's area, pixels
  double uncertainty = 0;  // how far the grid may lie from the exact tube, pixels

  [[nodiscard]] std::size_t quads() const { return (rows - 1) * (columns - 1); }
  [[nodiscard]] std::size_t facets() const { return quads() + (has_ends ? 2 * (columns - 1) : 0); }
};

// `chord`: pixels by which each of the grid's columns and rows may leave the surface, and the inside of a
// quadrilateral these. `stops`: knots of v, increasing, that each have a row, so that skins of one body with
// other chords can be put together there. Errors: geometry (coordinates that are not finite), limit (more
// than 2^31 facets).
Result<Skin> make_skin(const yarn::Body& body, const Camera& camera, double chord,
                       std::span<const double> stops = {});

}  // namespace selvage::view
