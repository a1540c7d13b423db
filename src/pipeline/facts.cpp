#include "pipeline/facts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "nurbs/measure.h"
#include "solid/tessellation.h"

namespace selvage::pipeline {

bool is_closed(const yarn::Body& body) {
  if (body.closed_along) return true;
  if (body.start.style == yarn::EndStyle::none || body.end.style == yarn::EndStyle::none) return false;
  const double allowed = solid::sewing_gap(body);
  return yarn::end_gap(body, false) <= allowed && yarn::end_gap(body, true) <= allowed;
}

namespace {

double round_down(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (double step : {5.0, 2.0})
    if (step * power <= value) return step * power;
  return power;
}

}  // namespace

Json yarn_json(const yarn::Body& body, const std::string& name, Unit units) {
  const double mm = millimetres_per(units);
  return {{"name", name},
          {"closed", is_closed(body)},
          {"length", body.length * mm},
          {"volume", body.volume * mm * mm * mm},
          {"min_bend_radius", if_finite(body.min_bend_radius * mm)},
          {"tube_error", body.tube_error * mm},
          {"path_miss", if_true(body.path_miss > 0, body.path_miss * mm)},
          {"control_points", {body.surface.count_u, body.surface.count_v}},
          {"self_overlap", if_true(!body.tight_bends.empty(), true)}};
}

namespace {

Json fit_json(const fabric::CurveFit& fit, double mm) {
  const auto in_mm = [&](const Vec2& p) { return point_json(p * mm); };
  return {{"shape", fabric::name_of(fit.shape)},
          {"by", fabric::name_of(fit.by)},
          {"points", list_json(fit.points,
                               [&](const fabric::FixedPoint& point) {
                                 return Json{{"parameter", point.parameter},
                                             {"point", in_mm(point.at)},
                                             {"error", point.error * mm},
                                             {"distance", point.distance * mm}};
                               })},
          {"largest_error", fit.largest_error() * mm},
          {"largest_distance", fit.largest_distance() * mm},
          {"control_points", list_json(fit.bezier.solved, in_mm)},
          {"control_points_by_descent", list_json(fit.bezier.descended, in_mm)},
          {"descent_steps", fit.bezier.iterations}};
}

}  // namespace

Json piece_json(const fabric::PieceShape& piece, Unit units, bool with_table) {
  const double mm = millimetres_per(units);
  const auto edge_json = [&](const fabric::PieceEdge& edge) {
    return Json{{"name", edge.name},
                {"kind", edge.is_line() ? "line" : "curve"},
                {"length", nurbs::arc_length(edge.curve) * mm},
                {"fit", with_table && edge.fit ? fit_json(*edge.fit, mm) : Json()}};
  };
  return {{"name", piece.name},
          {"perimeter", piece.perimeter * mm},
          {"area", piece.area * mm * mm},
          {"valid", nullptr},  // until a check knows
          {"edges", list_json(piece.edges, edge_json)}};
}

std::optional<double> creo_accuracy(std::optional<double> thinnest, std::optional<double> min_gap) {
  if (!thinnest || !(*thinnest > 0) || !std::isfinite(*thinnest)) return std::nullopt;
  double accuracy = *thinnest / 100;
  if (min_gap && *min_gap > 0) accuracy = std::min(accuracy, *min_gap / 4);
  return round_down(accuracy);
}

}  // namespace selvage::pipeline
