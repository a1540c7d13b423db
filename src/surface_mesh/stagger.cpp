#include "surface_mesh/stagger.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/box_tree.h"
#include "core/parallel.h"

namespace selvage::fem {
namespace {

class Staggerer {
 public:
  Staggerer(std::span<const StaggeredMesh> meshes, const SizeField& field, int threads)
      : meshes_(meshes), field_(field), threads_(threads) {}

  void run() {
    for (int round = 0; round < rounds; ++round) {
      collect();
      find_movers();
      if (movers_.empty()) return;
      relax();
      settle();
    }
    // Where points went away from a place that is narrower than its surroundings.
    for_each_index(meshes_.size(), threads_,
                   [&](std::size_t m) { split_long_edges(*meshes_[m].mesh, *meshes_[m].support, field_); });
  }

 private:
  static constexpr int rounds = 4, steps = 10;  // edges turn after each round
  // Lengths are over the edges' wanted one.
  static constexpr double range = 0.5;           // of the repulsion, exp(-(distance / range)^2)
  static constexpr double farthest = 3 * range;  // where it has ended
  static constexpr double gap_stretch = 2;       // a distance over a gap counts that often
  static constexpr double widest_gap = 0.7, nearest_across = 1;
  static constexpr double rate = 0.8;  // a step, over the force
  static constexpr double longest_step = 0.1, longest_round = 0.35;
  static constexpr double facing = 0.2;  // cosine between normals

  struct Point {
    Vec3 at = Vec3::Zero(), normal = Vec3::Zero();
    double size = 0;  // the edges wanted there
    std::uint32_t mesh = 0, number = 0;
  };
  struct Near {
    std::uint32_t point;
    bool is_across;  // on a surface that faces it
  };
  struct Mover {
    std::uint32_t point, first, last;  // into near_
  };
  void collect();
  [[nodiscard]] std::vector<Near> neighbours(const BoxTree& tree, std::uint32_t number) const;
  void find_movers();
  [[nodiscard]] Vec3 force_on(const Mover& mover) const;
  void relax();
  void settle();

  std::span<const StaggeredMesh> meshes_;
  const SizeField& field_;
  int threads_;
  std::vector<Point> points_;
  std::vector<Mover> movers_;
  std::vector<Near> near_;
};

void Staggerer::collect() {
  points_.clear();
  for (std::uint32_t m = 0; m < meshes_.size(); ++m)
    for (std::uint32_t k = 0; k < meshes_[m].mesh->points.size(); ++k)
      points_.push_back({.at = meshes_[m].mesh->points[k], .mesh = m, .number = k});
  for_each_index(points_.size(), threads_, [&](std::size_t k) {
    Point& point = points_[k];
    const auto& [mesh, support] = meshes_[point.mesh];
    point.normal = support->normal(mesh->parameters[point.number]);
    point.size = field_.at(point.at);
  });
}

// Of a free point that faces another surface over a narrow gap; else none. Normals of other bodies may point
// inward: what is so near to a surface and alongside faces it.
std::vector<Staggerer::Near> Staggerer::neighbours(const BoxTree& tree, std::uint32_t number) const {
  const Point& point = points_[number];
  std::vector<Near> found;
  if (point.number < meshes_[point.mesh].mesh->fixed_points) return found;
  const double reach = farthest * point.size;
  bool has_gap = false;
  tree.near_point(point.at, reach, [&](std::uint32_t k) {
    if (k == number) return reach;
    const Point& other = points_[k];
    const double cosine = point.normal.dot(other.normal);
    const bool is_across = other.mesh != point.mesh ? std::abs(cosine) > facing : cosine < -facing;
    found.push_back({k, is_across});
    const Vec3 way = other.at - point.at;
    has_gap = has_gap || (is_across && way.norm() < nearest_across * point.size &&
                          std::abs(way.dot(point.normal)) < widest_gap * point.size);
    return reach;
  });
  if (!has_gap) found.clear();
  return found;
}

void Staggerer::find_movers() {
  std::vector<Box3> boxes;
  boxes.reserve(points_.size());
  for (const Point& point : points_) boxes.emplace_back(point.at, point.at);
  const BoxTree tree(std::move(boxes));
  std::vector<std::vector<Near>> near(points_.size());
  for_each_index(points_.size(), threads_,
                 [&](std::size_t k) { near[k] = neighbours(tree, static_cast<std::uint32_t>(k)); });
  movers_.clear();
  near_.clear();
  for (std::uint32_t k = 0; k < points_.size(); ++k) {
    if (near[k].empty()) continue;
    const auto first = static_cast<std::uint32_t>(near_.size());
    near_.insert(near_.end(), near[k].begin(), near[k].end());
    movers_.push_back({k, first, static_cast<std::uint32_t>(near_.size())});
  }
}

// Along the surface; where sizes change, points as many sizes away push as much.
Vec3 Staggerer::force_on(const Mover& mover) const {
  const Point& point = points_[mover.point];
  Vec3 force = Vec3::Zero();
  for (std::uint32_t n = mover.first; n < mover.last; ++n) {
    const Point& other = points_[near_[n].point];
    const Vec3 way = point.at - other.at;
    const double height = way.dot(point.normal), size = (point.size + other.size) / 2;
    const Vec3 along = way - height * point.normal;
    const double up = near_[n].is_across ? gap_stretch * height : height;
    const double square = (along.squaredNorm() + up * up) / (range * range * size * size);
    force += std::exp(-square) * point.size / size * along;
  }
  return force;
}

void Staggerer::relax() {
  std::vector<Vec3> start(movers_.size()), next(movers_.size());
  for (std::size_t k = 0; k < movers_.size(); ++k) start[k] = points_[movers_[k].point].at;
  const auto at_most = [](const Vec3& way, double length) {
    return way.norm() > length ? Vec3(way.normalized() * length) : way;
  };
  for (int step = 0; step < steps; ++step) {
    for_each_index(movers_.size(), threads_, [&](std::size_t k) {
      const Point& point = points_[movers_[k].point];
      const Vec3 way = at_most(rate * force_on(movers_[k]), longest_step * point.size);
      next[k] = start[k] + at_most(point.at + way - start[k], longest_round * point.size);
    });
    for (std::size_t k = 0; k < movers_.size(); ++k) points_[movers_[k].point].at = next[k];
  }
}

void Staggerer::settle() {
  std::vector<std::vector<PointTarget>> targets(meshes_.size());
  for (const Mover& mover : movers_) {
    const Point& point = points_[mover.point];
    targets[point.mesh].push_back({point.number, point.at});
  }
  for_each_index(meshes_.size(), threads_, [&](std::size_t m) {
    if (!targets[m].empty()) move_points(*meshes_[m].mesh, *meshes_[m].support, targets[m]);
  });
}

}  // namespace

void stagger(std::span<const StaggeredMesh> meshes, const SizeField& field, int threads) {
  Staggerer(meshes, field, threads).run();
}

}  // namespace selvage::fem
