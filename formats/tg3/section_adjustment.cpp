#include "formats/tg3/section_adjustment.h"

#include <algorithm>

namespace selvage::formats::tg3 {

namespace {

Vec2 shift_round(const std::vector<OutlineShift>& around, double round) {
  if (around.empty()) return Vec2::Zero();
  if (round <= around.front().t) return around.front().by;
  if (round >= around.back().t) return around.back().by;
  const auto next = std::ranges::upper_bound(around, round, {}, &OutlineShift::t), last = next - 1;
  return last->by + (round - last->t) / (next->t - last->t) * (next->by - last->by);
}

}  // namespace

bool SectionAdjustments::is_empty() const {
  return std::all_of(spans_.begin(), spans_.end(), [](const auto& span) { return span.empty(); });
}

std::vector<double> SectionAdjustments::bends_along(std::size_t span) const {
  std::vector<double> bends;
  if (span < spans_.size())
    for (const SectionAdjustment& one : spans_[span]) bends.push_back(one.t);
  return bends;
}

std::vector<double> SectionAdjustments::bends_round() const {
  std::vector<double> bends;
  for (const std::vector<SectionAdjustment>& span : spans_)
    for (const SectionAdjustment& one : span)
      for (const OutlineShift& shift : one.around)
        if (shift.t < 1) bends.push_back(shift.t);
  std::sort(bends.begin(), bends.end());
  bends.erase(std::unique(bends.begin(), bends.end()), bends.end());
  return bends;
}

SectionAdjustments::Jet SectionAdjustments::at(std::size_t span, double t, double from, double round) const {
  if (span >= spans_.size() || spans_[span].empty()) return {};
  const std::vector<SectionAdjustment>& all = spans_[span];
  constexpr double aside = 1e-9;
  const double inside = t + aside * (from - t);
  if (inside <= all.front().t) return {shift_round(all.front().around, round), Vec2::Zero()};
  if (inside >= all.back().t) return {shift_round(all.back().around, round), Vec2::Zero()};
  const auto next = std::ranges::upper_bound(all, inside, {}, &SectionAdjustment::t), last = next - 1;
  const Vec2 a = shift_round(last->around, round), b = shift_round(next->around, round);
  const double width = next->t - last->t;
  return {a + (t - last->t) / width * (b - a), (b - a) / width};
}

}  // namespace selvage::formats::tg3
