// Which points of the yarns' surfaces stand against which others, now: rays along the outward normals of
// sampled points meet the sampled surfaces that face them, and the gap is then taken on the B-splines.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "contact/strand.h"
#include "core/box_tree.h"
#include "nurbs/samples.h"

namespace selvage::contact {

// A point of one yarn and the point of a surface that faces it.
struct Facing {
  std::uint32_t a = 0, b = 0;  // strands; equal: a yarn faces itself
  Vec2 site_a = Vec2::Zero(), site_b = Vec2::Zero();
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // unit, from a to b: the mean of a's outward normal and b's inward one
  double gap = 0;              // (on_b - on_a) . normal; < 0: overlap
  bool is_pulled = false;      // the gap is to be reached from both sides
};

class NearSkins {
 public:
  // `strands` outlives this. The tree's structure is made from their present shape. `wanted`: whether
  // these two strands (or this one with itself) are looked at.
  NearSkins(std::span<const Strand> strands, const std::function<bool(std::size_t, std::size_t)>& wanted);

  // Samples the present surfaces anew and gives all facings with a gap up to `reach` (of each strand: by its
  // index), as seen from the samples. Overlaps are seen down to a good third of the thickness.
  std::vector<Facing> find(double reach, int threads);

 private:
  struct Skin {
    nurbs::Samples samples;    // the last column is the first
    std::vector<double> arcs;  // of each row
    std::vector<Vec3> normals;
  };
  struct Leaf {
    std::uint32_t strand = 0;
    std::size_t row = 0, column = 0, columns = 0;  // quads (column .. column + columns - 1, row)
  };
  void sample(std::size_t strand);
  [[nodiscard]] std::vector<Box3> boxes() const;  // of the leaves
  void look_from(std::uint32_t leaf, double reach, std::vector<Facing>& found) const;
  struct Ray {
    Vec3 origin, direction;
    double from = 0, to = 0;
  };
  void cast(const Leaf& from, const Leaf& onto, const Box3& box, double reach,
            std::vector<Facing>& found) const;
  [[nodiscard]] std::vector<Vec2> hits(const Leaf& leaf, const Ray& ray) const;
  [[nodiscard]] bool are_neighbours(const Leaf& a, const Leaf& b) const;
  [[nodiscard]] bool is_wanted(const Leaf& a, const Leaf& b) const;

  std::span<const Strand> strands_;
  std::vector<char> wanted_;  // strands x strands
  std::vector<Skin> skins_;
  std::vector<Leaf> leaves_;
  BoxTree tree_;  // of the leaves
};

// The facing at the place where the two surfaces are nearest (or deepest in each other) that belongs to this
// one: both normals on one line. Steps of Newton's method; nothing where it does not converge, as at edges.
std::optional<Facing> settled(std::span<const Strand> strands, const Facing& facing);

}  // namespace selvage::contact
