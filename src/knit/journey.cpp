#include "knit/journey.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace selvage::fabric {

namespace {

TextPlace place_of(const Knit& knit, std::size_t row) {
  const std::size_t from_top = knit.chart.size() - 1 - row;
  return from_top < knit.chart_lines.size() ? TextPlace{knit.chart_lines[from_top], 1} : knit.chart_place;
}

bool is_made(Stitch stitch) {
  return is_loop(stitch) || is_tuck(stitch);
}

}  // namespace

bool Journeys::are_needed(const Knit& knit) {
  return !knit.moves.empty() || std::any_of(knit.chart.begin(), knit.chart.end(), [](const std::string& row) {
    return row.find('.') != std::string::npos;
  });
}

Result<Journeys> Journeys::of(const StitchChart& chart, const Knit& knit) {
  if (knit.courses * static_cast<long long>(chart.feeds()) != chart.courses() || knit.wales != chart.wales())
    return error(Kind::malformed,
                 fmt::format(
                     "a chart with '.', 'transfer' or 'drop' is the whole cloth: write 'courses {}' and "
                     "'wales {}', or leave these out of the chart",
                     chart.courses() / chart.feeds(), chart.wales()))
        .placed(knit.chart_place);
  if (knit.loop || !knit.own_loops.empty())
    return error(Kind::malformed,
                 "the length and the points of a loop go with a chart that repeats: leave out 'loop' and "
                 "'points', or '.', 'transfer' and 'drop'")
        .placed(knit.chart_place);
  Journeys journeys;
  journeys.wales_ = static_cast<std::size_t>(chart.wales());
  const std::size_t cells = journeys.wales_ * static_cast<std::size_t>(chart.courses());
  journeys.journeys_.resize(cells);
  journeys.held_.resize(cells);
  journeys.order_.assign(cells, -1);
  if (Status read = journeys.read_spans(chart, knit); !read) return read.error();
  if (Status followed = journeys.follow(chart, knit); !followed) return followed.error();
  journeys.stack(chart);
  journeys.cross(chart);
  return journeys;
}

Stitch Journeys::joined(const StitchChart& chart, long long row, long long wale) const {
  const Journey& journey = at(row, wale);
  if (journey.off >= 0) {
    const Held& first = held(journey.off, wale + journey.right);
    return journey.index > 0 ? chart.at(first.row, first.wale) : chart.at(journey.off, wale + journey.right);
  }
  for (long long below = row - 1; below >= 0; --below)
    if (const Stitch stitch = chart.at(below, wale); is_loop(stitch)) return stitch;
  return chart.at(row, wale);
}

Status Journeys::read_spans(const StitchChart& chart, const Knit& knit) {
  bool has_stitches = false;
  for (int row = 0; row < chart.courses(); ++row) {
    WaleSpan span;
    int stitches = 0;
    for (int wale = 0; wale < chart.wales(); ++wale) {
      if (chart.at(row, wale) == Stitch::none) continue;
      if (stitches++ == 0) span.first = wale;
      span.last = wale;
    }
    if (stitches != span.last - span.first + 1)
      return error(
                 Kind::malformed,
                 "'.' stands between stitches of this row: the yarn floats past there, which is M, or it is "
                 "two yarns, in two rows")
          .placed(place_of(knit, static_cast<std::size_t>(row)));
    has_stitches = has_stitches || stitches > 0;
    spans_.push_back(span);
  }
  if (!has_stitches) return error(Kind::geometry, "the chart has no stitch").placed(knit.chart_place);
  return {};
}

Status Journeys::follow(const StitchChart& chart, const Knit& knit) {
  std::vector<bool> dropped(journeys_.size());
  for (std::size_t i = 0; i < knit.moves.size(); ++i) {
    const LoopMove& move = knit.moves[i];
    const auto refuse = [&](std::string text) {
      return error(Kind::malformed, std::move(text)).placed(move.place);
    };
    if (move.row < 1 || move.row > chart.courses() || move.wale < 1 || move.wale > chart.wales())
      return refuse(fmt::format("the chart has {} rows of {} wales: there is no row {}, wale {}",
                                chart.courses(), chart.wales(), move.row, move.wale));
    const std::size_t c = cell(move.row - 1, move.wale - 1);
    if (!is_made(chart.at(move.row - 1, move.wale - 1)))
      return refuse(fmt::format("row {}, wale {} of the chart makes no loop that could be moved: it is {}",
                                move.row, move.wale,
                                static_cast<char>(chart.at(move.row - 1, move.wale - 1))));
    if (order_[c] >= 0)
      return refuse(fmt::format("the loop of row {}, wale {} is moved twice", move.row, move.wale));
    if (std::abs(move.right) > most_moved)
      return refuse(fmt::format("a loop can be moved by {} wales at most", most_moved));
    if (const int to = move.wale + move.right; to < 1 || to > chart.wales())
      return refuse(fmt::format("wale {} is beyond the {} of the chart", to, chart.wales()));
    order_[c] = static_cast<int>(i);
    journeys_[c].right = move.right;
    dropped[c] = move.is_dropped;
  }
  // The next row that knits on each needle: of the front bed, or of both; of the back bed.
  std::array<std::vector<int>, 2> next{std::vector<int>(wales_, -1), std::vector<int>(wales_, -1)};
  const auto bed = [&](Stitch stitch) { return chart.is_opposite() && bed_of(stitch) < 0 ? 1U : 0U; };
  const int most = (max_held + 1) * chart.feeds();
  for (int row = chart.courses() - 1; row >= 0; --row) {
    for (int wale = 0; wale < chart.wales(); ++wale) {
      const Stitch stitch = chart.at(row, wale);
      const std::size_t c = cell(row, wale);
      if (!is_made(stitch) || dropped[c]) continue;
      Journey& journey = journeys_[c];
      const int to = wale + journey.right;
      journey.off = next[bed(stitch)][static_cast<std::size_t>(to)];
      if (journey.off < 0) continue;
      if (journey.off - row > most)
        return error(Kind::geometry, fmt::format("the loop of row {}, wale {} of the chart is held over more "
                                                 "than {} courses: no loop can be",
                                                 row + 1, wale + 1, max_held))
            .placed(place_of(knit, static_cast<std::size_t>(row)));
      knits_within_courses_ = knits_within_courses_ || journey.off / chart.feeds() == row / chart.feeds();
      longest_hold_ = std::max(longest_hold_, journey.off - row - 1);
    }
    for (int wale = 0; wale < chart.wales(); ++wale)
      if (const Stitch stitch = chart.at(row, wale); is_loop(stitch))
        next[bed(stitch)][static_cast<std::size_t>(wale)] = row;
  }
  return {};
}

// Loops that are knitted off together lie on their needle as they came: of earlier rows first, of one row in
// the order of the moves, which is told from the face; loops that are not moved lie before those.
void Journeys::stack(const StitchChart& chart) {
  struct Laid {
    std::size_t off;
    int row, order, wale;
  };
  std::vector<Laid> items;
  for (int row = 0; row < chart.courses(); ++row)
    for (int wale = 0; wale < chart.wales(); ++wale) {
      const std::size_t c = cell(row, wale);
      const Journey& journey = journeys_[c];
      if (!is_made(chart.at(row, wale)) || journey.off < 0) continue;
      const int to = wale + journey.right;
      const bool from_back = chart.at(journey.off, to) == Stitch::purl;
      items.push_back({cell(journey.off, to), row, from_back ? -order_[c] : order_[c], wale});
    }
  std::stable_sort(items.begin(), items.end(), [](const Laid& a, const Laid& b) {
    if (a.off != b.off) return a.off < b.off;
    return a.row != b.row ? a.row < b.row : a.order < b.order;
  });
  for (std::size_t first = 0, end = 0; first < items.size(); first = end) {
    while (end < items.size() && items[end].off == items[first].off) ++end;
    for (std::size_t i = first; i < end; ++i) {
      Journey& journey = journeys_[cell(items[i].row, items[i].wale)];
      journey.index = static_cast<int>(i - first);
      journey.count = static_cast<int>(end - first);
    }
    held_[items[first].off] = {items[first].row, items[first].wale, static_cast<int>(end - first)};
  }
}

void Journeys::cross(const StitchChart& chart) {
  std::vector<int> before(journeys_.size());  // loops that it passes before, less those that it passes behind
  for (int row = 0; row < chart.courses(); ++row)
    for (int wale = 0; wale < chart.wales(); ++wale) {
      const std::size_t c = cell(row, wale);
      const int right = journeys_[c].right;
      if (right == 0) continue;
      const int last = std::min(chart.wales() - 1, wale + 2 * most_moved);
      for (int other = std::max(0, wale - 2 * most_moved); other <= last; ++other) {
        const std::size_t o = cell(row, other);
        if (o == c || !is_made(chart.at(row, other))) continue;
        const int now = other - wale, then = now + journeys_[o].right - right;
        if (now * then >= 0) continue;
        before[c] += order_[c] < order_[o] ? 1 : -1;
        if (journeys_[o].right == 0) before[o] += order_[o] < order_[c] ? 1 : -1;  // else its own turn
      }
    }
  for (std::size_t c = 0; c < before.size(); ++c) journeys_[c].lift = (before[c] > 0) - (before[c] < 0);
}

}  // namespace selvage::fabric
