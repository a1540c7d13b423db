// Manifold solid B-reps (186 with 514, 510, 508, 504, 502 and the edges' 126s): their entities, and a yarn as
// one. Vertices and edges go by their indices 0, 1, ... in the lists.
#pragma once

#include "formats/iges/entities.h"

namespace selvage::formats::iges {

struct SolidEdge {
  nurbs::Curve curve;
  std::size_t from = 0, to = 0;
  const Vec3* normal = nullptr;  // of the curve's plane
};
// The pointers of the 502 and the 504 of a solid.
struct SolidLists {
  int vertices = 0, edges = 0;
};
// What a loop runs along.
struct EdgeUse {
  bool is_vertex = false;  // a pole: the loop passes through a point where the surface has an edge of length
                           // zero
  std::size_t index = 0;
  bool forward = true;
  int flat = 0;  // pointer of its curve in the surface's parameters; 0: none
};
struct SolidFace {
  int pointer = 0;      // of the 510
  bool outward = true;  // S_u x S_v points out of the solid
};

// The edges' 126s, 502 and 504.
SolidLists write_lists(Records& records, const Common& common, const std::vector<Vec3>& vertices,
                       const std::vector<SolidEdge>& edges);
int write_loop(Records& records, const Common& common, const SolidLists& lists,
               std::span<const EdgeUse> uses);  // 508
// 510; the outer loop is the first. `property`: of the entity, or 0.
int write_face(Records& records, const Common& common, int surface, std::span<const int> loops,
               int property = 0);
// Their 514s, and the 186 of them: the outer shell comes first.
int write_shells(Records& records, const Common& common, std::span<const std::vector<SolidFace>> shells);

// How many entities write_solid writes for this body.
int entities_of_solid(const yarn::Body& body);

// Precondition: the body is closed (a ring, or both ends sealed). Returns the pointer of the 186.
int write_solid(Records& records, const Common& common, const yarn::Body& body);

}  // namespace selvage::formats::iges
