#include "knit/chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "core/wrapped.h"
#include "fabric/repeat.h"
#include "knit/journey.h"

namespace selvage::fabric {

namespace {

constexpr int most_rib_wales = 100'000;  // more than any machine has needles

}  // namespace

Result<StitchChart> StitchChart::of(const Knit& knit) {
  StitchChart chart;
  chart.courses_ = chart.wales_ = 1;
  switch (knit.form) {
    case Knit::Form::jersey:
      chart.stitches_ = {Stitch::knit};
      break;
    case Knit::Form::purl:
      chart.courses_ = 2;
      chart.stitches_ = {Stitch::knit, Stitch::purl};
      break;
    case Knit::Form::rib:
      if (knit.rib_a < 1 || knit.rib_b < 1)
        return error(Kind::malformed, fmt::format("a rib {}x{} does not exist: both numbers are 1 or more",
                                                  knit.rib_a, knit.rib_b));
      if (std::int64_t{knit.rib_a} + knit.rib_b > most_rib_wales)
        return error(
            Kind::limit,
            fmt::format("a rib {}x{} begins anew after {} wales; it may after at most {}", knit.rib_a,
                        knit.rib_b, std::int64_t{knit.rib_a} + knit.rib_b, most_rib_wales));
      chart.wales_ = knit.rib_a + knit.rib_b;
      chart.stitches_.assign(static_cast<std::size_t>(knit.rib_a), Stitch::knit);
      chart.stitches_.resize(static_cast<std::size_t>(chart.wales_), Stitch::purl);
      break;
    case Knit::Form::interlock:
      chart.feeds_ = 2;
      chart.is_opposite_ = true;
      chart.fill({"KP", "PK"});
      break;
    case Knit::Form::full_cardigan:
      chart.fill({"KT", "TP"});
      break;
    case Knit::Form::half_cardigan:
      chart.fill({"KP", "KT"});
      break;
    case Knit::Form::milano:
      chart.fill({"KP", "KM", "MP"});
      break;
    case Knit::Form::half_milano:
      chart.fill({"KP", "KM"});
      break;
    case Knit::Form::jacquard:
      if (Status filled = chart.fill_jacquard(knit); !filled) return filled.error();
      break;
    case Knit::Form::chart:
      if (Status filled = chart.fill(knit); !filled) return filled.error();
      break;
  }
  constexpr double crowded = 1.0 / 3;
  chart.feed_step_ = 1.0 / chart.feeds_;
  if (knit.form == Knit::Form::jacquard) chart.feed_step_ = std::min(chart.feed_step_, crowded);
  if (Journeys::are_needed(knit)) {
    Result<Journeys> journeys = Journeys::of(chart, knit);
    if (!journeys) return journeys.error();
    chart.longest_hold_ = journeys->longest_hold();
    if (!chart.is_opposite_ && !journeys->knits_within_courses())
      chart.feed_step_ = std::min(chart.feed_step_, crowded);
    chart.journeys_ = std::make_shared<const Journeys>(std::move(*journeys));
    return chart;
  }
  for (int wale = 0; wale < chart.wales_; ++wale)
    for (const int bed : {1, -1})
      if (Status held = chart.measure_holding(knit, wale, bed); !held) return held.error();
  return chart;
}

void StitchChart::fill(std::vector<std::string> rows) {
  courses_ = static_cast<int>(rows.size());
  wales_ = static_cast<int>(rows.front().size());
  for (const std::string& row : rows)
    for (const char sign : row) stitches_.push_back(static_cast<Stitch>(sign));
}

Status StitchChart::fill_jacquard(const Knit& knit) {
  feeds_ = static_cast<int>(knit.threads.size());
  std::vector<std::string> rows;
  for (auto row = knit.chart.rbegin(); row != knit.chart.rend(); ++row)
    for (int feed = 0; feed < feeds_; ++feed) {
      std::string& stitches = rows.emplace_back();
      for (const char sign : *row) {
        const int number = sign - '1';
        if (number < 0 || number >= feeds_)
          return error(Kind::geometry,
                       fmt::format("the jacquard's chart asks for thread {}, and 'thread' names {}: "
                                   "name more, joined by commas",
                                   sign, feeds_))
              .placed(knit.chart_place);
        stitches += number == feed ? 'K' : 'M';
      }
      if (stitches.size() != rows.front().size())
        return error(Kind::malformed, "the rows of the chart are not equally long");
    }
  if (rows.empty() || rows.front().empty()) return error(Kind::malformed, "the chart has no rows");
  fill(std::move(rows));
  return {};
}

Status StitchChart::fill(const Knit& knit) {
  if (knit.chart.empty() || knit.chart.front().empty())
    return error(Kind::malformed, "the chart has no rows");
  feeds_ = knit.feeds.value_or(1);
  is_opposite_ = knit.gating == Knit::Gating::opposite;
  std::vector<std::string> rows;
  for (auto row = knit.chart.rbegin(); row != knit.chart.rend(); ++row) {
    if (row->size() != knit.chart.front().size())
      return error(Kind::malformed, "the rows of the chart are not equally long");
    if (row->find_first_not_of(is_opposite_ ? "KPTUM." : "KPTM.") != std::string::npos)
      return error(Kind::malformed,
                   is_opposite_ ? "the chart has a sign that is none of K, P, T, U, M and '.'"
                                : "the chart has a sign that is none of K, P, T, M and '.' (U goes with "
                                  "'gating opposite')")
          .placed(knit.chart_place);
    rows.push_back(*row);
  }
  fill(std::move(rows));
  return {};
}

// No loop of this wale stays on its needle for longer than it can.
Status StitchChart::measure_holding(const Knit& knit, int wale, int bed) {
  bool is_used = !is_opposite_ && bed > 0;  // needles of opposite beds may be empty
  for (long long course = 0; course < courses_; ++course)
    is_used = is_used || (is_opposite_ && bed_of(at(course, wale)) == bed);
  if (!is_used) return {};
  int run = 0;
  const long long most = static_cast<long long>(max_held) * feeds_;
  const long long end = courses_ + most + 1;  // runs go on into the next repeat
  for (long long course = 0; course < end; ++course) {
    run = is_loop(at(course, wale, bed)) ? 0 : run + 1;
    longest_hold_ = std::max(longest_hold_, run);
    if (run <= most) continue;
    const int rows_of_one = knit.form == Knit::Form::jacquard ? feeds_ : 1;
    const auto row = static_cast<std::size_t>((courses_ - 1 - course % courses_) / rows_of_one);
    const bool has_line = row < knit.chart_lines.size();
    return error(Kind::geometry,
                 fmt::format("wale {} of the chart has more than {} tucks and misses one above the "
                             "other: no loop can be held over more courses",
                             wale + 1, most))
        .placed(has_line ? TextPlace{knit.chart_lines[row], 1} : knit.chart_place);
  }
  return {};
}

Stitch StitchChart::at(long long course, long long wale) const {
  return stitches_[static_cast<std::size_t>(wrapped<long long>(course, courses_) * wales_ +
                                            wrapped<long long>(wale, wales_))];
}

double StitchChart::height(long long row) const {
  const long long feed = wrapped<long long>(row, feeds_);
  const long long course = (row - feed) / feeds_;
  return static_cast<double>(course) + static_cast<double>(feed) * feed_step_;
}

Stitch StitchChart::at(long long course, long long wale, int bed) const {
  const Stitch stitch = at(course, wale);
  return is_opposite_ && bed_of(stitch) != bed ? Stitch::miss : stitch;
}

long long StitchChart::repeat_of_courses() const {
  if (journeys_ != nullptr) return std::max(courses_, 2);  // never as its own copies
  return smallest_repeat(courses_, wales_,
                         [&](long long course, long long wale) { return at(course, wale); });
}

long long StitchChart::repeat_of_wales() const {
  if (journeys_ != nullptr) return std::max(wales_, 2);
  return smallest_repeat(wales_, courses_,
                         [&](long long wale, long long course) { return at(course, wale); });
}

}  // namespace selvage::fabric
