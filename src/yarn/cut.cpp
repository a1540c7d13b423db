#include "yarn/cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "yarn/finish.h"

namespace selvage::yarn {

namespace {

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

// The surface with the knot v as often as its degree: one row of control points is then the section at v.
nurbs::Surface opened_at(const nurbs::Surface& surface, double v) {
  const auto present = static_cast<int>(std::count(surface.knots_v.begin(), surface.knots_v.end(), v));
  const int missing = std::max(0, surface.degree_v - present);
  nurbs::Surface out = surface;
  out.count_v = surface.count_v + missing;
  out.points.resize(at(out.count_u) * at(out.count_v));
  if (surface.is_rational()) out.weights.resize(out.points.size());
  for (int i = 0; i < surface.count_u; ++i) {
    const nurbs::Curve refined = nurbs::insert_knot(nurbs::control_column(surface, i), v, missing);
    out.knots_v = refined.knots;
    for (int j = 0; j < out.count_v; ++j) {
      out.points[out.index(i, j)] = refined.points[at(j)];
      if (surface.is_rational()) out.weights[out.index(i, j)] = refined.weights[at(j)];
    }
  }
  return out;
}

// The part between two values of v that are knots of full multiplicity, or ends.
nurbs::Surface part_between(const nurbs::Surface& surface, double v0, double v1) {
  const std::vector<double>& knots = surface.knots_v;
  const auto first_after = [&](double v) {
    return static_cast<int>(std::upper_bound(knots.begin(), knots.end(), v) - knots.begin());
  };
  const auto first_at = [&](double v) {
    return static_cast<int>(std::lower_bound(knots.begin(), knots.end(), v) - knots.begin());
  };
  // The rows before the last knot of value v0, and up to the one of value v1.
  const int first = first_after(v0) - 1 - surface.degree_v;
  const int end = first_at(v1);
  nurbs::Surface part;
  part.degree_u = surface.degree_u;
  part.degree_v = surface.degree_v;
  part.knots_u = surface.knots_u;
  part.count_u = surface.count_u;
  part.count_v = end - first;
  part.knots_v.assign(at(surface.degree_v) + 1, v0);
  for (const double knot : knots)
    if (knot > v0 && knot < v1) part.knots_v.push_back(knot);
  part.knots_v.insert(part.knots_v.end(), at(surface.degree_v) + 1, v1);
  const auto from = static_cast<std::ptrdiff_t>(surface.index(0, first));
  const auto to = static_cast<std::ptrdiff_t>(surface.index(0, end));
  part.points.assign(surface.points.begin() + from, surface.points.begin() + to);
  if (surface.is_rational())
    part.weights.assign(surface.weights.begin() + from, surface.weights.begin() + to);
  return part;
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
  piece.surface = std::move(surface);
  piece.axis = nurbs::sub_curve(whole.axis, piece.surface.first_v(), piece.surface.last_v());
  return piece;
}

}  // namespace

Result<std::vector<Body>> cut(const Body& body, int count, EndStyle ends) {
  std::vector<double> breaks = cuts_of(body.surface, count);
  if (breaks.empty() && count > 1) {
    Message message = error(
        Kind::geometry, fmt::format("yarn '{}' has too few sections to be cut into {}", body.name, count));
    message.yarn = body.name;
    message.place = body.place;
    return message;
  }
  nurbs::Surface surface = body.surface;
  for (const double v : breaks) surface = opened_at(surface, v);
  breaks.insert(breaks.begin(), body.surface.first_v());
  breaks.push_back(body.surface.last_v());
  const bool is_open = !body.closed_along && body.start.style == EndStyle::none;
  std::vector<Body> pieces;
  for (int k = 0; k < count; ++k) {
    Body piece = piece_of(body, part_between(surface, breaks[at(k)], breaks[at(k) + 1]), k + 1);
    if (Status status = finish(piece, is_open ? EndStyle::none : ends); !status.ok()) return status.error();
    piece.inward = body.inward;
    if (!body.closed_along && k == 0) piece.start = body.start;
    if (!body.closed_along && k == count - 1) piece.end = body.end;
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace selvage::yarn
