// Triangles on a smooth support (a B-spline surface, or a plane) brought to wanted edge lengths.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "fem/size_field.h"
#include "solid/planar.h"

namespace selvage::fem {

// What the triangles lie on: points by two parameters.
class Support {
 public:
  Support() = default;
  Support(const Support&) = delete;
  Support& operator=(const Support&) = delete;
  virtual ~Support() = default;

  struct Place {
    Vec2 parameters;
    Vec3 point;
  };
  [[nodiscard]] virtual Vec3 point(const Vec2& parameters) const = 0;
  // Unit, to the side from which triangles run counter-clockwise.
  [[nodiscard]] virtual Vec3 normal(const Vec2& parameters) const = 0;
  // The place about nearest to `target`, found from a start nearby.
  [[nodiscard]] virtual Place nearest(const Vec2& start, const Vec3& target) const = 0;
  // `b` as it is beside `a`: where the parameters go round, by whole periods.
  [[nodiscard]] virtual Vec2 beside(const Vec2& /*a*/, const Vec2& b) const { return b; }
};

struct TriangleMesh {
  std::vector<Vec3> points;                               // the fixed ones first
  std::vector<Vec2> parameters;                           // one a point
  std::size_t fixed_points = 0;                           // they stay where they are
  std::vector<std::array<std::uint32_t, 2>> fixed_edges;  // between fixed points: they stay edges
  std::vector<std::array<std::uint32_t, 3>> triangles;    // counter-clockwise on the support
  std::vector<std::int32_t> domains;  // one a triangle; domains meet along fixed edges only
};

// A region of the parameter plane to fill: points on its borders and lines, and these.
struct PlanarRegion {
  std::vector<Vec2> parameters;  // need not be quite those of the points
  std::vector<Vec3> points;
  std::vector<solid::PlanarSegment> segments;
  Vec2 scale = Vec2::Ones();  // lengths per parameter: Delaunay's circles are drawn in such lengths
};

// Triangles with points inside, no edge inside much longer than the field has it. The points are the region's
// first, all fixed. Errors: what solid::triangulate() says, limit (more than `most` triangles).
Result<TriangleMesh> fill(const PlanarRegion& region, const Support& support, const SizeField& field,
                          std::size_t most);

// Split, collapse, turn and smooth until edges are about as long as the field has them, and angles good;
// after Botsch and Kobbelt (A remeshing approach to multiresolution modeling, 2004). Fixed points and edges
// stay.
void remesh(TriangleMesh& mesh, const Support& support, const SizeField& field);

// Degrees.
double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace selvage::fem
