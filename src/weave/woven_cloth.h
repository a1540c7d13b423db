// A weave in equilibrium (mechanics/woven.h): from the threads and pitches of a text to the mechanics, and
// back to centre lines and sections.
#pragma once

#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/plan.h"
#include "mechanics/woven.h"
#include "weave/draft.h"
#include "weave/system.h"

namespace selvage::fabric {

// What the equilibrium is of. `clearance`: between yarns, file units.
struct ClothText {
  const Fabric* fabric = nullptr;
  const Weave* weave = nullptr;  // without a state: finished
  const System *warp = nullptr, *weft = nullptr;
  const Drawdown* drawdown = nullptr;
  double clearance = 0;
  double yarns = 1;  // diameters over those of the text
  [[nodiscard]] int layers() const { return drawdown->first_ends.empty() ? weave->layers.value_or(1) : 1; }
};

// Errors: of twist_factor_of, at the thread (geometry); a repeat of too many crossings (limit).
Result<mechanics::WovenCloth> woven_cloth(const ClothText& text);

// Of a column or a row, both numbered from 0 and in both directions without end; of those above each other
// there the how-manieth from below, from 0.
struct ClothYarn {
  bool is_weft = false;
  long long place = 0;
  int layer = 0;
};

class ClothInEquilibrium {
 public:
  // Errors: of woven_cloth; of find_equilibrium, at the weave; a thickness or fraction that it does not have
  // (geometry, without a place); a pressure where a thread does not say what its fibres are (malformed).
  static Result<ClothInEquilibrium> find(const ClothText& text);

  // The centre line of a yarn from one place along it to another one, in its own plane (x: along, z), with
  // its section and its sizes.
  void shape(YarnPlan& plan, const ClothYarn& yarn, double from, double to,
             Vec3 (*to_place)(double s, double z, double across)) const;
  [[nodiscard]] yarn::SectionSize size(const ClothYarn& yarn, long long crossing) const;
  // Height of a yarn's axis at a crossing.
  [[nodiscard]] double height(const ClothYarn& yarn, long long crossing) const;
  [[nodiscard]] double thickness() const { return top_ - bottom_; }
  // Of fibre over the whole cloth, its layers a clearance apart.
  [[nodiscard]] double fraction() const;
  [[nodiscard]] double max_width(bool is_weft) const { return max_width_[is_weft ? 1 : 0]; }
  [[nodiscard]] double max_height(bool is_weft) const { return max_height_[is_weft ? 1 : 0]; }
  [[nodiscard]] EquilibriumReport report() const;
  // Fibre volume over the volume of the yarn.
  [[nodiscard]] double packing(const ClothYarn& yarn) const;

 private:
  ClothInEquilibrium(const ClothText& text, mechanics::WovenCloth cloth,
                     mechanics::WovenEquilibrium equilibrium);
  [[nodiscard]] double knot(bool is_weft, long long index) const;  // of the centre lines' spans
  [[nodiscard]] double control_height(const ClothYarn& yarn, long long index) const;
  [[nodiscard]] nurbs::Curve unclamped(const ClothYarn& yarn, long long first, long long last) const;
  [[nodiscard]] int number(const ClothYarn& yarn) const;  // in cloth_
  [[nodiscard]] double fibre_volume() const;              // of a layer, over its area
  // Of a layer that has this fraction, with yarns as long as they are.
  [[nodiscard]] double thickness_for(double fraction) const;
  [[nodiscard]] bool is_too_thick() const;
  [[nodiscard]] bool is_solid() const;  // fibres fill its yarns
  // Of a cloth whose pressure makes it solid; with the largest one that does not.
  [[nodiscard]] Message too_much_pressure(const ClothText& text) const;
  [[nodiscard]] std::vector<ClothYarn> yarns(bool is_weft) const;
  [[nodiscard]] int crossings(bool is_weft) const { return is_weft ? cloth_.columns() : cloth_.rows(); }

  System warp_, weft_;
  Weave::State state_;
  double millimetres_;
  int layers_;
  mechanics::WovenCloth cloth_;
  mechanics::WovenEquilibrium equilibrium_;
  double top_ = 0, bottom_ = 0;
  double max_width_[2] = {0, 0}, max_height_[2] = {0, 0};
};

}  // namespace selvage::fabric
