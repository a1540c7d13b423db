// A stretch of a yarn as a closed mesh.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "contact/face.h"
#include "core/box_tree.h"

namespace selvage::contact {

// Triangles counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<Vec2> sites;  // one a vertex: (u, v) on its triangles' face
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::int32_t> faces;  // one a triangle: of the model; -1: where the yarn was cut

  static constexpr std::int32_t cut = -1;
};

// A range of v on a body's side; on a ring it may pass the seam (first < last all the same).
struct Stretch {
  double first = 0, last = 0;
};

// The side between two sections, about 64 quads round, none longer than a sixth of the thickness, and what
// closes it: the end faces, or flat fans where the stretch ends before the yarn does (and at open ends).
Mesh tube_mesh(const CellModel& model, std::size_t body, const Stretch& stretch);

// Which points a closed mesh holds: by the number of triangles on a ray.
class Inside {
 public:
  // `mesh` outlives this.
  explicit Inside(const Mesh& mesh);
  [[nodiscard]] bool contains(const Vec3& point) const;

 private:
  const Mesh& mesh_;
  std::vector<Vec3> turned_;  // the vertices, turned so that no ray runs along a grid
  BoxTree tree_;
};

// Does the ray from `point` along +x pass through the triangle?
bool ray_meets(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace selvage::contact
