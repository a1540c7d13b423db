#include "fabric/build.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "fabric/yarn_spec.h"
#include "yarn/finish.h"
#include "yarn/grid.h"
#include "yarn/tube.h"

namespace selvage::fabric {

namespace {

Message at_yarn(Message message, const Fabric& fabric, const Yarn& yarn) {
  message.file = fabric.file;
  if (message.place.line == 0) message.place = yarn.place;
  message.yarn = yarn.name;
  return message;
}

yarn::GridNet net_of(const Grid& grid, bool yarn_closed) {
  yarn::GridNet net;
  net.sections = grid.sections;
  net.per_section = grid.per_section;
  net.points = grid.points;
  net.weights = grid.weights;
  net.degree_along = grid.degree_along;
  net.degree_round = grid.degree_round;
  net.knots_along = grid.knots_along;
  net.knots_round = grid.knots_round;
  net.open_round = grid.open_round;
  net.closed_along = grid.closed_along || yarn_closed;
  return net;
}

Message unsupported(const Fabric& fabric, TextPlace place, std::string_view what) {
  Message message = error(Kind::unsupported, fmt::format("{} is not supported yet", what));
  message.file = fabric.file;
  message.place = place;
  return message;
}

}  // namespace

double tolerance_of(const Fabric& fabric, const BuildOptions& options) {
  if (options.tolerance > 0.0) return options.tolerance;
  if (fabric.tolerance) return *fabric.tolerance;
  double smallest = std::numeric_limits<double>::infinity();
  for (const Item& item : fabric.items)
    if (const auto* yarn = std::get_if<Yarn>(&item))
      if (const std::optional<double> size = smallest_size(fabric, *yarn))
        smallest = std::min(smallest, *size);
  return std::isfinite(smallest) ? smallest / 1000.0 : 0.0;
}

std::optional<YarnBuilder> YarnBuilder::create(const Fabric& fabric, const BuildOptions& options,
                                               Diagnostics& diagnostics) {
  YarnBuilder builder;
  builder.fabric_ = &fabric;
  builder.options_ = options;
  const int errors_before = diagnostics.error_count();
  std::set<std::string> warned;  // a warning about a thread is worth saying once
  for (const Item& item : fabric.items) {
    if (const auto* yarn = std::get_if<Yarn>(&item)) {
      builder.yarns_.push_back(yarn);
      std::optional<Message> warning = fibre_share_warning(fabric, *yarn, resolved_thread(fabric, *yarn));
      if (warning && warned.insert(warning->text).second) diagnostics.add(std::move(*warning));
    }
    if (const auto* weave = std::get_if<Weave>(&item))
      diagnostics.add(unsupported(fabric, weave->place, "`weave`"));
    if (const auto* knit = std::get_if<Knit>(&item))
      diagnostics.add(unsupported(fabric, knit->place, "`knit`"));
    if (const auto* warpknit = std::get_if<Warpknit>(&item))
      diagnostics.add(unsupported(fabric, warpknit->place, "`warpknit`"));
    if (const auto* braid = std::get_if<Braid>(&item))
      diagnostics.add(unsupported(fabric, braid->place, "`braid`"));
    if (const auto* piece = std::get_if<Piece>(&item))
      diagnostics.add(unsupported(fabric, piece->place, "`piece`"));
  }
  for (const Edit& edit : fabric.edits) diagnostics.add(unsupported(fabric, edit.place, "`edit`"));
  builder.tolerance_ = tolerance_of(fabric, options);
  if (diagnostics.error_count() > errors_before) return std::nullopt;
  return builder;
}

Status YarnBuilder::sweep_path(yarn::Body& body, const Yarn& yarn, const Thread& thread) const {
  Result<yarn::PathRows> rows = path_rows_of(*fabric_, yarn, thread);
  if (!rows) return rows.error();
  const Path& path = std::get<Path>(yarn.shape);
  // Every row becomes a section at least: what cannot be held is refused before it is computed.
  constexpr std::size_t fewest_round = 8;
  if (path.points.size() > options_.max_control_points / fewest_round)
    return error(
        Kind::limit,
        fmt::format(
            "yarn '{}' has {} points: its surface would need more than {} control points; split the yarn",
            yarn.name, path.points.size(), options_.max_control_points));
  Result<yarn::CentreLine> line = yarn::make_centre_line(*rows);
  if (!line) {
    Message message = line.error();
    const int row = message.place.line;  // from 1
    if (row > 0)
      message.place.line =
          path.lines.empty() ? path.place.line + row : path.lines[static_cast<std::size_t>(row - 1)];
    return message;
  }
  Result<yarn::TubeSpec> spec = tube_spec_of(*fabric_, yarn, thread, line->parameters);
  if (!spec) return spec.error();
  spec->tolerance = tolerance_;
  spec->max_control_points = options_.max_control_points;
  return yarn::sweep(body, *line, *spec);
}

Result<yarn::Body> YarnBuilder::build(std::size_t index) const {
  const Yarn& yarn = *yarns_[index];
  const Thread thread = resolved_thread(*fabric_, yarn);
  yarn::Body body;
  body.name = yarn.name;
  body.thread = yarn.thread;
  body.material = thread.material.value_or("");
  body.role = yarn.role.value_or(Role::other);
  body.color = thread.color.value_or(Color{});
  body.place = yarn.place;
  if (const auto* grid = std::get_if<Grid>(&yarn.shape)) {
    Status filled = yarn::fill_from_grid(body, net_of(*grid, yarn.closed));
    if (!filled) {
      filled.error().place = grid->place;
      return at_yarn(filled.error(), *fabric_, yarn);
    }
  } else if (std::holds_alternative<Path>(yarn.shape)) {
    Status swept = sweep_path(body, yarn, thread);
    if (!swept) return at_yarn(swept.error(), *fabric_, yarn);
  } else {
    return at_yarn(error(Kind::geometry, fmt::format("yarn '{}' has neither a path nor a grid", yarn.name)),
                   *fabric_, yarn);
  }
  Status finished = yarn::finish(body, options_.ends);
  if (!finished) return at_yarn(finished.error(), *fabric_, yarn);
  for (Message& message : body.messages) message = at_yarn(message, *fabric_, yarn);
  return body;
}

}  // namespace selvage::fabric
