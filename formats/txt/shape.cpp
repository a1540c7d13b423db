// The rows of `path` and `grid`: the bulk of every large file, read without a step that is not needed.
#include <fmt/format.h>

#include <algorithm>

#include "formats/txt/blocks.h"
#include "nurbs/basis.h"

namespace selvage::formats::txt {

namespace {

using fabric::Grid;
using fabric::Path;
using fabric::SizeAt;

// Makes room for one more of the rows that come: all at once when there are many, so that memory is taken
// once.
template <class T>
void make_room(const Parser& p, std::vector<T>& list) {
  constexpr std::size_t many = 4096;
  if (list.size() == list.capacity() && list.size() >= many) list.reserve(list.size() + 2 + p.rows_ahead());
}

// --- path
// -----------------------------------------------------------------------------------------------------------

struct PathRows {
  Path& path;
  ShapeReading& reading;
  std::size_t seen = 0;  // rows, wrong ones included
  std::optional<Spot> knots_spot{};
};

void add_size(const Parser& p, Path& path, const std::array<double, 6>& row, int count) {
  if (count == 3 && path.sizes.empty()) return;
  if (path.sizes.empty()) {
    path.sizes.reserve(path.points.capacity());
    path.sizes.resize(path.points.size() - 1);
  }
  make_room(p, path.sizes);
  std::optional<SizeAt>& size = path.sizes.emplace_back();
  if (count == 3) return;
  size.emplace(SizeAt{row[3], row[4], std::nullopt});
  if (count == 6) size->angle = row[5];
}

void note_line(const Parser& p, Path& path, int line) {
  const std::size_t before = path.points.size() - 1;
  if (path.lines.empty()) {
    if (line == path.place.line + static_cast<int>(before) + 1) return;
    path.lines.reserve(path.points.capacity());
    for (std::size_t i = 0; i < before; ++i) path.lines.push_back(path.place.line + static_cast<int>(i) + 1);
  }
  make_room(p, path.lines);
  path.lines.push_back(line);
}

// `outline A [B SHARE] [weight W]`, behind the numbers of a row.
void read_outline_at(Parser& p, Path& path) {
  if (!p.more() || !same_word(p.peek_word(), outline_word)) {
    if (!path.outlines.empty()) path.outlines.emplace_back();
    return;
  }
  p.take_word();
  fabric::OutlineAt at;
  at.place = p.here().place();
  at.from = p.reference(p.outlines).value_or("");
  const auto is_word = [&](std::string_view word) { return same_word(p.peek_word(), word); };
  if (p.more() && !is_word("weight") && !is_word(fixed_word)) {
    at.to = p.reference(p.outlines).value_or("");
    at.share = p.number("the share of the second outline").value_or(0.0);
    if (!p.has_failed() && !(at.share >= 0.0 && at.share <= 1.0))
      p.error(p.last(), "a share lies between 0, the first outline, and 1, the second");
  }
  if (p.more() && is_word("weight")) {
    p.take_word();
    at.weight = p.positive("the weight").value_or(1.0);
  }
  path.outlines.resize(path.points.size() - 1);
  path.outlines.emplace_back(std::move(at));
}

// The word at the end of a row.
void read_fixed(Parser& p, Path& path) {
  if (!p.more()) return;
  if (!same_word(p.peek_word(), fixed_word)) {
    p.finish();
    return;
  }
  p.take_word();
  if (!p.finish()) return;
  path.fixed.resize(path.points.size() - 1, false);
  path.fixed.push_back(true);
}

void read_path_knots(Parser& p, PathRows& rows, std::string_view) {
  rows.knots_spot = p.statement();
  while (p.more())
    if (const auto knot = p.number("a knot")) rows.path.knots.push_back(*knot);
  if (p.finish() && rows.path.form != yarn::PathForm::control)
    p.error(*rows.knots_spot, "knots go with 'path control', whose rows are control points");
}

// Rows + 4, clamped, none inside so often that the line would have a corner.
void check_path_knots(Parser& p, const PathRows& rows) {
  const std::vector<double>& knots = rows.path.knots;
  const std::size_t n = rows.path.points.size();
  if (knots.size() != n + 4 || n < 4)
    return p.error(*rows.knots_spot,
                   fmt::format("{} knots: {} control points of a cubic have {}, and there are "
                               "4 points at least",
                               knots.size(), n, n + 4));
  if (knots[0] != knots[3] || knots[n] != knots[n + 3] || !(knots[3] < knots[n]))
    return p.error(*rows.knots_spot,
                   "the first four knots have to be equal, and the last four: the line ends in "
                   "its first and last row");
  for (std::size_t i = 1; i < knots.size(); ++i)
    if (knots[i] < knots[i - 1])
      return p.error(*rows.knots_spot,
                     fmt::format("knots do not decrease: {:g} after {:g}", knots[i], knots[i - 1]));
  for (std::size_t i = 4; i + 2 < n; ++i)
    if (knots[i] == knots[i + 2])
      return p.error(*rows.knots_spot,
                     fmt::format("the knot {:g} stands three times: the line would have a corner "
                                 "there",
                                 knots[i]));
}

bool is_good_row(Parser& p, const PathRows& rows, const std::array<double, 6>& row, int count) {
  const Path& path = rows.path;
  if (count < 0) return false;
  if (count != 3 && count != 5 && count != 6) {
    p.error(p.here(), fmt::format("a row of a path is x y z or x y z W H or x y z W H ANGLE; this one has {}",
                                  counted(static_cast<std::size_t>(count), "value")));
    return false;
  }
  if (count > 3 && !(row[3] > 0.0 && row[4] > 0.0)) {
    p.error(p.statement(),
            fmt::format("the section's width and height have to be larger than 0, here they are {:g} and "
                        "{:g}",
                        row[3], row[4]));
    return false;
  }
  // Control points may coincide: that only stiffens the curve there.
  const bool same = !path.points.empty() && path.points.back() == Vec3(row[0], row[1], row[2]);
  if (!same || path.form == yarn::PathForm::control) return true;
  p.error(p.statement(), "this point equals the one before it: the yarn has no direction between them");
  return false;
}

void read_path_row(Parser& p, PathRows& rows) {
  std::array<double, 6> row{};
  const int count = p.row(row.data(), 6, "a row of the path", Measure::angle, {fixed_word, outline_word});
  ++rows.seen;
  const bool good = is_good_row(p, rows, row, count);
  rows.reading.good = rows.reading.good && good;
  if (count < 3) return;
  Path& path = rows.path;
  make_room(p, path.points);
  path.points.emplace_back(row[0], row[1], row[2]);
  if (!good) return;
  rows.reading.last_row = p.statement();
  add_size(p, path, row, count);
  read_outline_at(p, path);
  read_fixed(p, path);
  note_line(p, path, rows.reading.last_row.line);
}

bool all_equal(const std::vector<Vec3>& points) {
  return std::all_of(points.begin(), points.end(),
                     [&](const Vec3& point) { return point == points.front(); });
}

// --- points in the plane
// --------------------------------------------------------------------------------------------

void read_point_row(Parser& p, PointRows& rows) {
  rows.last = p.statement();
  std::array<double, 3> xy{};
  const int count =
      p.row(xy.data(), rows.is_spline ? 3 : 2, rows.what, rows.is_spline ? Measure::plain : Measure::length);
  if (count == 0 || count == 1) p.error(p.here(), fmt::format("{} has two coordinates: x y", rows.what));
  const bool good = count == 2 || (count == 3 && xy[2] > 0.0);
  if (count == 3 && !good) p.error(p.last(), "a weight has to be larger than 0");
  rows.good = rows.good && good;
  if (!good) return;
  if (count == 3 && rows.weights.empty()) rows.weights.assign(rows.points.size(), 1.0);
  if (count == 3 || !rows.weights.empty()) rows.weights.push_back(count == 3 ? xy[2] : 1.0);
  const Vec2 point(xy[0], xy[1]);
  if (!rows.may_repeat && !rows.points.empty() && rows.points.back() == point) {
    p.error(rows.last, fmt::format("this {} equals the one before it", rows.noun));
    rows.good = false;
  }
  rows.points.push_back(point);
}

void read_point_knots(Parser& p, PointRows& rows, std::string_view) {
  while (p.more())
    if (const auto knot = p.number("a knot")) rows.knots.push_back(*knot);
  rows.good = p.finish() && rows.good;
}

// --- grid
// -----------------------------------------------------------------------------------------------------------

struct GridRows {
  Grid& grid;
  ShapeReading& reading;
  std::size_t expected = 0;       // rows; 0: the counts could not be read
  std::size_t seen = 0;           // rows, wrong ones included
  bool section_has_size = false;  // its points so far are not all the same
  bool sections_differ = false;   // not every section is the first one again
  Spot knots_along_spot{}, knots_round_spot{}, corners_spot{};
};

// The words that may stand behind the counts, or on lines of their own before the rows. Each is read up to
// the next.
using GridWord = void (*)(Parser&, GridRows&);

// along or round
std::optional<bool> direction_word(Parser& p) {
  constexpr std::array<Word<bool>, 2> words{{{"along", true}, {"round", false}}};
  return p.choice("direction of the grid", words);
}

void read_degree(Parser& p, GridRows& rows) {
  const auto degree = p.integer("the degree", 1, nurbs::max_degree);
  const auto along = direction_word(p);
  if (!along) return;
  std::optional<int>& place = *along ? rows.grid.degree_along : rows.grid.degree_round;
  if (place) p.error(p.last(), fmt::format("the degree {} is given twice", *along ? "along" : "round"));
  place = *degree;
}

void read_knots(Parser& p, GridRows& rows) {
  const Spot spot = p.last();
  const auto along = direction_word(p);
  if (!along) return;
  std::vector<double>& knots = *along ? rows.grid.knots_along : rows.grid.knots_round;
  if (!knots.empty()) p.error(spot, fmt::format("the knots {} are given twice", *along ? "along" : "round"));
  (*along ? rows.knots_along_spot : rows.knots_round_spot) = spot;
  while (p.more() && !p.next_is_letter()) {
    const auto knot = p.number("a knot");
    if (!knot) {
      p.go_on();  // all that are wrong are told
      continue;
    }
    if (!knots.empty() && *knot < knots.back())
      p.error(p.last(), fmt::format("knots do not decrease: {:g} after {:g}", *knot, knots.back()));
    knots.push_back(*knot);
  }
  if (knots.empty()) p.error(p.here(), "the knots are missing");
}

void read_open(Parser& p, GridRows& rows) {
  if (p.expect("round")) rows.grid.open_round = true;
}

void read_grid_closed(Parser&, GridRows& rows) {
  rows.grid.closed_along = true;
}

void read_corners(Parser& p, GridRows& rows) {
  rows.corners_spot = p.last();
  std::array<double, 4> corners{};
  for (double& corner : corners)
    corner = p.number("a corner of the end patches (there are four)").value_or(0.0);
  rows.grid.corners = corners;
}

void read_centre(Parser& p, GridRows& rows) {
  constexpr std::array<Word<std::size_t>, 2> ends{{{"start", 0}, {"end", 1}}};
  const Spot spot = p.last();
  const auto end = p.choice("end of the grid", ends);
  const auto centre = p.point("the centre of the end's fan");
  if (!centre) return;
  if (rows.grid.fan_centres[*end])
    p.error(spot, fmt::format("the centre at the {} is given twice", ends[*end].text));
  rows.grid.fan_centres[*end] = *centre;
}

constexpr std::array<Word<GridWord>, 6> grid_words{{{"degree", read_degree},
                                                    {"knots", read_knots},
                                                    {"open", read_open},
                                                    {"closed", read_grid_closed},
                                                    {"corners", read_corners},
                                                    {"centre", read_centre}}};

// From the word that was taken to the end of the line.
void read_grid_words(Parser& p, GridRows& rows, std::string_view word) {
  const int errors = p.report.errors();
  if (rows.seen > 0) p.error(p.statement(), fmt::format("the word '{}' has to stand before the rows", word));
  while (!word.empty() && p.report.errors() == errors && !p.has_failed()) {
    const auto known = std::find_if(grid_words.begin(), grid_words.end(),
                                    [&](const auto& candidate) { return same_word(candidate.text, word); });
    if (known != grid_words.end()) {
      known->value(p, rows);
      word = p.take_word();
    } else {
      p.error(p.last(), fmt::format("unknown word {} of the grid; known: degree, knots, open, closed, "
                                    "corners, centre",
                                    in_quotes(word)));
      break;  // by itself: an error past the twentieth is not counted
    }
  }
  if (p.report.errors() > errors) rows.reading.good = false;
}

void check_knots(Parser& p, const GridRows& rows, bool along) {
  const Grid& grid = rows.grid;
  const std::vector<double>& knots = along ? grid.knots_along : grid.knots_round;
  const Spot& spot = along ? rows.knots_along_spot : rows.knots_round_spot;
  if (knots.empty()) return;
  const auto count = static_cast<std::size_t>(along ? grid.sections : grid.per_section);
  const int standard = std::min(along ? 3 : 2, static_cast<int>(count) - 1);
  const auto degree =
      static_cast<std::size_t>((along ? grid.degree_along : grid.degree_round).value_or(standard));
  const std::string_view which = along ? "along" : "round";
  if (!along && !grid.open_round)
    return p.error(spot, "knots round go with the words 'open round': they are those of the clamped form");
  if (knots.size() != count + degree + 1)
    return p.error(spot, fmt::format("{} knots {}: {} control points of degree {} have {}", knots.size(),
                                     which, count, degree, count + degree + 1));
  if (knots[0] != knots[degree] || knots[count] != knots[count + degree])
    return p.error(
        spot,
        fmt::format("the first {0} knots {1} have to be equal, and the last {0}: the surface is clamped",
                    degree + 1, which));
  if (!(knots[degree] < knots[count])) return p.error(spot, fmt::format("all knots {} are equal", which));
  for (std::size_t i = 1; i < count; ++i)
    if (knots[i] == knots[i + degree] && knots[i] > knots.front() && knots[i] < knots.back())
      return p.error(spot, fmt::format("the knot {:g} {} stands more often than its degree {}", knots[i],
                                       which, degree));
}

// What can be judged before the first row.
void check_grid_words(Parser& p, const GridRows& rows) {
  const Grid& grid = rows.grid;
  const int degree_along = grid.degree_along.value_or(1), degree_round = grid.degree_round.value_or(1);
  const int distinct = grid.open_round ? grid.per_section - 1 : grid.per_section;
  if (distinct < 3)
    p.error(rows.reading.spot,
            "the closed form of a section has at least 4 points: 3 different ones and the first again");
  if (degree_along > grid.sections - (grid.closed_along ? 0 : 1))
    return p.error(rows.reading.spot,
                   fmt::format("degree {} along needs more than {} sections", degree_along, grid.sections));
  if (degree_round > distinct)
    return p.error(rows.reading.spot,
                   fmt::format("degree {} round needs more than {} points", degree_round, grid.per_section));
  check_knots(p, rows, true);
  check_knots(p, rows, false);
  if (grid.corners)
    for (std::size_t k = 1; k < 4; ++k)
      if (!((*grid.corners)[k - 1] < (*grid.corners)[k]))
        return p.error(rows.corners_spot,
                       "corners are four parameters round, each larger than the one before");
}

// Compares the row just added with those before it.
void check_grid_row(Parser& p, GridRows& rows) {
  const Grid& grid = rows.grid;
  const auto per_section = static_cast<std::size_t>(grid.per_section);
  const std::size_t index = grid.points.size() - 1;
  const std::size_t in_section = index % per_section;
  const Vec3& point = grid.points.back();
  const Vec3& first = grid.points[index - in_section];
  rows.section_has_size = in_section > 0 && (rows.section_has_size || point != first);
  rows.sections_differ = rows.sections_differ || point != grid.points[in_section];
  if (in_section + 1 < per_section) return;
  const std::size_t section = index / per_section + 1;
  if (!rows.section_has_size)
    p.error(p.statement(), fmt::format("section {} has no size: all its points are the same", section));
  else if (grid.open_round && (point != first || (!grid.weights.empty() &&
                                                  grid.weights.back() != grid.weights[index - in_section])))
    p.error(
        p.statement(),
        fmt::format("section {} is not closed: with 'open round' its last row is its first again", section));
}

void read_grid_row(Parser& p, GridRows& rows) {
  Grid& grid = rows.grid;
  if (++rows.seen == 1 && rows.expected > 0) {
    if (rows.reading.good) check_grid_words(p, rows);
    // A count is a promise, the size of the file is a fact: a row has 6 bytes at least.
    grid.points.reserve(std::min(rows.expected, p.bytes_left() / 6 + 1));
  }
  if (rows.expected > 0 && rows.seen > rows.expected) {
    if (rows.seen == rows.expected + 1)
      p.error(p.statement(),
              fmt::format("a row too many: the grid of {} sections of {} points, line {}, is complete",
                          grid.sections, grid.per_section, rows.reading.spot.line));
    return;
  }
  std::array<double, 4> row{};
  const int count = p.row(row.data(), 4, "a row of the grid", Measure::plain);
  if (count >= 0 && count < 3)
    p.error(p.here(), fmt::format("a row of a grid is x y z or x y z WEIGHT; this one has {}",
                                  counted(static_cast<std::size_t>(count), "value")));
  if (count == 4 && !(row[3] > 0.0)) p.error(p.last(), "a weight has to be larger than 0");
  rows.reading.good = rows.reading.good && (count == 3 || (count == 4 && row[3] > 0.0));
  if (!rows.reading.good || rows.expected == 0) return;
  grid.points.emplace_back(row[0], row[1], row[2]);
  if (count == 4 && grid.weights.empty()) {
    grid.weights.reserve(grid.points.capacity());
    grid.weights.assign(grid.points.size() - 1, 1.0);
  }
  if (count == 4 || !grid.weights.empty()) grid.weights.push_back(count == 4 ? row[3] : 1.0);
  check_grid_row(p, rows);
}

// The counts behind the word `grid`, and the words behind them.
void read_grid_line(Parser& p, GridRows& rows) {
  Grid& grid = rows.grid;
  const auto sections = p.count("the number of sections");
  if (sections && *sections < 2) p.error(p.last(), "a grid has at least 2 sections: a yarn has a length");
  const auto per_section = sections ? p.count("the number of points round a section") : std::nullopt;
  if (per_section && *per_section < 3) p.error(p.last(), "a section has at least 3 points round");
  if (!per_section) return;
  if (*sections >= 2 && *per_section >= 3) {
    grid.sections = *sections;
    grid.per_section = *per_section;
    rows.expected = static_cast<std::size_t>(*sections) * static_cast<std::size_t>(*per_section);
  }
  read_grid_words(p, rows, p.take_word());
}

}  // namespace

bool read_points(Parser& p, std::string_view kind, std::string_view name, const Spot& opened,
                 PointRows& rows) {
  static const Table<PointRows> plain({}, read_point_row);
  static const Table<PointRows> spline({{"knots", read_point_knots}}, read_point_row);
  return p.read_block(kind, name, opened, rows.is_spline ? spline : plain, rows) && rows.good;
}

fabric::Path read_path(Parser& p, ShapeReading& reading) {
  static const Table<PathRows> table({{"knots", read_path_knots}}, read_path_row);
  Path path;
  path.place = reading.spot.place();
  const auto form = p.more() ? p.choice("form of path", path_words) : yarn::PathForm::chord;
  path.form = form.value_or(yarn::PathForm::chord);
  if (path.form == yarn::PathForm::smooth)
    path.error = p.positive("how far rows may be from the centre line", Measure::length).value_or(1.0);
  p.finish();
  reading.good = true;
  PathRows rows{path, reading};
  const bool complete = p.read_block("path", "", reading.spot, table, rows);
  if (!path.fixed.empty()) path.fixed.resize(path.points.size(), false);
  if (complete && rows.seen < 2) {
    p.error(p.last(), fmt::format("a path has at least 2 rows; this one has {}", rows.seen));
    reading.good = false;
  } else if (complete && reading.good && path.form == yarn::PathForm::control && all_equal(path.points)) {
    p.error(reading.last_row, "the path has no length: all its control points are the same");
    reading.good = false;
  } else if (complete && reading.good && rows.knots_spot && path.form == yarn::PathForm::control) {
    check_path_knots(p, rows);
  }
  return path;
}

fabric::Grid read_grid(Parser& p, ShapeReading& reading) {
  static const Table<GridRows> table({{"degree", read_grid_words, Times::any},
                                      {"knots", read_grid_words, Times::any},
                                      {"open", read_grid_words},
                                      {"closed", read_grid_words},
                                      {"corners", read_grid_words},
                                      {"centre", read_grid_words, Times::any}},
                                     read_grid_row);
  Grid grid;
  grid.place = reading.spot.place();
  reading.good = true;
  GridRows rows{grid, reading};
  read_grid_line(p, rows);
  if (!p.read_block("grid", "", reading.spot, table, rows) || rows.expected == 0) return grid;
  if (rows.seen < rows.expected)
    p.error(p.last(), fmt::format("a grid of {} sections of {} points has {} rows; this one ends after {}",
                                  grid.sections, grid.per_section, rows.expected, rows.seen));
  else if (reading.good && !rows.sections_differ)
    p.error(reading.spot, "the grid has no length: all its sections are the same");
  return grid;
}

}  // namespace selvage::formats::txt
