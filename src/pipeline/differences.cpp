#include "pipeline/differences.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "core/text_report.h"
#include "core/words.h"
#include "pipeline/report.h"

namespace selvage::pipeline {

using cad::Difference;

namespace {

std::string point_text(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

std::string color_text(const yarn::Color& c) {
  return fmt::format("{},{},{}", c.red, c.green, c.blue);
}

// "yarn 'warp1'", or "part #120" where there is no name.
std::string thing_text(const Difference& d) {
  if (!d.name.empty()) return fmt::format("{} {}", name_of(d.what), in_quotes(d.name));
  return fmt::format("{} {}", name_of(d.what), d.entity.empty() ? "without a name" : d.entity);
}

std::string reach_text(const cad::Reach& reach, Unit units) {
  const double low = reach.at_least, high = reach.at_most;
  if (!std::isfinite(high))
    return fmt::format("by about {:.3g} {}", std::max(reach.found, low), name_of(units));
  if (high <= 1.000001 * low) return fmt::format("by {:.6g} {}", low, name_of(units));
  if (low > 0 && high > 1.6 * low)
    return fmt::format("by {:.6g} {} or more (nowhere by more than {:.6g})", low, name_of(units), high);
  return fmt::format("by {:.6g} to {:.6g} {}", low, high, name_of(units));
}

std::string shape_text(const Difference& d, Unit units) {
  const std::string where = d.surface.empty() ? "" : fmt::format(" of its {}", d.surface);
  if (d.control_point) {
    const Difference::ControlPoint& c = *d.control_point;
    const std::string index = c.count_j == 1
                                  ? fmt::format("{} of {}", c.i, c.count_i)
                                  : fmt::format("({}, {}) of {} x {}", c.i, c.j, c.count_i, c.count_j);
    if (d.reach.at_least == 0)
      return fmt::format("its knots or weights{} {}", where, reach_text(d.reach, units));
    return fmt::format("control point {}{} at {} {}; {} of {} points differ", index, where,
                       point_text(d.reach.at), reach_text(d.reach, units), c.changed, c.points);
  }
  return fmt::format("{}{}at {} {}", d.surface, d.surface.empty() ? "" : " ", point_text(d.reach.at),
                     reach_text(d.reach, units));
}

std::string motion_text(const cad::Motion& motion, Unit units) {
  std::string text =
      fmt::format("by {}, {:.6g} {}", point_text(motion.shift), motion.shift.norm(), name_of(units));
  if (motion.angle > 0)
    text += fmt::format(", and turned by {:.6g} degrees about {}", motion.angle, point_text(motion.axis));
  return text;
}

constexpr std::array<Difference::Kind, 6> all_kinds = {
    Difference::Kind::added,    Difference::Kind::removed, Difference::Kind::moved,
    Difference::Kind::reshaped, Difference::Kind::renamed, Difference::Kind::recoloured};

std::size_t count_of(const cad::Comparison& found, Difference::Kind kind) {
  return static_cast<std::size_t>(std::ranges::count(found.differences, kind, &Difference::kind));
}

// Of many that are reshaped, about how far.
std::string spread_text(const cad::Comparison& found, Unit units) {
  constexpr std::size_t many = 3;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  std::size_t count = 0;
  for (const Difference& d : found.differences) {
    if (d.kind != Difference::Kind::reshaped) continue;
    const double by = std::max(d.reach.at_least, d.reach.found);
    low = std::min(low, by);
    high = std::max(high, by);
    ++count;
  }
  if (count < many || high == 0) return {};
  const std::string_view all = found.equal == 0 && count == found.differences.size() ? "all " : "";
  if (high <= 1.2 * low) return fmt::format(", {}by about {:.3g} {}", all, high, name_of(units));
  return fmt::format(", {}by about {:.3g} to {:.3g} {}", all, low, high, name_of(units));
}

using Counts = cad::Comparison::Counts;
constexpr std::array<std::pair<std::string_view, std::size_t Counts::*>, 4> counted_things = {
    {{"yarn", &Counts::yarns},
     {"part", &Counts::parts},
     {"surface", &Counts::surfaces},
     {"curve", &Counts::curves}}};

std::string counts_text(const Counts& counts) {
  std::string text;
  for (const auto& [noun, count] : counted_things)
    if (counts.*count > 0) text += (text.empty() ? "" : ", ") + counted(counts.*count, noun);
  return text.empty() ? "nothing" : text;
}

Json counts_json(const Counts& counts) {
  Json json;
  for (const auto& [noun, count] : counted_things) json[std::string(noun) + "s"] = counts.*count;
  return json;
}

Json difference_json(const Difference& d) {
  using enum Difference::Kind;
  const bool has_come_or_gone = d.kind == added || d.kind == removed,
             has_reach = d.kind == moved || d.kind == reshaped;
  const auto color = [&](const yarn::Color& c) {
    return if_true(d.kind == recoloured, {c.red, c.green, c.blue});
  };
  const Difference::ControlPoint c = d.control_point.value_or(Difference::ControlPoint{});
  const bool turns = d.kind == moved && d.motion.angle > 0;
  return {{"kind", name_of(d.kind)},
          {"what", name_of(d.what)},
          {"name", d.name},
          {"other_name", if_true(d.kind == renamed, d.other_name)},
          {"swapped", if_true(d.is_swapped, true)},
          {"entity", if_true(!d.entity.empty(), d.entity)},
          {"surfaces", if_true(has_come_or_gone, d.surfaces)},
          {"box", if_true(has_come_or_gone, {point_json(d.box.min()), point_json(d.box.max())})},
          {"vector", if_true(d.kind == moved, point_json(d.motion.shift))},
          {"angle", if_true(turns, d.motion.angle)},
          {"axis", if_true(turns, point_json(d.motion.axis))},
          {"at_least", if_true(has_reach, d.reach.at_least)},
          {"at_most", if_true(has_reach, if_finite(d.reach.at_most))},
          {"at", if_true(has_reach, point_json(d.reach.at))},
          {"surface", if_true(!d.surface.empty(), d.surface)},
          {"control_point", if_true(d.control_point.has_value(), {c.i, c.j})},
          {"points_changed", if_true(d.control_point.has_value(), c.changed)},
          {"points", if_true(d.control_point.has_value(), c.points)},
          {"from", color(d.before)},
          {"to", color(d.after)}};
}

}  // namespace

std::string line_of(const Difference& d, Unit units) {
  std::string text = fmt::format("{}: {}", name_of(d.kind), thing_text(d));
  switch (d.kind) {
    case Difference::Kind::added:
    case Difference::Kind::removed:
      return text + fmt::format(", {}between {} and {}",
                                d.what == cad::Thing::Kind::curve ? "" : counted(d.surfaces, "surface") + " ",
                                point_text(d.box.min()), point_text(d.box.max()));
    case Difference::Kind::moved:
      return text + " " + motion_text(d.motion, units);
    case Difference::Kind::reshaped:
      return text + ", " + shape_text(d, units);
    case Difference::Kind::renamed:
      return text + fmt::format(" to {}{}", in_quotes(d.other_name),
                                d.is_swapped ? ": the two swapped their names" : "");
    case Difference::Kind::recoloured:
      return text + fmt::format(" from {} to {}", color_text(d.before), color_text(d.after));
  }
  return text;
}

std::string summary_of(const cad::Comparison& found, double tolerance, Unit units) {
  std::string text;
  if (found.differences.empty()) {
    text = fmt::format("equal: {}", counts_text(found.a));
  } else {
    std::string kinds;
    for (const Difference::Kind kind : all_kinds)
      if (const std::size_t count = count_of(found, kind); count > 0)
        kinds += fmt::format("{}{} {}", kinds.empty() ? "" : ", ", count, name_of(kind));
    text = fmt::format("different: {}{}; the other {} equal", kinds, spread_text(found, units), found.equal);
  }
  if (found.largest > 0)
    text += fmt::format(", at most {:.6g} {} apart{}", found.largest, name_of(units),
                        found.largest_of.empty() ? "" : fmt::format(" ({})", in_quotes(found.largest_of)));
  if (found.uncertain > 0)
    text +=
        fmt::format("; of {} nothing farther than the tolerance was found, and no more than that is proven",
                    found.uncertain);
  return text + fmt::format(" (tolerance {:g} {})", tolerance, name_of(units));
}

std::string to_json(const cad::Comparison& found, const std::string& a, const std::string& b,
                    double tolerance, Unit units) {
  Json kinds = Json::object();
  for (const Difference::Kind kind : all_kinds) kinds[std::string(name_of(kind))] = count_of(found, kind);
  Json out = {{"a", a},
              {"b", b},
              {"units", name_of(units)},
              {"tolerance", tolerance},
              {"equal", found.differences.empty()},
              {"counts", {{"a", counts_json(found.a)}, {"b", counts_json(found.b)}}},
              {"same", found.equal},
              {"uncertain", found.uncertain},
              {"largest_deviation", found.largest},
              {"kinds", kinds},
              {"differences", list_json(found.differences, difference_json)},
              {"notes", found.notes}};
  drop_unknown(out);
  return text_of(out, 2) + "\n";
}

}  // namespace selvage::pipeline
