#include "fabric/plies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "fabric/clearance.h"
#include "fabric/disc_packing.h"
#include "fabric/spine.h"

namespace selvage::fabric {

namespace {

using std::numbers::pi;
constexpr double clearance = 0.005;  // of a part's diameter
constexpr std::size_t most_plies = 1000, most_filaments = 100'000;
constexpr double share_kept = 0.98;  // a share nearer to the packing than this needs no words

std::uint64_t ply_count(const Thread& thread, Detail detail) {
  return detail != Detail::yarn && thread.plies ? static_cast<std::uint64_t>(thread.plies->count) : 1;
}
std::uint64_t filament_count(const Thread& thread, Detail detail) {
  const int filaments = thread.filaments.value_or(1);
  const bool are_built =
      detail == Detail::filaments || (detail == Detail::usual && filaments <= max_usual_filaments);
  return are_built ? static_cast<std::uint64_t>(filaments) : 1;
}

// Radians per file unit; Z is a right-handed helix.
double turning_of(double turns_a_metre, Hand hand, Unit units) {
  return 2.0 * pi * turns_a_metre * millimetres_per(units) / 1000.0 * (hand == Hand::z ? 1.0 : -1.0);
}

bool is_round(const yarn::Section& section) {
  return std::holds_alternative<yarn::Circle>(section) || std::holds_alternative<yarn::Loop7>(section);
}

// The share of a yarn's section that its filaments are to fill; none: as much as they can.
std::optional<double> wanted_share(const Thread& thread, double area, Unit units) {
  if (thread.packing) return thread.packing;
  if (!thread.linear_density || !thread.fibre_density()) return std::nullopt;
  const double mm = millimetres_per(units);
  return std::min(thread.linear_density->tex() / (1000.0 * *thread.fibre_density() * area * mm * mm), 1.0);
}

// Discs in the section of a yarn: where they lie, and whether they are spread over it.
struct Places {
  DiscPacking packing;
  bool round = true;  // in a circle of radius `reach`
  double reach = 0;   // of the farthest one's outside
  double angle = 0;   // by which the section stands turned

  [[nodiscard]] Vec2 place(std::size_t disc, double diameter) const {
    const Vec2 p = round ? place_of(packing, disc, reach, diameter) : packing.centres[disc];
    return {std::cos(angle) * p.x() - std::sin(angle) * p.y(),
            std::sin(angle) * p.x() + std::cos(angle) * p.y()};
  }
};

Result<Places> places_in(const yarn::TubeSpec& spec, std::size_t count) {
  const yarn::SizeAtParameter& first = spec.sizes.front();
  for (const yarn::SizeAtParameter& size : spec.sizes)
    if (size.size != first.size || size.angle != first.angle)
      return error(Kind::unsupported,
                   "a yarn of plies or filaments has the same section all along: leave out the sizes at its "
                   "points, or the plies and filaments");
  Places places;
  places.angle = first.angle;
  places.round = is_round(spec.section);
  if (Status good = yarn::check_section(spec.section, first.size); !good) return good.error();
  if (places.round) {
    places.reach = 0.5 * first.size.width;
    places.packing = discs_in_circle(count);
    return places;
  }
  const std::vector<Vec2> outline = outline_polygon(spec.section);
  places.packing = discs_in_polygon(count, outline);
  if (places.packing.centres.empty())
    return error(Kind::geometry, fmt::format("no room was found for {} discs in the section", count));
  for (const Vec2& p : outline) places.reach = std::max(places.reach, p.norm());
  return places;
}

constexpr double steepest = 0.98;  // slope of the outside of a twisted yarn against its line

// `inclination`: of the outside, as a slope, of which `straight` is due to the twist alone.
Message too_much_twist(double turning, double inclination, double straight, Unit units) {
  const double most =
      std::floor(steepest / inclination * std::abs(turning) / (2.0 * pi) * 1000.0 / millimetres_per(units));
  if (straight < steepest)
    return error(
        Kind::geometry,
        fmt::format("where the path bends most, so much twist lays the outside of the yarn at 45 "
                    "degrees or more: at most {:.4g} turns per metre with this path. A straight one "
                    "has room for the twist: in a weave 'crimp 0' keeps the warp straight, 'crimp 1' "
                    "the weft",
                    most));
  return error(Kind::geometry,
               fmt::format("so much twist lays the outside of the yarn at 45 degrees or more: at most {:.4g} "
                           "turns per metre for this section and path",
                           most));
}

// The spine of a plan whose parts lie at these places. Errors: as Bundle::make.
Result<Spine> spine_of(const YarnPlan& plan, const Places& places, double turning, Unit units) {
  if (!places.round && turning != 0.0)
    return error(Kind::geometry,
                 "a twisted bundle has a round section: give the thread a circle, or its plies and filaments "
                 "no twist");
  Result<Spine> spine = make_spine(plan.line, plan.spec.guide, turning, places.reach);
  if (!spine) return spine;
  if (spine->inclination > steepest)
    return too_much_twist(turning, spine->inclination, std::abs(turning) * places.reach, units);
  return spine;
}

// The single yarn of a ply yarn, or its filament.
Thread thread_of_part(const Thread& whole, double count, double diameter, bool is_filament) {
  Thread thread = whole;
  thread.plies.reset();
  if (is_filament) {
    thread.filaments.reset();
    thread.twist.reset();
  }
  if (thread.linear_density) thread.linear_density = thread.linear_density->times(1 / count);
  thread.diameter = diameter;
  thread.section = yarn::Circle{diameter};
  return thread;
}

}  // namespace

std::uint64_t part_count(const Thread& thread, Detail detail) {
  return ply_count(thread, detail) * filament_count(thread, detail);
}

std::string part_name(const std::string& yarn, const Thread& thread, Detail detail, std::size_t part) {
  const std::uint64_t filaments = filament_count(thread, detail);
  std::string name = yarn;
  if (ply_count(thread, detail) > 1) name += fmt::format(".ply{}", part / filaments + 1);
  if (filaments > 1) name += fmt::format(".f{}", part % filaments + 1);
  return name;
}

struct Bundle::Content {
  YarnPlan parent;
  Detail detail = Detail::filaments;
  bool own_tolerance = false;
  Unit units = Unit::mm;
  std::size_t plies = 1, filaments = 1;
  std::vector<YarnPlan> singles;  // the plies, or the yarn itself
  std::vector<Spine> spines;      // of the singles, where they have filaments
  Places places;                  // of the filaments in a single
  double diameter = 0;            // of a filament
  std::vector<Message> messages;

  [[nodiscard]] YarnPlan strand(const YarnPlan& from, const Spine& spine, const Vec2& place,
                                double diameter_of_part) const {
    YarnPlan plan;
    plan.at = parent.at;
    plan.group = parent.name;
    plan.role = parent.role;
    plan.place = parent.place;
    plan.thread_name = parent.thread_name;
    plan.line = strand_of(spine, place);
    plan.spec.section = yarn::Circle{diameter_of_part};
    plan.spec.sizes = {{0.0, {diameter_of_part, diameter_of_part}, 0.0}};
    plan.spec.guide = yarn::FrameGuide::free_from(outward(spine, place));
    plan.spec.tolerance = from.spec.tolerance;
    if (own_tolerance) {
      const double own = diameter_of_part / 1000.0;
      plan.spec.tolerance = plan.spec.tolerance > 0.0 ? std::min(plan.spec.tolerance, own) : own;
    }
    return plan;
  }

  Status lay_plies();
  Status lay_filaments();
};

Status Bundle::Content::lay_plies() {
  if (plies == 1) {
    singles.push_back(parent);
    return {};
  }
  const Result<Places> at = places_in(parent.spec, plies);
  if (!at) return at.error();
  const Plies& statement = *parent.thread.plies;
  const Result<Spine> spine =
      spine_of(parent, *at, turning_of(statement.turns, statement.hand, units), units);
  if (!spine) return spine.error();
  const double size =
      (1.0 - clearance) * largest_diameter(at->packing, at->reach, spine->inclination, at->round);
  for (std::size_t i = 0; i < plies; ++i) {
    singles.push_back(strand(parent, *spine, at->place(i, size), size));
    singles.back().thread = thread_of_part(parent.thread, static_cast<double>(plies), size, false);
  }
  return {};
}

Status Bundle::Content::lay_filaments() {
  const Result<Places> at = places_in(singles.front().spec, filaments);
  if (!at) return at.error();
  places = *at;
  const std::optional<Twist>& twist = parent.thread.twist;
  const double turning = twist ? turning_of(twist->turns, twist->hand, units) : 0.0;
  double inclination = 0.0;  // one diameter for all
  for (const YarnPlan& single : singles) {
    Result<Spine> spine = spine_of(single, places, turning, units);
    if (!spine) return spine.error();
    inclination = std::max(inclination, spine->inclination);
    spines.push_back(std::move(*spine));
  }
  const yarn::SectionSize size = parent.spec.sizes.front().size;
  const double area = yarn::area(parent.spec.section, size);
  const double all = static_cast<double>(plies * filaments);
  const auto share_of = [&](double d) { return all * 0.25 * pi * d * d / area; };
  diameter = (1.0 - clearance) * largest_diameter(places.packing, places.reach, inclination, places.round);
  const std::optional<double> wanted = wanted_share(parent.thread, area, units);
  if (!wanted) return {};
  const double largest = share_of(diameter);
  if (largest < share_kept * *wanted) {
    messages.push_back(warning(
        Kind::geometry,
        fmt::format("the {} filaments of {} fill {:.3f} of its section, the largest fraction for this number "
                    "of round filaments{}; its packing is {:.3g}",
                    plies * filaments,
                    parent.thread.name.empty() ? fmt::format("yarn '{}'", parent.name)
                                               : fmt::format("each yarn of thread '{}'", parent.thread.name),
                    largest, inclination > 0.0 ? " at this twist" : "", *wanted)));
  } else {
    diameter = std::min(diameter, diameter * std::sqrt(*wanted / largest));
  }
  return {};
}

Result<Bundle> Bundle::make(YarnPlan parent, Unit units, Detail detail, bool own_tolerance) {
  auto content = std::make_unique<Content>();
  content->plies = static_cast<std::size_t>(ply_count(parent.thread, detail));
  content->filaments = static_cast<std::size_t>(filament_count(parent.thread, detail));
  if (content->plies > most_plies || content->filaments > most_filaments)
    return error(Kind::limit,
                 fmt::format("a yarn has at most {} plies of {} filaments each", most_plies, most_filaments));
  content->parent = std::move(parent);
  content->units = units;
  content->detail = detail;
  content->own_tolerance = own_tolerance;
  if (Status laid = content->lay_plies(); !laid) return laid.error();
  if (content->filaments > 1)
    if (Status laid = content->lay_filaments(); !laid) return laid.error();
  return Bundle(std::move(content));
}

Result<YarnPlan> Bundle::part(std::size_t part) const {
  const Content& c = *content_;
  const std::size_t single = part / c.filaments, filament = part % c.filaments;
  YarnPlan plan;
  if (c.filaments == 1) {
    plan = c.singles[single];
  } else {
    plan = c.strand(c.singles[single], c.spines[single], c.places.place(filament, c.diameter), c.diameter);
    plan.thread =
        thread_of_part(c.parent.thread, static_cast<double>(c.plies * c.filaments), c.diameter, true);
  }
  plan.name = part_name(c.parent.name, c.parent.thread, c.detail, part);
  if (part == 0) plan.messages = c.messages;
  return plan;
}

Bundle::Bundle(std::unique_ptr<Content> content) : content_(std::move(content)) {}
Bundle::~Bundle() = default;
Bundle::Bundle(Bundle&&) noexcept = default;
Bundle& Bundle::operator=(Bundle&&) noexcept = default;

}  // namespace selvage::fabric
