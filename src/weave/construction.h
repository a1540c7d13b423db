// The construction `weave` as its parts know it: weave.cpp (layers, heights, yarns) and binders.cpp.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fabric/build_options.h"
#include "weave/draft.h"
#include "weave/fit.h"
#include "weave/interlacing.h"
#include "weave/leno_shape.h"
#include "weave/pucker_shape.h"
#include "weave/remedies.h"
#include "weave/system.h"
#include "weave/woven_cloth.h"

namespace selvage::fabric {

// A place on the path of a yarn along the warp, or of a weft.
inline Vec3 along_warp(double s, double z, double y) {
  return {s, y, z};
}
inline Vec3 along_weft(double s, double z, double x) {
  return {x, s, z};
}

// The yarns of one kind and layer, one after the other in the construction's order.
struct Block {
  enum class Kind { warp, weft, binder } kind = Kind::warp;
  int layer = 0;        // from 0; of wefts between straight warps one more than of these
  std::size_t set = 0;  // binder: which line
  std::size_t first = 0, count = 0;
  long long begin = 0;       // the number of its first yarn (column): below 0 before the cloth's edge
  std::size_t in_cloth = 0;  // of them, those that the text counts: 0, 1, ...
};

// One yarn of a weave with pile: of the ground, an end of pile, or a tuft of one.
struct PileYarn {
  Block::Kind kind = Block::Kind::warp;  // of the system that it is of
  long long yarn = 0;                    // of that system
  bool is_pile = false;
  long long first = 0, last = 0;  // of pile: the crossings from the first to the last that bind it
  int number = 0;                 // of a tuft, from 1 in the cloth
  bool is_tuft = false;
  bool ends_at_foot = false;  // an end of pile whose `last` has but the foot of its last loop
};

// Yarns side by side: how many the text counts, where they lie, and how wide they are.
struct Row {
  long long count = 0;
  double first = 0, step = 0;  // across the yarns
  double width = 0;
};

// How far yarns of one direction go: from and to, and the crossings that they pass (numbers of the other
// system).
struct Reach {
  double from = 0, to = 0;
  long long first = 0, last = 0;
};

class WeaveConstruction final : public Construction {
 public:
  WeaveConstruction(const Fabric& fabric, const Weave& weave, const BuildOptions& options, System warp,
                    System weft);
  // Errors: of its threads.
  static Result<std::unique_ptr<WeaveConstruction>> make(const Fabric& fabric, const Weave& weave,
                                                         const BuildOptions& options);

  // Everything that can go wrong, before any yarn is planned.
  Status prepare(Diagnostics& diagnostics);

  [[nodiscard]] std::size_t count() const override {
    return has_pile() ? pile_yarns_.size() : blocks_.back().first + blocks_.back().count;
  }
  [[nodiscard]] std::string name(std::size_t index) const override;
  [[nodiscard]] const Thread& thread(std::size_t index) const override;
  [[nodiscard]] std::uint64_t data_points() const override { return data_points_; }
  [[nodiscard]] std::uint64_t longest() const override { return std::max(points_of(false), points_of(true)); }
  [[nodiscard]] Result<YarnPlan> plan(std::size_t index) const override;
  [[nodiscard]] Repeat repeat() const override;
  [[nodiscard]] Vec2 unit() const override { return {weave_.weft.pitch, weave_.warp.pitch}; }
  [[nodiscard]] std::string system(std::size_t index) const override;
  [[nodiscard]] bool has_whole_yarns() const override { return equilibrium_.has_value(); }
  [[nodiscard]] std::optional<EquilibriumReport> equilibrium() const override {
    return equilibrium_ ? std::optional(equilibrium_->report()) : std::nullopt;
  }
  [[nodiscard]] std::optional<PileReport> pile() const override;

 private:
  struct Place {
    const Block* block;
    long long yarn;  // its number, of warps above each other their column's: from 0 in the cloth
    int layer = 0;   // of those above each other
  };
  [[nodiscard]] Place place_of(std::size_t index) const;
  // Data points of a weft, or of a yarn along the warp.
  [[nodiscard]] std::uint64_t points_of(bool is_weft) const {
    const Reach& reach = is_weft ? along_y_ : along_x_;
    const auto crossings = static_cast<std::uint64_t>(reach.last - reach.first + 3);
    if (!has_formula_) return mechanics::spans_a_gap * crossings;
    return is_sine(is_weft) ? points_a_wave * crossings : crossings;
  }
  [[nodiscard]] bool is_sine(bool is_weft) const {
    return !is_straight() && !(is_weft ? weft_bend_ : warp_bend_);
  }
  [[nodiscard]] bool is_straight() const { return weave_.profile == Weave::Profile::straight; }
  [[nodiscard]] int layers() const { return weave_.layers.value_or(1); }
  // Warps and wefts lie above each other in one cloth; else layers are cloths, or of straight yarns.
  [[nodiscard]] bool is_stacked() const { return !weave_.columns.empty(); }
  void add_block(Block::Kind kind, int layer, std::size_t set, const Row& row);
  [[nodiscard]] static Row row_of(const System& system) {
    // Yarns off their even places reach further.
    double off = 0.0;
    for (const double offset : system.offsets) off = std::max(off, std::abs(offset));
    return {system.text->count, 0.5 * system.text->pitch, system.text->pitch, system.widest + 2.0 * off};
  }
  Status prepare_interlacing(Diagnostics& diagnostics);
  [[nodiscard]] bool any_section(bool (*is)(const yarn::Section& section)) const;
  Status prepare_heights(Diagnostics& diagnostics);
  Status prepare_formula(Diagnostics& diagnostics);
  Status fit_drawing(Diagnostics& diagnostics);
  [[nodiscard]] double thinnest() const;
  Status prepare_equilibrium(Diagnostics& diagnostics);
  [[nodiscard]] Message jammed(const Message& failure) const;
  // Of pile (pile.cpp).
  struct Leg;
  struct BoundPart;
  [[nodiscard]] bool has_pile() const { return weave_.pile || weave_.draft.has_pile(); }
  [[nodiscard]] bool is_pile(bool is_weft, long long yarn) const;
  // The following: of a yarn of pile.
  [[nodiscard]] bool pile_is_up(long long yarn) const;
  [[nodiscard]] bool is_bound(long long yarn, long long crossing) const;
  [[nodiscard]] std::optional<long long> bound_from(long long yarn, long long crossing) const;
  [[nodiscard]] BoundPart bound_part(long long yarn, long long first, long long last) const;
  [[nodiscard]] std::optional<std::vector<Vec2>> free_part(const BoundPart& part, int side, bool is_up,
                                                           double height) const;
  static System with_pile_ends(const System& ground, const WovenThread& pile);
  [[nodiscard]] Result<Drawdown> pile_drawdown() const;
  [[nodiscard]] std::array<long long, 2> pile_repeat() const;  // ends, picks
  [[nodiscard]] bool pile_fits(double height);
  void measure_ground();
  [[nodiscard]] std::optional<std::string> pitch_for_pile() const;
  [[nodiscard]] Message refused_pile();
  Status prepare_pile(Diagnostics& diagnostics);
  [[nodiscard]] std::string pile_name(const PileYarn& yarn) const;
  Status plan_pile(YarnPlan& plan, const PileYarn& pile) const;
  Status prepare_leno();
  Status prepare_pucker(Diagnostics& diagnostics);
  Status pucker(YarnPlan& plan) const;
  [[nodiscard]] Result<double> puckered_gap() const;
  [[nodiscard]] Result<YarnPlan> plan_flat(std::size_t index) const;
  Status plan_leno(YarnPlan& plan, bool is_weft, long long yarn) const;
  [[nodiscard]] Result<Heights> heights_at(const System& warp, const System& weft, double clearance) const;
  [[nodiscard]] Result<WeaveFit> fit_systems(const System& warp, const System& weft) const;
  [[nodiscard]] Result<Heights> fit_heights(Diagnostics& diagnostics);
  [[nodiscard]] bool has_room(const Result<WeaveFit>& fit) const;
  // Neighbours of a system, side by side, overlap.
  [[nodiscard]] static bool is_over_dense(const System& warp, const System& weft);
  Status prepare_binders(Diagnostics& diagnostics);
  [[nodiscard]] Status check_binder(const Block& block) const;
  void warn_of_widths(Diagnostics& diagnostics) const;
  void warn_of_shared_gaps(Diagnostics& diagnostics) const;
  void warn(TextPlace place, std::string text, Diagnostics& diagnostics) const;
  [[nodiscard]] double straight_z(bool is_weft, int layer) const;
  [[nodiscard]] long long binder_gap(const Binder& binder, long long yarn) const {
    return binder.first + yarn * binder.every;
  }
  [[nodiscard]] Pass binder_pass(std::size_t set, long long column) const;
  void fit_binder(const Block& block, Diagnostics& diagnostics);
  [[nodiscard]] double binder_gap_to_wefts(const Block& block) const;
  [[nodiscard]] long long last_different_column(const Binder& binder) const;
  // Shifts along the weft and the warp after which binders are the same; above longest_repeat: no repeat of
  // any cell.
  static constexpr long long longest_repeat = 1'000'000;  // yarns
  [[nodiscard]] long long repeat_of_binders() const;
  [[nodiscard]] long long repeat_of_levels() const;
  [[nodiscard]] std::vector<Pass> passes_of(const Place& place) const;
  [[nodiscard]] double layer_shift(int layer) const {
    return is_stacked() ? 0.0 : (layer - 0.5 * (layers() - 1)) * layer_pitch_;
  }
  Status plan_sine(YarnPlan& plan, const std::vector<Pass>& passes, const Reach& reach, bool is_weft) const;

  const Fabric& fabric_;
  const Weave& weave_;
  bool as_published_ = false;
  System warp_, weft_;
  bool has_only_formula_ = false;  // for heights and sections, whether it has room or not
  bool has_formula_ = false;       // where it has room; else they are in equilibrium
  bool is_jammed_ = false;         // there was no room
  // One a binder line: its thread, and the clearance of its bends from the wefts.
  std::vector<WovenThread> binders_;
  std::vector<double> binder_clearances_;
  double warp_layer_ = 0;  // thickness of a layer of straight warps and what lies between them
  Reach along_x_, along_y_;
  Drawdown drawdown_;
  Heights heights_;
  std::optional<ClothInEquilibrium> equilibrium_;
  std::optional<LenoShape> leno_;
  std::optional<PuckerShape> pucker_;
  std::optional<Bend> warp_bend_, weft_bend_;  // none: sine
  bool is_thinner_ = false;                    // sections are not those of the threads
  double clearance_ = 0;                       // between yarns that cross
  double thinner_ = 0;                         // by which warps and wefts are less thick than their threads
  double layer_pitch_ = 0;
  std::vector<Block> blocks_;
  std::uint64_t data_points_ = 0;
  BuildOptions options_;
  std::vector<PileYarn> pile_yarns_;
  double pile_height_ = 0, ground_top_ = 0, ground_bottom_ = 0;
  bool seeks_remedies_ = true;
};

// The numbers of a row's yarns: those of the text, and in a cell that is periodic across them those beyond
// the cloth's edges, too, that reach into it.
std::pair<long long, long long> numbers_of(const Row& row, bool is_periodic, double low, double high);

}  // namespace selvage::fabric
