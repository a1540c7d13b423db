// Shifts of the outline of a TexGen yarn's section (CYarnSectionAdjusted): in the section's plane, linear
// between places along the yarn, and between parameters round the outline; beyond the outermost ones as
// there.
#pragma once

#include <vector>

#include "core/vec.h"

namespace selvage::formats::tg3 {

struct OutlineShift {
  double t = 0;  // of the section's outline, 0 .. 1
  Vec2 by = Vec2::Zero();
};

struct SectionAdjustment {
  double t = 0;                      // of the way from one node to the next
  std::vector<OutlineShift> around;  // by increasing t
};

class SectionAdjustments {
 public:
  // Of the next span; both lists by increasing t.
  void add_span(std::vector<SectionAdjustment> span) { spans_.push_back(std::move(span)); }
  // Is there no shift anywhere?
  [[nodiscard]] bool is_empty() const;
  // Places of a span at which the shift may have a bend along the yarn.
  [[nodiscard]] std::vector<double> bends_along(std::size_t span) const;
  // The same round the outline, of all spans; increasing, below 1.
  [[nodiscard]] std::vector<double> bends_round() const;

  struct Jet {
    Vec2 by = Vec2::Zero(), by_dt = Vec2::Zero();
  };
  // At `t` of the span, of the side of `from` where the shift bends there, and at `round` of the outline.
  [[nodiscard]] Jet at(std::size_t span, double t, double from, double round) const;

 private:
  std::vector<std::vector<SectionAdjustment>> spans_;
};

}  // namespace selvage::formats::tg3
