#include "fabric/weave.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <set>
#include <span>
#include <utility>

#include "fabric/build.h"
#include "fabric/draft.h"
#include "fabric/interlacing.h"
#include "fabric/weave_fit.h"
#include "fabric/weave_system.h"
#include "fabric/yarn_spec.h"

namespace selvage::fabric {

namespace {

Message at_line(Message message, TextPlace place) {
  if (message.place.line == 0) message.place = place;
  return message;
}

constexpr int most_layers = 100'000;
// Of a thickness, between the surfaces of yarns that cross: less makes poor tetrahedra of what lies between.
constexpr double clearance_share = 0.01;

// The yarns of one kind and layer, one after the other in the construction's order.
struct Block {
  enum class Kind { warp, weft, binder } kind = Kind::warp;
  int layer = 0;        // from 0; of wefts between straight warps one more than of these
  std::size_t set = 0;  // binder: which line
  std::size_t first = 0, count = 0;
  long long begin = 0;       // the number of its first yarn: below 0 before the cloth's edge
  std::size_t in_cloth = 0;  // of them, those that the text counts: 0, 1, ...
};

// Yarns side by side: how many the text counts, where they lie, and how wide they are.
struct Row {
  long long count = 0;
  double first = 0, step = 0;  // across the yarns
  double width = 0;
};

Vec3 along_warp(double s, double z, double y) {
  return {s, y, z};
}
Vec3 along_weft(double s, double z, double x) {
  return {x, s, z};
}

// How far yarns of one direction go: from and to, and the crossings that they pass (numbers of the other
// system).
struct Reach {
  double from = 0, to = 0;
  long long first = 0, last = 0;
};

// With a unit cell the cloth goes on beyond it by so many pitches. What is different at a spline's end falls
// by 2 + sqrt(3) from section to section: faces of the cell that are a repeat apart cut yarns that agree to
// 1e-10 of it.
constexpr long long continued_pitches = 4;

// 0 .. count x pitch; with a cell, beyond both it and the cloth.
Reach reach_over(const System& crossed, bool has_cell, double low, double high) {
  constexpr double most = 1e15;  // pitches: past what any limit lets through, and exact in both number types
  const double pitch = crossed.text->pitch;
  long long before = 0, after = 0;
  if (has_cell) {
    const auto pitches = [&](double beyond) {
      return continued_pitches + static_cast<long long>(std::clamp(std::ceil(beyond), 0.0, most));
    };
    before = pitches(-low / pitch);
    after = pitches(high / pitch - crossed.text->count);
  }
  const long long last = crossed.text->count - 1 + after;
  return {static_cast<double>(-before) * pitch, static_cast<double>(last + 1) * pitch, -before, last};
}

// The numbers of a row's yarns: those of the text, and in a cell that is periodic across them those beyond
// the cloth's edges, too, that reach into it.
std::pair<long long, long long> numbers_of(const Row& row, bool is_periodic, double low, double high) {
  if (!is_periodic) return {0, row.count};
  constexpr double most = 1e9;  // past what any limit lets through
  const auto number = [&](double place) {
    return static_cast<long long>(std::clamp(std::floor((place - row.first) / row.step), -most, most));
  };
  return {std::min(0LL, number(low - 0.5 * row.width) + 1),
          std::max(row.count, -number(2.0 * row.first - high - 0.5 * row.width))};
}

int level_at(const Binder& binder, long long column) {
  const auto n = static_cast<long long>(binder.levels.size());
  return binder.levels[static_cast<std::size_t>(((column % n) + n) % n)];
}

// The first gap up to `last` that holds binders of both lines; 0 where none does.
long long shared_gap(const Binder& a, const Binder& b, long long last) {
  const auto [rarer, other] = a.every >= b.every ? std::pair(&a, &b) : std::pair(&b, &a);
  long long gap = rarer->first;
  // After as many steps as the other line has places in its repeat, all comes again.
  for (long long step = 0; step <= other->every + other->first / rarer->every && gap <= last;
       ++step, gap += rarer->every)
    if (gap >= other->first && (gap - other->first) % other->every == 0) return gap;
  return 0;
}

class WeaveConstruction final : public Construction {
 public:
  WeaveConstruction(const Fabric& fabric, const Weave& weave, const BuildOptions& options, System warp,
                    System weft)
      : fabric_(fabric),
        weave_(weave),
        as_published_(options.as_published),
        warp_(std::move(warp)),
        weft_(std::move(weft)) {
    const bool has_cell = fabric.cell.has_value();
    // Both tubes are modelled within the tolerance.
    clearance_ = 2.0 * std::max(tolerance_of(fabric, {}), options.tolerance);
    if (!as_published_)
      clearance_ +=
          options.gap > 0.0 ? options.gap : clearance_share * std::min(warp_.thickest, weft_.thickest);
    const Cell cell = fabric.cell.value_or(Cell{});
    along_x_ = reach_over(weft_, has_cell, cell.low.x(), cell.high.x());
    along_y_ = reach_over(warp_, has_cell, cell.low.y(), cell.high.y());
  }

  // Everything that can go wrong, before any yarn is planned.
  Status prepare(Diagnostics& diagnostics);

  [[nodiscard]] std::size_t count() const override { return blocks_.back().first + blocks_.back().count; }
  [[nodiscard]] std::string name(std::size_t index) const override;
  [[nodiscard]] const Thread& thread(std::size_t index) const override;
  [[nodiscard]] std::uint64_t data_points() const override { return data_points_; }
  [[nodiscard]] std::uint64_t longest() const override { return std::max(points_of(false), points_of(true)); }
  [[nodiscard]] Result<YarnPlan> plan(std::size_t index) const override;
  [[nodiscard]] Repeat repeat() const override;

 private:
  struct Place {
    const Block* block;
    long long yarn;  // its number: from 0 in the cloth
  };
  [[nodiscard]] Place place_of(std::size_t index) const;
  // Data points of a weft, or of a yarn along the warp.
  [[nodiscard]] std::uint64_t points_of(bool is_weft) const {
    const Reach& reach = is_weft ? along_y_ : along_x_;
    const auto crossings = static_cast<std::uint64_t>(reach.last - reach.first + 3);
    return is_sine(is_weft) ? points_a_wave * crossings : crossings;
  }
  [[nodiscard]] bool is_sine(bool is_weft) const {
    return !is_straight() && !(is_weft ? weft_bend_ : warp_bend_);
  }
  [[nodiscard]] bool is_straight() const { return weave_.profile == Weave::Profile::straight; }
  [[nodiscard]] int layers() const { return weave_.layers.value_or(1); }
  void add_block(Block::Kind kind, int layer, std::size_t set, const Row& row);
  [[nodiscard]] static Row row_of(const System& system) {
    return {system.text->count, system.at(0.0), system.text->pitch, system.widest};
  }
  Status prepare_interlacing(Diagnostics& diagnostics);
  [[nodiscard]] Result<Heights> fit_heights(Diagnostics& diagnostics);
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
  [[nodiscard]] long long repeat_of_binders() const;
  [[nodiscard]] std::vector<Pass> passes_of(const Place& place) const;
  [[nodiscard]] double layer_shift(int layer) const { return (layer - 0.5 * (layers() - 1)) * layer_pitch_; }
  Status plan_sine(YarnPlan& plan, const std::vector<Pass>& passes, const Reach& reach, bool is_weft,
                   double across) const;

  const Fabric& fabric_;
  const Weave& weave_;
  bool as_published_ = false;
  System warp_, weft_;
  // One a binder line: its thread, and the clearance of its bends from the wefts.
  std::vector<WovenThread> binders_;
  std::vector<double> binder_clearances_;
  double warp_layer_ = 0;  // thickness of a layer of straight warps and what lies between them
  Reach along_x_, along_y_;
  Drawdown drawdown_;
  Heights heights_;
  std::optional<Bend> warp_bend_, weft_bend_;  // none: sine
  double clearance_ = 0;                       // between yarns that cross
  double thinner_ = 0;                         // by which warps and wefts are less thick than their threads
  double layer_pitch_ = 0;
  std::vector<Block> blocks_;
  std::uint64_t data_points_ = 0;
};

void WeaveConstruction::add_block(Block::Kind kind, int layer, std::size_t set, const Row& row) {
  const bool is_weft = kind == Block::Kind::weft;
  const Cell cell = fabric_.cell.value_or(Cell{});
  const int axis = is_weft ? 0 : 1;
  const auto [begin, end] =
      numbers_of(row, is_weft ? cell.periodic_x : cell.periodic_y, cell.low[axis], cell.high[axis]);
  const auto count = static_cast<std::size_t>(end - begin);
  Block block{kind, layer, set, 0, count, begin, static_cast<std::size_t>(row.count)};
  if (!blocks_.empty()) block.first = blocks_.back().first + blocks_.back().count;
  blocks_.push_back(block);
  const std::uint64_t each = points_of(is_weft);
  constexpr auto most = std::numeric_limits<std::uint64_t>::max();
  const bool fits = count == 0 || each <= (most - data_points_) / count;
  data_points_ = fits ? data_points_ + count * each : most;
}

// Does any yarn of the draft change sides from one crossing to the next? {warps, wefts}
std::pair<bool, bool> changes_of(const Drawdown& drawdown) {
  bool warps = false, wefts = false;
  for (int pick = 0; pick < drawdown.picks; ++pick)
    for (int end = 0; end < drawdown.ends; ++end) {
      const bool here = drawdown.warp_on_top(pick, end);
      warps = warps || here != drawdown.warp_on_top(pick + 1, end);
      wefts = wefts || here != drawdown.warp_on_top(pick, end + 1);
    }
  return {warps, wefts};
}

// Heights at which yarns pass each other at the clearance, and how much thinner they become for it.
Result<Heights> WeaveConstruction::fit_heights(Diagnostics& diagnostics) {
  // A sine has room for any height over any pitch.
  const auto [warps_change, wefts_change] = changes_of(drawdown_);
  const SystemPair pair{&warp_,
                        &weft_,
                        warp_bend_.value_or(Bend::round),
                        weft_bend_.value_or(Bend::round),
                        warps_change && warp_bend_,
                        wefts_change && weft_bend_};
  const auto heights_at = [&](double clearance) { return share_crimp(pair, weave_.crimp, clearance); };
  if (as_published_ || weave_.amplitude) {
    Result<Heights> apart = heights_at(clearance_);
    return apart.ok() ? apart : heights_at(0.0);
  }
  Result<WeaveFit> fit =
      fit_weave({&warp_, &weft_, &drawdown_, warp_bend_, weft_bend_}, clearance_, heights_at);
  if (!fit) return fit.error();
  thinner_ = fit->thinner;
  const std::string_view unit = name_of(fabric_.units);
  if (fit->gap <= 0.0)
    warn(weave_.place,
         fmt::format("yarns that cross have no room to pass each other and overlap, by about {:.2g} {}: a "
                     "larger pitch or narrower sections give it",
                     -fit->gap, unit),
         diagnostics);
  else if (thinner_ > 0.0)
    warn(weave_.place,
         fmt::format("the cloth is jammed: its yarns would touch, and are made {:.2g} {} thinner", thinner_,
                     unit),
         diagnostics);
  return fit->heights;
}

Status WeaveConstruction::prepare_interlacing(Diagnostics& diagnostics) {
  Result<Drawdown> drawdown = drawdown_of(weave_.draft);
  if (!drawdown) return at_line(drawdown.error(), weave_.draft.place);
  drawdown_ = std::move(*drawdown);
  const auto bend_over = [&](const System& crossed) -> std::optional<Bend> {
    if (!weave_.profile) return natural_bend(crossed);
    switch (*weave_.profile) {
      case Weave::Profile::lenticular:
        return Bend::lens;
      case Weave::Profile::racetrack:
        return Bend::racetrack;
      case Weave::Profile::sine:
        return std::nullopt;
      case Weave::Profile::peirce:
      case Weave::Profile::straight:
        break;
    }
    return Bend::round;
  };
  warp_bend_ = bend_over(weft_);
  weft_bend_ = bend_over(warp_);
  Result<Heights> heights = fit_heights(diagnostics);
  if (!heights) return heights.error();
  heights_ = *heights;
  double top = 0.0;
  for (const WovenThread& woven : warp_.threads)
    top = std::max(top, heights_.warp(woven.size.height) + 0.5 * woven.size.height);
  for (const WovenThread& woven : weft_.threads)
    top = std::max(top, heights_.weft(woven.size.height) + 0.5 * woven.size.height);
  if (weave_.amplitude) top = *weave_.amplitude + 0.5 * std::max(warp_.thickest, weft_.thickest);
  layer_pitch_ = 2.0 * top + clearance_;
  for (int layer = 0; layer < layers(); ++layer) {
    add_block(Block::Kind::warp, layer, 0, row_of(warp_));
    add_block(Block::Kind::weft, layer, 0, row_of(weft_));
  }
  return {};
}

Status WeaveConstruction::prepare_binders(Diagnostics& diagnostics) {
  warp_layer_ = warp_.thickest;
  for (int layer = 0; layer <= layers(); ++layer) {
    if (layer < layers()) add_block(Block::Kind::warp, layer, 0, row_of(warp_));
    add_block(Block::Kind::weft, layer, 0, row_of(weft_));
  }
  for (std::size_t set = 0; set < weave_.binders.size(); ++set) {
    const Binder& binder = weave_.binders[set];
    Result<WovenThread> woven = woven_thread(fabric_, binder.thread, binder.place);
    if (!woven) return woven.error();
    binders_.push_back(std::move(*woven));
    binder_clearances_.push_back(clearance_);
    for (int level : binder.levels) {
      if (level > 0 && level <= layers() && !as_published_)
        warp_layer_ = std::max(warp_layer_, binders_.back().size.height);
      if (level > layers() + 1)
        return at_line(
            error(Kind::geometry,
                  fmt::format("level {} is above all layers: {} layers of warp have {} layers of weft, "
                              "so levels go from 0 to {}",
                              level, layers(), layers() + 1, layers() + 1)),
            binder.place);
    }
    const int gaps = warp_.text->count - 1;
    if (binder.first > gaps)
      return at_line(
          error(Kind::geometry,
                fmt::format("there is no gap {}: {} warp{} {} gap{} between them", binder.first,
                            warp_.text->count, gaps == 0 ? " has" : "s have", gaps, gaps == 1 ? "" : "s")),
          binder.place);
    const double pitch = warp_.text->pitch;
    add_block(Block::Kind::binder, 0, set,
              {(gaps - binder.first) / binder.every + 1, binder.first * pitch, binder.every * pitch,
               binders_.back().size.width});
  }
  for (const Block& block : blocks_) {
    if (block.kind != Block::Kind::binder) continue;
    if (Status fits = check_binder(block); !fits) return fits;
    if (!as_published_) fit_binder(block, diagnostics);
  }
  return {};
}

// The last of the columns that show all that a binder meets, from along_x_.first on.
long long WeaveConstruction::last_different_column(const Binder& binder) const {
  constexpr long long most = 1'000'000;  // columns; a longer repeat shows its faults when its yarn is planned
  const auto levels = static_cast<long long>(binder.levels.size()),
             threads = static_cast<long long>(weft_.threads.size());
  const long long repeat = levels / std::gcd(levels, threads) * threads + 1;
  return std::min({along_x_.last, along_x_.first + repeat, along_x_.first + most});
}

// The least gap between a binder and the wefts that it passes.
double WeaveConstruction::binder_gap_to_wefts(const Block& block) const {
  constexpr int stations = 320;
  const double pitch = weft_.text->pitch;
  using Key = std::array<const void*, 3>;
  std::set<std::pair<std::array<double, 3>, Key>> seen;
  double gap = std::numeric_limits<double>::infinity();
  const long long last = last_different_column(weave_.binders[block.set]);
  for (long long k = along_x_.first; k <= last; ++k) {
    std::array<Pass, 3> passes;
    std::array<double, 3> heights{};
    Key threads{};
    for (std::size_t i = 0; i < 3; ++i) {
      const long long column = k + static_cast<long long>(i) - 1;
      passes[i] = binder_pass(block.set, column);
      passes[i].s = (static_cast<double>(i) - 1.0) * pitch;
      heights[i] = passes[i].z;
      threads[i] = weft_.thread(column).thread;
    }
    if (!seen.emplace(heights, threads).second) continue;
    const SweptYarn binder = swept_in_plane(PlanePath::bent(passes[0], passes[1], passes[2]), false, 0.0,
                                            binders_[block.set].section);
    const int own_level = level_at(weave_.binders[block.set], k);
    // The wefts just below and above; from the others of the column the slopes lead away.
    for (const int layer : {own_level - 1, own_level}) {
      if (layer < 0 || layer > layers()) continue;
      const Pass level{0.0, straight_z(true, layer), {}, {}};
      Pass before = level, after = level;
      before.s = -pitch;
      after.s = pitch;
      const SweptYarn weft =
          swept_in_plane(PlanePath::bent(before, level, after), true, 0.0, weft_.thread(k).section);
      gap = std::min(gap, least_gap(binder, -2.0 * pitch, 2.0 * pitch, stations, weft, 0.0, pitch));
    }
  }
  return gap;
}

// Wide sections tilt on the slope and come nearer than at the crossing: the bends become wider by that.
void WeaveConstruction::fit_binder(const Block& block, Diagnostics& diagnostics) {
  double& clearance = binder_clearances_[block.set];
  const double thickness = binders_[block.set].size.height;
  const std::optional<double> least =
      least_clearance(clearance_, clearance_ + thickness, [&](double value) -> std::optional<double> {
        clearance = value;
        if (!check_binder(block)) return std::nullopt;
        return binder_gap_to_wefts(block);
      });
  clearance = least.value_or(clearance_);
  if (least) return;
  if (const double gap = binder_gap_to_wefts(block); gap <= 0.0)
    warn(weave_.binders[block.set].place,
         fmt::format(
             "the binder has no room between the wefts and overlaps them, by about {:.2g} {}: a larger "
             "pitch gives it",
             -gap, name_of(fabric_.units)),
         diagnostics);
}

// One repeat of a binder's levels over the wefts' threads tells whether it has room everywhere.
Status WeaveConstruction::check_binder(const Block& block) const {
  const Binder& binder = weave_.binders[block.set];
  const long long last = last_different_column(binder);
  std::vector<Pass> passes;
  for (long long k = along_x_.first; k <= last; ++k) passes.push_back(binder_pass(block.set, k));
  Result<yarn::CentreLine> line =
      bridge_passes(passes, along_x_.from, weft_.at(static_cast<double>(last) + 0.5), along_warp, 0.0);
  if (!line) return at_line(line.error(), binder.place);
  return {};
}

void WeaveConstruction::warn(TextPlace place, std::string text, Diagnostics& diagnostics) const {
  Message message = warning(Kind::geometry, std::move(text));
  message.file = fabric_.file;
  message.place = place;
  diagnostics.add(std::move(message));
}

void WeaveConstruction::warn_of_widths(Diagnostics& diagnostics) const {
  for (const System* system : {&warp_, &weft_})
    if (system->widest > system->text->pitch)
      warn(system->text->place,
           fmt::format("yarns {:.6g} wide at a pitch of {:.6g} overlap their neighbours", system->widest,
                       system->text->pitch),
           diagnostics);
  for (std::size_t set = 0; set < binders_.size(); ++set)
    if (const double gap = warp_.text->pitch - warp_.widest; binders_[set].size.width > gap)
      warn(weave_.binders[set].place,
           fmt::format("a binder {:.6g} wide overlaps the warps: between them there is {:.6g}",
                       binders_[set].size.width, gap),
           diagnostics);
}

// Two binders in one gap are apart where one stays above the other all the way.
void WeaveConstruction::warn_of_shared_gaps(Diagnostics& diagnostics) const {
  const std::vector<Binder>& all = weave_.binders;
  for (std::size_t b = 1; b < all.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      const long long gap = shared_gap(all[a], all[b], warp_.text->count - 1);
      if (gap == 0) continue;
      const auto above = [&](long long column) {
        return level_at(all[b], column) - level_at(all[a], column);
      };
      const auto repeat = static_cast<long long>(std::lcm(all[a].levels.size(), all[b].levels.size()));
      const long long last = std::min(along_x_.last, along_x_.first + repeat);
      for (long long k = along_x_.first; k <= last; ++k) {
        const bool crosses = k < last && (above(k) < 0) != (above(k + 1) < 0);
        if (above(k) != 0 && !crosses) continue;
        warn(all[b].place,
             fmt::format("in gap {} lies a binder of line {}, too, and the two overlap: where two share a "
                         "gap, one has to "
                         "stay above the other at every weft",
                         gap, all[a].place.line),
             diagnostics);
        break;
      }
    }
}

Status WeaveConstruction::prepare(Diagnostics& diagnostics) {
  if (layers() > most_layers)
    return error(Kind::limit,
                 fmt::format("{} layers are more than the {} that a weave may have", layers(), most_layers));
  Status status = is_straight() ? prepare_binders(diagnostics) : prepare_interlacing(diagnostics);
  if (status.ok()) {
    warn_of_widths(diagnostics);
    warn_of_shared_gaps(diagnostics);
  }
  return status;
}

WeaveConstruction::Place WeaveConstruction::place_of(std::size_t index) const {
  const auto after = std::upper_bound(blocks_.begin(), blocks_.end(), index,
                                      [](std::size_t i, const Block& block) { return i < block.first; });
  const Block& block = *std::prev(after);
  return {&block, block.begin + static_cast<long long>(index - block.first)};
}

std::string WeaveConstruction::name(std::size_t index) const {
  const auto [block, yarn] = place_of(index);
  if (block->kind == Block::Kind::binder) {
    // Line by line, and then those beyond the cloth's edges.
    const auto in_cloth = static_cast<long long>(block->in_cloth);
    const bool is_beyond = yarn < 0 || yarn >= in_cloth;
    long long number = yarn + 1;
    if (yarn >= in_cloth)
      number = yarn - in_cloth - block->begin + 1;
    else if (yarn < 0)
      number = yarn - block->begin + 1;
    for (const Block& other : std::span(blocks_).last(binders_.size())) {
      if (is_beyond || other.first < block->first) number += static_cast<long long>(other.in_cloth);
      if (is_beyond && other.first < block->first)
        number += static_cast<long long>(other.count - other.in_cloth);
    }
    return fmt::format("binder_{}", number);
  }
  const std::string_view kind = block->kind == Block::Kind::warp ? "warp" : "weft";
  const std::string layer =
      layers() > 1 || is_straight() ? fmt::format("layer{}_", block->layer + 1) : std::string();
  return fmt::format("{}{}_{}", layer, kind, yarn + 1);
}

const Thread& WeaveConstruction::thread(std::size_t index) const {
  const auto [block, yarn] = place_of(index);
  if (block->kind == Block::Kind::binder) return *binders_[block->set].thread;
  return *(block->kind == Block::Kind::warp ? warp_ : weft_).thread(yarn).thread;
}

double WeaveConstruction::straight_z(bool is_weft, int layer) const {
  return (layer - 0.5 * layers() + (is_weft ? 0.0 : 0.5)) * (warp_layer_ + weft_.thickest + 2.0 * clearance_);
}

// Between the layers of weft a binder lies where the warps do; outside it touches the outermost weft.
Pass WeaveConstruction::binder_pass(std::size_t set, long long column) const {
  const Binder& binder = weave_.binders[set];
  const WovenThread& own = binders_[set];
  const double clearance = binder_clearances_[set];
  const int level = level_at(binder, column);
  const WovenThread& weft = weft_.thread(column);
  const Bend bend = std::holds_alternative<yarn::Lenticular>(weft.section) ? Bend::lens
                    : std::holds_alternative<yarn::Circle>(weft.section)   ? Bend::round
                                                                           : Bend::racetrack;
  const Obstacle obstacle = obstacle_of(bend, weft.size, own.size.height, clearance);
  Pass pass{weft_.at(static_cast<double>(column)), 0.0, obstacle, obstacle};
  const double outside = 0.5 * (weft.size.height + own.size.height) + clearance;
  if (level == 0)
    pass.z = straight_z(true, 0) - outside;
  else if (level == layers() + 1)
    pass.z = straight_z(true, layers()) + outside;
  else
    pass.z = straight_z(false, level - 1);
  return pass;
}

std::vector<Pass> WeaveConstruction::passes_of(const Place& place) const {
  const auto& [block, yarn] = place;
  const bool is_weft = block->kind == Block::Kind::weft;
  const Reach& reach = is_weft ? along_y_ : along_x_;
  std::vector<Pass> passes;
  for (long long k = reach.first; k <= reach.last; ++k) {
    if (block->kind == Block::Kind::binder) {
      passes.push_back(binder_pass(block->set, k));
      continue;
    }
    const System &own = is_weft ? weft_ : warp_, &crossed = is_weft ? warp_ : weft_;
    Pass pass;
    pass.s = crossed.at(static_cast<double>(k));
    if (is_straight()) {
      pass.z = straight_z(is_weft, block->layer);
    } else {
      const double thickness = own.thread(yarn).size.height;
      const bool on_top = is_weft ? !drawdown_.warp_on_top(yarn, k) : drawdown_.warp_on_top(k, yarn);
      const double height =
          weave_.amplitude.value_or(is_weft ? heights_.weft(thickness) : heights_.warp(thickness));
      pass.z = layer_shift(block->layer) + (on_top ? height : -height);
      pass.below = pass.above = obstacle_of((is_weft ? weft_bend_ : warp_bend_).value_or(Bend::round),
                                            crossed.thread(k).size, thickness, heights_.clearance);
    }
    passes.push_back(pass);
  }
  return passes;
}

// Half waves of a cosine from crossing to crossing, level over floats: a cubic through eight points a pitch.
Status WeaveConstruction::plan_sine(YarnPlan& plan, const std::vector<Pass>& passes, const Reach& reach,
                                    bool is_weft, double across) const {
  const System& crossed = is_weft ? warp_ : weft_;
  const auto place = is_weft ? along_weft : along_warp;
  constexpr int steps = points_a_wave;
  const auto add = [&](double crossing, double z) {
    plan.points.push_back(place(crossed.at(crossing), z, across));
  };
  for (int i = 0; i < steps / 2; ++i)
    add(static_cast<double>(reach.first) - 0.5 + static_cast<double>(i) / steps, passes.front().z);
  for (std::size_t k = 0; k + 1 < passes.size(); ++k) {
    const double middle = 0.5 * (passes[k].z + passes[k + 1].z), half = 0.5 * (passes[k].z - passes[k + 1].z);
    for (int i = 0; i < steps; ++i)
      add(static_cast<double>(reach.first + static_cast<long long>(k)) + static_cast<double>(i) / steps,
          middle + half * std::cos(std::numbers::pi * i / steps));
  }
  for (int i = 0; i <= steps / 2; ++i)
    add(static_cast<double>(reach.last) + static_cast<double>(i) / steps, passes.back().z);
  const Vec3 direction = is_weft ? Vec3::UnitY() : Vec3::UnitX();
  return interpolate(plan, yarn::PathForm::chord, direction, direction);
}

Result<YarnPlan> WeaveConstruction::plan(std::size_t index) const {
  const Place place = place_of(index);
  const auto& [block, yarn] = place;
  const bool is_weft = block->kind == Block::Kind::weft, is_binder = block->kind == Block::Kind::binder;
  const Role role = is_binder ? Role::binder : is_weft ? Role::weft : Role::warp;
  const TextPlace text = is_binder ? weave_.binders[block->set].place : weave_.place;
  Result<YarnPlan> plan = start_plan(fabric_, thread(index), name(index), role, text);
  if (!plan) return plan;
  for (yarn::SizeAtParameter& at : plan->spec.sizes) {
    const double share = 1.0 - (is_binder ? 0.0 : thinner_) / at.size.height;
    at.size = {share * at.size.width, share * at.size.height};
  }
  const Reach& reach = is_weft ? along_y_ : along_x_;
  const double across =
      is_binder ? static_cast<double>(binder_gap(weave_.binders[block->set], yarn)) * warp_.text->pitch
                : (is_weft ? weft_ : warp_).at(static_cast<double>(yarn));
  const std::vector<Pass> passes = passes_of(place);
  plan->spec.guide = yarn::FrameGuide::with_across(is_weft ? Vec3(-Vec3::UnitX()) : Vec3(Vec3::UnitY()));
  if (is_sine(is_weft)) {
    if (Status made = plan_sine(*plan, passes, reach, is_weft, across); !made) return made.error();
    return plan;
  }
  Result<yarn::CentreLine> line =
      bridge_passes(passes, reach.from, reach.to, is_weft ? along_weft : along_warp, across);
  if (!line) return line.error();
  plan->line = std::move(*line);
  for (const Pass& pass : passes)
    plan->points.push_back((is_weft ? along_weft : along_warp)(pass.s, pass.z, across));
  return plan;
}

// Shifts of a sequence of levels along the warp.
long long repeat_of_levels(const Binder& binder) {
  const auto count = static_cast<long long>(binder.levels.size());
  return smallest_shift(count, [&](long long shift) {
    for (long long k = 0; k < count; ++k)
      if (level_at(binder, k + shift) != level_at(binder, k)) return false;
    return true;
  });
}

constexpr long long longest_repeat = 1'000'000;  // yarns; more is no repeat of any cell

// Gaps between warps after which the same binders lie in them.
long long WeaveConstruction::repeat_of_binders() const {
  long long all = 1;
  for (const Binder& binder : weave_.binders) {
    all = std::lcm(all, static_cast<long long>(binder.every));
    if (all > longest_repeat) return all;
  }
  // What lies in a gap: threads and levels.
  const auto in_gap = [&](long long gap) {
    std::multiset<std::pair<std::string, std::vector<int>>> binders;
    for (const Binder& binder : weave_.binders)
      if (((gap - binder.first) % binder.every + binder.every) % binder.every == 0)
        binders.emplace(binder.thread, binder.levels);
    return binders;
  };
  return smallest_shift(all, [&](long long shift) {
    for (long long gap = 0; gap < all; ++gap)
      if (in_gap(gap + shift) != in_gap(gap)) return false;
    return true;
  });
}

Repeat WeaveConstruction::repeat() const {
  long long wefts = 1, warps = 1;
  if (is_straight()) {
    warps = repeat_of_binders();
    for (const Binder& binder : weave_.binders) {
      wefts = std::lcm(wefts, repeat_of_levels(binder));
      if (wefts > longest_repeat) break;
    }
  } else {
    wefts = drawdown_.repeat_of_picks();
    warps = drawdown_.repeat_of_ends();
  }
  if (wefts > longest_repeat || warps > longest_repeat) return {};
  wefts = std::lcm(wefts, weft_.repeat_of_threads());
  warps = std::lcm(warps, warp_.repeat_of_threads());
  return {static_cast<double>(wefts) * weft_.text->pitch, static_cast<double>(warps) * warp_.text->pitch,
          std::nullopt};
}

}  // namespace

Result<std::unique_ptr<Construction>> make_weave(const Fabric& fabric, const Weave& weave,
                                                 const BuildOptions& options, Diagnostics& diagnostics) {
  Result<System> warp = system_of(fabric, weave.warp);
  if (!warp) return warp.error();
  Result<System> weft = system_of(fabric, weave.weft);
  if (!weft) return weft.error();
  auto made = std::make_unique<WeaveConstruction>(fabric, weave, options, std::move(*warp), std::move(*weft));
  if (Status prepared = made->prepare(diagnostics); !prepared) return prepared.error();
  return std::unique_ptr<Construction>(std::move(made));
}

}  // namespace selvage::fabric
