#include "pipeline/facts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nurbs/measure.h"
#include "solid/tessellation.h"

namespace selvage::pipeline {

namespace {

bool is_closed(const yarn::Body& body) {
  if (body.closed_along) return true;
  if (body.start.style == yarn::EndStyle::none || body.end.style == yarn::EndStyle::none) return false;
  const double allowed = solid::sewing_gap(body);
  return yarn::end_gap(body, false) <= allowed && yarn::end_gap(body, true) <= allowed;
}

double round_down(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (double step : {5.0, 2.0})
    if (step * power <= value) return step * power;
  return power;
}

}  // namespace

YarnReport facts_of(const yarn::Body& body, Unit units) {
  const double mm = millimetres_per(units);
  YarnReport facts;
  facts.name = body.name;
  facts.closed = is_closed(body);
  if (!body.tight_bends.empty()) facts.self_overlap = true;
  facts.length = body.length * mm;
  facts.volume = body.volume * mm * mm * mm;
  if (std::isfinite(body.min_bend_radius)) facts.min_bend_radius = body.min_bend_radius * mm;
  facts.tube_error = body.tube_error * mm;
  if (body.path_miss > 0) facts.path_miss = body.path_miss * mm;
  facts.count_u = body.surface.count_u;
  facts.count_v = body.surface.count_v;
  return facts;
}

PieceReport facts_of(const fabric::PieceShape& piece, Unit units, bool with_table) {
  const double mm = millimetres_per(units);
  PieceReport facts;
  facts.name = piece.name;
  facts.area = piece.area * mm * mm;
  facts.perimeter = piece.perimeter * mm;
  for (const fabric::PieceEdge& edge : piece.edges) {
    facts.edges.push_back({edge.name, edge.is_line(), nurbs::arc_length(edge.curve) * mm, {}});
    if (!with_table || !edge.fit) continue;
    PieceReport::Fit& fit = facts.edges.back().fit.emplace(PieceReport::Fit{});
    fit.shape = fabric::name_of(edge.fit->shape);
    fit.iterations = edge.fit->bezier.iterations;
    fit.largest_error = edge.fit->largest_error() * mm;
    fit.largest_distance = edge.fit->largest_distance() * mm;
    for (const fabric::FixedPoint& point : edge.fit->points)
      fit.points.push_back({point.parameter, point.at * mm, point.error * mm, point.distance * mm});
    for (std::size_t k = 0; k < 4; ++k) {
      fit.solved[k] = edge.fit->bezier.solved[k] * mm;
      fit.descended[k] = edge.fit->bezier.descended[k] * mm;
    }
  }
  return facts;
}

double thinnest_section(const yarn::Body& body) {
  double least = std::numeric_limits<double>::infinity();
  const nurbs::Surface& surface = body.surface;
  for (int j = 0; j < surface.count_v; ++j) {
    Vec3 centre = Vec3::Zero();
    for (int i = 0; i < surface.count_u; ++i) centre += surface.point(i, j);
    centre /= surface.count_u;
    for (int i = 0; i < surface.count_u; ++i)
      least = std::min(least, 2 * (surface.point(i, j) - centre).norm());
  }
  return least;
}

std::optional<double> creo_accuracy(std::optional<double> thinnest, std::optional<double> min_gap) {
  if (!thinnest || !(*thinnest > 0) || !std::isfinite(*thinnest)) return std::nullopt;
  double accuracy = *thinnest / 100;
  if (min_gap && *min_gap > 0) accuracy = std::min(accuracy, *min_gap / 4);
  return round_down(accuracy);
}

}  // namespace selvage::pipeline
