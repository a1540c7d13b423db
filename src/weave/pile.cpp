// Pile of a weave: warp pile in loops (terry) or cut (velvet), and cut weft pile (corduroy, velveteen). Bound
// parts are those of the equilibrium, of a cloth whose pile floats on it. A float of two crossings or more is
// replaced: from its feet, in the middle between two crossings, the yarn rises out of the ground and turns
// upright, by angles that change as 3u^2 - 2u^3 along it, with the section that it has at its foot. Every
// yarn stays between two parallel planes, so that neighbours keep apart as they do in the ground.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/rounding.h"
#include "core/wrapped.h"
#include "fabric/clearance.h"
#include "nurbs/measure.h"
#include "nurbs/roots.h"
#include "weave/construction.h"
#include "weave/remedies.h"

namespace selvage::fabric {

namespace {

using std::numbers::pi;

constexpr int points_a_gap = 16, points_a_turn = 12, points_a_straight = 4;
constexpr std::uint64_t points_a_tuft = 2ULL * (points_a_turn + points_a_straight);
constexpr long long most_tufts = 10'000'000;
// Least radii of turns, and the usual one at a foot, by the thickness of the yarn.
constexpr double least_turn = 0.65, usual_turn = 1.0;
constexpr double narrower = 0.9;   // from one radius to the next one that is tried
constexpr double lead_step = 0.1;  // of a foot's straight beginning, by the thickness
constexpr int most_lead_steps = 30;
constexpr double flattest = pi / 9, most_overhang = 0.75 * pi;  // of the legs of a loop
constexpr double pitch_step = 1.02;
constexpr int most_pitch_steps = 70;

double smooth(double u) {
  return u * u * (3.0 - 2.0 * u);
}

// From one direction to another one, beginning at the origin; `radius` is the least on the way. `part`: of
// the whole turn, which is symmetrical about its middle.
double turn_length(double from, double to, double radius) {
  return 1.5 * radius * std::abs(to - from);
}
std::vector<Vec2> turn(double from, double to, double radius, double part = 1.0) {
  constexpr int substeps = 16;
  const double length = part * turn_length(from, to, radius);
  std::vector<Vec2> points;
  Vec2 at = Vec2::Zero();
  for (int i = 0; i < points_a_turn; ++i) {
    for (int k = 0; k < substeps; ++k) {
      const double u = part * (i + (k + 0.5) / substeps) / points_a_turn;
      const double angle = from + (to - from) * smooth(u);
      at += length / (points_a_turn * substeps) * Vec2(std::cos(angle), std::sin(angle));
    }
    points.push_back(at);
  }
  return points;
}

// The top half of a loop: from a leg of this direction to its apex.
std::vector<Vec2> half_top(double leg, double radius) {
  return turn(leg, -leg, radius, 0.5);
}

// Of turns, by the thickness, from the widest one to the least.
std::vector<double> radii_from(double widest) {
  std::vector<double> radii;
  while (widest >= least_turn) {
    radii.push_back(widest);
    widest *= narrower;
  }
  return radii;
}

void append(std::vector<Vec2>& line, const std::vector<Vec2>& more) {
  const Vec2 from = line.empty() ? Vec2::Zero() : line.back();
  for (const Vec2& point : more) line.push_back(from + point);
}

void append_straight(std::vector<Vec2>& line, double angle, double length) {
  if (length <= 0.0) return;
  std::vector<Vec2> points;
  for (int i = 1; i <= points_a_straight; ++i)
    points.push_back(length * i / points_a_straight * Vec2(std::cos(angle), std::sin(angle)));
  append(line, points);
}

}  // namespace

// A yarn's free part from its foot: x towards the middle of the float, y out of the cloth.
struct WeaveConstruction::Leg {
  struct Crossed {
    Vec2 at;
    std::vector<Vec2> section;
    [[nodiscard]] double distance(const Vec2& point) const { return signed_distance(section, point - at); }
  };
  double angle = 0;  // at the foot
  double reach = 0;  // to the middle of the float
  double thickness = 0, apex_thickness = 0;
  double clearance = 0;
  std::array<Crossed, 2> crossed;  // the yarn that binds it, and the first one of the float

  // Apart from both, nowhere over the middle of what binds it, and before the middle of the float but for the
  // last `tops` points.
  [[nodiscard]] bool has_room(const std::vector<Vec2>& line, std::ptrdiff_t tops) const {
    const double half = 0.5 * (thickness + clearance);
    for (const Crossed& yarn : crossed) {
      const double needed = std::min(0.5 * thickness + 0.9 * clearance, yarn.distance(Vec2::Zero()));
      for (const Vec2& point : line)
        if (yarn.distance(point) < needed || point.x() < crossed[0].at.x() + half) return false;
    }
    return std::all_of(line.begin(), line.end() - tops,
                       [&](const Vec2& point) { return point.x() <= reach - half; });
  }
  // A straight and a turn.
  [[nodiscard]] std::vector<Vec2> foot(double to, double radius, double lead) const {
    std::vector<Vec2> line;
    if (lead > 0.0) line.emplace_back(lead * Vec2(std::cos(angle), std::sin(angle)));
    append(line, turn(angle, to, radius));
    return line;
  }
  // The first that there is with feet of these turns and straights, from the widest one; else none.
  template <class With>
  [[nodiscard]] std::optional<std::vector<Vec2>> first_of(const With& with) const {
    for (const double radius : radii_from(usual_turn))
      for (int steps = 0; steps <= most_lead_steps; ++steps)
        if (auto line = with(radius * thickness, lead_step * steps * thickness)) return line;
    return std::nullopt;
  }

  // Upright, so high or so long in all; none: it has no room.
  [[nodiscard]] std::optional<std::vector<Vec2>> cut(std::optional<double> height, double length) const {
    return first_of([&](double radius, double lead) -> std::optional<std::vector<Vec2>> {
      std::vector<Vec2> line = foot(0.5 * pi, radius, lead);
      const double straight =
          height ? *height - line.back().y() : length - lead - turn_length(angle, 0.5 * pi, radius);
      if (straight <= 0.0 || !has_room(line, 0)) return std::nullopt;
      append_straight(line, 0.5 * pi, straight);
      return line;
    });
  }

  // To the apex of a loop, so high; none: it has no room.
  [[nodiscard]] std::optional<std::vector<Vec2>> loop(double height) const {
    return first_of([&](double radius, double lead) -> std::optional<std::vector<Vec2>> {
      if (!has_room(foot(0.5 * pi, radius, lead), 0)) return std::nullopt;
      const double left = reach - foot(0.5 * pi, radius, lead).back().x();
      const double widest = std::max(left / half_top(0.5 * pi, 1.0).back().x() / thickness, least_turn);
      for (const double of_top : radii_from(widest)) {
        const double top = of_top * thickness;
        // The straight between both turns, and by how much the apex lies beyond the middle.
        const auto straight_at = [&](double leg) {
          return (height - foot(leg, radius, lead).back().y() - half_top(leg, top).back().y()) /
                 std::sin(leg);
        };
        const auto beyond = [&](double leg) {
          return foot(leg, radius, lead).back().x() + straight_at(leg) * std::cos(leg) +
                 half_top(leg, top).back().x() - reach;
        };
        double low = std::max(angle, flattest), high = most_overhang;
        if (beyond(low) < 0.0 || beyond(high) > 0.0) continue;
        nurbs::halve_between(low, high, 50, [&](double leg) { return beyond(leg) > 0.0; });
        const double straight = straight_at(low);
        std::vector<Vec2> line = foot(low, radius, lead);
        append_straight(line, low, straight);
        append(line, half_top(low, top));
        if (straight >= 0.0 && has_room(line, points_a_turn)) return line;
      }
      return std::nullopt;
    });
  }
};

bool WeaveConstruction::is_pile(bool is_weft, long long yarn) const {
  if (weave_.pile) return !is_weft && wrapped<long long>(yarn, 2) == 1;
  return weave_.draft.has_pile() && is_weft && weft_.thread(yarn).thread != weft_.thread(0).thread;
}

bool WeaveConstruction::pile_is_up(long long yarn) const {
  if (!weave_.pile) return true;
  const WarpPile::Side side = weave_.pile->side;
  return side == WarpPile::Side::face || (side == WarpPile::Side::both && wrapped<long long>(yarn, 4) == 1);
}

bool WeaveConstruction::is_bound(long long yarn, long long crossing) const {
  const bool is_up =
      weave_.pile ? drawdown_.warp_on_top(crossing, yarn) : !drawdown_.warp_on_top(yarn, crossing);
  return is_up != pile_is_up(yarn);
}

// The last crossing of the bound part that begins there; none: none does.
std::optional<long long> WeaveConstruction::bound_from(long long yarn, long long crossing) const {
  const auto bound = [&](long long k) { return is_bound(yarn, k); };
  if (!bound(crossing) || bound(crossing - 1) || bound(crossing - 2)) return std::nullopt;
  long long last = crossing;
  while (bound(last + 1) || bound(last + 2)) last += bound(last + 2) ? 2 : 1;
  return last;
}

System WeaveConstruction::with_pile_ends(const System& ground, const WovenThread& pile) {
  auto text = std::make_shared<WeaveSystem>(*ground.text);
  text->count *= 2;
  text->pitch *= 0.5;
  text->ends_of_one = 2;
  System both = ground;
  both.threads.clear();
  for (const WovenThread& thread : ground.threads) {
    both.threads.push_back(thread);
    both.threads.push_back(pile);
  }
  both.thickest = std::max(ground.thickest, pile.size.height);
  both.widest = std::max(ground.widest, pile.size.width);
  both.text = text.get();
  both.own_text = std::move(text);
  space_evenly(both);
  return both;
}

// The ground's draft with the pile's bindings. Terry: bound by picks 1, 3, ... of each group, free over the
// two last of them at least.
Result<Drawdown> WeaveConstruction::pile_drawdown() const {
  Drawdown made;
  if (weave_.pile) {
    Result<Drawdown> ground = drawdown_of(weave_.draft);
    if (!ground) return ground;
    const int group = weave_.pile->picks;
    if (product_of(std::lcm<std::uint64_t>(static_cast<std::uint64_t>(ground->picks),
                                           static_cast<std::uint64_t>(group)),
                   4ULL * static_cast<std::uint64_t>(ground->ends)) > most_crossings_by_numbers)
      return error(Kind::limit, "the repeat of draft and pile has more crossings than a draft may have");
    made.picks = std::lcm(ground->picks, group);
    made.ends = 2 * std::lcm(ground->ends, 2);
    for (int pick = 0; pick < made.picks; ++pick)
      for (int end = 0; end < made.ends; ++end) {
        const int of_group = pick % group;
        const bool is_free = of_group % 2 != 0 || of_group > group - 3;
        made.bits.push_back(end % 2 == 0 ? ground->warp_on_top(pick, end / 2) : is_free == pile_is_up(end));
      }
    return made;
  }
  made.ends = weave_.draft.a;
  const bool is_corduroy = weave_.draft.form == Draft::Form::corduroy;
  const int kinds = is_corduroy ? 2 : made.ends / 2;
  const auto listed = static_cast<std::uint64_t>(weft_.threads.size());
  const std::uint64_t picks = product_of(listed, static_cast<std::uint64_t>(std::lcm(2, kinds)));
  if (product_of(picks, static_cast<std::uint64_t>(made.ends)) > most_crossings_by_numbers)
    return error(Kind::limit, "the repeat of draft and picks has more crossings than a draft may have");
  made.picks = static_cast<int>(picks);
  int grounds = 0, piles = 0;
  for (int pick = 0; pick < made.picks; ++pick) {
    const bool is_of_pile = is_pile(true, pick);
    const int of_kind = (is_of_pile ? piles : grounds)++;
    const int binding = is_corduroy ? made.ends / 2 - of_kind % 2 : 2 * (of_kind % kinds);
    for (int end = 0; end < made.ends; ++end)
      made.bits.push_back(is_of_pile ? end == binding : (of_kind + end) % 2 == 0);
  }
  return made;
}

std::array<long long, 2> WeaveConstruction::pile_repeat() const {
  return {std::lcm(drawdown_.repeat_of_ends(), std::lcm(warp_.repeat_of_threads(), weave_.pile ? 2LL : 1LL)),
          std::lcm(drawdown_.repeat_of_picks(), weft_.repeat_of_threads())};
}

// A bound part between its feet, with a leg at each of them; x along the yarn from the first crossing of the
// cloth, y out of the cloth on the pile's side.
struct WeaveConstruction::BoundPart {
  std::vector<Vec2> points;
  std::vector<yarn::SectionSize> sizes;  // of each
  Leg legs[2];                           // backwards, forwards
  double lengths[2] = {0, 0};            // half of the float beside it
};

WeaveConstruction::BoundPart WeaveConstruction::bound_part(long long yarn, long long first,
                                                           long long last) const {
  const bool is_weft = !weave_.pile;
  const System& crossed = is_weft ? warp_ : weft_;
  const auto at = [&](double crossing) { return crossed.at(crossing); };
  const double up = pile_is_up(yarn) ? 1.0 : -1.0;
  long long before = first - 1, after = last + 1;
  while (!is_bound(yarn, before)) --before;
  while (!is_bound(yarn, after)) ++after;
  YarnPlan plan;
  const double from = at(static_cast<double>(before)), to = at(static_cast<double>(after));
  equilibrium_->shape(plan, {is_weft, yarn}, from, to, along_warp);
  const nurbs::Curve& line = plan.line.curve;
  const auto parameter = [&](double s) { return (s - from) / (to - from); };
  const auto size_at = [&](double s) {
    const auto next = std::find_if(plan.spec.sizes.begin(), plan.spec.sizes.end(),
                                   [&](const auto& size) { return size.parameter > parameter(s); });
    if (next == plan.spec.sizes.begin()) return next->size;
    if (next == plan.spec.sizes.end()) return std::prev(next)->size;
    const auto& low = *std::prev(next);
    const double share = (parameter(s) - low.parameter) / (next->parameter - low.parameter);
    return yarn::SectionSize{std::lerp(low.size.width, next->size.width, share),
                             std::lerp(low.size.height, next->size.height, share)};
  };
  BoundPart part;
  const long long gaps = points_a_gap * (last - first + 1);
  for (long long k = 0; k <= gaps; ++k) {
    const double s = at(static_cast<double>(first) - 0.5 + static_cast<double>(k) / points_a_gap);
    part.points.emplace_back(s, up * nurbs::evaluate(line, parameter(s)).z());
    part.sizes.push_back(size_at(s));
  }
  for (const int side : {0, 1}) {
    const bool is_forward = side == 1;
    const double way = is_forward ? 1.0 : -1.0;
    const Vec2 foot = is_forward ? part.points.back() : part.points.front();
    const double other =
        is_forward ? at(static_cast<double>(after) - 0.5) : at(static_cast<double>(before) + 0.5);
    const long long binding = is_forward ? last : first;
    const Vec3 slope = nurbs::evaluate_jet(line, parameter(foot.x())).d1;
    Leg& leg = part.legs[side];
    leg.angle = std::atan2(way * up * slope.z(), slope.x());
    leg.reach = 0.5 * std::abs(other - foot.x());
    leg.thickness = (is_forward ? part.sizes.back() : part.sizes.front()).height;
    leg.apex_thickness = 0.5 * (leg.thickness + size_at(other).height);
    leg.clearance = clearance_;
    for (const int k : {0, 1}) {
      const long long crossing = binding + (is_forward ? k : -k);
      const auto size = equilibrium_->size({!is_weft, crossing}, yarn);
      leg.crossed[static_cast<std::size_t>(k)] = {
          {way * (at(static_cast<double>(crossing)) - foot.x()),
           up * equilibrium_->height({!is_weft, crossing}, yarn) - foot.y()},
          outline_polygon(yarn::Ellipse{size.width, size.height})};
    }
    part.lengths[side] = 0.5 * nurbs::arc_length(line, std::min(parameter(foot.x()), parameter(other)),
                                                 std::max(parameter(foot.x()), parameter(other)));
  }
  return part;
}

// Of a leg: to its cut end or to the apex, over the pile's height in file units.
std::optional<std::vector<Vec2>> WeaveConstruction::free_part(const BoundPart& part, int side, bool is_up,
                                                              double height) const {
  const Leg& leg = part.legs[side];
  const Vec2& foot = side == 1 ? part.points.back() : part.points.front();
  const double top = (is_up ? ground_top_ : -ground_bottom_) + height - foot.y();
  if (!weave_.pile) return leg.cut(std::nullopt, part.lengths[side]);
  if (weave_.pile->is_cut) return leg.cut(top, 0.0);
  if (height < leg.apex_thickness + clearance_) return std::nullopt;
  return leg.loop(top - 0.5 * leg.apex_thickness);
}

bool WeaveConstruction::pile_fits(double height) {
  const auto [ends, picks] = pile_repeat();
  const bool is_weft = !weave_.pile;
  double highest = 0.0;
  for (long long yarn = 0; yarn < (is_weft ? picks : ends); ++yarn) {
    if (!is_pile(is_weft, yarn)) continue;
    for (long long k = 0; k < (is_weft ? ends : picks); ++k) {
      const std::optional<long long> last = bound_from(yarn, k);
      if (!last) continue;
      const BoundPart part = bound_part(yarn, k, *last);
      for (const int side : {0, 1}) {
        const auto line = free_part(part, side, pile_is_up(yarn), height);
        if (!line) return false;
        highest =
            std::max(highest, (side == 1 ? part.points.back() : part.points.front()).y() + line->back().y());
      }
    }
  }
  if (is_weft) pile_height_ = highest - ground_top_;
  return true;
}

// From the lowest to the highest place of the yarns that are no pile.
void WeaveConstruction::measure_ground() {
  const auto [ends, picks] = pile_repeat();
  ground_top_ = -std::numeric_limits<double>::infinity();
  ground_bottom_ = -ground_top_;
  for (const bool is_weft : {false, true})
    for (long long yarn = 0; yarn < (is_weft ? picks : ends); ++yarn) {
      if (is_pile(is_weft, yarn)) continue;
      const long long crossings = is_weft ? ends : picks;
      const System& crossed = is_weft ? warp_ : weft_;
      YarnPlan plan;
      equilibrium_->shape(plan, {is_weft, yarn}, crossed.at(0.0), crossed.at(static_cast<double>(crossings)),
                          along_warp);
      for (const yarn::SizeAtParameter& size : plan.spec.sizes) {
        const double z = nurbs::evaluate(plan.line.curve, size.parameter).z();
        ground_top_ = std::max(ground_top_, z + 0.5 * size.size.height);
        ground_bottom_ = std::min(ground_bottom_, z - 0.5 * size.size.height);
      }
    }
}

// Of the crossed system, in steps of 2 %, with which the pile is built; in the form of the text.
std::optional<std::string> WeaveConstruction::pitch_for_pile() const {
  Weave wider = weave_;
  WeaveSystem& system = weave_.pile ? wider.weft : wider.warp;
  const double pitch = system.pitch;
  const auto wider_by = [&](int steps) { return pitch * std::pow(pitch_step, steps); };
  const auto fits = [&](int steps) {
    system.pitch = as_shown(system, wider_by(steps), fabric_.units);
    Diagnostics own;
    Result<std::unique_ptr<WeaveConstruction>> made = make(fabric_, wider, options_);
    if (!made) return false;
    (*made)->seeks_remedies_ = false;
    return (*made)->prepare(own).ok();
  };
  int close = 0, wide = 4;
  while (wide < most_pitch_steps && !fits(wide)) {
    close = wide;
    wide *= 2;
  }
  if (wide >= most_pitch_steps) return std::nullopt;
  while (wide - close > 1) {
    const int middle = (close + wide) / 2;
    (fits(middle) ? wide : close) = middle;
  }
  return shown_pitch(system, wider_by(wide), fabric_.units);
}

Message WeaveConstruction::refused_pile() {
  const TextPlace place = weave_.pile ? weave_.pile->place : weave_.draft.place;
  const std::string_view unit = name_of(fabric_.units);
  const auto refuse = [&](std::string text) { return error(Kind::geometry, std::move(text)).placed(place); };
  if (weave_.pile) {
    const double height = weave_.pile->height;
    double low = height, high = height + 40.0 * warp_.thickest;
    if (pile_fits(high)) {
      while (high - low > 1e-3 * warp_.thickest) {
        const double middle = 0.5 * (low + high);
        (pile_fits(middle) ? high : low) = middle;
      }
      return refuse(
          fmt::format("a pile of {:.6g} {} is lower than its {} can be: {:.4g} {} at least, or leave out "
                      "'pile' for a ground without one",
                      height, unit, weave_.pile->is_cut ? "tufts" : "loops", rounded_up(high), unit));
    }
  }
  const std::string_view crossed = weave_.pile ? "weft" : "warp";
  std::string text =
      fmt::format("the pile has no room: its {} overlap where they rise between the yarns of the {}",
                  weave_.pile && !weave_.pile->is_cut ? "loops" : "tufts", crossed);
  if (seeks_remedies_) {
    const std::optional<std::string> pitch = pitch_for_pile();
    text += pitch ? fmt::format("; {} of the {} gives it, and so do thinner threads", *pitch, crossed)
                  : "; thinner threads give it";
  }
  return refuse(text);
}

Status WeaveConstruction::prepare_pile(Diagnostics& diagnostics) {
  const bool is_weft = !weave_.pile;
  measure_ground();
  pile_height_ = is_weft ? 0.0 : weave_.pile->height;
  if (!pile_fits(pile_height_)) return refused_pile();
  const Cell cell = fabric_.cell.value_or(Cell{});
  const Box3 box = cell.shape().bounds();
  const auto numbers = [&](bool of_weft) {
    const int axis = of_weft ? 0 : 1;
    return numbers_of(row_of(of_weft ? weft_ : warp_), cell.periodic[static_cast<std::size_t>(axis)],
                      box.min()[axis], box.max()[axis]);
  };
  const bool goes_on = fabric_.cell.has_value();
  const Reach& reach = is_weft ? along_y_ : along_x_;
  const auto [ends, picks] = pile_repeat();
  const long long beyond = goes_on ? (is_weft ? ends : picks) : 0;
  const bool is_cut = is_weft || weave_.pile->is_cut;
  data_points_ = 0;
  for (const bool of_weft : {false, true}) {
    const auto [begin, end] = numbers(of_weft);
    data_points_ =
        sum_of(data_points_, product_of(static_cast<std::uint64_t>(end - begin), points_of(of_weft)));
    const auto places = static_cast<std::uint64_t>(
        is_cut && of_weft == is_weft ? reach.last - reach.first + 1 + 2 * beyond : 1);
    if (product_of(static_cast<std::uint64_t>(end - begin), places) > most_tufts)
      return error(Kind::limit,
                   fmt::format("a cloth has {} tufts of pile at most: build it in parts", most_tufts))
          .placed(weave_.place);
    for (long long yarn = begin; yarn < end; ++yarn) {
      PileYarn made{of_weft ? Block::Kind::weft : Block::Kind::warp, yarn, is_pile(of_weft, yarn)};
      made.is_tuft = made.is_pile && is_cut;
      if (!made.is_pile) {
        pile_yarns_.push_back(made);
        continue;
      }
      std::vector<PileYarn> parts;
      int before = 0;
      for (long long k = reach.first - beyond; k <= reach.last + beyond; ++k)
        if (const std::optional<long long> last = bound_from(yarn, k)) {
          made.first = k;
          made.last = *last;
          if (k < 0) ++before;
          parts.push_back(made);
        }
      if (parts.empty()) continue;
      data_points_ = sum_of(data_points_, product_of(parts.size(), points_a_tuft));
      for (std::size_t i = 0; i < parts.size(); ++i) parts[i].number = static_cast<int>(i) - before + 1;
      if (is_cut) {
        pile_yarns_.insert(pile_yarns_.end(), parts.begin(), parts.end());
      } else {
        made = parts.front();
        // A loop that ends at the cloth's edge ends with its foot there.
        made.ends_at_foot = !goes_on && bound_from(yarn, reach.last + 1);
        made.last = made.ends_at_foot ? reach.last + 1 : parts.back().last;
        pile_yarns_.push_back(made);
      }
    }
  }
  if (is_weft)
    diagnostics.add(
        note(Kind::geometry, fmt::format("picks of thread '{}' are ground; the others are pile, whose cut "
                                         "floats stand {:.3g} {} out of it",
                                         weft_.thread(0).thread->name, pile_height_, name_of(fabric_.units)))
            .placed(weave_.draft.place, fabric_.file));
  return {};
}

std::optional<PileReport> WeaveConstruction::pile() const {
  if (!has_pile()) return std::nullopt;
  const double mm = millimetres_per(fabric_.units);
  PileReport report{mm * pile_height_, mm * (ground_top_ - ground_bottom_), {}, {}};
  if (weave_.pile) report.ends_per_mm = 1.0 / (mm * weave_.warp.pitch);
  if (weave_.draft.form == Draft::Form::corduroy)
    report.wales_per_mm = 1.0 / (mm * weave_.draft.a * warp_.text->pitch);
  return report;
}

std::string WeaveConstruction::pile_name(const PileYarn& yarn) const {
  const long long number =
      (weave_.pile && yarn.kind == Block::Kind::warp ? (yarn.yarn - wrapped<long long>(yarn.yarn, 2)) / 2
                                                     : yarn.yarn) +
      1;
  if (!yarn.is_pile) return fmt::format("{}_{}", yarn.kind == Block::Kind::warp ? "warp" : "weft", number);
  return yarn.is_tuft ? fmt::format("pile_{}_tuft_{}", number, yarn.number) : fmt::format("pile_{}", number);
}

Status WeaveConstruction::plan_pile(YarnPlan& plan, const PileYarn& pile) const {
  const bool is_weft = !weave_.pile, is_cut = is_weft || weave_.pile->is_cut, is_up = pile_is_up(pile.yarn);
  const System& crossed = is_weft ? warp_ : weft_;
  const auto to_place = is_weft ? along_weft : along_warp;
  // Tufts of one kind are planned alike, at the place of the first one.
  const auto [ends, picks] = pile_repeat();
  const long long repeat = is_weft ? ends : picks;
  const long long shift = is_cut ? pile.first - wrapped(pile.first, repeat) : 0;
  const double origin = is_cut ? crossed.at(static_cast<double>(pile.first - shift)) : 0.0;
  if (is_cut)
    plan.at = to_place(crossed.at(static_cast<double>(pile.first)), 0.0,
                       (is_weft ? weft_ : warp_).at(static_cast<double>(pile.yarn)));
  std::vector<Vec2> line;
  std::vector<std::pair<std::size_t, yarn::SectionSize>> sizes;
  const auto free = [&](const BoundPart& part, int side) {
    const Vec2 foot = side == 1 ? part.points.back() : part.points.front();
    std::vector<Vec2> points = *free_part(part, side, is_up, pile_height_);
    for (Vec2& point : points) point = foot + Vec2((side == 1 ? 1.0 : -1.0) * point.x(), point.y());
    if (side == 0) std::reverse(points.begin(), points.end());
    return points;
  };
  for (long long k = pile.first; k <= pile.last; ++k) {
    const std::optional<long long> last = bound_from(pile.yarn, k);
    if (!last) continue;
    const BoundPart part = bound_part(pile.yarn, k - shift, *last - shift);
    if (is_cut || k > pile.first) {
      const std::vector<Vec2> down = free(part, 0);
      // The apex of a loop is that of its first half, too.
      line.insert(line.end(), down.begin() + (is_cut ? 0 : 1), down.end());
      if (is_cut) sizes.emplace_back(0, part.sizes.front());
    }
    const bool is_edge = pile.ends_at_foot && k == pile.last;
    for (std::size_t i = 0; i < (is_edge ? 1 : part.points.size()); ++i) {
      if (i % 2 == 0) sizes.emplace_back(line.size(), part.sizes[i]);
      line.push_back(part.points[i]);
    }
    if (is_cut || (!is_edge && *last < pile.last)) {
      const std::vector<Vec2> up = free(part, 1);
      line.insert(line.end(), up.begin(), up.end());
      if (is_cut) sizes.emplace_back(line.size() - 1, part.sizes.back());
    }
  }
  for (const Vec2& point : line)
    plan.points.push_back(to_place(point.x() - origin, is_up ? point.y() : -point.y(), 0.0));
  const auto direction = [&](std::size_t from, std::size_t to) {
    return Vec3(plan.points[to] - plan.points[from]);
  };
  if (Status made = interpolate(plan, yarn::PathForm::chord, direction(0, 1),
                                direction(line.size() - 2, line.size() - 1));
      !made)
    return made;
  plan.spec.sizes.clear();
  for (const auto& [index, size] : sizes) plan.spec.sizes.push_back({plan.line.parameters[index], size, 0.0});
  const yarn::SectionSize size = sizes.front().second;
  plan.spec.section = plan.thread.section.emplace(yarn::Ellipse{size.width, size.height});
  plan.thread.packing = equilibrium_->packing({is_weft, pile.yarn});
  return {};
}

}  // namespace selvage::fabric
