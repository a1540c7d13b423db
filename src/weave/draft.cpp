#include "weave/draft.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

#include "core/wrapped.h"
#include "fabric/repeat.h"

namespace selvage::fabric {

namespace {

Status check_size(long long picks, long long ends, long long most) {
  if (picks <= most / std::max(ends, 1LL)) return {};
  return error(Kind::limit,
               fmt::format("a draft of {} x {} crossings is larger than the {} that are possible{}", picks,
                           ends, most, most < most_crossings ? " without its rows" : ""));
}

// The square or oblong repeat whose crossings `is_on_top(pick, end)` tells.
template <class Rule>
Result<Drawdown> filled(long long picks, long long ends, Rule is_on_top,
                        long long most = most_crossings_by_numbers) {
  if (Status fits = check_size(picks, ends, most); !fits) return fits.error();
  Drawdown drawdown{static_cast<int>(picks), static_cast<int>(ends), {}};
  drawdown.bits.reserve(static_cast<std::size_t>(picks * ends));
  for (long long pick = 0; pick < picks; ++pick)
    for (long long end = 0; end < ends; ++end) drawdown.bits.push_back(is_on_top(pick, end));
  return drawdown;
}

Result<Drawdown> from_rows(const std::vector<std::string>& rows) {
  if (rows.empty() || rows.front().empty()) return error(Kind::malformed, "the draft has no rows");
  const std::size_t width = rows.front().size();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() != width)
      return error(Kind::malformed, fmt::format("row {} of the draft has {} signs, the first one has {}",
                                                i + 1, rows[i].size(), width));
    if (rows[i].find_first_not_of("01") != std::string::npos)
      return error(Kind::malformed,
                   fmt::format("row {} of the draft has a sign that is neither 0 nor 1", i + 1));
  }
  return filled(
      static_cast<long long>(rows.size()), static_cast<long long>(width),
      [&](long long pick, long long end) {
        return rows[static_cast<std::size_t>(pick)][static_cast<std::size_t>(end)] == '1';
      },
      most_crossings);
}

// Which end each pick of an irregular satin has on top; empty: it is a regular one.
std::vector<long long> irregular_satin(long long n) {
  if (n == 4) return {0, 1, 3, 2};
  if (n == 6) return {0, 2, 4, 1, 5, 3};
  return {};
}

long long usual_step(long long n) {
  long long step = 2;
  while (step <= n - 2 && std::gcd(n, step) != 1) ++step;
  return step;
}

Result<Drawdown> satin(long long n, long long step, bool warp_faced) {
  const std::vector<long long> order = step == 0 ? irregular_satin(n) : std::vector<long long>();
  if (!order.empty())
    return filled(n, n, [&](long long pick, long long end) {
      return (order[static_cast<std::size_t>(pick)] == end) != warp_faced;
    });
  if (step == 0 && n < 5)
    return error(Kind::malformed, fmt::format("a satin {} does not exist: the smallest is 4", n));
  if (step == 0) step = usual_step(n);
  if (step < 2 || step > n - 2 || std::gcd(n, step) != 1)
    return error(Kind::malformed,
                 fmt::format("a satin {}/{} does not exist: the step lies between 1 and {} and has "
                             "no divisor in common with {}",
                             n, step, n - 1, n));
  return filled(n, n,
                [&](long long pick, long long end) { return ((end + step * pick) % n == 0) != warp_faced; });
}

Result<Drawdown> twill(const Draft& draft) {
  std::vector<int> runs = {draft.a, draft.b};
  runs.insert(runs.end(), draft.further.begin(), draft.further.end());
  if (runs.size() % 2 != 0)
    return error(Kind::malformed, "a twill goes over and under in turn: an even number of counts");
  long long period = 0;
  for (const int run : runs) {
    if (run < 1) return error(Kind::malformed, "the counts of a twill are 1 or more");
    period += run;
  }
  if (Status fits = check_size(period, period, most_crossings_by_numbers); !fits) return fits.error();
  std::string one_pick;
  for (std::size_t i = 0; i < runs.size(); ++i)
    one_pick.append(static_cast<std::size_t>(runs[i]), i % 2 == 0 ? '1' : '0');
  const long long move = draft.hand == Hand::z ? 1 : -1;
  return filled(period, period, [&](long long pick, long long end) {
    return one_pick[static_cast<std::size_t>(wrapped(end + move * pick, period))] == '1';
  });
}

}  // namespace

bool Drawdown::warp_on_top(long long pick, long long end) const {
  return bits[static_cast<std::size_t>(wrapped<long long>(pick, picks) * ends +
                                       wrapped<long long>(end, ends))];
}

long long Drawdown::ends_before(long long column) const {
  if (first_ends.empty()) return column;
  const int in_repeat = static_cast<int>(wrapped<long long>(column, columns()));
  return (column - in_repeat) / columns() * ends + first_end(in_repeat);
}

std::pair<long long, int> Drawdown::column_of(long long end) const {
  if (first_ends.empty()) return {end, 0};
  const int in_repeat = static_cast<int>(wrapped<long long>(end, ends));
  const auto after = std::upper_bound(first_ends.begin(), first_ends.end(), in_repeat);
  const auto column = static_cast<int>(after - first_ends.begin()) - 1;
  return {(end - in_repeat) / ends * columns() + column, in_repeat - first_end(column)};
}

long long Drawdown::repeat_of_picks() const {
  return smallest_shift(rows(), [&](long long i, long long k) {
    for (long long layer = 0; layer < layers; ++layer)
      for (long long end = 0; end < ends; ++end)
        if (warp_on_top(i * layers + layer, end) != warp_on_top(k * layers + layer, end)) return false;
    return true;
  });
}

long long Drawdown::repeat_of_ends() const {
  return smallest_shift(columns(), [&](long long i, long long k) {
    const int a = wrapped(static_cast<int>(i), columns()), b = wrapped(static_cast<int>(k), columns());
    const int count = first_end(a + 1) - first_end(a);
    if (first_end(b + 1) - first_end(b) != count) return false;
    for (long long pick = 0; pick < picks; ++pick)
      for (int end = 0; end < count; ++end)
        if (warp_on_top(pick, first_end(a) + end) != warp_on_top(pick, first_end(b) + end)) return false;
    return true;
  });
}

namespace {

std::string name_of_end(const Drawdown& drawdown, int end) {
  if (drawdown.first_ends.empty()) return fmt::format("warp {}", end + 1);
  const auto [column, layer] = drawdown.column_of(end);
  return fmt::format("warp_{}_{}", column + 1, layer + 1);
}

std::string name_of_pick(const Drawdown& drawdown, int pick) {
  if (drawdown.layers == 1) return fmt::format("weft {}", pick + 1);
  return fmt::format("layer{}_weft_{}", pick % drawdown.layers + 1, pick / drawdown.layers + 1);
}

}  // namespace

std::string what_falls_apart(const Drawdown& drawdown) {
  const auto ends = static_cast<std::size_t>(drawdown.ends), picks = static_cast<std::size_t>(drawdown.picks);
  const auto is_over = [&](std::size_t yarn, std::size_t other) {  // warps first, then wefts
    return yarn < ends ? drawdown.bits[(other - ends) * ends + yarn]
                       : !drawdown.bits[(yarn - ends) * ends + other];
  };
  const auto crossed_by = [&](std::size_t yarn) {
    return yarn < ends ? std::pair(ends, ends + picks) : std::pair(std::size_t{0}, ends);
  };
  for (std::size_t yarn = 0; yarn < ends + picks; ++yarn) {
    const auto [from, to] = crossed_by(yarn);
    std::size_t over = 0;
    for (std::size_t other = from; other < to; ++other) over += is_over(yarn, other) ? 1 : 0;
    if (over == 0 || over == to - from)
      return fmt::format("{} lies {} every {}",
                         yarn < ends ? name_of_end(drawdown, static_cast<int>(yarn))
                                     : name_of_pick(drawdown, static_cast<int>(yarn - ends)),
                         over == 0 ? "under" : "over", yarn < ends ? "weft" : "warp");
  }
  for (const bool down : {true, false}) {
    std::vector<bool> is_reached(ends + picks, false);
    std::vector<std::size_t> next = {0};
    is_reached[0] = true;
    while (!next.empty()) {
      const std::size_t yarn = next.back();
      next.pop_back();
      const auto [from, to] = crossed_by(yarn);
      for (std::size_t other = from; other < to; ++other)
        if (!is_reached[other] && is_over(yarn, other) == down) {
          is_reached[other] = true;
          next.push_back(other);
        }
    }
    if (std::find(is_reached.begin(), is_reached.end(), false) != is_reached.end())
      return "it is woven in layers";
  }
  return {};
}

Result<Drawdown> drawdown_of(const Draft& draft) {
  const long long a = draft.a;
  const long long b = draft.b;
  if (draft.form == Draft::Form::basket && (a < 1 || b < 1))
    return error(Kind::malformed,
                 fmt::format("a draft {}/{} does not exist: both numbers are 1 or more", a, b));
  switch (draft.form) {
    case Draft::Form::rows:
      return from_rows(draft.rows);
    case Draft::Form::plain:
      return filled(2, 2, [](long long pick, long long end) { return pick == end; });
    case Draft::Form::twill:
      return twill(draft);
    case Draft::Form::satin:
      return satin(a, b, draft.warp_faced);
    case Draft::Form::basket:
      return filled(a + b, a + b, [&](long long pick, long long end) { return (pick < a) == (end < a); });
    case Draft::Form::leno:  // standing ends under every pick, doup ends over it
      return filled(1, 2, [](long long, long long end) { return end == 1; });
    case Draft::Form::corduroy:  // those of its picks that are pile decide (pile.cpp)
    case Draft::Form::velveteen:
      return error(Kind::unsupported, "the draft has pile, which its picks decide");
    case Draft::Form::file:
      break;
  }
  return error(Kind::unsupported,
               fmt::format("the draft stands in the file '{}', which was not read", draft.file));
}

namespace {

std::string joined(const std::vector<int>& levels) {
  return fmt::format("{}", fmt::join(levels, " "));
}

// Of two warps of a column, the second above the first one.
Status check_order(const StackedWarp& lower, const StackedWarp& upper) {
  std::size_t below = 0, first = 0;
  for (std::size_t k = 0; k < upper.levels.size(); ++k) {
    if (upper.levels[k] >= lower.levels[k]) continue;
    if (below++ == 0) first = k;
  }
  if (below == 0) return {};
  bool can_exchange = true;
  for (std::size_t k = 0; k < upper.levels.size(); ++k)
    can_exchange = can_exchange && upper.levels[k] <= lower.levels[k];
  return error(Kind::malformed,
               fmt::format("at weft {} this warp lies below the one in front of it, at level {} and not {}: "
                           "warps of a column keep their order, from the lowest; {}",
                           first + 1, upper.levels[first], lower.levels[first],
                           can_exchange
                               ? fmt::format("write '{} , {}'", joined(upper.levels), joined(lower.levels))
                               : "give it a column, a line 'levels', of its own"))
      .placed(upper.place);
}

}  // namespace

Result<Drawdown> drawdown_of(const std::vector<WarpColumn>& columns, int layers) {
  Drawdown made;
  made.layers = layers;
  made.first_ends = {0};
  if (columns.empty() || columns.front().empty()) return error(Kind::malformed, "a column has no warp");
  const std::size_t rows = columns.front().front().levels.size();
  for (const WarpColumn& column : columns) {
    if (column.empty()) return error(Kind::malformed, "a column has no warp");
    for (std::size_t k = 0; k < column.size(); ++k) {
      const StackedWarp& warp = column[k];
      if (warp.levels.size() != rows || rows == 0)
        return error(Kind::malformed,
                     fmt::format("this warp has {} level{}, the first one of the weave has {}: all have as "
                                 "many, one for each weft of the repeat",
                                 warp.levels.size(), warp.levels.size() == 1 ? "" : "s", rows))
            .placed(warp.place);
      for (const int level : warp.levels)
        if (level < 0 || level > layers)
          return error(Kind::malformed,
                       fmt::format("level {0} is above all wefts: with {1} layer{2} of weft levels go from 0 "
                                   "to {1}; for level {0} write 'layers {0}'",
                                   level, layers, layers == 1 ? "" : "s"))
              .placed(warp.place);
      if (k > 0)
        if (Status keeps = check_order(column[k - 1], warp); !keeps) return keeps.error();
    }
    made.first_ends.push_back(made.first_ends.back() + static_cast<int>(column.size()));
  }
  made.ends = made.first_ends.back();
  const long long picks = static_cast<long long>(rows) * layers;
  if (Status fits = check_size(picks, made.ends, most_crossings); !fits)
    return fits.error().placed(columns.front().front().place);
  made.picks = static_cast<int>(picks);
  for (std::size_t row = 0; row < rows; ++row)
    for (int layer = 0; layer < layers; ++layer)
      for (const WarpColumn& column : columns)
        for (const StackedWarp& warp : column) made.bits.push_back(warp.levels[row] > layer);
  return made;
}

std::pair<std::vector<int>, std::vector<int>> changes_between(const Drawdown& drawdown) {
  const long long picks = drawdown.repeat_of_picks(), ends = drawdown.repeat_of_ends();
  std::vector<int> of_picks(static_cast<std::size_t>(picks)), of_ends(static_cast<std::size_t>(ends));
  for (long long pick = 0; pick < picks; ++pick)
    for (long long end = 0; end < ends; ++end) {
      const bool here = drawdown.warp_on_top(pick, end);
      of_picks[static_cast<std::size_t>(pick)] += here != drawdown.warp_on_top(pick + 1, end) ? 1 : 0;
      of_ends[static_cast<std::size_t>(end)] += here != drawdown.warp_on_top(pick, end + 1) ? 1 : 0;
    }
  return {of_picks, of_ends};
}

}  // namespace selvage::fabric
