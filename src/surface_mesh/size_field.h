// How long edges may be at each place of a unit cell.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/parallelepiped.h"
#include "yarn/body.h"

namespace selvage::fem {

// The smallest of the bounds that are set at places, each growing by a share of the distance from its place.
class SizeField {
 public:
  struct Bound {
    Vec3 at;
    double size;
  };
  SizeField(double largest, double growth, std::vector<Bound> bounds);
  [[nodiscard]] double at(const Vec3& place) const;
  [[nodiscard]] double largest() const { return largest_; }

 private:
  struct Node {
    Box3 box;
    double least = 0;         // of its bounds
    std::uint32_t first = 0;  // leaf: into bounds_; else the left child, the right one follows it
    std::uint32_t count = 0;  // 0: not a leaf
  };
  void split(std::uint32_t node, std::uint32_t first, std::uint32_t last);

  double largest_, growth_;
  std::vector<Bound> bounds_;
  std::vector<Node> nodes_;
};

// Of edges away from what asks for short ones, per length.
inline constexpr double usual_growth = 0.5;

struct SizeRules {
  struct Yarn {
    double largest = 0;  // on its surface, file units, > 0
    double turn = 0.7;   // of its surface along an edge, radians
  };
  std::vector<Yarn> yarns;  // one a body
  double coarsest = 0;      // away from them; at least their largest
  double smallest = 0;      // never finer, >= 0
  // Edges over the width of a gap; 0: gaps are not meshed. Tetrahedra in it get flatter with it, and what
  // yarns lack of their volume there the rest of them has to make up.
  double gap_factor = 5;
  double growth = usual_growth;  // of the size, per length
  double raster = 0;             // places on a yarn are no nearer; they are at 0.4 of its largest
  double turn_finest = 0.35;     // curvature alone asks for no less than this share of the yarn's largest
};

// Bounds on the yarns' surfaces in the box and a little beyond it: the gap to other yarns and to other parts
// of the same one, the gap to faces of the box that run alongside, curvature; and `more` of them. The same
// for any number of threads.
SizeField size_field(std::span<const yarn::Body> bodies, const Parallelepiped& cell, const SizeRules& rules,
                     int threads, std::vector<SizeField::Bound> more = {});

// Values of u at which the surface has a sharp crest all along, increasing, first u <= value < last u.
std::vector<double> crests_of(const nurbs::Surface& surface);

}  // namespace selvage::fem
