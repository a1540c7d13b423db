#include "pipeline/pieces.h"

#include <fmt/format.h>

#include <algorithm>

#include "pipeline/scaling.h"
#include "pipeline/table.h"

namespace selvage::pipeline {

namespace {

using fabric::CurveFit;
using fabric::PieceEdge;
using fabric::PieceShape;

// Errors beside rounding are shown as they are, rounding itself as few digits.
std::string small(double value) {
  return fmt::format("{:.3g}", value);
}

std::string point_table(const CurveFit& fit) {
  Table table({"fixed point", "t", "x", "y", "error", "from the curve"});
  for (std::size_t i = 0; i < fit.points.size(); ++i) {
    const fabric::FixedPoint& point = fit.points[i];
    table.add({std::to_string(i + 1), cell(point.parameter), cell(point.at.x()), cell(point.at.y()),
               small(point.error), small(point.distance)});
  }
  return table.text();
}

std::string control_table(const nurbs::BezierFit& fit) {
  Table table({"control point", "x", "y", "x by descent", "y by descent", "apart"});
  for (std::size_t k = 0; k < 4; ++k)
    table.add({fmt::format("B{}", k), cell(fit.solved[k].x()), cell(fit.solved[k].y()),
               cell(fit.descended[k].x()), cell(fit.descended[k].y()),
               small((fit.solved[k] - fit.descended[k]).norm())});
  return table.text();
}

}  // namespace

std::string piece_table(const std::vector<PieceShape>& pieces, Unit file, Unit shown) {
  const auto length = [&](double value) { return converted(value, file, shown); };
  Table table({"piece", "lines", "curves", "perimeter", "area", "width", "height", "largest error"});
  for (const PieceShape& piece : pieces) {
    const auto lines = std::count_if(piece.edges.begin(), piece.edges.end(),
                                     [](const PieceEdge& edge) { return edge.is_line(); });
    double largest = 0;
    for (const PieceEdge& edge : piece.edges)
      if (edge.fit) largest = std::max(largest, edge.fit->largest_error());
    const Vec2 size = piece.box.sizes();
    table.add({piece.name, std::to_string(lines),
               std::to_string(static_cast<std::ptrdiff_t>(piece.edges.size()) - lines),
               cell(length(piece.perimeter)), cell(length(length(piece.area))), cell(length(size.x())),
               cell(length(size.y())), small(length(largest))});
  }
  return fmt::format("  lengths in {}\n{}", name_of(shown), table.text());
}

std::string curve_tables(const PieceShape& piece, Unit file, Unit shown) {
  PieceShape converted_piece = piece;
  convert_lengths(converted_piece, file, shown);
  std::string text;
  for (const PieceEdge& edge : converted_piece.edges) {
    if (!edge.fit) continue;
    text += fmt::format("\n  curve '{}' of piece '{}': {}, largest error {}, {} steps of descent\n",
                        edge.name, piece.name, fabric::name_of(edge.fit->shape),
                        small(edge.fit->largest_error()), edge.fit->bezier.iterations);
    text += point_table(*edge.fit) + control_table(edge.fit->bezier);
  }
  return text;
}

}  // namespace selvage::pipeline
