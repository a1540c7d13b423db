// The heights at which the yarns of a weave pass each other without touching. Arcs about round sections keep
// their distance by themselves; sines and the flanks of wide sections come nearer on the slope than at the
// crossing, so the gap of every crossing that is different is measured on the swept sections.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "fabric/clearance.h"
#include "weave/draft.h"
#include "weave/system.h"

namespace selvage::fabric {

// Three neighbouring passes of one yarn and the way between them, level before and after, as a path in its
// plane. The parameter is 0 at the middle pass; it is the length along a bent path, the distance s along a
// sine.
class PlanePath {
 public:
  // By arcs and straights. Precondition: there is room for them (find_bridge).
  static PlanePath bent(const Pass& before, const Pass& here, const Pass& after);
  // By half waves of a cosine, as the cubic through so many points of each (about: the spline here is over
  // even steps of s).
  static PlanePath sine(const Pass& before, const Pass& here, const Pass& after, int points);

  struct Point {
    Vec2 position, derivative;  // (s, z), by the parameter
  };
  [[nodiscard]] Point at(double t) const;

 private:
  struct Piece {
    double from = 0;  // parameter
    Vec2 start = Vec2::Zero();
    double heading = 0, curvature = 0;  // radians from level; per file unit, positive: upwards
  };
  void add(double length, double turn);
  void add_bridge(const Pass& from, const Pass& to);

  std::vector<Piece> pieces_;  // bent
  Piece end_;                  // where the next piece begins
  // Sine: heights and slopes at even steps, the middle pass half way.
  std::vector<double> heights_, slopes_;
  double step_ = 0, middle_ = 0;
};

// A yarn on this path, at `across` in the other direction of the cloth: the warp runs along x, the weft
// along y. `share`: of the section's own size.
SweptYarn swept_in_plane(const PlanePath& path, bool is_weft, double across, const yarn::Section& section,
                         double share = 1.0);

inline constexpr int points_a_wave = 8;  // of a sine, from crossing to crossing

// Does any yarn of the draft change sides from one crossing to the next? {warps, wefts}
std::pair<bool, bool> changes_of(const Drawdown& drawdown);

// What a weave's yarns do where they cross.
struct WovenPair {
  const System *warp, *weft;
  const Drawdown* drawdown;
  std::optional<Bend> warp_bend, weft_bend;  // none: sine
};

// The least gap of yarns that cross at these heights, by samples; negative: they overlap. `thinner`: the
// length by which every thickness is less than the threads say (widths shrink in proportion).
double crossing_gap(const WovenPair& pair, const Heights& heights, double thinner);

// Heights that keep yarns apart, and what it took.
struct WeaveFit {
  Heights heights;
  double gap = 0;      // of yarns that cross, at least; negative: an overlap that nothing here mends
  double thinner = 0;  // by how much all thicknesses have to be less than the threads say
};

// `heights_at` gives the heights for a clearance at the crossings, or an error where the cloth has no room
// for it. Looks for the smallest clearance that leaves `wanted` free everywhere. In a jammed cloth, which has
// no room for that, yarns take what room there is; where less than half of `wanted` comes of it, they become
// thinner until that much is free, by 3 % at most. Errors: those of `heights_at` without a clearance.
Result<WeaveFit> fit_weave(const WovenPair& pair, double wanted,
                           const std::function<Result<Heights>(double clearance)>& heights_at);

// The smallest clearance from `wanted` on at which `gap_at` reaches `wanted`, by secants, up to `most`; none:
// there is none. `gap_at` returns none where there is no room.
std::optional<double> least_clearance(double wanted, double most,
                                      const std::function<std::optional<double>(double)>& gap_at);

}  // namespace selvage::fabric
