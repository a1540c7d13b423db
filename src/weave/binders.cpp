#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "core/wrapped.h"
#include "weave/construction.h"

namespace selvage::fabric {

namespace {

int level_at(const Binder& binder, long long column) {
  return binder
      .levels[static_cast<std::size_t>(wrapped(column, static_cast<long long>(binder.levels.size())))];
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

// Shifts of a sequence of levels along the warp.
long long shift_of_levels(const Binder& binder) {
  return smallest_shift(static_cast<long long>(binder.levels.size()),
                        [&](long long i, long long k) { return level_at(binder, i) == level_at(binder, k); });
}

}  // namespace

Status WeaveConstruction::prepare_binders(Diagnostics& diagnostics) {
  if (!as_published_)
    for (System* system : {&warp_, &weft_}) fill(*system);
  warp_layer_ = warp_.thickest;
  for (int layer = 0; layer <= layers(); ++layer) {
    if (layer < layers()) add_block(Block::Kind::warp, layer, 0, row_of(warp_));
    add_block(Block::Kind::weft, layer, 0, row_of(weft_));
  }
  for (std::size_t set = 0; set < weave_.binders.size(); ++set) {
    const Binder& binder = weave_.binders[set];
    Result<WovenThread> woven = woven_thread(fabric_, binder.thread, binder.place);
    if (!woven) return woven.error();
    binders_.push_back(as_published_ ? std::move(*woven) : filled(std::move(*woven)));
    binder_clearances_.push_back(clearance_);
    for (int level : binder.levels) {
      if (level > 0 && level <= layers() && !as_published_)
        warp_layer_ = std::max(warp_layer_, binders_.back().size.height);
      if (level > layers() + 1)
        return error(Kind::geometry,
                     fmt::format("level {} is above all layers: {} layers of warp have {} layers of weft, "
                                 "so levels go from 0 to {}",
                                 level, layers(), layers() + 1, layers() + 1))
            .placed(binder.place);
    }
    const int gaps = warp_.text->count - 1;
    if (binder.first > gaps)
      return error(Kind::geometry,
                   fmt::format("there is no gap {}: {} warp{} {} gap{} between them", binder.first,
                               warp_.text->count, gaps == 0 ? " has" : "s have", gaps, gaps == 1 ? "" : "s"))
          .placed(binder.place);
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
    const bool has_edges = std::holds_alternative<yarn::Polygon>(binders_[block.set].section) ||
                           std::holds_alternative<yarn::Polygon>(weft_.thread(k).section);
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
      if (has_edges)
        gap = std::min({gap, refined_gap(binder, -2.0 * pitch, 2.0 * pitch, stations, weft, 0.0, pitch),
                        refined_gap(weft, -pitch, pitch, stations, binder, 0.0, 2.0 * pitch)});
    }
  }
  return gap;
}

// Wide sections tilt on the slope and come nearer than at the crossing: the bends become wider by that.
void WeaveConstruction::fit_binder(const Block& block, Diagnostics& diagnostics) {
  double& clearance = binder_clearances_[block.set];
  const double thickness = binders_[block.set].size.height + weft_.thickest;
  // The best of what was looked at, for a binder without room.
  double best = clearance_, best_gap = -std::numeric_limits<double>::infinity();
  const std::optional<double> least =
      least_clearance(clearance_, clearance_ + thickness, [&](double value) -> std::optional<double> {
        clearance = value;
        if (!check_binder(block)) return std::nullopt;
        const double gap = binder_gap_to_wefts(block);
        if (gap > best_gap) {
          best_gap = gap;
          best = value;
        }
        return gap;
      });
  clearance = least.value_or(best);
  if (least) return;
  if (best_gap <= 0.0)
    warn(weave_.binders[block.set].place,
         fmt::format(
             "the binder has no room between the wefts and overlaps them, by about {:.2g} {}: a larger "
             "pitch gives it",
             -best_gap, name_of(fabric_.units)),
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
  if (!line) return line.error().placed(binder.place);
  return {};
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

long long WeaveConstruction::repeat_of_levels() const {
  long long all = 1;
  for (const Binder& binder : weave_.binders) {
    all = std::lcm(all, shift_of_levels(binder));
    if (all > longest_repeat) break;
  }
  return all;
}

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
      if ((gap - binder.first) % binder.every == 0) binders.emplace(binder.thread, binder.levels);
    return binders;
  };
  return smallest_shift(all, [&](long long i, long long k) { return in_gap(i) == in_gap(k); });
}

}  // namespace selvage::fabric
