// Triangles on a smooth support (a B-spline surface, or a plane) brought to wanted edge lengths.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "solid/planar.h"
#include "surface_mesh/size_field.h"

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
  std::vector<std::uint32_t> known;                       // one a fixed point: PlanarRegion::Node::known
  std::size_t fixed_points = 0;                           // they stay where they are
  std::vector<std::array<std::uint32_t, 2>> fixed_edges;  // between fixed points: they stay edges
  std::vector<std::array<std::uint32_t, 3>> triangles;    // counter-clockwise on the support
  std::vector<std::int32_t> domains;  // one a triangle; domains meet along fixed edges only
};

// A region of the parameter plane to fill: the nodes on its borders and lines, and where in the plane they
// are, which is more than one place where a surface was cut open.
struct PlanarRegion {
  static constexpr std::uint32_t none = static_cast<std::uint32_t>(-1);
  struct Node {
    Vec3 point;
    Vec2 parameters;             // need not be quite those of the point
    std::uint32_t known = none;  // the caller's number of it; none: a new one
    bool is_fixed = true;        // else it may be moved, or taken away
  };
  struct Place {
    Vec2 parameters;
    std::uint32_t node;
  };
  std::vector<Node> nodes;  // fixed ones and others in any order; those without a place are left out
  std::vector<Place> places;
  std::vector<solid::PlanarSegment> segments;  // between places
  Vec2 scale = Vec2::Ones();  // lengths per parameter: Delaunay's circles are drawn in such lengths

  std::uint32_t add_node(const Node& node) {
    nodes.push_back(node);
    return static_cast<std::uint32_t>(nodes.size() - 1);
  }
  std::uint32_t add_place(const Vec2& parameters, std::uint32_t node) {
    places.push_back({parameters, node});
    return static_cast<std::uint32_t>(places.size() - 1);
  }
  // A node with a place of its own.
  std::uint32_t add(const Node& node) { return add_place(node.parameters, add_node(node)); }
  // The places from this one on, closed to a loop.
  void close(std::uint32_t first, std::int32_t left = 0, std::int32_t right = -1) {
    const auto last = static_cast<std::uint32_t>(places.size());
    for (std::uint32_t k = first; k < last; ++k)
      segments.push_back({k, k + 1 < last ? k + 1 : first, left, right});
  }
};

// Triangles of the region with points inside, whose edges are about as long as the field has them. Segments
// between fixed nodes stay edges. Errors: what solid::triangulate() says, limit (more than 5e7 triangles).
Result<TriangleMesh> fill(const PlanarRegion& region, const Support& support, const SizeField& field);

// Split, collapse, turn and smooth until edges are about as long as the field has them, and angles good;
// after Botsch and Kobbelt (A remeshing approach to multiresolution modeling, 2004). Fixed points and edges
// stay.
void remesh(TriangleMesh& mesh, const Support& support, const SizeField& field);

struct PointTarget {
  std::uint32_t point;
  Vec3 at;
};

// Moves points to the places of their support nearest to where they are wanted, but for those by which
// triangles would turn over or become slender; then turns edges.
void move_points(TriangleMesh& mesh, const Support& support, std::span<const PointTarget> targets);

// Splits edges that are longer by 1.4 than the field has them, and turns others.
void split_long_edges(TriangleMesh& mesh, const Support& support, const SizeField& field);

// Degrees.
double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace selvage::fem
