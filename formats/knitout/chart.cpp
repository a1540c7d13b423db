#include "formats/knitout/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "knit/journey.h"

namespace selvage::formats::knitout {

namespace {

using fabric::Knit;
using fabric::LoopMove;

class Charter {
 public:
  Charter(const StitchGraph& graph, TextReport& report)
      : graph_(graph), report_(report), passes_(passes_of(graph)) {}
  std::optional<GraphChart> run();

 private:
  [[nodiscard]] const Loop& loop(int number) const { return graph_.loops[static_cast<std::size_t>(number)]; }
  [[nodiscard]] const Pass& pass_of(int number) const {
    return passes_.list[static_cast<std::size_t>(passes_.of_loop[static_cast<std::size_t>(number)])];
  }
  [[nodiscard]] int made_at(const Loop& one) const { return passes_.column(one.made) - first_column_; }
  [[nodiscard]] int left_at(const Loop& one) const { return passes_.column(one.left) - first_column_; }
  [[nodiscard]] int right_of(const Loop& one) const {
    return one.end == Loop::End::knitted ? left_at(one) - made_at(one) : 0;
  }
  void refuse(const Loop& at, std::string text) {
    report_.error(at.spot, std::move(text), Kind::unsupported);
  }

  void find_gating();
  bool find_size();
  void check_loops();
  void check_passings();
  void check_stacks(const fabric::StitchChart& chart);
  [[nodiscard]] char sign_of(const Loop& one) const;
  void fill();
  void order_moves();
  void order_row(const Pass& pass);
  [[nodiscard]] std::optional<bool> is_before(int a, int b) const;
  void drop_open_loops();
  void add_empty_course();

  const StitchGraph& graph_;
  TextReport& report_;
  Passes passes_;
  GraphChart made_;
  int first_column_ = 0, wales_ = 0;
  bool is_opposite_ = false;
};

// Where a needle knits while the needle opposite holds loops, each bed holds its own.
void Charter::find_gating() {
  is_opposite_ = !passes_.is_doubled && std::any_of(graph_.loops.begin(), graph_.loops.end(),
                                                    [](const Loop& one) { return one.faces_loops; });
}

bool Charter::find_size() {
  int first = passes_.column(graph_.loops.front().made), last = first;
  for (const Loop& one : graph_.loops)
    for (const Station& station : {one.made, one.left}) {
      first = std::min(first, passes_.column(station));
      last = std::max(last, passes_.column(station));
    }
  first_column_ = first;
  wales_ = last - first + 1;
  const long long rows = static_cast<long long>(passes_.courses) * passes_.feeds;
  const auto loops = static_cast<long long>(graph_.loops.size());
  const long long most = std::min(most_cells, free_cells + cells_a_loop * loops);
  if (rows * wales_ <= most) return true;
  report_.error(
      graph_.loops.front().spot,
      fmt::format("{} rows by {} wales are beyond the {} stitches that the chart of {} loops may have", rows,
                  wales_, most, loops),
      Kind::limit);
  return false;
}

void Charter::check_loops() {
  for (std::size_t i = 0; i < graph_.loops.size() && !report_.is_full(); ++i) {
    const Loop& one = graph_.loops[i];
    if (one.splits)
      refuse(one,
             "a split is not supported: the loops that it moves would hold two loops; knit, or transfer");
    if (one.end == Loop::End::knitted && is_opposite_ && one.made.bed != loop(one.next).made.bed)
      refuse(
          loop(one.next),
          fmt::format("this knits a loop of the other bed (line {}), which is not supported where needles of "
                      "both beds hold loops face to face",
                      one.spot.line));
    if (std::abs(right_of(one)) > fabric::most_moved)
      refuse(one, fmt::format("a loop that is moved by {} wales is not supported: by {} at most",
                              right_of(one), fabric::most_moved));
    if (one.is_tuck && one.through_count > 0 && !is_opposite_ &&
        loop(graph_.through(one).front()).made.bed != one.made.bed)
      refuse(one, "a tuck to a loop that was made on the other bed is not supported");
    if (i == 0) continue;
    const Loop& before = graph_.loops[i - 1];
    if (before.carriers == one.carriers && before.direction == one.direction &&
        before.made.bed != one.made.bed && passes_.column(before.made) == passes_.column(one.made))
      refuse(one,
             "needles that face each other cannot knit in one pass: 'rack 0.25' makes them stand in turn");
  }
}

void Charter::check_passings() {
  for (const auto& [pair, first_was_before] : graph_.passings) {
    const Loop &a = loop(pair.first), &b = loop(pair.second);
    if (a.end != Loop::End::knitted || b.end != Loop::End::knitted) continue;
    if (pass_of(pair.first).row == pass_of(pair.second).row) continue;
    const long long before = made_at(b) - made_at(a), after = left_at(b) - left_at(a);
    if (before * after < 0)
      refuse(b, fmt::format(
                    "this loop passes one of another course on its way (line {}), which is not supported",
                    a.spot.line));
  }
}

char Charter::sign_of(const Loop& one) const {
  const bool is_front = one.made.bed == Bed::front;
  if (!one.is_tuck || one.through_count == 0) return is_front ? 'K' : 'P';
  return is_opposite_ && !is_front ? 'U' : 'T';
}

void Charter::fill() {
  const int rows = passes_.courses * passes_.feeds;
  Knit& knit = made_.knit;
  knit.chart.assign(static_cast<std::size_t>(rows), std::string(static_cast<std::size_t>(wales_), '.'));
  knit.chart_lines.assign(static_cast<std::size_t>(rows), graph_.loops.front().spot.line);
  made_.carrier_sets.assign(static_cast<std::size_t>(rows), -1);
  for (const Pass& pass : passes_.list) {
    const auto from_top = static_cast<std::size_t>(rows - 1 - pass.row);
    std::string& signs = knit.chart[from_top];
    const int start = made_at(loop(pass.loops.front())), end = made_at(loop(pass.loops.back()));
    const int first = std::min(start, end), last = std::max(start, end);
    std::fill(signs.begin() + first, signs.begin() + last + 1, 'M');
    for (const int number : pass.loops)
      signs[static_cast<std::size_t>(made_at(loop(number)))] = sign_of(loop(number));
    knit.chart_lines[from_top] = loop(pass.loops.front()).spot.line;
    made_.carrier_sets[static_cast<std::size_t>(pass.row)] = static_cast<int>(pass.carriers);
  }
  knit.form = Knit::Form::chart;
  knit.courses = passes_.courses;
  knit.wales = wales_;
  if (passes_.feeds > 1) knit.feeds = passes_.feeds;
  if (is_opposite_) knit.gating = Knit::Gating::opposite;
  knit.place = knit.chart_place = graph_.loops.front().spot.place();
  made_.is_doubled = passes_.is_doubled;
}

// Of two loops of a row that cross on their way or meet on a needle: does `a` lie before `b`, seen from the
// face? None: they do neither, or nobody knows.
std::optional<bool> Charter::is_before(int a, int b) const {
  const Loop &first = loop(a), &second = loop(b);
  if (left_at(first) == left_at(second)) {  // on one needle
    if (first.next != second.next) return std::nullopt;
    const bool is_lower = first.place_in_stack < second.place_in_stack;
    return is_lower == (loop(first.next).made.bed == Bed::front);
  }
  const auto found = graph_.passings.find(std::minmax(a, b));
  if (found != graph_.passings.end()) return found->second == (a < b);
  if (first.made.bed != second.made.bed) return first.made.bed == Bed::front;
  return std::nullopt;
}

// Loops of a row in an order in which those before others come first; told are those that are moved, and
// those that lie behind one that is.
void Charter::order_row(const Pass& pass) {
  const std::size_t count = pass.loops.size();
  const auto at = [&](std::size_t i) {
    return pass.direction > 0 ? pass.loops[i] : pass.loops[count - 1 - i];
  };
  std::vector<std::vector<std::size_t>> behind(count);
  std::vector<int> before(count);
  constexpr int reach = 2 * fabric::most_moved;
  for (std::size_t i = 0; i < count; ++i) {
    const Loop& one = loop(at(i));
    if (one.end != Loop::End::knitted) continue;
    for (std::size_t j = i + 1; j < count && made_at(loop(at(j))) - made_at(one) <= reach; ++j) {
      const Loop& other = loop(at(j));
      if (other.end != Loop::End::knitted || left_at(other) > left_at(one)) continue;
      const std::optional<bool> first = is_before(at(i), at(j));
      if (!first && left_at(other) == left_at(one)) continue;
      if (!first) {
        refuse(other,
               fmt::format("this loop and that of line {} change places in a way that is not supported",
                           one.spot.line));
        continue;
      }
      const std::size_t a = *first ? i : j, b = *first ? j : i;
      behind[a].push_back(b);
      ++before[b];
    }
  }
  std::vector<std::size_t> ready;
  std::vector<int> left = before;
  for (std::size_t i = count; i-- > 0;)
    if (before[i] == 0) ready.push_back(i);
  std::size_t done = 0;
  while (!ready.empty()) {
    const std::size_t i = ready.back();
    ready.pop_back();
    ++done;
    const Loop& one = loop(at(i));
    if (right_of(one) != 0 || before[i] > 0) {
      LoopMove move;
      move.place = one.spot.place();
      move.row = pass.row + 1;
      move.wale = made_at(one) + 1;
      move.right = right_of(one);
      made_.knit.moves.push_back(move);
    }
    for (const std::size_t b : behind[i])
      if (--left[b] == 0) ready.push_back(b);
  }
  if (done < count)
    refuse(loop(pass.loops.front()), "loops of this course lie before each other in a circle");
}

void Charter::order_moves() {
  for (const Pass& pass : passes_.list)
    if (std::any_of(pass.loops.begin(), pass.loops.end(), [&](int i) { return right_of(loop(i)) != 0; }))
      order_row(pass);
}

// Loops that nothing is drawn through, under others of their needle.
void Charter::drop_open_loops() {
  std::array<std::vector<bool>, 2> is_knitted;
  for (std::vector<bool>& needles : is_knitted) needles.assign(static_cast<std::size_t>(wales_), false);
  const auto bed = [&](const Loop& one) { return is_opposite_ && one.made.bed == Bed::back ? 1U : 0U; };
  std::vector<const Pass*> rows;
  rows.reserve(passes_.list.size());
  for (const Pass& pass : passes_.list) rows.push_back(&pass);
  std::sort(rows.begin(), rows.end(), [](const Pass* a, const Pass* b) { return a->row > b->row; });
  for (const Pass* pass : rows) {
    for (const int number : pass->loops) {
      const Loop& one = loop(number);
      const auto wale = static_cast<std::size_t>(made_at(one));
      if (one.end == Loop::End::knitted || !is_knitted[bed(one)][wale]) continue;
      LoopMove move;
      move.place = one.spot.place();
      move.row = pass->row + 1;
      move.wale = made_at(one) + 1;
      move.is_dropped = true;
      made_.knit.moves.push_back(move);
    }
    for (const int number : pass->loops) {
      const Loop& one = loop(number);
      if (const char sign = sign_of(one); sign == 'K' || sign == 'P')
        is_knitted[bed(one)][static_cast<std::size_t>(made_at(one))] = true;
    }
  }
}

// The chart says of every loop what the graph says.
void Charter::check_stacks(const fabric::StitchChart& chart) {
  const fabric::Journeys* const journeys = chart.journeys();
  for (std::size_t i = 0; i < graph_.loops.size() && !report_.is_full(); ++i) {
    const Loop& one = graph_.loops[i];
    const int row = pass_of(static_cast<int>(i)).row;
    const int off = one.next == no_loop ? -1 : pass_of(one.next).row;
    const bool is_knitted = one.end == Loop::End::knitted;
    if (journeys == nullptr) {  // a repeating chart, in which all loops go straight up
      if (is_knitted && right_of(one) != 0) refuse(one, "this loop's transfer is not supported");
      continue;
    }
    const fabric::Journey& journey = journeys->at(row, made_at(one));
    if (journey.off != (is_knitted ? off : -1) || (is_knitted && journey.index != one.place_in_stack))
      refuse(one, "the way in which this loop lies with others on its needle is not supported");
  }
}

// A chart without '.' is taken for one that repeats, in which loops of the last course would be held on by
// the first one.
void Charter::add_empty_course() {
  const auto feeds = static_cast<std::size_t>(passes_.feeds);
  Knit& knit = made_.knit;
  knit.chart.insert(knit.chart.begin(), feeds, std::string(static_cast<std::size_t>(wales_), '.'));
  knit.chart_lines.insert(knit.chart_lines.begin(), feeds, knit.chart_lines.front());
  made_.carrier_sets.insert(made_.carrier_sets.end(), feeds, -1);
  knit.courses += 1;
}

std::optional<GraphChart> Charter::run() {
  if (graph_.loops.empty()) return std::nullopt;
  find_gating();
  if (!find_size()) return std::nullopt;
  check_loops();
  check_passings();
  if (report_.errors() > 0) return std::nullopt;
  fill();
  order_moves();
  drop_open_loops();
  if (report_.errors() > 0) return std::nullopt;
  Result<fabric::StitchChart> chart = fabric::StitchChart::of(made_.knit);
  if (!chart && !fabric::Journeys::are_needed(made_.knit)) {
    add_empty_course();
    chart = fabric::StitchChart::of(made_.knit);
  }
  if (!chart) {
    Spot spot = graph_.loops.front().spot;
    for (const Pass& pass : passes_.list)
      if (loop(pass.loops.front()).spot.line == chart.error().place.line)
        spot = loop(pass.loops.front()).spot;
    report_.error(spot, fmt::format("this is not supported: {}", chart.error().text), chart.error().kind);
    return std::nullopt;
  }
  check_stacks(*chart);
  if (report_.errors() > 0) return std::nullopt;
  return std::move(made_);
}

}  // namespace

std::optional<GraphChart> chart_of(const StitchGraph& graph, TextReport& report) {
  return Charter(graph, report).run();
}

}  // namespace selvage::formats::knitout
