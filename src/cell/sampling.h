// A yarn's surface as a grid of triangles, and how far each vertex is inside of a box. Internal to this
// folder.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "cell/cut.h"

namespace selvage::cell {

// Vertices (i, j): u by i, which is periodic, v by j, periodic on a ring. Each cell of the grid is two
// triangles.
class Sampling {
 public:
  using Vertex = std::uint32_t;
  // Planes that an end lies in, which is then inside of them: faces 0..5 or -1, at the start and at the end.
  using EndFaces = std::array<int, 2>;

  Sampling(const yarn::Body& body, const Box3& box, double tolerance);

  // Distance from the face, > 0 inside.
  [[nodiscard]] double depth(Vertex vertex, int face) const {
    const double coordinate = points_[vertex][axis_of(face)];
    const double value = is_high(face) ? planes_[static_cast<std::size_t>(face)] - coordinate
                                       : coordinate - planes_[static_cast<std::size_t>(face)];
    if (value >= 0) return value;
    const std::size_t row = vertex / us_.size();
    for (std::size_t end = 0; end < 2; ++end)
      if (end_faces_[end] == face && row >= level_rows_[end][0] && row < level_rows_[end][1]) return 0;
    return value;
  }
  [[nodiscard]] bool is_inside(Vertex vertex) const {
    for (int face = 0; face < face_count; ++face)
      if (depth(vertex, face) < 0) return false;
    return true;
  }
  [[nodiscard]] const Vec3& point(Vertex vertex) const { return points_[vertex]; }
  [[nodiscard]] Vec2 parameters(Vertex vertex) const {
    return {us_[vertex % us_.size()], vs_[vertex / us_.size()]};
  }

  [[nodiscard]] std::size_t vertex_count() const { return points_.size(); }
  [[nodiscard]] std::size_t triangle_count() const { return 2 * us_.size() * cell_rows(); }
  // Counter-clockwise in (u, v).
  [[nodiscard]] std::array<Vertex, 3> triangle(std::size_t index) const;
  // Is this side (from a to b) the yarn's own border? 0: no, else Arc::own_start, own_end.
  [[nodiscard]] int own_border(Vertex a, Vertex b) const;

  [[nodiscard]] const EndFaces& end_faces() const { return end_faces_; }

 private:
  void choose_parameters(const yarn::Body& body, const Box3& box, double tolerance);
  void find_end_faces(const Box3& box, double tolerance);
  [[nodiscard]] std::size_t cell_rows() const { return is_ring_ ? vs_.size() : vs_.size() - 1; }

  std::vector<double> us_, vs_;  // without the last one where it is the first again
  std::vector<Vec3> points_;     // u fastest
  std::array<double, face_count> planes_{};
  EndFaces end_faces_{-1, -1};
  std::array<std::array<std::size_t, 2>, 2> level_rows_{};  // that lie in the end's face within the tolerance
  bool is_ring_ = false;
};

}  // namespace selvage::cell
