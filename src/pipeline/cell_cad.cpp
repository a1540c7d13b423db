#include "pipeline/cell_cad.h"

#include <fmt/format.h>

#include <iterator>

#include "cell/cad_parts.h"
#include "pipeline/overlaps.h"
#include "pipeline/unit_cell.h"
#include "yarn/in_axes.h"

namespace selvage::pipeline {

namespace {

// How far edges may be from what meets in them, of the cell's size: below what CAD systems resolve.
constexpr double edge_tolerance = 2e-8;

// Yarn by yarn: without the matrix it does not matter where they overlap.
Result<std::vector<cad::Part>> yarns_alone(std::span<const yarn::Body> bodies, const Box3& box,
                                           const cell::Cut& cut, const cell::CadOptions& options) {
  std::vector<cad::Part> all;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    cell::Cut own;
    for (const cell::Piece& piece : cut.pieces)
      if (piece.body == i) own.pieces.push_back(piece);
    for (cell::Piece& piece : own.pieces) piece.body = 0;
    if (own.pieces.empty()) continue;
    Result<std::vector<cad::Part>> parts = cell::cad_parts({&bodies[i], 1}, box, own, options);
    if (!parts) return parts.error();
    all.insert(all.end(), std::make_move_iterator(parts->begin()), std::make_move_iterator(parts->end()));
  }
  return all;
}

// From the cell's own coordinates.
void bring_to_space(std::vector<cad::Part>& parts, const ObliqueAxes& axes) {
  if (axes.are_of_space()) return;
  const auto bring = [&](std::vector<Vec3>& points) {
    for (Vec3& point : points) point = axes.place(point);
  };
  for (cad::Part& part : parts)
    for (cad::Face& face : part.faces) {
      bring(face.surface.points);
      for (cad::Loop& loop : face.loops)
        for (cad::Edge& edge : loop.edges) bring(edge.curve.points);
    }
}

}  // namespace

std::optional<std::vector<cad::Part>> cell_solids(Job& job, const fabric::Fabric& fabric,
                                                  const fabric::YarnBuilder& builder) {
  const std::string_view option = job.options.matrix ? "--matrix" : "--cut";
  if (!check_cell_text(job, fabric, false)) return std::nullopt;  // the CAD of a matrix needs no material
  if (!fabric::pieces_of(fabric).empty() || !fabric.parts.empty() || !fabric.curves.empty())
    return job.fail(at_cell(fabric, error(Kind::unsupported, fmt::format("{} cuts yarns only; this input has "
                                                                         "other geometry as well",
                                                                         option))));
  const std::optional<std::vector<yarn::Body>> bodies = job.build_all(builder);
  // Where yarns overlap, the space in both belongs to none.
  const auto finish = [](Message& message) {
    message.text +=
        "; the matrix is what yarns leave free: --relax moves them apart where they have room, else make one "
        "thinner";
  };
  if (!bodies || (job.options.matrix && !check_overlaps(job, *bodies, finish))) return std::nullopt;
  const Parallelepiped shape = fabric.cell->shape();
  const Box3& box = shape.box;
  const yarn::BodiesInAxes own(*bodies, shape.axes);
  const Result<cell::Cut> cut = cell::cut(own.list(), box, fabric::tolerance_of(fabric, job.build_options()));
  if (!cut) return job.fail(at_cell(fabric, cell::in_space(cut.error(), shape)));
  for (const Message& note : cut->notes) job.say(cell::in_space(note, shape));
  cell::CadOptions options;
  options.matrix = job.options.matrix;
  options.tolerance = edge_tolerance * box.diagonal().norm();
  Result<std::vector<cad::Part>> parts = options.matrix ? cell::cad_parts(own.list(), box, *cut, options)
                                                        : yarns_alone(own.list(), box, *cut, options);
  if (!parts) return job.fail(at_cell(fabric, cell::in_space(parts.error(), shape)));
  bring_to_space(*parts, shape.axes);
  return std::move(*parts);
}

}  // namespace selvage::pipeline
