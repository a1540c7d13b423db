// The least translation that ends an overlap.
#pragma once

#include <vector>

#include "contact/tube_mesh.h"

namespace selvage::contact {

// How far one yarn has to go along a direction, and which points part last.
struct Parting {
  double distance = 0;                      // 0: nothing shared was seen
  std::uint32_t a = 0, b = 0;               // triangles of the two skins
  Vec3 p = Vec3::Zero(), q = Vec3::Zero();  // on them; p - q = distance * direction
};

// A skin's triangles in runs, each within a sphere: most are far from the few lines that are looked along.
// The mesh has to outlive it.
class TriangleRuns {
 public:
  struct Run {
    std::uint32_t begin = 0, end = 0;  // triangles
    Vec3 middle = Vec3::Zero();
    double radius = 0;
  };
  explicit TriangleRuns(const Mesh& mesh);
  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }

 private:
  const Mesh& mesh_;
  std::vector<Run> runs_;
};

// Two closed skins that share the space round some points. parting(n): how far A has to
// go along -n until that space is shared no more: on every line along n through it, A's piece [a0, a1] and
// B's piece [b0, b1] that overlap part by a1 - b0, and the largest of these counts. Lines are tried on a
// square raster.
class SharedSpace {
 public:
  // `walls`: points whose box holds the shared space; what the skins share elsewhere is not looked at.
  // Lines that share no more than `grain` share nothing.
  SharedSpace(const Mesh& a, const Mesh& b, std::vector<Vec3> walls, double grain)
      : a_(a), b_(b), walls_(std::move(walls)), grain_(grain) {}

  // The walls of each connected piece of the shared space: where lines along the direction enter and leave
  // it.
  [[nodiscard]] std::vector<std::vector<Vec3>> pieces(const Vec3& direction) const;

  [[nodiscard]] Parting parting(const Vec3& direction) const;

  // Where they part later than on the lines beside it, and not much earlier than where they part last: at
  // least `share` of that distance, which is between 0 and 1. The last one first.
  [[nodiscard]] std::vector<Parting> late_partings(const Vec3& direction, double share) const;

  // The direction in which the least movement parts them, by compass search from the best of `starts` (unit
  // vectors).
  [[nodiscard]] Vec3 easiest_direction(const std::vector<Vec3>& starts) const;

 private:
  class View;

  TriangleRuns a_, b_;
  std::vector<Vec3> walls_;
  double grain_;
};

// 26 directions: the faces, edges and corners of a cube.
std::vector<Vec3> directions_all_round();

}  // namespace selvage::contact
