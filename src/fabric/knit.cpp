#include "fabric/constructions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "fabric/build.h"
#include "fabric/knit_chart.h"
#include "fabric/knit_loop.h"
#include "fabric/knit_mend.h"
#include "fabric/yarn_spec.h"
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
  KnitConstruction(const Fabric& fabric, const Knit& knit, const Thread& thread, KnitField field,
                   KnitMoves moves, Vec2 half)
      : fabric_(fabric),
        knit_(knit),
        thread_(thread),
        field_(std::move(field)),
        moves_(std::move(moves)),
        half_(std::move(half)) {}

  [[nodiscard]] std::size_t count() const override {
    return static_cast<std::size_t>(field_.last_course - field_.first_course + 1);
  }
  [[nodiscard]] std::string name(std::size_t index) const override {
    return fmt::format("course_{}", course(index) + 1);
  }
  [[nodiscard]] const Thread& thread(std::size_t /*index*/) const override { return thread_; }
  [[nodiscard]] std::uint64_t data_points() const override {
    return count() * longest();  // below 2^64: counts are below 2^31
  }
  [[nodiscard]] std::uint64_t longest() const override {
    constexpr std::uint64_t points_a_loop = 8;
    return points_a_loop * wales() + 1;
  }
  [[nodiscard]] Result<YarnPlan> plan(std::size_t index) const override;
  [[nodiscard]] Repeat repeat() const override {
    const StitchChart& chart = field_.chart;
    return {static_cast<double>(chart.repeat_of_wales()) * wale_spacing * half_.x(),
            static_cast<double>(chart.repeat_of_courses()) * course_spacing * half_.x(), std::nullopt};
  }

 private:
  [[nodiscard]] long long course(std::size_t index) const {
    return field_.first_course + static_cast<long long>(index);
  }
  [[nodiscard]] std::uint64_t wales() const {
    return static_cast<std::uint64_t>(field_.last_wale - field_.first_wale + 1);
  }

  const Fabric& fabric_;
  const Knit& knit_;
  const Thread& thread_;
  KnitField field_;
  KnitMoves moves_;
  Vec2 half_;  // of the section: r across, and r through the thickness
};

Result<YarnPlan> KnitConstruction::plan(std::size_t index) const {
  Result<YarnPlan> plan = start_plan(fabric_, thread_, name(index), Role::course, knit_.place);
  if (!plan) return plan;
  const double r = half_.x();
  plan->at.y() = static_cast<double>(course(index)) * (course_spacing * r);
  std::vector<Vec3>& points = plan->points;
  points.reserve(8 * wales() + 1);
  const auto place_from = [&](std::size_t first, long long wale) {
    for (std::size_t i = first; i < points.size(); ++i) {
      const Vec3 base = points[i];
      points[i] = {std::fma(static_cast<double>(wale), wale_spacing * r, base.x() * r), base.y() * r,
                   base.z() * half_.y()};
    }
  };
  for (long long wale = field_.first_wale; wale <= field_.last_wale; ++wale) {
    const std::size_t first = points.size();
    add_stitch_points(field_, course(index), wale, points);
    moves_.apply(course(index), wale, points, first);
    place_from(first, wale);
  }
  points.push_back(last_sinker_point(field_, course(index)));
  moves_.apply(course(index), field_.last_wale + 1, points, points.size() - 1);
  place_from(points.size() - 1, field_.last_wale + 1);
  plan->spec.guide = yarn::FrameGuide::with_up(Vec3::UnitZ());
  Onward onward;  // loops that move alike are all of one form
  if (moves_.wales_go_on()) onward = {(points.size() - 1) / wales(), {wale_spacing * r, 0, 0}};
  plan->line = course_line(points, knit_.method.value_or(nurbs::Parameterization::chord), onward);
  return plan;
}

// The moves that part the loops. A warning where they cannot.
KnitMoves moves_of(const Fabric& fabric, const Knit& knit, const yarn::Section& section,
                   const KnitField& field, const BuildOptions& options, Diagnostics& diagnostics) {
  const auto warn = [&](std::string text) {
    diagnostics.add(warning(Kind::geometry, std::move(text)).placed(knit.place, fabric.file));
  };
  const yarn::SectionSize size = yarn::nominal_size(section);
  if (!(size.width > 0.0) || !(size.height > 0.0)) return {};
  if (const long long loops = KnitMoves::loops_solved(field); loops > most_solved) {
    warn(
        fmt::format("the chart's repeat is too large for its loops to be moved apart ({} loops that differ, "
                    "at most {}): they are as published, and overlap",
                    loops, most_solved));
    return {};
  }
  // A hundredth of the thickness (or the wanted gap) is left between two yarns, or twice the tolerance where
  // that is more; each surface may lie outside of its yarn by the tolerance.
  const double tolerance = tolerance_of(fabric, {});
  const double share = options.gap > 0.0 ? options.gap : least_gap_share * std::min(size.width, size.height);
  const double gap = std::max(share, 2.0 * tolerance);
  KnitMoves moves(field, {.how = knit.method.value_or(nurbs::Parameterization::chord),
                          .section = section,
                          .half = Vec2(size.width / 2, size.height / 2),
                          .turns = section_twist(*fabric.find_thread(knit.thread), fabric.units) != 0.0 &&
                                   !std::holds_alternative<yarn::Circle>(section),
                          .gap = gap + 2.0 * tolerance});
  const Mending& mending = moves.mending();
  if (mending.is_solved()) return moves;
  const double left = gap + 2.0 * tolerance - 0.5 * mending.missing * size.width;
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

}  // namespace

Result<std::unique_ptr<Construction>> make_knit(const Fabric& fabric, const Knit& knit,
                                                const BuildOptions& options, Diagnostics& diagnostics) {
  Result<StitchChart> chart = StitchChart::of(knit);
  if (!chart) return chart.error().placed(knit.place);
  const Thread* thread = fabric.find_thread(knit.thread);
  if (thread == nullptr)
    return error(Kind::geometry, fmt::format("there is no thread '{}'", knit.thread))
        .placed(knit.thread_place);
  Result<yarn::Section> section = centred_section_of(*thread, fabric.units);
  if (!section) return section.error().placed(knit.thread_place);
  const yarn::SectionSize size = yarn::nominal_size(*section);
  const long long beside = fabric.cell ? margin_wales : 0;
  // The loops of courses below reach up into the cell as far as they are held, and one course further.
  const long long beyond = fabric.cell ? chart->longest_hold() + 2 + border_courses(*chart) : 0;
  KnitField field{std::move(*chart), -beyond, knit.courses - 1 + beyond, -beside, knit.wales - 1 + beside};
  const Vec2 half(size.width / 2, size.height / 2);
  KnitMoves moves;
  if (!options.as_published) moves = moves_of(fabric, knit, *section, field, options, diagnostics);
  return std::unique_ptr<Construction>(
      std::make_unique<KnitConstruction>(fabric, knit, *thread, std::move(field), std::move(moves), half));
}

}  // namespace selvage::fabric
