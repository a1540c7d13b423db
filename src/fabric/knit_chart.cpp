#include "fabric/knit_chart.h"

#include <fmt/format.h>

namespace selvage::fabric {

namespace {

int wrapped(long long index, int period) {
  const auto rest = static_cast<int>(index % period);
  return rest < 0 ? rest + period : rest;
}

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
      chart.wales_ = knit.rib_a + knit.rib_b;
      chart.stitches_.assign(static_cast<std::size_t>(knit.rib_a), Stitch::knit);
      chart.stitches_.resize(static_cast<std::size_t>(chart.wales_), Stitch::purl);
      break;
  }
  return chart;
}

Stitch StitchChart::at(long long course, long long wale) const {
  return stitches_[static_cast<std::size_t>(wrapped(course, courses_)) * static_cast<std::size_t>(wales_) +
                   static_cast<std::size_t>(wrapped(wale, wales_))];
}

}  // namespace selvage::fabric
