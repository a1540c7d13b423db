#include "knit/knit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <variant>

#include "core/rounding.h"
#include "core/wrapped.h"
#include "fabric/build_options.h"
#include "fabric/quantities.h"
#include "fabric/yarn_spec.h"
#include "knit/chart.h"
#include "knit/density.h"
#include "knit/knit_mend.h"
#include "knit/loop.h"
#include "knit/own_loop.h"
#include "nurbs/interpolate.h"

namespace selvage::fabric {

namespace {

// With a unit cell the cloth goes on beyond it, inside of the border whose loops move for themselves. The
// influence of a spline's end falls by 2 + sqrt(3) from data point to data point: four wales of eight points
// make the loops inside periodic to the last bits.
constexpr long long margin_wales = 4 + border_wales;

constexpr double least_gap_share = 0.01;  // of the thickness, between two yarns

// Loops whose moves are solved for, at most: larger repeats are left as published.
constexpr long long most_solved = 10'000;

class KnitConstruction final : public Construction {
 public:
  KnitConstruction(const Fabric& fabric, const Knit& knit, std::vector<const Thread*> threads,
                   KnitField field, KnitMoves moves, Vec2 half)
      : fabric_(fabric),
        knit_(knit),
        threads_(std::move(threads)),
        field_(std::move(field)),
        moves_(std::move(moves)),
        half_(std::move(half)),
        pitch_(knit.wale_pitch > 0 ? knit.wale_pitch : wale_spacing * knit.unit.value_or(half_.x()),
               knit.course_pitch > 0 ? knit.course_pitch : course_spacing * knit.unit.value_or(half_.x())) {
    if (knit.crossing) origin_ = *knit.crossing - Vec3(pitch_.x() / 2, 0, 0);
    if (field_.chart.journeys() == nullptr) return;
    for (long long row = field_.first_course; row <= field_.last_course; ++row)
      if (const RowExtent extent = extent_of(field_, row); extent.first <= extent.last) rows_.push_back(row);
  }

  [[nodiscard]] std::size_t count() const override {
    if (!rows_.empty()) return rows_.size();
    return static_cast<std::size_t>(field_.last_course - field_.first_course + 1) * yarns_of_a_course();
  }
  [[nodiscard]] std::string name(std::size_t index) const override {
    const long long row = course(index), feeds = field_.chart.feeds(), feed = wrapped(row, feeds);
    const long long number = (row - feed) / feeds + 1;
    std::string of_course =
        feeds == 1 ? fmt::format("course_{}", number) : fmt::format("course_{}_{}", number, feed + 1);
    if (end(index) == 0) return of_course;
    if (knit_.pile_is_cut) return fmt::format("{}_tuft_{}", of_course, tuft(index) + 1);
    return of_course + (knit_.pile ? "_pile" : "_plating");
  }
  [[nodiscard]] Vec2 unit() const override { return pitch_; }
  [[nodiscard]] std::string system(std::size_t index) const override {
    if (end(index) == 0) return "course";
    return knit_.pile ? "pile" : "plating";
  }
  [[nodiscard]] const Thread& thread(std::size_t index) const override {
    if (end(index) == 1) return *fabric_.find_thread(knit_.plating);
    return *threads_[static_cast<std::size_t>(
        wrapped(course(index), static_cast<long long>(threads_.size())))];
  }
  [[nodiscard]] std::uint64_t data_points() const override {
    const auto rows = static_cast<std::uint64_t>(field_.last_course - field_.first_course + 1);
    return product_of(rows * static_cast<std::uint64_t>(field_.ends), longest());
  }
  [[nodiscard]] std::uint64_t longest() const override {
    std::uint64_t points_a_loop = field_.pile > 0 ? 12 : 8;
    for (const OwnLoop& own : knit_.own_loops)
      points_a_loop = std::max<std::uint64_t>(points_a_loop, own.points.size());
    return points_a_loop * wales() + 1;
  }
  [[nodiscard]] Result<YarnPlan> plan(std::size_t index) const override;
  [[nodiscard]] Repeat repeat() const override {
    const StitchChart& chart = field_.chart;
    const long long of_threads =
        smallest_shift(static_cast<long long>(threads_.size()), [&](long long i, long long k) {
          return threads_[static_cast<std::size_t>(i) % threads_.size()] ==
                 threads_[static_cast<std::size_t>(k) % threads_.size()];
        });
    return {
        static_cast<double>(chart.repeat_of_wales()) * pitch_.x(),
        chart.height(std::lcm(std::lcm(chart.repeat_of_courses(), of_threads), chart.feeds())) * pitch_.y(),
        std::nullopt};
  }

 private:
  // The row of the chart, from 0.
  [[nodiscard]] long long course(std::size_t index) const {
    if (!rows_.empty()) return rows_[index];
    return field_.first_course + static_cast<long long>(index / yarns_of_a_course());
  }
  // The first one is the ground's.
  [[nodiscard]] std::size_t yarns_of_a_course() const {
    return knit_.pile_is_cut ? 1 + static_cast<std::size_t>(wales()) : static_cast<std::size_t>(field_.ends);
  }
  [[nodiscard]] int end(std::size_t index) const { return index % yarns_of_a_course() == 0 ? 0 : 1; }
  [[nodiscard]] long long tuft(std::size_t index) const {  // the wale in which it is knitted
    return field_.first_wale + static_cast<long long>(index % yarns_of_a_course()) - 1;
  }
  [[nodiscard]] std::uint64_t wales() const {
    return static_cast<std::uint64_t>(field_.last_wale - field_.first_wale + 1);
  }

  const Fabric& fabric_;
  const Knit& knit_;
  std::vector<const Thread*> threads_;  // in turn
  KnitField field_;
  KnitMoves moves_;
  std::vector<long long> rows_;  // that have a yarn; empty: all
  Vec2 half_;                    // of the section: r across, and r through the thickness
  Vec2 pitch_;                   // of wales and courses, file units
  Vec3 origin_ = Vec3::Zero();
};

Result<YarnPlan> KnitConstruction::plan(std::size_t index) const {
  Result<YarnPlan> plan = start_plan(fabric_, thread(index), name(index), Role::course, knit_.place);
  if (!plan) return plan;
  const double r = half_.x();
  plan->at = origin_;
  plan->at.y() += field_.chart.height(course(index)) * pitch_.y();
  std::vector<Vec3>& points = plan->points;
  points.reserve(8 * wales() + 1);
  const auto place_from = [&](std::size_t first, long long wale) {
    for (std::size_t i = first; i < points.size(); ++i) {
      const Vec3 base = points[i];
      points[i] = {std::fma(static_cast<double>(wale), pitch_.x(), base.x() * r), base.y() * r,
                   base.z() * half_.y()};
    }
  };
  const bool is_tuft = knit_.pile_is_cut && end(index) == 1;
  const RowExtent extent = extent_of(field_, course(index));
  const long long first_wale = is_tuft ? tuft(index) : extent.first;
  const long long last_wale = is_tuft ? tuft(index) : extent.last;
  for (long long wale = first_wale; wale <= last_wale; ++wale) {
    const std::size_t first = points.size();
    add_stitch_points(field_, course(index), wale, points, end(index));
    moves_.apply(course(index), wale, points, first, end(index));
    place_from(first, wale);
  }
  // What goes from bed to bed, and a pile, runs along the cloth's normal, which says nothing about its
  // sections there.
  const bool stands_out = knit_.bed_distance || (knit_.pile && end(index) == 1) ||
                          (knit_.shape == Knit::Shape::relaxed && half_.x() == half_.y());
  if (is_tuft) {  // without the sinker that is cut
    points.erase(points.begin());
    plan->spec.guide = yarn::FrameGuide::free_from(Vec3::UnitX());
    if (Status made = interpolate(*plan, yarn::PathForm::chord, Vec3::UnitZ(), -Vec3::UnitZ()); !made)
      return made.error();
    return plan;
  }
  points.push_back(last_sinker_point(field_, course(index), end(index)));
  moves_.apply(course(index), field_.last_wale + 1, points, points.size() - 1, end(index));
  place_from(points.size() - 1, extent.last + 1);
  plan->spec.guide =
      stands_out ? yarn::FrameGuide::free_from(Vec3::UnitZ()) : yarn::FrameGuide::with_up(Vec3::UnitZ());
  Onward onward;  // loops that move alike are all of one form
  if (moves_.wales_go_on()) onward = {(points.size() - 1) / wales(), {pitch_.x(), 0, 0}};
  plan->line = course_line(points, method_of(knit_), onward);
  return plan;
}

// A hundredth of the thickness (or the wanted gap) is left between two yarns, or twice the tolerance where
// that is more.
double gap_of(const Fabric& fabric, const yarn::SectionSize& size, const BuildOptions& options) {
  const double share = options.gap > 0.0 ? options.gap : least_gap_share * std::min(size.width, size.height);
  return std::max(share, 2.0 * tolerance_of(fabric, {}));
}

// Its thickest thread is that of all loops.
struct Thickest {
  const Thread* thread = nullptr;
  yarn::Section section;
};

KnitYarn knit_yarn_of(const Fabric& fabric, const Knit& knit, const Thickest& thickest,
                      const BuildOptions& options) {
  const yarn::SectionSize size = yarn::nominal_size(thickest.section);
  KnitYarn yarn;
  yarn.how = method_of(knit);
  yarn.section = thickest.section;
  yarn.half = Vec2(size.width / 2, size.height / 2);
  yarn.turns = section_twist(*thickest.thread, fabric.units) != 0.0 &&
               !std::holds_alternative<yarn::Circle>(thickest.section);
  // Each surface may lie outside of its yarn by the tolerance.
  yarn.gap = gap_of(fabric, size, options) + 2.0 * tolerance_of(fabric, {});
  yarn.relaxes = knit.shape == Knit::Shape::relaxed;
  yarn.keeps_length = knit.loop.has_value() || yarn.relaxes;
  return yarn;
}

// The loops that the statement asks for, were all its lengths so many times larger.
Result<LoopShape> shape_of(const Knit& knit, const KnitField& field, const Vec2& half, double larger) {
  KnitField spaced = field;
  if (knit.unit) {
    const double across = larger * *knit.unit / half.x();
    spaced.shape.wale = across * wale_spacing;
    spaced.shape.course = across * course_spacing;
    spaced.shape.depth *= larger * *knit.unit / half.y();
  }
  if (knit.wale_pitch > 0) spaced.shape.wale = larger * knit.wale_pitch / half.x();
  if (knit.course_pitch > 0) spaced.shape.course = larger * knit.course_pitch / half.x();
  if (field.chart.is_opposite())
    spaced.shape.bed = knit.bed_distance ? larger * *knit.bed_distance / 2 / half.y() : least_bed;
  if (!knit.loop) return spaced.shape;
  return shape_of_length(spaced, method_of(knit), half, larger * *knit.loop);
}

// Published loops are what they are; loops of given densities have to have room.
bool has_densities(const Knit& knit) {
  return knit.wale_pitch > 0 || knit.course_pitch > 0 || knit.loop || knit.unit;
}

constexpr long long most_tried = 400;  // loops

// How many times larger the cloth has to be for its yarn, surely. None where eight times does not help.
std::optional<double> least_enlargement(const Knit& knit, KnitField field, const KnitYarn& yarn) {
  // A cloth that does not repeat is tried as a whole.
  if (field.chart.journeys() != nullptr && KnitMoves::loops_solved(field) > most_tried) return std::nullopt;
  const auto fits = [&](double larger) {
    const Result<LoopShape> shape = shape_of(knit, field, yarn.half, larger);
    if (!shape) return false;
    KnitField tried = field;
    tried.shape = *shape;
    return KnitMoves::come_apart(tried, yarn);
  };
  double low = 1, high = 1.25;
  constexpr double most = 8, enough = 1.04, surely = 1.02;
  while (!fits(high)) {
    if (high > most) return std::nullopt;
    low = high;
    high *= 1.25;
  }
  while (high > enough * low) {
    const double middle = std::sqrt(low * high);
    (fits(middle) ? high : low) = middle;
  }
  return surely * high;
}

// What no way of moving loops apart undercuts: two legs lie side by side in a wale, and heads above each
// other.
Status check_pitches(const Fabric& fabric, const Knit& knit, const yarn::SectionSize& size) {
  struct Pitch {
    std::string_view what;
    double value, least;  // in widths of the yarn
  };
  for (const Pitch& pitch : {Pitch{"wale", knit.wale_pitch, 2}, Pitch{"course", knit.course_pitch, 1}}) {
    if (!(pitch.value > 0)) continue;
    if (Status fits = check_proportion(fmt::format("a {} pitch", pitch.what), pitch.value, size.width,
                                       fabric.units, knit.place);
        !fits)
      return fits;
    if (const double least = pitch.least * size.width; pitch.value < least)
      return error(
                 Kind::geometry,
                 fmt::format(
                     "a {} pitch of {:.6g} has no room for a yarn of {:.4g}: it takes {:.4g} at least, most "
                     "loops twice that; or a yarn of {:.4g} at most, half of which is better",
                     pitch.what, pitch.value, size.width, least, pitch.value / pitch.least))
          .placed(knit.place);
  }
  return {};
}

// What is left between the yarns of solved loops; not above 0: they overlap.
double left_between(const Mending& mending, const KnitYarn& yarn) {
  return yarn.gap - mending.missing * yarn.half.x();
}

// Are the loops apart when all lengths of the cloth but the yarn's are so many times larger?
bool has_room(const Knit& knit, const KnitField& field, const KnitYarn& yarn, double larger) {
  const Result<LoopShape> enlarged = shape_of(knit, field, yarn.half, larger);
  if (!enlarged) return false;
  KnitField tried = field;
  tried.shape = *enlarged;
  return left_between(KnitMoves(tried, yarn).mending(), yarn) > 0;
}

// Of a yarn of three digits. None: none was found, and what the loops lack is not room.
std::optional<double> enlargement_with_room(const Knit& knit, const KnitField& field, const KnitYarn& yarn) {
  std::vector<double> tried = {1.25, 1.5, 2, 3};
  if (KnitMoves::loops_solved(field) > most_tried && field.chart.journeys() != nullptr) return std::nullopt;
  if (const std::optional<double> least = least_enlargement(knit, field, yarn))
    tried.insert(tried.begin(), *least);
  const double across = 2 * yarn.half.x();
  for (const double larger : tried)
    if (const double rounded = across / rounded_down(across / larger); has_room(knit, field, yarn, rounded))
      return rounded;
  return std::nullopt;
}

// How a thread that is sized by its linear density becomes so many times thinner.
std::string as_count(const Thread& thread, double thinner) {
  if (!thread.linear_density || thread.diameter || thread.section) return {};
  const LinearDensity finer = thread.linear_density->times(1 / (thinner * thinner));
  std::string text = fmt::format(" ({} {:.3g}", name_of(finer.measure),
                                 finer.is_indirect() ? rounded_up(finer.value) : rounded_down(finer.value));
  const double denser = rounded_up(thread.size_packing().value_or(1.0) * thinner * thinner);
  if (denser <= 1) text += fmt::format(", or a packing of {:.3g}", denser);
  return text + ")";
}

// The error with the sizes that have room.
std::optional<Message> no_room(const Fabric& fabric, const Knit& knit, const KnitField& field,
                               const KnitYarn& yarn, const Thread& thread) {
  const std::optional<double> larger = enlargement_with_room(knit, field, yarn);
  if (!larger) return std::nullopt;
  const double across = 2 * yarn.half.x();
  const LoopShape& shape = field.shape;
  std::string text = fmt::format(
      "a yarn of {:.4g} {} has no room in loops of these courses and wales: a yarn of {:.3g} at most has{}, "
      "or courses {:.4g} and wales {:.4g} apart",
      across, name_of(fabric.units), across / *larger, as_count(thread, *larger),
      shape.course * yarn.half.x() * *larger, shape.wale * yarn.half.x() * *larger);
  if (knit.loop) text += fmt::format(" with loops of {:.4g}", *knit.loop * *larger);
  return error(Kind::geometry, std::move(text));
}

// The moves that part the loops. A warning where they cannot.
Result<KnitMoves> moves_of(const Fabric& fabric, const Knit& knit, const Thickest& thickest,
                           const KnitField& field, const BuildOptions& options, Diagnostics& diagnostics) {
  const auto warn = [&](std::string text) {
    diagnostics.add(warning(Kind::geometry, std::move(text)).placed(knit.place, fabric.file));
  };
  const yarn::SectionSize size = yarn::nominal_size(thickest.section);
  if (!(size.width > 0.0) || !(size.height > 0.0)) return KnitMoves();
  if (const long long loops = KnitMoves::loops_solved(field); loops > most_solved) {
    warn(
        fmt::format("the chart's repeat is too large for its loops to be moved apart ({} loops that differ, "
                    "at most {}): they are as published, and overlap",
                    loops, most_solved));
    return KnitMoves();
  }
  const KnitYarn yarn = knit_yarn_of(fabric, knit, thickest, options);
  KnitMoves moves(field, yarn);
  const Mending& mending = moves.mending();
  constexpr double most_stretch = 0.01;
  if (mending.stretch > most_stretch)
    warn(fmt::format(
        "the loops of this knit become {:.2g} % longer or shorter than is said where they are moved "
        "apart",
        100 * mending.stretch));
  if (mending.is_solved() && yarn.relaxes && !mending.is_relaxed)
    warn(
        "the loops of this knit have no room to relax: they are only moved apart; longer loops or a thinner "
        "yarn "
        "give it");
  if (mending.is_solved() && mending.is_relaxed)
    diagnostics.add(
        note(Kind::geometry, fmt::format("relaxed, the loops of this knit bend with {:.3g} of the energy "
                                         "that they have where they are only moved apart",
                                         mending.bent / mending.bent_before))
            .placed(knit.place, fabric.file));
  if (mending.is_solved()) return moves;
  const double gap = gap_of(fabric, size, options);
  const double left = left_between(mending, yarn);
  if (left <= 0.0 && has_densities(knit))
    if (const std::optional<Message> refused = no_room(fabric, knit, field, yarn, *thickest.thread))
      return *refused;
  const std::string near = fmt::format("near ({:.4g}, {:.4g}, {:.4g})", mending.at.x() * size.width / 2,
                                       mending.at.y() * size.width / 2, mending.at.z() * size.height / 2);
  warn(left > 0.0 ? fmt::format("the loops of this knit come nearer to each other than is wanted: {} about "
                                "{:.2g} {} of {:.2g} are left between them",
                                near, left, name_of(fabric.units), gap)
                  : fmt::format("the loops of this knit could not be moved apart: {} they overlap, by about "
                                "{:.2g} {}",
                                near, -left, name_of(fabric.units)));
  return moves;
}

// Courses and wales that a loop's length is worth in a relaxed jersey, from dry to fully relaxed: D. L.
// Munden, The geometry and dimensional properties of plain-knit fabrics, J. Text. Inst. 50 (1959) T448, and
// after him. A warning where a cloth is farther off than stretching and finishing bring it.
void tell_of_constants(const Fabric& fabric, const Knit& knit, Diagnostics& diagnostics) {
  if (knit.form != Knit::Form::jersey || !knit.loop || !(knit.course_pitch > 0) || !(knit.wale_pitch > 0))
    return;
  constexpr std::array<double, 2> of_courses = {5.0, 5.6}, of_wales = {3.8, 4.3};
  constexpr double stretched = 1.15;
  const double kc = *knit.loop / knit.course_pitch, kw = *knit.loop / knit.wale_pitch;
  const auto is_near = [](double k, const std::array<double, 2>& range) {
    return k >= range[0] / stretched && k <= range[1] * stretched;
  };
  if (is_near(kc, of_courses) && is_near(kw, of_wales)) return;
  diagnostics.add(
      warning(Kind::geometry, fmt::format("a loop's length is {:.3g} courses and {:.3g} wales here; in "
                                          "a relaxed jersey it is {} to {} and {} to {} (Munden)",
                                          kc, kw, of_courses[0], of_courses[1], of_wales[0], of_wales[1]))
          .placed(knit.place, fabric.file));
}

}  // namespace

Result<std::unique_ptr<Construction>> make_knit(const Fabric& fabric, const Knit& knit,
                                                const BuildOptions& options, Diagnostics& diagnostics) {
  Result<StitchChart> chart = StitchChart::of(knit);
  if (!chart) return chart.error().placed(knit.place);
  std::vector<const Thread*> threads;
  Thickest thickest;
  for (const std::string& name : knit.threads) {
    const Thread* thread = fabric.find_thread(name);
    if (thread == nullptr)
      return error(Kind::geometry, fmt::format("there is no thread '{}'", name)).placed(knit.thread_place);
    Result<yarn::Section> section = centred_section_of(*thread, fabric.units);
    if (!section) return section.error().placed(knit.thread_place);
    threads.push_back(thread);
    if (thickest.thread == nullptr ||
        yarn::nominal_size(*section).width > yarn::nominal_size(thickest.section).width)
      thickest = {thread, std::move(*section)};
  }
  if (chart->journeys() != nullptr && fabric.cell)
    return error(Kind::geometry,
                 "a cell is cut from a cloth that goes on beyond it, and a chart with '.', 'transfer' or "
                 "'drop' is "
                 "the whole cloth: leave out the cell, or these")
        .placed(knit.chart_place);
  KnitField field;
  if (!knit.plating.empty()) {
    const Thread* thread = fabric.find_thread(knit.plating);
    if (thread == nullptr)
      return error(Kind::geometry, fmt::format("there is no thread '{}'", knit.plating)).placed(knit.place);
    Result<yarn::Section> section = centred_section_of(*thread, fabric.units);
    if (!section) return section.error().placed(knit.place);
    if (thickest.thread == nullptr ||
        yarn::nominal_size(*section).width > yarn::nominal_size(thickest.section).width)
      thickest = {thread, std::move(*section)};
    field.ends = 2;
    field.shape.depth = plated_depth;
  }
  if (!knit.own_loops.empty()) field.own = &knit.own_loops;
  if (threads.empty()) return error(Kind::geometry, "this knit has no thread").placed(knit.place);
  const yarn::SectionSize size = yarn::nominal_size(thickest.section);
  const long long beside = fabric.cell ? margin_wales : 0;
  // The loops of courses below reach up into the cell as far as they are held, and one course further.
  const long long beyond = fabric.cell ? chart->longest_hold() + 2 + border_courses(*chart) : 0;
  const long long rows = static_cast<long long>(knit.courses) * chart->feeds();
  field.chart = std::move(*chart);
  field.first_course = -beyond;
  field.last_course = rows - 1 + beyond;
  field.first_wale = -beside;
  field.last_wale = knit.wales - 1 + beside;
  const Vec2 half(size.width / 2, size.height / 2);
  if (Status fits = check_pitches(fabric, knit, size); !fits) return fits.error();
  Result<LoopShape> shape = shape_of(knit, field, half, 1);
  if (!shape) return shape.error().placed(knit.place);
  field.shape = *shape;
  if (field.own != nullptr)
    if (Status good = check_own_loops(knit, field); !good) return good.error();
  if (knit.pile) {
    field.pile = plated_back(field.shape) + *knit.pile / half.y() - 1;
    if (const double least = (least_pile(field.shape) - plated_back(field.shape) + 1) * half.y();
        *knit.pile < least)
      return error(Kind::geometry,
                   fmt::format("a pile of {:.6g} is lower than its loops can be: {:.4g} at least, or "
                               "leave out 'pile' for a plated cloth",
                               *knit.pile, least))
          .placed(knit.place);
  }
  tell_of_constants(fabric, knit, diagnostics);
  KnitMoves moves;
  if (!options.as_published) {
    Result<KnitMoves> found = moves_of(fabric, knit, thickest, field, options, diagnostics);
    if (!found) return found.error().placed(knit.place);
    moves = std::move(*found);
  }
  return std::unique_ptr<Construction>(std::make_unique<KnitConstruction>(
      fabric, knit, std::move(threads), std::move(field), std::move(moves), half));
}

}  // namespace selvage::fabric
