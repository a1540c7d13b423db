// Tetrahedra of several regions made better: their smallest dihedral angle is raised to a target, while every
// triangle of the surface and between regions stays exactly as it is.
//
// Local operations that each raise the smallest angle of what they touch (hill climbing): removal of inner
// edges by the best triangulation of the ring round them (Klincsek, Canadian J. Math. 32, 1980; with it the
// flips 3-2, 4-4 and all others of one edge), its open form at edges of the surface and part of a ring (with
// it the flip 2-3), smoothing of inner points by the smallest angle of their star (after Freitag and
// Ollivier-Gooch, Int. J. Numer. Meth. Engng 40, 1997), contraction of inner edges, and a new point in a
// cavity that grows from a bad tetrahedron (after Klingner and Shewchuk, 16th Int. Meshing Roundtable, 2007).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "fem/mesh.h"
#include "tetrahedra/refine.h"

namespace selvage::fem {

// A tetrahedron that is still below the target.
struct BelowTarget {
  // geometry: two triangles of the surface meet in the edge under a wedge that is sharper than the target:
  // no mesh of this surface can be better. needle: it stands at a triangle of the surface with an angle below
  // the target. surface: all its corners are on the surface, whose triangles are too long for the gap. inner:
  // nothing helped.
  enum class Cause { geometry, needle, surface, inner } cause = Cause::inner;
  std::size_t cell = 0;
  double angle = 0;  // its smallest dihedral angle, degrees
  double wedge = 0;  // of the geometry, or of the needle: degrees
  Vec3 at = Vec3::Zero();
  // Cause::surface: the longest edge of the surface that the gap here asks for, three times its width.
  double edge_needed = 0;
};

struct Improvement {
  std::vector<BelowTarget> below;  // worst first
};

struct ImproveOptions {
  double target = 10;  // degrees, 0..30
  double polish = 0;   // degrees: what is below is looked at once, before the passes; 0: not
  int passes = 8;      // over the tetrahedra below it; work is linear in their number
  std::optional<RefineOptions> refine{};  // points are put in first
  int threads = 1;                        // each works on regions of its own
};

// `cells`: corners with positive volume; `regions`: of each cell. The first `fixed_points` points and every
// other one on the surface or between regions stay where they are, inner ones move, come and go, so that
// points are numbered anew behind the fixed ones, and the cells change in number and order. The smallest
// angle is never less afterwards, where no points were put in first. The same input gives the same result, to
// the bit, with any number of threads.
Improvement improve(std::vector<Vec3>& points, std::vector<std::array<std::uint32_t, 4>>& cells,
                    std::vector<std::uint32_t>& regions, std::size_t fixed_points,
                    const ImproveOptions& options);

// What is left below the target, for a message each: a note of wedges of the geometry, warnings of the rest,
// with the worst place (in the points' unit, whose name is `unit`) and the remedy. None where nothing is
// left.
std::vector<Message> describe(const Improvement& improvement, double target, std::string_view unit);

// The same as counts.
AngleTarget count(const Improvement& improvement, double target);

}  // namespace selvage::fem
