// A weave's two systems where the formulas have no room: their yarns press each other flat (weave_press.h),
// as measured on the swept yarns.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "fabric/draft.h"
#include "fabric/weave_fit.h"
#include "fabric/weave_system.h"

namespace selvage::fabric {

// Both systems as their threads are.
struct LooseCloth {
  System warp, weft;
  const Drawdown* drawdown = nullptr;
  std::optional<double> crimp;      // the warp's share that the text asks for
  std::optional<double> thickness;  // of the cloth, at most
  double clearance = 0;             // of yarns that cross
  Unit units = Unit::mm;
};

// Both systems with sections as they become, and how their yarns lie.
struct PressedCloth {
  System warp, weft;
  PressedBend warp_bend, weft_bend;
  Heights heights;
  double gap = 0;  // of yarns that cross, measured
  [[nodiscard]] double thickness() const { return thickness_of(warp, weft, heights); }
};

// False: a section cannot be pressed (a polygon).
bool can_press(const LooseCloth& cloth);

// None: however its yarns are pressed, they keep less than half of the clearance, or the cloth is thicker
// than asked for.
std::optional<PressedCloth> press_cloth(const LooseCloth& cloth);

// What the yarns of a thread have become: `pressed from 0.343 x 0.343 mm to 0.382 x 0.254 mm, its packing
// rises from 0.6 to 0.73`.
std::string pressing_of(const WovenThread& loose, const WovenThread& pressed, Unit units);

// The least thickness that the cloth can be pressed to, file units, to three digits: the same whatever its
// own `thickness` asks for. Nothing where it cannot be pressed at all.
std::optional<double> least_thickness(const LooseCloth& cloth);

// For a cloth that has no room: by how much it is too dense, and three remedies, each of them tried by
// `has_room`, which gets the cloth with other pitches or with yarns of `yarns` times the diameter.
using HasRoom = std::function<bool(const LooseCloth& cloth, double yarns)>;
std::string remedies_for(const LooseCloth& cloth, const HasRoom& has_room);
// Of pressed yarns.
std::string remedies_for(const LooseCloth& cloth);

}  // namespace selvage::fabric
