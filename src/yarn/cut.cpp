#include "yarn/cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/index.h"
#include "yarn/finish.h"

namespace selvage::yarn {

namespace {

// The part between two values of v that are knots of full multiplicity, or ends.
nurbs::Surface part_between(const nurbs::Surface& surface, const std::vector<nurbs::Curve>& columns,
                            double v0, double v1) {
  std::vector<nurbs::Curve> parts;
  parts.reserve(columns.size());
  for (const nurbs::Curve& column : columns) parts.push_back(nurbs::sub_curve(column, v0, v1));
  return nurbs::of_columns(surface.degree_u, surface.knots_u, parts);
}

// The knots at which to cut: those nearest to equal shares of the sections, each once.
std::vector<double> cuts_of(const nurbs::Surface& surface, int count) {
  std::vector<double> inner = nurbs::breakpoints(surface.knots_v, surface.degree_v);
  inner.erase(inner.begin());
  inner.pop_back();
  const auto places = static_cast<double>(inner.size());
  std::vector<double> cuts;
  if (places < count - 1) return cuts;
  for (int k = 1; k < count; ++k)
    cuts.push_back(inner[static_cast<std::size_t>((places + 1) * k / count) - 1]);
  return cuts;
}

Body piece_of(const Body& whole, nurbs::Surface surface, int number) {
  Body piece;
  static_cast<BodyLabel&>(piece) = whole;
  piece.name = fmt::format("{}.part{}", whole.name, number);
  piece.quarters = whole.quarters;
  piece.tube_error = whole.tube_error;
  piece.tolerance = whole.tolerance;
  piece.surface = std::move(surface);
  piece.axis = nurbs::sub_curve(whole.axis, piece.surface.first_v(), piece.surface.last_v());
  return piece;
}

}  // namespace

Result<std::vector<Body>> cut(const Body& body, int count, EndStyle ends) {
  std::vector<double> breaks = cuts_of(body.surface, count);
  if (breaks.empty() && count > 1)
    return error(Kind::geometry,
                 fmt::format("yarn '{}' has too few sections to be cut into {}", body.name, count))
        .of_yarn(body.name, body.place);
  // Of each cut one row of control points is then the section there.
  std::vector<nurbs::Curve> columns;
  for (int i = 0; i < body.surface.count_u; ++i) {
    columns.push_back(nurbs::control_column(body.surface, i));
    for (const double v : breaks) columns.back() = nurbs::opened_at(columns.back(), v);
  }
  breaks.insert(breaks.begin(), body.surface.first_v());
  breaks.push_back(body.surface.last_v());
  const bool is_open = !body.closed_along && body.start.style == EndStyle::none;
  std::vector<Body> pieces;
  for (int k = 0; k < count; ++k) {
    Body piece = piece_of(body, part_between(body.surface, columns, breaks[at(k)], breaks[at(k) + 1]), k + 1);
    if (Status status = finish(piece, is_open ? EndStyle::none : ends); !status.ok()) return status.error();
    piece.inward = body.inward;
    if (!body.closed_along && k == 0) piece.start = body.start;
    if (!body.closed_along && k == count - 1) piece.end = body.end;
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace selvage::yarn
