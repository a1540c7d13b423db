// Yarns of a dense weave, which have no room for their own sections, press each other flat. Sections, places
// and bends are chosen together, by least energy:
//
//   pressing  what changes a section at its own area, its height to width, and what makes its area smaller
//   bending   of the axes (J. W. S. Hearle, P. Grosberg, S. Backer, Structural Mechanics of Fibers, Yarns,
//   and
//             Fabrics, 1969), and the tension that pulls them straight: their length over that of the cloth
//
// so that nowhere yarns that cross come nearer than the clearance. A yarn is level at every crossing; from a
// crossing to the next one on the other side its axis goes level over a flat, by an arc, a straight and the
// same back (interlacing.h). The lower side of the upper yarn and the upper side of the lower one are then
// parallel curves of their axes, known in closed form at every place: the condition is exact.
#pragma once

#include <optional>

#include "yarn/outline.h"
#include "yarn/section.h"

namespace selvage::fabric {

// One system, warp or weft, all lengths in file units.
struct PressedSystem {
  yarn::Section section;   // not a polygon
  yarn::SectionSize size;  // its size
  double pitch = 0;        // of its yarns, the least
  double room = 0;         // the least between yarns between which the other system changes sides
  double least_area = 1;  // of a section, as a share of what it is: where its fibres lie as close as they can
  bool changes = true;    // do its yarns change sides
};

struct PressedSystems {
  PressedSystem warp, weft;
  // Is there a crossing beside which warp and weft both change sides, so that all four yarns meet.
  bool change_together = true;
  double clearance = 0;
  std::optional<double> warp_share;  // of the height by which both systems rise: as asked for
  std::optional<double> thickness;   // of the cloth, at most
};

// What becomes of the yarns of a system.
struct PressedYarn {
  double height_share = 1, area_share = 1;  // of what their sections have by themselves
  double pointed = 0;                       // added to the exponent of power sections (circle and ellipse: 1)
  double height = 0;                        // of the axis over the middle of the cloth, where it crosses
  double flat = 0, radius = 0;              // half of the flat; of the arcs
};

struct Pressed {
  PressedYarn warp, weft;
  // No yarn is wider than its pitch or bends more tightly than its section allows, and each finds its way
  // from crossing to crossing. Whether yarns that cross keep the clearance has to be measured.
  bool is_sound = false;
};

// The section of a pressed yarn, of this size by itself: circles and ellipses become ellipses, or with
// pointed edges power sections.
yarn::Section pressed_section(const yarn::Section& section, const yarn::SectionSize& size,
                              const PressedYarn& pressed);
bool can_be_pressed(const yarn::Section& section);

// The state of least energy. Where there is no room at all, what comes nearest to it. The same in every unit:
// solved in ratios to the yarns' mean thickness, of ten digits.
Pressed press(const PressedSystems& systems);

// The densest that round fibres lie: pi / (2 sqrt(3)), hexagons.
inline constexpr double densest_packing = 0.9068996821171089;

}  // namespace selvage::fabric
