// What improve() could not do, in words.
#include <fmt/format.h>

#include <algorithm>

#include "fem/improve.h"

namespace selvage::fem {
namespace {

std::size_t how_many(const Improvement& improvement, BelowTarget::Cause cause) {
  return static_cast<std::size_t>(
      std::count_if(improvement.below.begin(), improvement.below.end(),
                    [cause](const BelowTarget& below) { return below.cause == cause; }));
}

std::string text_of(const BelowTarget& worst, std::size_t count, double target, double least_edge,
                    std::string_view unit) {
  const std::string start =
      fmt::format("{} dihedral angle below {:.3g} degrees",
                  count == 1 ? "1 tetrahedron has a" : fmt::format("{} tetrahedra have a", count), target);
  switch (worst.cause) {
    case BelowTarget::Cause::geometry:
      return fmt::format(
          "{}: they stand in wedges of the geometry, where faces meet under less than that, and "
          "no mesh of them is better; the sharpest wedge has {:.3g} degrees",
          start, worst.wedge);
    case BelowTarget::Cause::needle:
      return fmt::format(
          "{}, the smallest {:.3g}: they stand at triangles of the surface that are needles "
          "themselves, the sharpest with {:.3g} degrees; another --size may help",
          start, worst.angle, worst.wedge);
    case BelowTarget::Cause::surface:
      return fmt::format(
          "{}, the smallest {:.3g}, in gaps that are thin for the triangles beside them; edges of "
          "{:.3g} {} would do in the narrowest: choose a finer --size",
          start, worst.angle, least_edge, unit);
    case BelowTarget::Cause::inner:
      break;
  }
  return fmt::format("{}, the smallest {:.3g}; another --size may help", start, worst.angle);
}

}  // namespace

std::vector<Message> describe(const Improvement& improvement, double target, std::string_view unit) {
  using Cause = BelowTarget::Cause;
  std::vector<Message> result;
  for (const Cause cause : {Cause::geometry, Cause::needle, Cause::surface, Cause::inner}) {
    const BelowTarget* worst = nullptr;
    double least_edge = 0;
    for (const BelowTarget& below : improvement.below) {
      if (below.cause != cause) continue;
      const bool is_worse = worst == nullptr || (cause == Cause::geometry && below.wedge < worst->wedge);
      least_edge = worst == nullptr ? below.edge_needed : std::min(least_edge, below.edge_needed);
      if (is_worse) worst = &below;
    }
    if (worst == nullptr) continue;
    Message message =
        warning(Kind::geometry, text_of(*worst, how_many(improvement, cause), target, least_edge, unit));
    if (cause == Cause::geometry) message.severity = Severity::note;
    message.at = worst->at;
    result.push_back(std::move(message));
  }
  return result;
}

AngleTarget count(const Improvement& improvement, double target) {
  return {.wanted = target,
          .below = improvement.below.size(),
          .in_wedges = how_many(improvement, BelowTarget::Cause::geometry)};
}

}  // namespace selvage::fem
