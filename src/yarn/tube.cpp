#include "yarn/tube.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "nurbs/divided.h"
#include "yarn/channels.h"
#include "yarn/frame.h"
#include "yarn/size_profile.h"
#include "yarn/stretch_fit.h"

namespace selvage::yarn {

namespace {

using std::numbers::pi;

// Of so many pieces to a quarter.
double outline_error(const TubeSpec& spec, const SizeProfile& sizes, const SectionSize& size, int pieces) {
  const bool varying = sizes.parameters().size() > 1 && !is_affine(spec.section);
  return outline_error(spec.section, size, make_outline(spec.section, size, pieces, varying));
}

// How many pieces to a quarter give the smallest net: fewer leave less of the tolerance to the sections,
// whose number grows with the fourth root of its inverse.
Result<int> choose_pieces(const TubeSpec& spec, const SizeProfile& sizes) {
  if (is_exact(spec.section)) return 1;
  const bool varying = sizes.parameters().size() > 1;
  std::vector<SectionSize> all;
  for (double t : sizes.parameters()) {
    const SizeProfile::Values v = sizes.at(t).value;
    all.push_back({v[0], v[1]});
  }
  if (varying && is_affine(spec.section)) {  // every smaller size deviates less
    SectionSize largest;
    for (const SectionSize& s : all)
      largest = {std::max(largest.width, s.width), std::max(largest.height, s.height)};
    all = {largest};
  } else {  // no need to look at one size twice
    std::sort(all.begin(), all.end(), [](const SectionSize& a, const SectionSize& b) {
      return a.width != b.width ? a.width < b.width : a.height < b.height;
    });
    all.erase(std::unique(all.begin(), all.end()), all.end());
  }
  double best_cost = std::numeric_limits<double>::infinity();
  int best = 0, worse = 0;
  for (int pieces = 2; pieces <= 4096 && worse < 3; pieces += pieces < 64 ? 1 : pieces / 16) {
    double error = 0.0;
    for (const SectionSize& s : all) error = std::max(error, outline_error(spec, sizes, s, pieces));
    if (error > 0.95 * spec.tolerance) continue;
    const double cost = pieces * std::pow(1.0 - error / spec.tolerance, -0.25);
    if (cost < best_cost) {
      best_cost = cost;
      best = pieces;
    } else {
      ++worse;
    }
  }
  if (best == 0)
    return error(
        Kind::limit,
        fmt::format("the tolerance {:.3g} would need more than 16000 control points round the section",
                    spec.tolerance));
  return best;
}

// The ends of the stretches, and the spans that each of them has at least: samples have to see every turn, so
// none turns by more than a quarter.
struct Breaks : Stretches {
  double rows = 2;  // of control points; no more breaks than for `most` of them
};
Breaks breaks_of(const CentreLine& path, const FrameField& frames, const SizeProfile& sizes, double twist,
                 const DecimalGrid& grid, double most) {
  std::vector<double> marks = nurbs::breakpoints(path.curve.knots, path.curve.degree);
  for (double t : sizes.parameters())
    if (t > 0.0 && t < 1.0) marks.push_back(t);
  std::sort(marks.begin(), marks.end());
  Breaks breaks;
  std::vector<double> ends;
  // The same place of the path and of the sizes is one end: as the grid has it.
  for (double t : marks)
    if (const double end = grid.rounded(t); ends.empty() || end - ends.back() > 1e-9) ends.push_back(end);
  ends.back() = 1.0;
  breaks.at = {ends.front()};
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const double from = ends[k], to = ends[k + 1];
    double turn = std::abs(sizes.at(to).value[2] - sizes.at(from).value[2]);
    if (twist != 0.0) turn += std::abs(twist) * (frames.length_at(to) - frames.length_at(from));
    turn += frames.turn_between(from, to);
    const double spans = std::max(1.0, std::ceil(turn / (pi / 2))), parts = std::ceil(spans / most_spans);
    breaks.rows += spans + parts;
    if (breaks.rows > most) return breaks;
    for (int i = 1; i <= static_cast<int>(parts); ++i) {
      breaks.at.push_back(i < parts ? grid.rounded(from + (to - from) * i / parts) : to);
      breaks.least.push_back(static_cast<int>(std::ceil(spans / parts)));
    }
  }
  return breaks;
}

// On a closed path the section has to come back to itself: whole turns only.
double whole_turns(double twist, const FrameField& frames, Body& body) {
  const double turns = twist * frames.length() / (2.0 * pi), whole = std::round(turns);
  if (std::abs(turns - whole) > 1e-9)
    body.messages.push_back(
        warning(Kind::geometry,
                fmt::format("yarn '{}' is closed: its twist of {:.4g} turns was brought to {} whole turns",
                            body.name, turns, whole))
            .of_yarn(body.name, body.place));
  return whole * 2.0 * pi / frames.length();
}

// sweep(), whose errors do not yet say of which yarn they are.
Status swept(Body& body, const CentreLine& path, const TubeSpec& spec) {
  std::vector<double> at;
  std::vector<SizeProfile::Values> rows;
  for (const SizeAtParameter& s : spec.sizes) {
    if (Status checked = check_section(spec.section, s.size); !checked) return checked;
    at.push_back(s.parameter);
    rows.push_back({s.size.width, s.size.height, s.angle});
  }
  // Rows that all say the same are one row.
  if (std::all_of(rows.begin(), rows.end(), [&](const auto& r) { return r == rows.front(); })) {
    at.resize(1);
    rows.resize(1);
  }
  const SizeProfile sizes(at, rows, path.closed);
  Result<FrameField> frames = FrameField::make(path.curve, spec.guide, path.closed, spec.twist != 0.0);
  if (!frames) return frames.error();
  const double twist = path.closed && spec.twist != 0.0 ? whole_turns(spec.twist, *frames, body) : spec.twist;
  Result<int> pieces = choose_pieces(spec, sizes);
  if (!pieces) return pieces.error();
  const Channels channels(*frames, sizes, spec, twist, *pieces);
  if (!channels.has_common_knots())
    return error(Kind::unsupported,
                 "a racetrack section that is wider than high in one place and higher than wide in another "
                 "has no common B-spline; use `power` or `ellipse`");
  double section_error = 0.0;
  for (const SizeAtParameter& s : spec.sizes)
    section_error = std::max(section_error, outline_error(spec, sizes, s.size, *pieces));
  const std::size_t columns = channels.outline().points.size();
  const std::size_t most = spec.max_control_points / columns;
  const auto too_many = [&] {
    return error(
        Kind::limit,
        fmt::format("yarn '{}' would need more than {} sections of {} control points to stay within the "
                    "tolerance of {:.3g}: raise the tolerance{}",
                    body.name, most, columns, spec.tolerance,
                    twist != 0.0 ? ", lower the twist, or drop `rotate`" : ", or split the yarn"));
  };
  // Knots of few digits move rows along the tube by less than a hundred-thousandth of the tolerance.
  double polygon = 0.0;
  for (std::size_t i = 1; i < path.curve.points.size(); ++i)
    polygon += (path.curve.points[i] - path.curve.points[i - 1]).norm();
  const DecimalGrid knot_grid = spec.grid.step() > 0.0
                                    ? DecimalGrid(1e-5 * spec.tolerance / std::max(polygon, spec.tolerance))
                                    : DecimalGrid();
  const Breaks breaks = breaks_of(path, *frames, sizes, twist, knot_grid, static_cast<double>(most));
  if (breaks.rows > static_cast<double>(most)) return too_many();
  // A step's half by the rounding of points, another by that of the place that they are moved to.
  const double other_errors = section_error + 2.0 * spec.grid.reach();
  const std::optional<FittedRows> fit =
      fit_stretches(channels, path, breaks, knot_grid, spec.tolerance - other_errors, most);
  if (!fit) return too_many();

  nurbs::Surface& surface = body.surface;
  surface = {};
  surface.degree_u = channels.outline().degree;
  surface.degree_v = 3;
  surface.knots_u = channels.outline().knots;
  surface.knots_v = fit->knots;
  surface.count_u = static_cast<int>(columns);
  surface.count_v = static_cast<int>(fit->control.rows());
  surface.points.reserve(columns * static_cast<std::size_t>(surface.count_v));
  // Rounded, an oblique end would no more be flat.
  const auto is_oblique = [&](double t) {
    return !path.closed && (frames->at(t).tangent.cwiseAbs().array() > 1e-12).count() > 1;
  };
  const std::size_t last = fit->control.rows() - 1;
  const bool keeps_first = is_oblique(0.0), keeps_last = is_oblique(1.0);
  for (std::size_t j = 0; j <= last; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      const Vec3 point = channels.blend(fit->control.row(j), i);
      const bool keeps = (j == 0 && keeps_first) || (j == last && keeps_last);
      surface.points.push_back(keeps ? point : spec.grid.rounded(point));
    }
  body.axis = path.curve;
  body.closed_along = path.closed;
  body.quarters = channels.outline().quarters;
  body.tube_error = other_errors + fit->error;
  body.tolerance = spec.tolerance;
  return {};
}

}  // namespace

Status sweep(Body& body, const CentreLine& path, const TubeSpec& spec) {
  Status made = swept(body, path, spec);
  if (!made) return made.error().of_yarn(body.name, body.place);
  return made;
}

}  // namespace selvage::yarn
