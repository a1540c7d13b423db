#include "braid/braid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "braid/fit.h"
#include "braid/mandrel.h"
#include "braid/planar.h"
#include "braid/shape.h"
#include "core/wrapped.h"
#include "fabric/build_options.h"
#include "fabric/clearance.h"
#include "fabric/quantities.h"
#include "fabric/yarn_spec.h"
#include "nurbs/interpolate.h"

namespace selvage::fabric {

namespace {

using std::numbers::pi;
// Crossing yarns keep this share of the braiders' thickness apart, and at least what the file's tolerance may
// take from them.
constexpr double clearance = 1.0 / 200.0;
// Longest rest of a braider at a crossing, in steps on each side: the remaining 0.3 are its way to the other
// side.
constexpr double longest_plateau = 0.35;
// Degrees; beyond, the braiders of a strip lie on each other at its edges.
constexpr double steepest_strip = 80.0;

// Of a section, where the gap of crossing yarns is measured.
constexpr int outline_points = 64;

// For messages: four digits, never less than the value.
double rounded_up(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 3.0);
  return std::ceil(value / unit * (1.0 - 1e-9)) * unit;
}

class BraidConstruction : public Construction {
 public:
  BraidConstruction(const Fabric& fabric, const Braid& braid, const Thread& thread, const Thread* axial,
                    const BraidShape& shape, int points, std::optional<Mandrel> mandrel)
      : fabric_(fabric),
        braid_(braid),
        thread_(thread),
        axial_(axial),
        shape_(shape),
        mandrel_(std::move(mandrel)),
        points_(points) {
    const std::int64_t period = std::int64_t{shape.over} + shape.under;
    repeat_ = shape.flat ? 2 : period;
    class_count_ = period % 2 == 0 ? period / 2 : period;
    // A cell cuts a braid that goes on beyond it; a mandrel ends.
    const bool goes_on = fabric.cell.has_value() && !mandrel_;
    const double more = goes_on ? static_cast<double>(repeat_) * shape.step : 0.0;
    first_repeat_ = goes_on ? -1 : 0;
    begin_ = -more;
    end_ = (mandrel_ ? mandrel_->length() : braid.length) + more;
  }

  [[nodiscard]] std::size_t count() const override { return braiders() + axials(); }

  [[nodiscard]] Vec2 unit() const override { return Vec2::Zero(); }
  [[nodiscard]] std::string system(std::size_t index) const override {
    return index < braiders() ? "braider" : "axial";
  }

  [[nodiscard]] std::string name(std::size_t index) const override {
    return index < braiders() ? fmt::format("braider_{}", index + 1)
                              : fmt::format("axial_{}", index - braiders() + 1);
  }

  [[nodiscard]] const Thread& thread(std::size_t index) const override {
    return index < braiders() ? thread_ : *axial_;
  }

  [[nodiscard]] std::uint64_t data_points() const override {
    const double all = points_of_a_braider() * static_cast<double>(braiders()) +
                       points_of_an_axial() * static_cast<double>(axials());
    return static_cast<std::uint64_t>(std::min(all, most_points));
  }
  [[nodiscard]] std::uint64_t longest() const override {
    return static_cast<std::uint64_t>(std::min(points_of_a_braider(), most_points));
  }

  [[nodiscard]] Result<YarnPlan> plan(std::size_t index) const override {
    const bool is_braider = index < braiders();
    Result<YarnPlan> plan = start_plan(fabric_, thread(index), name(index),
                                       is_braider ? Role::braider : Role::axial, braid_.place);
    if (!plan) return plan;
    plan->spec.guide = shape_.flat ? yarn::FrameGuide::with_up(Vec3::UnitZ())
                                   : yarn::FrameGuide::about_axis(Vec3::Zero(), Vec3::UnitZ());
    if (mandrel_ && mandrel_->is_straight())
      plan->spec.guide = yarn::FrameGuide::about_axis(mandrel_->origin(), mandrel_->direction());
    if (is_braider) {
      if (Status made = place_braider(*plan, static_cast<std::int64_t>(index)); !made) return made.error();
      return plan;
    }
    if (Status made = place_axial(*plan, static_cast<std::int64_t>(index - braiders())); !made)
      return made.error();
    return plan;
  }

  // Braiders are two columns apart, and who is on top at a crossing depends on its column alone: after two
  // steps each has taken the place of the next one. (A single-thread braid: all have the same.)
  [[nodiscard]] Repeat repeat() const override {
    const double along = 2.0 * shape_.step;
    if (mandrel_) return {};
    if (shape_.flat) return {along, std::nullopt, std::nullopt};
    return {std::nullopt, std::nullopt, along};
  }

 private:
  static constexpr double most_points = 1e18;  // that a 64-bit count holds with room to spare
  [[nodiscard]] double points_of_a_braider() const {
    return std::ceil((end_ - begin_) / shape_.step * points_) + 2.0;
  }
  static constexpr double axial_points_a_step = 4.0;  // on a mandrel, whose generatrices bend
  [[nodiscard]] double points_of_an_axial() const {
    return mandrel_ ? std::ceil((end_ - begin_) / shape_.step * axial_points_a_step) + 1.0 : 2.0;
  }
  [[nodiscard]] std::size_t braiders() const { return static_cast<std::size_t>(shape_.carriers); }
  [[nodiscard]] std::size_t axials() const { return static_cast<std::size_t>(braid_.axial_count); }

  // How a braider follows from one of the first ones of its kind: a strip's by its place on the way there and
  // back, a tube's by a rotation.
  struct Copy {
    Braider original;
    std::int64_t ahead = 0;  // steps on a strip's way
    Vec2 turn = Vec2(1.0, 0.0);
  };
  [[nodiscard]] Copy copy_of(std::int64_t index) const {
    const std::int64_t carriers = shape_.carriers;
    if (shape_.flat) return {{0, 1}, 2 * index, Vec2(1.0, 0.0)};
    const std::int64_t half = carriers / 2;
    const std::int64_t place = index % half, original = place % class_count_;
    return {{2 * original, index < half ? 1 : -1}, 0, unit_at(2 * (place - original), carriers)};
  }

  [[nodiscard]] BraidPoint point(const Copy& copy, double t) const {
    BraidPoint point = braid_point(shape_, copy.original, t);
    const auto turned = [&](const Vec3& v) {
      return Vec3(copy.turn.x() * v.x() - copy.turn.y() * v.y(),
                  copy.turn.y() * v.x() + copy.turn.x() * v.y(), v.z());
    };
    if (!shape_.flat) point = {turned(point.position), turned(point.derivative)};
    return point;
  }

  [[nodiscard]] Status place_braider(YarnPlan& plan, std::int64_t index) const {
    const Copy copy = copy_of(index);
    const int axis = shape_.flat ? 0 : 2;
    const std::int64_t round = 2 * std::int64_t{shape_.carriers} * points_;  // a strip's way in points
    const double pitch = static_cast<double>(repeat_) * shape_.step;
    const std::int64_t per_repeat = repeat_ * points_;
    std::vector<double> parameters;
    std::vector<Vec3> away;
    const auto add = [&](BraidPoint at, double along) {
      at.position[axis] = along;
      if (mandrel_) {
        const Mandrel::Place place = mandrel_->carried(at.position, at.derivative, shape_.radius);
        at = {place.position, place.derivative};
        away.push_back(place.out);
      }
      plan.points.push_back(at.position);
      parameters.push_back((along - begin_) / (end_ - begin_));
      return Vec3(at.derivative / shape_.step * (end_ - begin_));
    };
    const auto point_at = [&](std::int64_t k) {
      if (shape_.flat) k = wrapped(k + copy.ahead * points_, round);
      return point(copy, static_cast<double>(k) / points_ - 0.5);
    };
    Vec3 first = Vec3::Zero();
    const double room = 0.25 * shape_.step / points_;  // the last point stands no nearer to its neighbour
    for (std::int64_t k = first_repeat_ * per_repeat;; ++k) {
      const std::int64_t within = wrapped(k, per_repeat);
      const std::int64_t repeat = (k - within) / per_repeat;
      const double base = static_cast<double>(within) * shape_.step / points_;
      const double along = base + static_cast<double>(repeat) * pitch;
      if (along > end_ - room && !plan.points.empty()) break;
      const Vec3 derivative = add(point_at(k), along);
      if (plan.points.size() == 1) first = derivative;
    }
    const double last_t = end_ / shape_.step - 0.5 + static_cast<double>(copy.ahead);
    const Vec3 last = add(point(copy, last_t), end_);
    parameters.back() = 1.0;
    plan.line.curve = nurbs::interpolate(plan.points, parameters, first, last);
    plan.line.parameters = std::move(parameters);
    return mandrel_ && !mandrel_->is_straight() ? hold_up(plan, away) : Status();
  }

  // Along a generatrix.
  [[nodiscard]] Status place_on_mandrel(YarnPlan& plan, const Vec2& out) const {
    const auto steps = static_cast<int>(points_of_an_axial()) - 1;
    std::vector<Vec3> away;
    std::vector<double> parameters;
    Vec3 first = Vec3::Zero(), last = Vec3::Zero();
    for (int i = 0; i <= steps; ++i) {
      parameters.push_back(static_cast<double>(i) / steps);
      const Vec3 on_tube(shape_.radius * out.x(), shape_.radius * out.y(), end_ * parameters.back());
      const Mandrel::Place place = mandrel_->carried(on_tube, end_ * Vec3::UnitZ(), shape_.radius);
      plan.points.push_back(place.position);
      away.push_back(place.out);
      if (i == 0) first = place.derivative;
      last = place.derivative;
    }
    plan.line.curve = nurbs::interpolate(plan.points, parameters, first, last);
    plan.line.parameters = std::move(parameters);
    return mandrel_->is_straight() ? Status() : hold_up(plan, away);
  }

  [[nodiscard]] Status place_axial(YarnPlan& plan, std::int64_t index) const {
    const std::int64_t runs = run_count(shape_);
    const Run run = run_of(shape_, index * runs / braid_.axial_count);
    if (mandrel_)
      return place_on_mandrel(plan, unit_at(run.first + run.last, 2 * std::int64_t{shape_.carriers}));
    for (const double along : {begin_, end_}) {
      if (shape_.flat) {
        plan.points.emplace_back(along, shape_.column * (run.middle() - 0.5 * shape_.carriers), 0.0);
      } else {
        const Vec2 out = shape_.radius * unit_at(run.first + run.last, 2 * std::int64_t{shape_.carriers});
        plan.points.emplace_back(out.x(), out.y(), along);
      }
    }
    const Vec3 axis = shape_.flat ? Vec3::UnitX() : Vec3::UnitZ();
    return interpolate(plan, yarn::PathForm::chord, axis, axis);
  }

  const Fabric& fabric_;
  const Braid& braid_;
  const Thread& thread_;
  const Thread* axial_;
  BraidShape shape_;
  std::optional<Mandrel> mandrel_;
  int points_;               // data points a step
  std::int64_t repeat_ = 1;  // steps after which the pattern is there again (a tube's turned)
  std::int64_t class_count_ = 1;
  std::int64_t first_repeat_ = 0;
  double begin_ = 0, end_ = 0;
};

Status check_counts(const Braid& braid, const BraidShape& shape) {
  if (braid.flat && braid.angle > steepest_strip)
    return error(
               Kind::geometry,
               fmt::format("braiders at {:.6g} degrees to the axis of a strip turn back on themselves at its "
                           "edges: at most {:.4g} degrees",
                           braid.angle, steepest_strip))
        .placed(braid.radius_place);
  const std::int64_t period = std::lcm(std::int64_t{2}, std::int64_t{braid.over} + braid.under);
  if (!shape.flat && braid.carriers % period != 0)
    return error(
               Kind::geometry,
               fmt::format("the pattern {}/{} does not {} {} carriers: it takes a multiple of {}, such as {}",
                           braid.over, braid.under,
                           shape.planar ? "repeat in a planar braid of" : "close round a tube of",
                           braid.carriers, period, (braid.carriers / period + 1) * period))
        .placed(braid.carriers_place);
  const std::int64_t runs = run_count(shape);
  if (braid.axial_count > runs)
    return error(Kind::geometry,
                 fmt::format("{} axial yarns are too many: between {} carriers in the pattern {}/{} there "
                             "is room for {} (one wherever the same braiders stay on top)",
                             braid.axial_count, braid.carriers, braid.over, braid.under, runs))
        .placed(braid.axial_place);
  return {};
}

// Braiders side by side need `width` across the yarn.
Status check_widths(const Braid& braid, const BraidShape& shape, double width, std::string_view unit) {
  const double cosine = std::cos(braid.angle / 180.0 * pi);
  if (2.0 * shape.column * cosine >= width * (1.0 - 1e-9)) return {};
  const double needed = 0.5 * width / cosine;  // a column
  if (shape.planar)
    return error(Kind::geometry,
                 fmt::format(
                     "{} carriers whose braiders are {:.4g} {} wide do not fit side by side into this "
                     "width: at {:.4g} degrees it has to be at least {:.4g} {}",
                     braid.carriers, width, unit, braid.angle, rounded_up(needed * braid.carriers), unit))
        .placed(braid.radius_place);
  if (shape.flat)
    return error(
               Kind::geometry,
               fmt::format(
                   "{} braiders {:.4g} {} wide do not fit side by side into this strip: at {:.4g} degrees it "
                   "has to be at least {:.4g} {} wide",
                   braid.carriers, width, unit, braid.angle,
                   rounded_up(strip_columns(shape, braid.angle) * needed + width), unit))
        .placed(braid.radius_place);
  return error(Kind::geometry,
               fmt::format(
                   "{} braiders {:.4g} {} wide do not fit side by side round a radius of {:.4g} {} at {:.4g} "
                   "degrees: the radius has to be at least {:.4g} {}, or the braiders at most {:.4g} {} wide",
                   braid.carriers, width, unit, shape.radius, unit, braid.angle,
                   rounded_up(needed * braid.carriers / (2.0 * pi)), unit, 2.0 * shape.column * cosine, unit))
      .placed(braid.radius_place);
}

// The mandrel has room for the innermost yarns.
Status check_radius(const Braid& braid, double reach, std::string_view unit) {
  if (braid.flat || braid.planar || braid.radius > reach) return {};
  return error(Kind::geometry,
               fmt::format("a radius of {:.4g} {} leaves no room for the yarns inside: the cloth's middle "
                           "surface needs more than {:.4g} {}",
                           braid.radius, unit, rounded_up(reach), unit))
      .placed(braid.radius_place);
}

// Step, columns and the rest at crossings, for braiders of this size.
BraidShape shape_of(const Braid& braid, const yarn::SectionSize& size) {
  BraidShape shape;
  shape.flat = braid.flat;
  shape.planar = braid.planar;
  shape.carriers = braid.carriers;
  shape.over = braid.over;
  shape.under = braid.under;
  shape.radius = braid.radius;
  const double angle = braid.angle / 180.0 * pi;
  if (!braid.flat && !braid.planar)
    shape.column = 2.0 * pi * braid.radius / braid.carriers;
  else if (braid.planar && braid.width > 0.0)
    shape.column = braid.width / braid.carriers;
  else if (braid.width > 0.0)
    shape.column = (braid.width - size.width) / strip_columns(shape, braid.angle);
  else
    shape.column = 0.5 * (size.width + size.height) / std::cos(angle);
  shape.step = shape.column / std::tan(angle);
  // Over the flat part of a wide section the crossing yarn rests; what is left of the step is its slope.
  const double flat_part = std::max(size.width - size.height, 0.0);
  const double rest = 0.5 * flat_part * (1.0 + std::abs(std::cos(2.0 * angle))) / std::sin(2.0 * angle);
  shape.plateau = std::min(rest * std::cos(angle) / shape.step, longest_plateau);
  return shape;
}

// The tube that the braid is like at a place of a mandrel, on the inside of its bend: the carriers turn at
// one rate while the mandrel is drawn through at one speed, so that steps are equal along the axis, and the
// tangent of the angle grows with the radius.
Braid tube_at(const Braid& braid, const Mandrel& mandrel, double s, bool inside) {
  Braid tube = braid;
  tube.radius = mandrel.radius(s);
  tube.length = mandrel.length();
  const double shortened = inside ? 1.0 - tube.radius * mandrel.curvature(s) : 1.0;
  const double tangent = std::tan(braid.angle / 180.0 * pi) * tube.radius / mandrel.radius(0.0) / shortened;
  tube.angle = std::atan(tangent) / pi * 180.0;
  return tube;
}

// Data points a step: even, so that crossings and the ends are among them; enough for the slope between two
// crossings, 5 degrees of the helix, the turns of a strip.
int points_of(const BraidShape& shape) {
  constexpr double on_slope = 6.0, round = 72.0, steep = 8.0;
  double points = std::max(12.0, on_slope / (1.0 - 2.0 * shape.plateau));
  if (shape.flat)
    points = std::max(points, std::min(steep * shape.column / shape.step, 1000.0));
  else if (!shape.planar)
    points = std::max(points, round / shape.carriers);
  return 2 * static_cast<int>(std::ceil(0.5 * points));
}

}  // namespace

Result<std::unique_ptr<Construction>> make_braid(const Fabric& fabric, const Braid& braid,
                                                 const BuildOptions& options, Diagnostics& diagnostics) {
  const Thread& thread = *fabric.find_thread(braid.thread);
  const Thread* axial = braid.axial_count > 0 ? fabric.find_thread(braid.axial_thread) : nullptr;
  const std::string_view unit = name_of(fabric.units);
  const auto outline_of = [&](const Thread& of, TextPlace place) -> Result<std::vector<Vec2>> {
    const Result<yarn::Section> section = centred_section_of(of, fabric.units);
    const Status checked =
        section ? yarn::check_section(*section, yarn::nominal_size(*section)) : Status(section.error());
    if (!checked)
      return error(Kind::geometry, fmt::format("thread '{}': {}", of.name, checked.error().text))
          .placed(place);
    return dense_outline_polygon(*section, outline_points);
  };
  const Result<std::vector<Vec2>> outline = outline_of(thread, braid.thread_place);
  if (!outline) return outline.error();
  Result<std::vector<Vec2>> axial_outline = std::vector<Vec2>();
  if (axial != nullptr) axial_outline = outline_of(*axial, braid.axial_place);
  if (!axial_outline) return axial_outline.error();

  const yarn::SectionSize size = yarn::nominal_size(*centred_section_of(thread, fabric.units));
  const double inlay =
      axial == nullptr ? 0.0 : yarn::nominal_size(*centred_section_of(*axial, fabric.units)).height;
  // The tubes that the braid has to fit on: itself, or those of a mandrel from place to place.
  std::optional<Mandrel> mandrel;
  std::vector<Braid> tubes = {braid};
  double inclination =
      1.0;  // heights are away from the axis: across a wall that widens yarns are nearer by so much
  if (!braid.mandrel.empty()) {
    Result<Mandrel> made = Mandrel::make(braid.mandrel, braid.radius_place);
    if (!made) return made.error();
    mandrel = std::move(*made);
    tubes.clear();
    const int places = 8 * static_cast<int>(braid.mandrel.size() - 1);
    for (int i = 0; i <= places; ++i) {
      const double s = mandrel->length() * i / places;
      inclination = std::max(inclination, std::hypot(1.0, mandrel->slope(s)));
      tubes.push_back(tube_at(braid, *mandrel, s, false));
      if (!mandrel->is_straight()) tubes.push_back(tube_at(braid, *mandrel, s, true));
    }
  }
  const double wanted = std::max(options.gap > 0.0 ? options.gap : clearance * size.height,
                                 2.0 * fabric.tolerance.value_or(0.0));
  std::optional<BraidShape> all;
  double gap = std::numeric_limits<double>::infinity();
  for (const Braid& tube : tubes) {
    BraidShape shape = shape_of(tube, size);
    const double least = 0.5 * (size.height + inlay);
    if (Status fits = check_counts(tube, shape); !fits) return fits.error();
    const auto check = [&](std::string_view what, double distance) {
      return check_proportion(what, distance, size.width, fabric.units, braid.radius_place);
    };
    if (Status fits = check("a radius", tube.flat || tube.planar ? size.width : tube.radius); !fits)
      return fits.error();
    if (Status fits = check("a width", tube.width > 0.0 ? tube.width : size.width); !fits)
      return fits.error();
    if (Status fits = check_radius(tube, least + 0.5 * size.height, unit); !fits) return fits.error();
    if (Status fits = check_widths(tube, shape, size.width, unit); !fits) return fits.error();
    if (Status fits = check("the way from crossing to crossing, by the angle,", shape.step); !fits)
      return fits.error();
    gap = std::min(gap, fit_amplitude(shape, least, wanted, *outline, *axial_outline));
    if (Status fits = check_radius(tube, shape.amplitude + 0.5 * size.height, unit); !fits)
      return fits.error();
    if (!all) {
      all = shape;
      continue;
    }
    all->amplitude = std::max(all->amplitude, shape.amplitude);
    all->plateau = std::max(all->plateau, shape.plateau);
  }
  all->amplitude *= inclination;
  if (gap < 0.5 * wanted) {
    const std::string found = gap > 0.0 ? fmt::format("come as near as about {:.2g} {}", gap, unit)
                                        : fmt::format("overlap, by about {:.2g} {}", -gap, unit);
    diagnostics.add(
        warning(Kind::geometry,
                fmt::format("crossing yarns have too little room and {}: fewer carriers, narrower "
                            "yarns or a larger {} give it",
                            found, braid.flat || braid.planar ? "width" : "radius"))
            .placed(braid.place, fabric.file));
  }
  if (braid.planar) return make_planar_braid(fabric, braid, thread, axial, *all, points_of(*all));
  return std::unique_ptr<Construction>(std::make_unique<BraidConstruction>(
      fabric, braid, thread, axial, *all, points_of(*all), std::move(mandrel)));
}

}  // namespace selvage::fabric
