// The data sheet of a cloth: its numbers, measured on the yarns as they are built. Of the endless cloth: a
// repeat of the construction is made with its neighbours, and measured from a plane across its yarns to the
// one a repeat on, so that no edge counts.
//
// What the numbers are, with w the area of the repeat:
//   threads        of a system, on a length across them: what its yarns go forward, together, by w
//   crimp          length by what the yarn goes forward, less one (ISO 7211-3); of a planar braid by the
//                  straight line
//   take-up        of the braiders and axial yarns of a tube or strip: the share of the yarn that the braid
//   is
//                  shorter; most of it is the angle
//   yarn ratio     of a knit: length of yarn by that of the fabric
//   mass           sum of length times linear density, by w (ISO 3801)
//   thickness      from the lowest to the highest place of the yarns; of a tube from its inside to its
//   outside cover          share of w that yarns hide, where they run straight when seen from above: of one
//                  direction k the share of its yarns' lanes, of both k1 + k2 - k1 k2 (Peirce 1937); of a
//                  planar braid of all directions, by the widths of the sections
//   cover factor   of a system: threads an inch by the root of the cotton count (Peirce 1937)
//   yarn fraction  volume of the yarns by that of the cloth, w times the thickness
//   fibre fraction volume of the fibres (tex by density) by that of the cloth; the rest is its porosity
//   loop length    of a weft knit: yarn for a needle in a row of the chart
//   tightness      root of tex by the loop length in cm (Munden 1962, Doyle)
//   run-in         of a warp knit: mm of yarn for a rack, 480 courses
//   braid angle    of a tube, by the turns about its axis at the radius of its middle surface; of a planar
//                  braid against x. A tube's cover: with f the share that the yarns of one direction fill,
//                  2 f - f^2 (Brunnschweiler 1954)
//   pile ratio     of warp pile: length of a pile end by the cloth's length
//   twist factor   turns a metre times the root of tex; and turns an inch by the root of the cotton count
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "construction/build.h"
#include "yarn/body.h"

namespace selvage::fabric {

// Yarns that do the same: all warps, all ends of a bar.
struct SystemSheet {
  std::string name;                    // warp, weft, binder, course, plating, pile, bar1, braider, axial
  double length = 0;                   // m of yarn in a square metre; of a braid in a metre
  double mass = 0;                     // g in a square metre (a metre); 0: not known
  std::optional<double> per_mm;        // threads on a length across them; of a braid: how many there are
  std::optional<double> crimp;         // of a weave or a planar braid; 0: straight; none of tufts
  std::optional<double> take_up;       // of a tube or strip, a share of the yarn
  std::optional<double> yarn_ratio;    // of a knit, >= 1
  std::optional<double> cover_factor;  // of a weave
  std::optional<double> loop_length;   // of a weft knit, mm
  std::optional<double> tightness;     // sqrt(tex) / cm
  std::optional<double> run_in;        // of a warp knit, mm a rack
};

struct ThreadSheet {
  std::string name;
  double tex = 0;                      // 0: not known
  double length = 0;                   // m in a square metre; of a braid in a metre
  double mass = 0;                     // g; 0: not known
  double fibre_fraction = 0;           // of its section as built; 0: not known
  std::optional<double> twist_factor;  // of a thread with a twist: sqrt(tex) / m
  std::optional<double> cotton_twist_factor;
};

struct Sheet {
  std::string kind;  // weave, knit, warpknit, braid
  std::string file;
  TextPlace place;
  [[nodiscard]] bool is_per_metre() const { return kind == "braid" && repeat_y == 0; }
  // mm: what was measured, along x and y; of a tube or strip along its axis, and nothing.
  double repeat_x = 0, repeat_y = 0;
  double mass = 0;         // g in a square metre; 0: not known
  double linear_mass = 0;  // of a braid, g in a metre; 0: not known, or no braid
  double thickness = 0;    // mm
  double yarn_fraction = 0;
  double fibre_fraction = 0;  // 0: not known
  std::optional<double> cover;
  std::optional<double> courses_per_mm, wales_per_mm;  // of knits
  std::optional<double> braid_angle;                   // degrees
  std::vector<SystemSheet> systems;                    // in the order of their first yarns
  std::vector<ThreadSheet> threads;
  std::optional<EquilibriumReport> equilibrium;
  std::optional<PileReport> pile;
  std::optional<double> pile_ratio;  // of warp pile
  [[nodiscard]] std::optional<double> porosity() const {
    return fibre_fraction > 0 ? std::optional(1 - fibre_fraction) : std::nullopt;
  }
};

// What is left out, and why.
struct SheetResult {
  std::vector<Sheet> sheets;
  std::vector<Message> missing;  // notes: no repeat, or one far larger than the cloth
};

// Of all constructions, those of used blocks as they are by themselves. The numbers do not depend on the
// number of threads.
SheetResult sheets_of(const YarnBuilder& builder, const BuildOptions& options, int threads);

}  // namespace selvage::fabric
