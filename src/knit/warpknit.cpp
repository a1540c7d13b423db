// The construction `warpknit` (formats/txt/README.md): one yarn a guide of every bar, over all courses.
//
// Wales run along +y, side by side in x: space s between needles (lapping.h) lies at x = s * wale pitch for
// the first guide of a bar, guide g is g - 1 pitches further, and the loops of course j stand on
// y = (j - 1) * course pitch. +z is the technical face, where the legs of the loops lie, -z the technical
// back with the underlaps. A loop rises from its foot, at the back, through the loop below (the one of the
// last course in which a bar knitted) to the face, and its head goes behind the legs of the next loop.
//
// What lies over what: from the back the underlaps of the first bar (the front bar), then those of the
// second, ..., then the heads and, on the face, the legs, those of the front bar foremost; so its feet stand
// outside of those of the other bars. A laid-in course has no loop: the yarn stays in the layer of its bar's
// underlaps, where those of the bars before it hold it against the loops of the needles that it crosses.
// The overlap of a fall-plate bar is a low arch over the feet of that course's loops, behind their legs,
// which does not pass through the loop below. At the edges of the needle bed loops of the course below may be
// missing, as in a strip cut from a wider fabric.
//
// Centre lines are by the loop path method of ../shared/references 000 (inserted control points), which
// nearly meets its data points; by how much it misses is in CentreLine::largest_miss.
#include "knit/warpknit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <set>

#include "core/wrapped.h"
#include "fabric/build_options.h"
#include "fabric/quantities.h"
#include "fabric/yarn_spec.h"
#include "knit/lapping.h"
#include "knit/own_loop.h"
#include "knit/warpknit_mend.h"
#include "mechanics/constants.h"
#include "yarn/outline.h"

namespace selvage::fabric {

namespace {

// Courses by which yarns are continued on each side of a fabric with a unit cell.
constexpr int continued_courses = 2;
// Wales by which inserted wefts are.
constexpr int continued_wales = 2;
// Of a thickness, between the surfaces of yarns: less makes poor tetrahedra of what lies between.
constexpr double gap_share = 0.01;

bool wraps(const Lapping& lapping) {
  return std::any_of(lapping.begin(), lapping.end(), [](const Overlap& o) { return !o.is_laid_in(); });
}

double thickness_of(const yarn::Section& section) {
  const yarn::SectionSize size = yarn::nominal_size(section);
  return std::max(size.width, size.height);
}

// The straight yarns across, counted from 0; with a unit cell there are some before it.
struct Wefts {
  std::vector<const Thread*> threads;  // in turn; none: no wefts
  int every = 1, first_course = 0;     // of weft 0
  long long first = 0, end = 0;        // wefts of the fabric
  [[nodiscard]] long long count() const { return end - first; }
  [[nodiscard]] long long course(long long weft) const { return first_course + weft * every; }
  [[nodiscard]] const Thread& thread(long long weft) const {
    return *threads[static_cast<std::size_t>(wrapped(weft, static_cast<long long>(threads.size())))];
  }
};

// Threads whose fibres lie closer than their own packing says.
using PressedThreads = std::vector<std::unique_ptr<const Thread>>;

class WarpknitConstruction final : public Construction {
 public:
  WarpknitConstruction(const Fabric& fabric, const Warpknit& warpknit, WarpknitPiece piece, LoopMoves moves,
                       Wefts wefts, PressedThreads pressed)
      : fabric_(fabric),
        warpknit_(warpknit),
        piece_(std::move(piece)),
        moves_(std::move(moves)),
        wefts_(std::move(wefts)),
        pressed_(std::move(pressed)) {}

  [[nodiscard]] std::size_t count() const override {
    return guides() + static_cast<std::size_t>(wefts_.count());
  }
  [[nodiscard]] std::string name(std::size_t index) const override {
    if (is_weft(index)) return fmt::format("weft_{}", weft_of(index) + 1);
    return fmt::format("bar{}_{}", bar_of(index) + 1, guide_of(index) + 1);
  }
  [[nodiscard]] Vec2 unit() const override { return {warpknit_.wale_pitch, warpknit_.course_pitch}; }
  [[nodiscard]] std::string system(std::size_t index) const override {
    return is_weft(index) ? "weft" : fmt::format("bar{}", bar_of(index) + 1);
  }
  [[nodiscard]] const Thread& thread(std::size_t index) const override {
    if (is_weft(index)) return wefts_.thread(weft_of(index));
    return *piece_.bars[bar_of(index)].thread;
  }
  [[nodiscard]] std::uint64_t data_points() const override { return product_of(count(), longest()); }
  [[nodiscard]] std::uint64_t longest() const override {
    return points_of_a_course * static_cast<std::uint64_t>(piece_.last_course - piece_.first_course) + 6;
  }
  [[nodiscard]] Result<YarnPlan> plan(std::size_t index) const override;
  [[nodiscard]] Repeat repeat() const override;

 private:
  [[nodiscard]] std::size_t guides() const {
    return piece_.bars.size() * static_cast<std::size_t>(warpknit_.wales);
  }
  [[nodiscard]] bool is_weft(std::size_t index) const { return index >= guides(); }
  [[nodiscard]] long long weft_of(std::size_t index) const {
    return wefts_.first + static_cast<long long>(index - guides());
  }
  [[nodiscard]] Result<YarnPlan> plan_weft(std::size_t index) const;
  [[nodiscard]] std::size_t bar_of(std::size_t index) const {
    return index / static_cast<std::size_t>(warpknit_.wales);
  }
  [[nodiscard]] std::size_t guide_of(std::size_t index) const {
    return index % static_cast<std::size_t>(warpknit_.wales);
  }
  const Fabric& fabric_;
  const Warpknit& warpknit_;
  WarpknitPiece piece_;  // all of it; at least one bar, front bar first
  LoopMoves moves_;
  Wefts wefts_;
  PressedThreads pressed_;  // that bars and wefts have
};

// Edge to edge of the needle bed.
Result<YarnPlan> WarpknitConstruction::plan_weft(std::size_t index) const {
  Result<YarnPlan> plan = start_plan(fabric_, thread(index), name(index), Role::weft, warpknit_.weft->place);
  if (!plan) return plan;
  int low = highest_space, high = 0;
  for (const Bar& bar : piece_.bars)
    for (const Overlap& o : bar.lapping) {
      low = std::min({low, o.from, o.to});
      high = std::max({high, o.from, o.to});
    }
  const Measures& m = piece_.measures;
  const double beyond = fabric_.cell ? continued_wales : 0;
  const double start = (low - beyond) * m.wale_pitch,
               end = (high + warpknit_.wales - 1 + beyond) * m.wale_pitch;
  plan->points = {{start, 0, m.weft_z()}, {end, 0, m.weft_z()}};
  plan->at.y() = std::fma(static_cast<double>(wefts_.course(weft_of(index))), m.course_pitch, m.weft_y());
  if (Status made = interpolate(*plan, yarn::PathForm::chord, Vec3::UnitX(), Vec3::UnitX()); !made)
    return made.error();
  plan->spec.guide = yarn::FrameGuide::with_up(Vec3::UnitZ());
  return plan;
}

Result<YarnPlan> WarpknitConstruction::plan(std::size_t index) const {
  if (is_weft(index)) return plan_weft(index);
  const Bar& bar = piece_.bars[bar_of(index)];
  Result<YarnPlan> plan = start_plan(fabric_, *bar.thread, name(index), Role::wale, bar.place);
  if (!plan) return plan;
  const Result<YarnPoints> points = points_of_bar(piece_.bars, bar_of(index), piece_.measures, moves_,
                                                  piece_.first_course, piece_.last_course);
  if (!points) return points.error();
  plan->points = points->of_guide(0);
  plan->at.x() = static_cast<double>(guide_of(index)) * piece_.measures.wale_pitch;
  if (Status made = interpolate(*plan, yarn::PathForm::loop, Vec3::UnitY(), Vec3::UnitY()); !made)
    return made.error();
  // Legs of loops run along the cloth's normal in places, where it says nothing about their sections.
  plan->spec.guide =
      bar.has_feet ? yarn::FrameGuide::free_from(Vec3::UnitZ()) : yarn::FrameGuide::with_up(Vec3::UnitZ());
  return plan;
}

// Guides of a bar all do the same. Lappings that are longer together than any cell have no repeat.
Repeat WarpknitConstruction::repeat() const {
  constexpr long long longest = 1'000'000;
  long long courses = 1;
  if (wefts_.count() > 0)
    courses = wefts_.every *
              smallest_shift(static_cast<long long>(wefts_.threads.size()), [&](long long i, long long k) {
                return &wefts_.thread(i) == &wefts_.thread(k);
              });
  for (const Bar& bar : piece_.bars) {
    courses = std::lcm(
        courses, smallest_shift(static_cast<long long>(bar.lapping.size()), [&](long long i, long long k) {
          return overlap_at(bar.lapping, i) == overlap_at(bar.lapping, k);
        }));
    if (courses > longest) return {warpknit_.wale_pitch, std::nullopt, std::nullopt};
  }
  return {warpknit_.wale_pitch, static_cast<double>(courses) * warpknit_.course_pitch, std::nullopt};
}

Status check_overlaps(const WarpknitBar& bar, const Lapping& lapping) {
  for (std::size_t i = 0; i < lapping.size(); ++i) {
    const Overlap& o = lapping[i];
    if (std::abs(o.from - o.to) <= 1) continue;
    return error(Kind::unsupported,
                 fmt::format(
                     "overlap {} of this lapping, {}-{}, goes over {} needles at once; a guide wraps one "
                     "needle a course, between neighbouring spaces",
                     i + 1, o.from, o.to, std::abs(o.from - o.to)))
        .placed(bar.lapping_place);
  }
  return {};
}

Result<std::vector<Bar>> read_bars(const Fabric& fabric, const Warpknit& warpknit) {
  std::vector<WarpknitBar> texts = warpknit.bars;
  if (!warpknit.classic.empty())
    for (const std::string_view lapping :
         classic_lappings(warpknit.classic, warpknit.stitch.value_or(Warpknit::Stitch::closed)))
      texts.push_back({warpknit.thread, warpknit.place, std::string(lapping), {}, false, {}});
  if (texts.empty()) return error(Kind::geometry, "this warp knit has no bars").placed(warpknit.place);
  std::vector<Bar> bars;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const WarpknitBar& text = texts[i];
    Bar bar;
    Result<Lapping> lapping = parse_lapping(text.lapping, text.lapping_place);
    if (!lapping) return lapping.error().placed(text.place);
    if (Status checked = check_overlaps(text, *lapping); !checked) return checked.error().placed(text.place);
    bar.lapping = std::move(*lapping);
    bar.thread = fabric.find_thread(text.thread);
    if (bar.thread == nullptr)
      return error(Kind::geometry, fmt::format("there is no thread '{}'", text.thread)).placed(text.place);
    bar.is_fall_plate = text.fall_plate;
    bar.place = text.place;
    bar.has_feet = wraps(bar.lapping);
    if (text.own_loop) bar.own = &*warpknit.bars[i].own_loop;
    if (bar.own != nullptr && !bar.has_feet)
      return error(Kind::geometry, "this bar only lays in: it forms no loop, leave out its 'points'")
          .placed(bar.own->place);
    bars.push_back(std::move(bar));
  }
  for (std::size_t i = 0; i < bars.size(); ++i) {
    bars[i].bars_behind = static_cast<int>(bars.size() - 1 - i);
    for (std::size_t k = 0; k < bars.size(); ++k)
      if (bars[k].has_feet && k != i) ++(k < i ? bars[i].feet_before : bars[i].feet_behind);
  }
  return bars;
}

// How many yarns lie side by side on one needle, and one above the other within a course.
struct Stack {
  int bars_with_feet = 0, fall_plates = 0, most_feet_before = 0;
  bool knits = false, has_own_only = true, has_weft = false;

  // Two feet a bar, the two legs of the loop below, half a space to each side.
  [[nodiscard]] double across() const { return 2.0 * bars_with_feet + 2.0; }
  // Feet from the lowest to the highest, arches, heads, the next feet.
  [[nodiscard]] double along() const {
    return 2.0 * most_feet_before + 4.0 + low_foot + 2.0 * fall_plates + (has_weft ? 1.0 : 0.0);
  }
};

Stack stack_of(const std::vector<Bar>& bars, const Wefts& wefts) {
  Stack stack;
  for (const Bar& bar : bars) {
    stack.bars_with_feet += bar.has_feet ? 1 : 0;
    stack.fall_plates += bar.has_feet && bar.is_fall_plate ? 1 : 0;
    stack.most_feet_before = std::max(stack.most_feet_before, bar.feet_before);
    stack.knits = stack.knits || (bar.has_feet && !bar.is_fall_plate);
    stack.has_own_only = stack.has_own_only && (!bar.has_feet || bar.own != nullptr);
  }
  stack.has_weft = wefts.count() > 0;
  return stack;
}

// How much thinner a thread's round yarns can be: with their fibres as close as discs lie. 1 where their size
// does not follow from their packing.
double least_share(const Thread& thread) {
  const std::optional<double> packing = thread.size_packing();
  const bool has_size =
      thread.diameter || (thread.section && yarn::nominal_size(*thread.section).width > 0.0);
  if (has_size || !packing || !thread.linear_density || !thread.fibre_density()) return 1.0;
  return std::min(1.0, std::sqrt(*packing / mechanics::densest_packing));
}

// Yarns that are thicker than the pitches leave room for, and whose fibres can come closer, are pressed; all
// of them or none: what has no room then is told by `measure`.
PressedThreads press_yarns(const Fabric& fabric, const Warpknit& warpknit, Wefts& wefts,
                           std::vector<Bar>& bars, Diagnostics& diagnostics) {
  constexpr double less = 1.0 - 1e-9;
  const Stack stack = stack_of(bars, wefts);
  const double most =
      less * std::min(warpknit.wale_pitch / stack.across(), warpknit.course_pitch / stack.along());
  if (stack.has_own_only || !(most > 0.0)) return {};
  std::vector<const Thread**> places;
  places.reserve(bars.size() + wefts.threads.size());
  for (Bar& bar : bars) places.push_back(&bar.thread);
  for (const Thread*& thread : wefts.threads) places.push_back(&thread);
  PressedThreads pressed;
  std::set<const Thread*> seen;
  for (const Thread** place : places) {
    if (!seen.insert(*place).second) continue;
    const Result<yarn::Section> section = centred_section_of(**place, fabric.units);
    if (!section) return {};
    const double thickness = thickness_of(*section);
    if (!(thickness * less > most)) continue;
    if (thickness * least_share(**place) > most) return {};
    Thread closer = **place;
    closer.packing = *closer.size_packing() * thickness * thickness / (most * most);
    pressed.push_back(std::make_unique<const Thread>(std::move(closer)));
  }
  for (const std::unique_ptr<const Thread>& now : pressed) {
    const Thread* const thread = fabric.find_thread(now->name);
    diagnostics.add(
        note(Kind::geometry,
             fmt::format("the warp knit has no room for thread '{}' as it is: it is pressed to {:.4g} {}, "
                         "the packing of its fibres rises from {:.3g} to {:.3g}",
                         now->name, most, name_of(fabric.units), *thread->size_packing(), *now->packing))
            .placed(thread->place, fabric.file));
    for (const Thread** place : places)
      if (*place == thread) *place = now.get();
  }
  return pressed;
}

Result<Measures> measure(const Fabric& fabric, const Warpknit& warpknit, const Wefts& wefts,
                         std::vector<Bar>& bars, bool are_pressed) {
  Measures m;
  double thickest = 0.0, pressed = 0.0;  // as they are, and as thin as they can be
  const auto add = [&](const Thread& thread, double thickness) {
    thickest = std::max(thickest, thickness);
    pressed = std::max(pressed, thickness * (are_pressed ? least_share(thread) : 1.0));
  };
  for (const Thread* thread : wefts.threads)
    if (const Result<yarn::Section> section = centred_section_of(*thread, fabric.units); section)
      add(*thread, thickness_of(*section));
  for (Bar& bar : bars) {
    const Result<yarn::Section> section = centred_section_of(*bar.thread, fabric.units);
    if (!section) return section.error();
    bar.thickness = thickness_of(*section);
    add(*bar.thread, bar.thickness);
  }
  const Stack stack = stack_of(bars, wefts);
  if (!stack.knits)
    return error(Kind::geometry,
                 "no bar of this warp knit forms loops: at least one needs overlaps, such as 1-0/1-2, "
                 "that are not pushed down");
  m.bars_with_feet = stack.bars_with_feet;
  m.fall_plates = stack.fall_plates;
  m.has_weft = stack.has_weft;
  const double across = stack.across(), along = stack.along();
  const auto too_small = [&](std::string_view what, double pitch, double yarns) {
    return error(Kind::geometry,
                 fmt::format("the {} pitch {:.6g} is too small for yarns of {:.4g}: the loops of {} bars "
                             "need at least {:.6g}{}",
                             what, pitch, thickest, m.bars_with_feet, yarns * pressed,
                             pressed < thickest ? ", with their fibres as close as they go" : ""));
  };
  if (!stack.has_own_only && !(warpknit.wale_pitch >= across * thickest))
    return too_small("wale", warpknit.wale_pitch, across);
  if (!stack.has_own_only && !(warpknit.course_pitch >= along * thickest))
    return too_small("course", warpknit.course_pitch, along);
  for (const auto& [what, pitch] :
       {std::pair("a wale pitch", warpknit.wale_pitch), std::pair("a course pitch", warpknit.course_pitch)})
    if (Status fits = check_proportion(what, pitch, thickest, fabric.units, warpknit.place); !fits)
      return fits.error();
  m.wale_pitch = warpknit.wale_pitch;
  m.course_pitch = warpknit.course_pitch;
  m.across = warpknit.wale_pitch / across;
  m.along = warpknit.course_pitch / along;
  m.thickest = thickest;
  m.layer = 1.12 * thickest;  // the loop path misses its points by a few per cent of a yarn
  m.deepest_foot = (0.5 + stack.most_feet_before) * m.along;
  m.substrate = warpknit.substrate.value_or(0.0);
  return m;
}

Result<Wefts> read_wefts(const Fabric& fabric, const Warpknit& warpknit, const WarpknitPiece& piece) {
  Wefts wefts;
  if (!warpknit.weft) return wefts;
  for (const std::string& name : warpknit.weft->threads) {
    wefts.threads.push_back(fabric.find_thread(name));
    if (wefts.threads.back() == nullptr)
      return error(Kind::geometry, fmt::format("there is no thread '{}'", name)).placed(warpknit.weft->place);
    if (const Result<yarn::Section> section = centred_section_of(*wefts.threads.back(), fabric.units);
        !section)
      return section.error().placed(warpknit.weft->place);
  }
  wefts.every = warpknit.weft->every;
  wefts.first_course = warpknit.weft->first - 1;
  if (wefts.first_course >= warpknit.courses)
    return error(Kind::geometry, fmt::format("the first weft is in course {}, and this warp knit has {}",
                                             wefts.first_course + 1, warpknit.courses))
        .placed(warpknit.weft->place);
  while (wefts.course(wefts.first - 1) >= piece.first_course) --wefts.first;
  wefts.end = (piece.last_course - 1 - wefts.first_course) / wefts.every + 1;
  return wefts;
}

// What keeps the loops apart. None moves where the repeat is too long, and where a loop is held too long,
// which its yarn says when it is planned.
LoopMoves moves_apart(const Fabric& fabric, const Warpknit& warpknit, const WarpknitPiece& piece,
                      const BuildOptions& options, Diagnostics& diagnostics) {
  const auto warn = [&](std::string text) {
    diagnostics.add(warning(Kind::geometry, std::move(text)).placed(warpknit.place, fabric.file));
  };
  double thickest = 0.0;
  for (const Bar& bar : piece.bars) thickest = std::max(thickest, bar.thickness);
  const double gap = (options.gap > 0.0 ? options.gap : gap_share * thickest) +
                     2.0 * std::max(tolerance_of(fabric, {}), options.tolerance);
  Result<std::optional<LoopMending>> mended = mend_loops(piece, gap);
  if (!mended) return {};
  if (!*mended) {
    warn(
        "the lappings of this warp knit begin anew together only after so many courses that its loops were "
        "not looked through for overlap");
    return {};
  }
  if (const Mending& mending = (*mended)->mending; mending.missing >= gap)
    warn(fmt::format("the loops have too little room and overlap, by about {:.2g} {}: larger pitches give it",
                     mending.missing - gap, name_of(fabric.units)));
  return std::move((*mended)->moves);
}

}  // namespace

Result<std::unique_ptr<Construction>> make_warpknit(const Fabric& fabric, const Warpknit& warpknit,
                                                    const BuildOptions& options, Diagnostics& diagnostics) {
  if (warpknit.wales < 1 || warpknit.courses < 1)
    return error(Kind::geometry, "a warp knit needs at least one wale and one course").placed(warpknit.place);
  Result<std::vector<Bar>> bars = read_bars(fabric, warpknit);
  if (!bars) return bars.error();
  WarpknitPiece piece;
  piece.last_course = warpknit.courses;
  if (fabric.cell) {
    piece.first_course -= continued_courses;
    piece.last_course += continued_courses;
  }
  Result<Wefts> wefts = read_wefts(fabric, warpknit, piece);
  if (!wefts) return wefts.error();
  PressedThreads pressed;
  if (!options.as_published) pressed = press_yarns(fabric, warpknit, *wefts, *bars, diagnostics);
  const Result<Measures> measures = measure(fabric, warpknit, *wefts, *bars, !options.as_published);
  if (!measures) return measures.error().placed(warpknit.place);
  piece.bars = std::move(*bars);
  piece.measures = *measures;
  if (Status good = check_own_loops(piece.bars, piece.measures); !good) return good.error();
  LoopMoves moves;
  if (!options.as_published) moves = moves_apart(fabric, warpknit, piece, options, diagnostics);
  return std::unique_ptr<Construction>(std::make_unique<WarpknitConstruction>(
      fabric, warpknit, std::move(piece), std::move(moves), std::move(*wefts), std::move(pressed)));
}

}  // namespace selvage::fabric
