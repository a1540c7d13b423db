#include "pipeline/pieces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text_report.h"
#include "pipeline/table.h"

namespace selvage::pipeline {

namespace {

using fabric::CurveFit;
using fabric::PieceEdge;
using fabric::PieceShape;

// OpenCASCADE integrates areas to 1e-9 of itself.
constexpr double area_agreement = 1e-6;

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

std::string piece_table(const std::vector<PieceShape>& pieces, const Shown& shown) {
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
               cell(shown.length(piece.perimeter)), cell(shown.area(piece.area)),
               cell(shown.length(size.x())), cell(shown.length(size.y())), small(shown.length(largest))});
  }
  return fmt::format("  lengths in {}\n{}", name_of(shown.unit), table.text());
}

std::string curve_tables(const PieceShape& piece, const Shown& shown) {
  PieceShape converted_piece = piece;
  convert_lengths(converted_piece, shown.file, shown.unit);
  std::string text;
  for (const PieceEdge& edge : converted_piece.edges) {
    if (!edge.fit) continue;
    text += fmt::format("\n  curve {} of piece {}: {}, points by {}, largest error {}, {} steps of descent\n",
                        in_quotes(edge.name), in_quotes(piece.name), fabric::name_of(edge.fit->shape),
                        fabric::name_of(edge.fit->by), small(edge.fit->largest_error()),
                        edge.fit->bezier.iterations);
    text += point_table(*edge.fit) + control_table(edge.fit->bezier);
  }
  return text;
}

std::optional<PieceFindings> examine_pieces(Job& job, const fabric::Fabric& fabric) {
  PieceFindings found;
  for (const fabric::Piece* piece : fabric::pieces_of(fabric)) {
    if (std::optional<PieceShape> shape = job.build_piece(fabric, *piece, /*defects=*/true))
      found.shapes.push_back(std::move(*shape));
    else
      ++found.defects;
  }
  if (found.shapes.empty()) return found;
  Result<std::vector<solid::FaceCheck>> faces = solid::check_piece_faces(found.shapes);
  if (!faces) return job.fail(faces.error());
  found.faces = std::move(*faces);
  for (std::size_t i = 0; i < found.shapes.size(); ++i) {
    const PieceShape& shape = found.shapes[i];
    solid::FaceCheck& face = found.faces[i];
    if (face.defects.empty() && std::abs(face.area - shape.area) > area_agreement * shape.area)
      face.defects.push_back(
          error(Kind::geometry,
                fmt::format("piece '{}': the face's area is {:.9g}, that of the outline {:.9g} {}^2",
                            shape.name, face.area, shape.area, name_of(fabric.units)),
                {.place = shape.place}));
    found.defects += face.defects.size();
    for (const Message& defect : face.defects) job.say_defect(defect);
    if (job.wants_report()) job.report["pieces"][i]["valid"] = face.defects.empty();
  }
  return found;
}

std::string face_table(const PieceFindings& found, const Shown& shown) {
  Table table({"piece", "edges", "perimeter", "area", "closed", "crosses itself", "B-rep", "defects"});
  for (std::size_t i = 0; i < found.shapes.size(); ++i) {
    const PieceShape& shape = found.shapes[i];
    table.add({shape.name, std::to_string(shape.edges.size()), cell(shown.length(shape.perimeter)),
               cell(shown.area(shape.area)), "yes", "no", found.faces[i].valid ? "valid" : "invalid",
               std::to_string(found.faces[i].defects.size())});
  }
  return found.shapes.empty() ? std::string() : table.text();
}

}  // namespace selvage::pipeline
