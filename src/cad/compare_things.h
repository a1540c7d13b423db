// How a thing of one model (a yarn, a part, a curve) differs from its partner in the other one.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "cad/basis.h"
#include "cad/distance.h"
#include "cad/motion.h"
#include "cad/region.h"
#include "cad/things.h"

namespace selvage::cad {

// A difference is told by bounds of which the upper one is at most this many times the lower one.
inline constexpr double largest_spread = 1.5;

struct CompareLimits {
  double points = 0;     // control points that are this near are equal
  double distances = 0;  // surfaces over different bases
  double motion = 0;     // what a motion may leave
  double near = 0;       // corners of boxes at the same place
};

// Two surfaces that belong together.
struct SurfaceFinding {
  Reach reach;
  std::optional<ControlChange> points;  // where the bases agree
};

struct PairFinding {
  Reach reach;               // the worst of its surfaces
  std::size_t surface = 0;   // that has it, in a
  bool is_equal = true;      // within the limits
  bool is_reversed = false;  // the start of one yarn is the end of the other
  bool is_swapped = false;   // another pair has these two names the other way round
  std::optional<ControlChange> points;
  std::size_t changed = 0, count = 0;
  std::optional<Motion> motion;
};

// What of its surface `k` a thing has.
Range range_of(const Thing& thing, std::size_t k);
std::optional<Region> region_of(const Thing& thing, std::size_t k);

// Nothing farther than `limit` was found.
bool is_within(const Reach& reach, double limit);

class ThingComparer {
 public:
  // The limits outlive it.
  explicit ThingComparer(const CompareLimits& limits) : limits_(limits) {}

  [[nodiscard]] PairFinding look_at(const Thing& a, const Thing& b) const;
  // Do a few points tell that they differ?
  [[nodiscard]] std::optional<PairFinding> glance_at(const Thing& a, const Thing& b) const;

 private:
  // Surface i of a is surface partner[i] of b.
  [[nodiscard]] PairFinding look_at(const Thing& a, const Thing& b,
                                    const std::vector<std::size_t>& partner) const;
  [[nodiscard]] SurfaceFinding compare_surfaces(const Thing& a, std::size_t i, const Thing& b,
                                                std::size_t j) const;
  [[nodiscard]] Reach distance_between(const nurbs::Surface& s, const nurbs::Surface& t) const;
  void look_beyond_points(const Thing& a, const Thing& b, const std::vector<std::size_t>& partner,
                          std::vector<SurfaceFinding>& found) const;
  [[nodiscard]] bool lies_on(const Thing& a, const Thing& b) const;
  void sum_up(const Thing& a, const std::vector<SurfaceFinding>& found, PairFinding& finding) const;
  [[nodiscard]] std::vector<std::size_t> partners(const Thing& a, const Thing& b) const;
  [[nodiscard]] PairFinding compare_unions(const Thing& a, const Thing& b) const;
  void find_motion(const Thing& a, const Thing& b, const std::vector<std::size_t>& partner,
                   const std::vector<SurfaceFinding>& found, PairFinding& finding) const;

  const CompareLimits& limits_;
};

}  // namespace selvage::cad
