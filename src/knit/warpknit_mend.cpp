#include "knit/warpknit_mend.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "yarn/path.h"

namespace selvage::fabric {

namespace {

constexpr long long most_points = 30'000;

// Courses after which all lappings begin anew; none where it is longer than any piece.
std::optional<long long> repeat_of(const std::vector<Bar>& bars) {
  long long repeat = 1;
  for (const Bar& bar : bars) {
    repeat = std::lcm(repeat, static_cast<long long>(bar.lapping.size()));
    if (repeat > most_points) return std::nullopt;
  }
  return repeat;
}

// The smallest piece that shows every repeat with all that touches it: fewer courses.
std::optional<WarpknitPiece> piece_of(const WarpknitPiece& cloth, long long repeat) {
  int held = 1;
  for (long long course = 0; course < repeat; ++course) held = std::max(held, hold_after(cloth.bars, course));
  WarpknitPiece piece = cloth;
  const long long courses = cloth.last_course - cloth.first_course, least = repeat + 2LL * (held + 2);
  if (courses > least) piece.last_course -= (courses - least) / repeat * repeat;
  const long long points = static_cast<long long>(cloth.bars.size()) * points_of_a_course;
  if (piece.last_course - piece.first_course > most_points / points) return std::nullopt;
  return piece;
}

// Two control points a row, as sums of it and its neighbours with the distances between them held.
std::vector<std::vector<Share>> loop_shares(const std::vector<Vec3>& rows) {
  std::vector<std::vector<Share>> shares;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i == 0 || i + 1 == rows.size()) {
      shares.push_back({{i, 1.0}});
      continue;
    }
    const double chord = (rows[i + 1] - rows[i - 1]).norm();
    const double before = (rows[i] - rows[i - 1]).norm() / (4.0 * chord),
                 after = (rows[i + 1] - rows[i]).norm() / (4.0 * chord);
    shares.push_back({{i - 1, before}, {i, 1.0}, {i + 1, -before}});
    shares.push_back({{i - 1, -after}, {i, 1.0}, {i + 1, after}});
  }
  return shares;
}

nurbs::Curve loop_curve(const std::vector<Vec3>& rows) {
  yarn::PathRows control;
  control.form = yarn::PathForm::control;
  control.points = yarn::loop_control_points(rows, false);
  const Result<yarn::CentreLine> line = yarn::make_centre_line(control);
  return line ? line->curve : nurbs::Curve{};
}

// Straight yarns in every course, which stay where they are, as long as all lines with their neighbours.
void add_wefts(const WarpknitPiece& piece, double gap, MendProblem& problem) {
  const Measures& m = piece.measures;
  double low = 0, high = 0;
  for (const MendLine& line : problem.lines)
    for (const Vec3& point : line.points) {
      low = std::min(low, point.x());
      high = std::max(high, point.x());
    }
  constexpr double beyond = 3;  // wales
  for (long long course = piece.first_course; course < piece.last_course; ++course) {
    const double y = static_cast<double>(course) * m.course_pitch + m.weft_y();
    MendLine line;
    line.points = {{low - beyond * m.wale_pitch, y, m.weft_z()},
                   {high + beyond * m.wale_pitch, y, m.weft_z()}};
    line.classes = {-1, -1};
    line.curve = [](const std::vector<Vec3>& ends) {
      return nurbs::Curve{3,
                          {0, 0, 0, 0, 1, 1, 1, 1},
                          {ends[0], (2 * ends[0] + ends[1]) / 3, (ends[0] + 2 * ends[1]) / 3, ends[1]},
                          {}};
    };
    line.shares = [](const std::vector<Vec3>&) { return std::vector<std::vector<Share>>(4); };
    line.repeats = false;
    line.radius = 0.5 * (m.thickest + gap);
    problem.lines.push_back(std::move(line));
  }
}

}  // namespace

Result<std::optional<LoopMending>> mend_loops(const WarpknitPiece& cloth, double gap) {
  const std::optional<long long> repeat = repeat_of(cloth.bars);
  const std::optional<WarpknitPiece> piece = repeat ? piece_of(cloth, *repeat) : std::nullopt;
  if (!piece) return std::optional<LoopMending>();
  LoopMending result{LoopMoves(cloth.bars.size(), *repeat), {}};
  MendProblem problem;
  problem.repeat = {cloth.measures.wale_pitch, 0, 0};  // all guides of a bar move alike
  std::map<std::size_t, int> classes;                  // of numbers of moves
  std::vector<std::size_t> numbers;
  for (std::size_t bar = 0; bar < piece->bars.size(); ++bar) {
    const Result<YarnPoints> points = points_of_bar(piece->bars, bar, piece->measures, result.moves,
                                                    piece->first_course, piece->last_course);
    if (!points) return points.error();
    MendLine line;
    for (const std::size_t number : points->moved_by()) {
      const auto [place, is_new] = classes.emplace(number, static_cast<int>(numbers.size()));
      if (is_new) {
        numbers.push_back(number);
        problem.freedom.emplace_back(1, 1, 1);
      }
      line.classes.push_back(place->second);
    }
    // The ends stay in their planes.
    for (const int end : {line.classes.front(), line.classes.back()})
      problem.freedom[static_cast<std::size_t>(end)] = {1, 0, 1};
    line.curve = loop_curve;
    line.shares = loop_shares;
    line.radius = 0.5 * (piece->bars[bar].thickness + gap);
    line.points = points->of_guide(0);
    problem.lines.push_back(std::move(line));
  }
  if (piece->measures.has_weft) add_wefts(*piece, gap, problem);
  result.mending = mend(problem);
  for (std::size_t c = 0; c < numbers.size(); ++c) result.moves.set(numbers[c], result.mending.moves[c]);
  return std::optional(std::move(result));
}

}  // namespace selvage::fabric
