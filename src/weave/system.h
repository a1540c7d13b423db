// One of a weave's two systems, warp or weft: its threads with their sections, and where its yarns are.
#pragma once

#include <memory>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "weave/interlacing.h"

namespace selvage::fabric {

struct WovenThread {
  const Thread* thread = nullptr;
  yarn::Section section;
  yarn::SectionSize size;
};

struct System {
  const WeaveSystem* text = nullptr;
  std::shared_ptr<const WeaveSystem> own_text{};  // what `text` is where the fabric does not have it
  std::vector<WovenThread> threads;  // used in turn, as the text lists them; and all that columns have
  // Of warps above each other: those of each column, from the lowest; used in turn. Empty: one of `threads`.
  std::vector<std::vector<WovenThread>> columns;
  double thickest = 0, widest = 0;

  // Where spacing is not even: by how much the yarns of a repeat lie off their even places.
  std::vector<double> offsets;
  // Least distances of neighbours: of those between which the other system changes sides, and of all.
  double room = 0, closest = 0;

  // Yarns (columns) are numbered from 0 and go on in both directions. `layer`: of those above each other.
  [[nodiscard]] const WovenThread& thread(long long yarn, int layer = 0) const;
  // Yarns after which the threads come again.
  [[nodiscard]] long long repeat_of_threads() const;
  // Where a yarn lies, one rounding: (yarn + 1/2) pitch; where spacing is not even, beside it. Between yarns
  // in proportion.
  [[nodiscard]] double at(double yarn) const;
};

// Errors (geometry): a thread without a size, at the system's line.
Result<WovenThread> woven_thread(const Fabric& fabric, const std::string& name, TextPlace place);
Result<System> system_of(const Fabric& fabric, const WeaveSystem& text);

// Thickness of the thickest yarn in the cloth, about: one without twist, and without a size of its own, lies
// as wide as its pitch.
double thickness_in_cloth(const System& system, Unit units, bool is_warp);

// Puts warps above each other. Errors as of system_of.
Status stack_columns(System& system, const Fabric& fabric, const std::vector<WarpColumn>& columns);

// With the room that it takes beside straight yarns: that of the circle round a Loop7, which is not quite
// round.
WovenThread filled(WovenThread woven);
// All its threads.
void fill(System& system);

// Yarns of a system move together under floats and apart where yarns of the other system change sides between
// them. `changes`: how many do, between yarn i and the next one, over a repeat. Neighbours without any come
// as near as `closest` (no further apart than the pitch); what that frees the others share, so that the
// energy of bending, changes / distance^3 of each gap, is least. Nothing moves where all gaps are alike.
void relax_spacing(System& system, const std::vector<int>& changes, double closest);

void space_evenly(System& system);

// The bend that yarns make over these threads where the text does not say it: by the form of their sections.
// None for sections whose arc would be too flat to be used (ellipse, power, polygon): sines cross those.
std::optional<Bend> natural_bend(const System& crossed);

// How high the axes of both systems lie where they cross: a yarn of thickness H is at +-((H + clearance)/2 -
// shift) in the warp, +-((H + clearance)/2 + shift) in the weft, so that every pair is just the clearance
// apart.
struct Heights {
  double shift = 0, clearance = 0;
  [[nodiscard]] double warp(double thickness) const { return 0.5 * (thickness + clearance) - shift; }
  [[nodiscard]] double weft(double thickness) const { return 0.5 * (thickness + clearance) + shift; }
};

// From the lowest to the highest place of the cloth.
double thickness_of(const System& warp, const System& weft, const Heights& heights);

// What the axes of one system may rise by from crossing to crossing, at most: infinity where they never
// change sides.
double most_height(const System& own, const System& crossed, Bend bend, bool changes_sides, double clearance);

// Shares the crimp: the warp's height is `wanted` of both (equal where nothing is wanted), or the nearest
// share that both systems have room for, so that yarns that cross keep the clearance. Error (geometry), at
// the line of the system whose pitch is too small for that: with the smallest.
struct SystemPair {
  const System *warp, *weft;
  Bend warp_bend, weft_bend;  // of the warp over the weft, of the weft over the warp
  bool warp_changes = true, weft_changes = true;
};
Result<Heights> share_crimp(const SystemPair& pair, const std::optional<double>& wanted, double clearance);

}  // namespace selvage::fabric
