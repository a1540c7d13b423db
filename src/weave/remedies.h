// What gives a jammed weave room: by how much it is too dense, and pitches and yarns that cure it.
#pragma once

#include <functional>
#include <string>

#include "weave/system.h"

namespace selvage::fabric {

struct LooseCloth {
  System warp, weft;
  Unit units = Unit::mm;
};

// With sections of `by` times the width and height.
System scaled(System system, double by);

// A pitch (file units) in the form of the text: `pitch P`, or yarns per cm or inch; and the pitch that this
// is. Not closer than it is.
std::string shown_pitch(const WeaveSystem& system, double pitch, Unit units);
double as_shown(const WeaveSystem& system, double pitch, Unit units);

// For a cloth that has no room: by how much it is too dense, and three remedies, each of them tried by
// `has_room`, which gets the cloth with other pitches or with yarns of `yarns` times the diameter.
using HasRoom = std::function<bool(const LooseCloth& cloth, double yarns)>;
std::string remedies_for(const LooseCloth& cloth, const HasRoom& has_room);

}  // namespace selvage::fabric
