// The statement `pucker` of a weave: pucker.h is the surface on which its yarns lie.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fabric/clearance.h"
#include "nurbs/basis.h"
#include "nurbs/interpolate.h"
#include "weave/construction.h"

namespace selvage::fabric {

namespace {

// Of each span of the flat line, and of a wave.
constexpr int looks_a_span = 8, looks_a_wave = 48;
// Of half the cloth's thickness to the surface's least radius: beyond, yarns inside a bend have no room.
constexpr double most_surface_bend = 0.8;
// Heights over the middle surface are raised by these steps until yarns that cross keep three quarters of the
// clearance.
constexpr double lift_step = 1.025, highest_lift = 1.5, least_share = 0.75;
constexpr double steepest = 1.5;  // amplitude by a quarter of a wave, where looking for it ends

std::vector<double> places_on(const nurbs::Curve& line, double length, double wave) {
  const std::vector<double> breaks = nurbs::breakpoints(line.knots, line.degree);
  std::vector<double> places = {breaks.front()};
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    const double share = (breaks[k + 1] - breaks[k]) / (breaks.back() - breaks.front());
    const int looks =
        std::max(looks_a_span, static_cast<int>(std::ceil(share * length / wave * looks_a_wave)));
    for (int i = 1; i <= looks; ++i)
      places.push_back(i == looks ? breaks[k + 1] : breaks[k] + (breaks[k + 1] - breaks[k]) * i / looks);
  }
  return places;
}

double polygon_length(const std::vector<Vec3>& points) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

// The parameter at which a line is nearest to a place along x or y, as its data points tell.
double parameter_near(const YarnPlan& plan, int axis, double place) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < plan.points.size(); ++i)
    if (std::abs(plan.points[i][axis] - place) < std::abs(plan.points[best][axis] - place)) best = i;
  return plan.line.parameters[best];
}

SweptYarn swept_plan(const YarnPlan& plan, const PuckerShape& shape) {
  return {[&plan, &shape](double t) {
            const nurbs::CurveJet jet = nurbs::evaluate_jet(plan.line.curve, t);
            const Vec3 tangent = jet.d1.normalized(), normal = shape.normal(jet.position);
            const Vec3 up = (normal - normal.dot(tangent) * tangent).normalized();
            return SweptStation{jet.position, jet.d1, up.cross(tangent), up};
          },
          outline_polygon(plan.spec.section)};
}

}  // namespace

// The least gap of the yarns that cross in a stripe and over a wave.
Result<double> WeaveConstruction::puckered_gap() const {
  constexpr int stations = 32;
  const Block &warps = blocks_[0], &wefts = blocks_[1];
  const double pitch_x = weft_.text->pitch, pitch_y = warp_.text->pitch;
  std::vector<YarnPlan> across;
  const int picks = std::min(weave_.pucker->picks, weft_.text->count);
  for (int j = 0; j < picks; ++j) {
    Result<YarnPlan> weft = plan(wefts.first + static_cast<std::size_t>(j - wefts.begin));
    if (!weft) return weft.error();
    across.push_back(std::move(*weft));
  }
  double least = std::numeric_limits<double>::infinity();
  // The tight warps on both sides of the stripe, too, where the picks bend.
  for (int i = -1; i <= pucker_->slack && pucker_->tight + i < warp_.text->count; ++i) {
    const Result<YarnPlan> warp =
        plan(warps.first + static_cast<std::size_t>(pucker_->tight + i - warps.begin));
    if (!warp) return warp.error();
    const SweptYarn along = swept_plan(*warp, *pucker_);
    const double y = warp_.at(pucker_->tight + i);
    for (int j = 0; j < picks; ++j) {
      const double x = weft_.at(j);
      const double from = parameter_near(*warp, 0, x - 0.5 * pitch_x),
                   to = parameter_near(*warp, 0, x + 0.5 * pitch_x);
      const YarnPlan& weft = across[static_cast<std::size_t>(j)];
      const double near = parameter_near(weft, 1, y);
      const double reach = parameter_near(weft, 1, y + pitch_y) - parameter_near(weft, 1, y - pitch_y);
      const SweptYarn other = swept_plan(weft, *pucker_);
      const double low = parameter_near(weft, 1, y - 0.5 * pitch_y),
                   high = parameter_near(weft, 1, y + 0.5 * pitch_y);
      least = std::min({least, least_gap(along, from, to, stations, other, near, reach),
                        least_gap(other, low, high, stations, along, 0.5 * (from + to), to - from)});
    }
  }
  return least;
}

// The line and its thickness directions on the puckered surface.
Status WeaveConstruction::pucker(YarnPlan& plan) const {
  tell_from_origin(plan);
  const nurbs::Curve flat = plan.line.curve;
  const auto extent = (flat.points.back() - flat.points.front()).norm();
  std::vector<double> places =
      places_on(flat, extent, std::min(pucker_->wave, (pucker_->slack + 1) * pucker_->pitch));
  std::vector<Vec3> points, ups;
  for (const double t : places) {
    const Vec3 place = nurbs::evaluate(flat, t);
    points.push_back(pucker_->carried(place));
    ups.push_back(pucker_->normal(place));
  }
  const auto derivative = [&](double t, double towards) {
    const double step = 1e-5 * (towards - t);
    const Vec3 a = pucker_->carried(nurbs::evaluate(flat, t)),
               b = pucker_->carried(nurbs::evaluate(flat, t + step)),
               c = pucker_->carried(nurbs::evaluate(flat, t + 2.0 * step));
    return Vec3((4.0 * b - 3.0 * a - c) / (2.0 * step));
  };
  const Vec3 first = derivative(places.front(), places[1]),
             last = derivative(places.back(), places[places.size() - 2]);
  plan.points = points;
  plan.line.curve = nurbs::interpolate(points, places, first, last);
  plan.line.parameters = std::move(places);
  return hold_up(plan, ups);
}

// The amplitude at which the slack warps have the ratio of lengths, on average.
Status WeaveConstruction::prepare_pucker(Diagnostics& diagnostics) {
  const Pucker& text = *weave_.pucker;
  PuckerShape shape;
  shape.wave = text.picks * weft_.text->pitch;
  shape.pitch = warp_.text->pitch;
  shape.tight = text.tight;
  shape.slack = text.slack;
  if (text.tight + text.slack > warp_.text->count)
    return error(Kind::geometry, fmt::format("{} tight and {} slack warps are more than the {} of this weave",
                                             text.tight, text.slack, warp_.text->count))
        .placed(text.place);
  std::vector<std::vector<Vec3>> flat;  // the slack warps of the first stripe, as polygons
  const Block& warps = blocks_.front();
  for (int i = 0; i < text.slack; ++i) {
    const auto index = warps.first + static_cast<std::size_t>(text.tight + i - warps.begin);
    Result<YarnPlan> plan = plan_flat(index);
    if (!plan) return plan.error();
    tell_from_origin(*plan);
    const nurbs::Curve& line = plan->line.curve;
    const double extent = (line.points.back() - line.points.front()).norm();
    std::vector<Vec3>& polygon = flat.emplace_back();
    for (const double t : places_on(line, extent, shape.wave)) polygon.push_back(nurbs::evaluate(line, t));
  }
  double shortest = 0.0, longest = 0.0;
  const auto mean_ratio = [&](double amplitude) {
    shape.amplitude = amplitude;
    PuckerShape flat_cloth = shape;
    flat_cloth.amplitude = 0.0;
    double sum = 0.0;
    shortest = longest = 0.0;
    for (const std::vector<Vec3>& polygon : flat) {
      std::vector<Vec3> slack, tight;
      for (const Vec3& point : polygon) {
        slack.push_back(shape.carried(point));
        tight.push_back(flat_cloth.carried(point));
      }
      const double ratio = polygon_length(slack) / polygon_length(tight);
      sum += ratio;
      shortest = shortest == 0.0 ? ratio : std::min(shortest, ratio);
      longest = std::max(longest, ratio);
    }
    return sum / static_cast<double>(flat.size());
  };
  const double half = 0.5 * (layer_pitch_ - clearance_);
  const auto refuse = [&] {
    return error(Kind::geometry,
                 fmt::format(
                     "waves of {} picks with {} slack warps bend more tightly than the cloth is thick when "
                     "these "
                     "are {:.4g} times as long: more picks from wave to wave, more slack warps, or a smaller "
                     "ratio give room",
                     text.picks, text.slack, text.ratio))
        .placed(text.place);
  };
  double gap = 0.0;
  for (; shape.lift <= highest_lift; shape.lift *= lift_step) {
    double low = 0.0, high = steepest * 0.25 * shape.wave;
    if (mean_ratio(high) < text.ratio) return refuse();
    for (int step = 0; step < 50; ++step) {
      const double middle = 0.5 * (low + high);
      (mean_ratio(middle) < text.ratio ? low : high) = middle;
    }
    mean_ratio(high);
    if (shape.most_curvature() * half > most_surface_bend) return refuse();
    pucker_ = shape;
    Result<double> found = puckered_gap();
    if (!found) return found.error();
    gap = *found;
    if (gap >= least_share * clearance_) break;
  }
  if (gap < least_share * clearance_)
    return error(
               Kind::geometry,
               fmt::format(
                   "the yarns of the stripe, which cross askew in its waves, have no room to pass each other "
                   "(they come as near as {:.2g} {}): rounder yarns, a smaller ratio, or more picks and "
                   "slack "
                   "warps to a wave give it",
                   gap, name_of(fabric_.units)))
        .placed(text.place);
  diagnostics.add(
      note(
          Kind::geometry,
          fmt::format("the slack warps are {:.4g} times as long as they would be flat, those in the middle "
                      "of a stripe {:.4g} times, at its edges {:.4g}; waves stand {:.3g} {} out of the cloth",
                      text.ratio, longest, shortest, shape.amplitude, name_of(fabric_.units)))
          .placed(text.place, fabric_.file));
  return {};
}

}  // namespace selvage::fabric
