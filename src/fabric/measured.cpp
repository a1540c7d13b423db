#include "fabric/measured.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fabric/section_stack.h"
#include "nurbs/hermite.h"
#include "yarn/size_profile.h"
#include "yarn/tube.h"

namespace selvage::fabric {

namespace {

using std::numbers::pi;

// Of the smallest size: what sections may be off that are said to be alike, as a yarn's default tolerance.
constexpr double size_error = 1e-3;
constexpr double sharpest_turn = 150.0, sharpest_noisy_turn = 120.0;  // degrees

Message at_point(const MeasuredYarn& measured, std::size_t point, std::string text) {
  return error(Kind::malformed, std::move(text)).placed(measured.places[point]).of_yarn(measured.name);
}

bool is_ring(const MeasuredYarn& measured) {
  return measured.points.size() > 3 && measured.points.front() == measured.points.back();
}

// What is no number by itself is told by the readers; products of two may be out of their range.
Status check_numbers(const MeasuredYarn& measured) {
  constexpr double most = 1e100;
  const auto is_good = [](const Vec3& v) { return v.allFinite() && v.cwiseAbs().maxCoeff() < most; };
  for (std::size_t i = 0; i < measured.points.size(); ++i) {
    const bool good = is_good(measured.points[i]) &&
                      (measured.derivatives.empty() || is_good(measured.derivatives[i])) &&
                      (measured.sizes.empty() || !measured.sizes[i] ||
                       is_good(Vec3(measured.sizes[i]->width, measured.sizes[i]->height, 0.0)));
    if (!good) return at_point(measured, i, "the numbers of this point are out of the range of yarns");
    if (!measured.ups.empty() && !(is_good(measured.ups[i]) && measured.ups[i].squaredNorm() > 0.0))
      return at_point(measured, i,
                      "the thickness has no direction at this point: `up` is zero, or out of range");
  }
  return {};
}

Status check_line(const MeasuredYarn& measured, const std::optional<double>& noise) {
  const std::vector<Vec3>& p = measured.points;
  if (p.size() < 2)
    return at_point(measured, 0,
                    fmt::format("yarn '{}' has one point: a centre line has two at least", measured.name));
  for (std::size_t i = 1; i < p.size(); ++i)
    if (p[i] == p[i - 1])
      return at_point(measured, i, "this point equals the one before it: leave one of them out");
  const double sharpest = noise ? sharpest_noisy_turn : sharpest_turn;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const Vec3 in = p[i] - p[i - 1], out = p[i + 1] - p[i];
    if (noise && std::min(in.norm(), out.norm()) <= 2.0 * *noise) continue;
    const double turn = std::atan2(in.cross(out).norm(), in.dot(out)) * 180.0 / pi;
    if (turn > sharpest)
      return at_point(
          measured, i,
          fmt::format("the line of yarn '{}' doubles back on itself here, turning by {:.0f} degrees: its "
                      "points stand in the order of the yarn{}",
                      measured.name, turn,
                      noise ? "; what is noise is less than the error" : ", or give noise an `error`"));
  }
  return {};
}

// Turns of the given thickness directions against the frame that turns least, radians, one a point.
Result<std::vector<double>> turns_of(const MeasuredYarn& measured, const nurbs::Curve& curve, bool closed,
                                     const std::vector<double>& parameters) {
  std::vector<double> turns;
  const Result<yarn::FrameField> frames =
      yarn::FrameField::make(curve, yarn::FrameGuide::free_from(measured.ups.front()), closed);
  if (!frames) return frames.error();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const yarn::Frame frame = frames->at(parameters[i]);
    double turn = std::atan2(-measured.ups[i].dot(frame.across), measured.ups[i].dot(frame.up));
    if (i > 0) turn += 2.0 * pi * std::round((turns.back() - turn) / (2.0 * pi));
    turns.push_back(turn);
  }
  return turns;
}

// What the sizes along a line come to.
struct MeasuredSizes {
  std::vector<yarn::SizeAtParameter> all;
  double least = 0;      // width or height
  bool is_round = true;  // as high as wide everywhere
  [[nodiscard]] bool is_one() const { return all.size() == 1; }
};

MeasuredSizes sizes_of(const MeasuredYarn& measured, const std::vector<double>& parameters,
                       const std::vector<double>& turns) {
  MeasuredSizes sizes;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!measured.sizes[i]) continue;
    const SizeAt& at = *measured.sizes[i];
    const double angle = at.angle.value_or(0.0) / 180.0 * pi + (turns.empty() ? 0.0 : turns[i]);
    sizes.all.push_back({parameters[i], {at.width, at.height}, angle});
    const double least = std::min(at.width, at.height);
    sizes.least = sizes.least > 0.0 ? std::min(sizes.least, least) : least;
  }
  for (const yarn::SizeAtParameter& at : sizes.all)
    sizes.is_round = sizes.is_round && std::abs(at.size.width - at.size.height) <= size_error * sizes.least;
  if (sizes.is_round)
    for (yarn::SizeAtParameter& at : sizes.all) {
      at.angle = 0.0;
      at.size.width = at.size.height = 0.5 * (at.size.width + at.size.height);
    }
  return sizes;
}

std::optional<SizeAt> row_size(const yarn::SizeAtParameter& at) {
  const double degrees = at.angle / pi * 180.0;
  return SizeAt{at.size.width, at.size.height, degrees != 0.0 ? std::optional(degrees) : std::nullopt};
}

// The rows' sizes, and the section where they are sizes of it.
Status give_sizes(Yarn& yarn, Path& path, const MeasuredYarn& measured, bool takes_size) {
  if (measured.sizes.empty()) return {};
  const bool is_exact = !path.knots.empty();
  yarn::PathRows rows;
  rows.form = path.form;
  rows.points = path.points;
  rows.knots = path.knots;
  rows.error = path.error;
  rows.closed = yarn.closed;
  const Result<yarn::CentreLine> line = yarn::make_centre_line(rows);
  if (!line) return line.error();
  std::vector<double> parameters = line->parameters;
  if (is_exact) {
    parameters = measured.parameters;
    const double first = parameters.front(), length = parameters.back() - first;
    for (double& t : parameters) t = (t - first) / length;
  }
  std::vector<double> turns;
  if (!measured.ups.empty()) {
    Result<std::vector<double>> found = turns_of(measured, line->curve, yarn.closed, parameters);
    if (!found) return found.error();
    turns = std::move(*found);
  }
  MeasuredSizes sizes = sizes_of(measured, parameters, turns);
  if (sizes.all.empty()) return {};
  if (path.form != yarn::PathForm::smooth)
    sizes.all = yarn::sparse_sizes(sizes.all, size_error * sizes.least, yarn.closed);
  const yarn::SectionSize& first = sizes.all.front().size;
  if (takes_size && sizes.is_round) yarn.own.section = yarn::Circle{first.width};
  if (takes_size && !sizes.is_round) yarn.own.section = yarn::Ellipse{first.width, first.height};
  const bool is_said = takes_size && sizes.is_one() && std::abs(sizes.all.front().angle) < 1e-9;
  if (is_said) return {};
  path.sizes.resize(path.points.size());
  if (path.form == yarn::PathForm::smooth) {  // which takes as few of them as its error needs
    std::size_t next = 0;
    for (std::size_t i = 0; i < path.points.size(); ++i)
      if (measured.sizes[i]) path.sizes[i] = row_size(sizes.all[next++]);
    return {};
  }
  std::vector<double> at;
  std::vector<yarn::SizeProfile::Values> values;
  for (const yarn::SizeAtParameter& size : sizes.all) {
    at.push_back(size.parameter);
    values.push_back({size.size.width, size.size.height, size.angle});
  }
  const yarn::SizeProfile profile(at, values, yarn.closed);
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const auto [width, height, angle] = profile.at(line->parameters[i]).value;
    path.sizes[i] = row_size({0.0, {width, height}, angle});
  }
  return {};
}

Result<Yarn> line_of(const MeasuredYarn& measured, const std::optional<double>& error, bool takes_size) {
  const bool is_exact = !measured.derivatives.empty() && !error;
  if (!is_exact || measured.points.size() < 2)
    if (Status good = check_line(measured, error); !good) return good.error();
  Yarn yarn;
  yarn.closed = is_ring(measured);
  Path path;
  path.place = measured.places.front();
  if (is_exact) {
    const nurbs::Curve curve =
        nurbs::through_derivatives(measured.parameters, measured.points, measured.derivatives);
    path.form = yarn::PathForm::control;
    path.points = curve.points;
    path.knots = curve.knots;
    if (yarn.closed) path.points.back() = path.points.front();
    path.lines.assign(path.points.size(), path.place.line);
  } else {
    path.form = error ? yarn::PathForm::smooth : yarn::PathForm::chord;
    path.error = error.value_or(0.0);
    path.points = measured.points;
    for (const TextPlace& place : measured.places) path.lines.push_back(place.line);
    if (yarn.closed) path.points.pop_back();
    if (yarn.closed) path.lines.pop_back();
  }
  if (!measured.ups.empty()) yarn.up = measured.ups.front();
  if (Status given = give_sizes(yarn, path, measured, takes_size); !given)
    return given.error().placed(measured.places.front()).of_yarn(measured.name);
  yarn.shape = std::move(path);
  return yarn;
}

}  // namespace

Result<Yarn> yarn_of(const MeasuredYarn& measured, const std::optional<double>& error, bool takes_size) {
  if (Status good = check_numbers(measured); !good) return good.error();
  Yarn yarn;
  if (!measured.sections.empty()) {
    Result<Grid> grid = grid_of_outlines(measured);
    if (!grid) return grid.error();
    yarn.shape = std::move(*grid);
  } else {
    Result<Yarn> line = line_of(measured, error, takes_size);
    if (!line) return line;
    yarn = std::move(*line);
  }
  yarn.name = measured.name;
  yarn.role = measured.role;
  yarn.place = measured.places.front();
  return yarn;
}

Fabric fabric_of(const Measured& measured, const Source& source, Diagnostics& diagnostics) {
  TextReport report(source);
  Fabric fabric;
  fabric.file = source.name();
  fabric.units = measured.units.value_or(Unit::mm);
  fabric.units_given = measured.units.has_value();
  for (const MeasuredYarn& points : measured.yarns) {
    Result<Yarn> yarn = yarn_of(points, std::nullopt, true);
    if (!yarn) {
      report.error(spot_at(source, yarn.error().place), yarn.error().text, yarn.error().kind);
      continue;
    }
    const auto* path = std::get_if<Path>(&yarn->shape);
    if (path != nullptr && points.sizes.empty()) {
      report.error(
          spot_at(source, points.places.front()),
          fmt::format("nothing says how thick yarn {} is: add width and height, radius or diameter to its "
                      "points, or name the file in a text whose yarn has a thread: points FILE",
                      in_quotes(points.name)));
      continue;
    }
    fabric.items.emplace_back(std::move(*yarn));
  }
  report.hand_over(diagnostics);
  return fabric;
}

void scale(MeasuredYarn& measured, double factor) {
  for (Vec3& point : measured.points) point *= factor;
  for (Vec3& derivative : measured.derivatives) derivative *= factor;
  for (std::optional<SizeAt>& size : measured.sizes) {
    if (!size) continue;
    size->width *= factor;
    size->height *= factor;
  }
}

}  // namespace selvage::fabric
