#include "fabric/knit_chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "core/wrapped.h"
#include "fabric/repeat.h"

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
    case Knit::Form::chart:
      if (Status filled = chart.fill(knit); !filled) return filled.error();
      break;
  }
  return chart;
}

Status StitchChart::fill(const Knit& knit) {
  if (knit.chart.empty() || knit.chart.front().empty())
    return error(Kind::malformed, "the chart has no rows");
  courses_ = static_cast<int>(knit.chart.size());
  wales_ = static_cast<int>(knit.chart.front().size());
  for (auto row = knit.chart.rbegin(); row != knit.chart.rend(); ++row) {
    if (row->size() != knit.chart.front().size())
      return error(Kind::malformed, "the rows of the chart are not equally long");
    if (row->find_first_not_of("KPTM") != std::string::npos)
      return error(Kind::malformed, "the chart has a sign that is none of K, P, T and M");
    for (const char sign : *row) stitches_.push_back(static_cast<Stitch>(sign));
  }
  for (int wale = 0; wale < wales_; ++wale)
    if (Status held = measure_holding(knit, wale); !held) return held;
  return {};
}

// No loop of this wale stays on its needle for longer than it can.
Status StitchChart::measure_holding(const Knit& knit, int wale) {
  int run = 0;
  const long long end = static_cast<long long>(courses_) + max_held + 1;  // runs go on into the next repeat
  for (long long course = 0; course < end; ++course) {
    run = is_loop(at(course, wale)) ? 0 : run + 1;
    longest_hold_ = std::max(longest_hold_, run);
    if (run <= max_held) continue;
    const auto row = static_cast<std::size_t>(courses_ - 1 - course % courses_);
    const bool has_line = row < knit.chart_lines.size();
    return error(Kind::geometry,
                 fmt::format("wale {} of the chart has more than {} tucks and misses one above the "
                             "other: no loop can be held over more courses",
                             wale + 1, max_held))
        .placed(has_line ? TextPlace{knit.chart_lines[row], 1} : knit.chart_place);
  }
  return {};
}

Stitch StitchChart::at(long long course, long long wale) const {
  return stitches_[static_cast<std::size_t>(wrapped<long long>(course, courses_) * wales_ +
                                            wrapped<long long>(wale, wales_))];
}

long long StitchChart::repeat_of_courses() const {
  return smallest_repeat(courses_, wales_,
                         [&](long long course, long long wale) { return at(course, wale); });
}

long long StitchChart::repeat_of_wales() const {
  return smallest_repeat(wales_, courses_,
                         [&](long long wale, long long course) { return at(course, wale); });
}

}  // namespace selvage::fabric
