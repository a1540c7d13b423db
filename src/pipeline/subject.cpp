#include "pipeline/subject.h"

#include "cad/from_body.h"
#include "cad/seam.h"
#include "pipeline/scaling.h"

namespace selvage::pipeline {

namespace {

// A plane, over x and y, that is trimmed by the piece's edges.
cad::Part part_of(const fabric::PieceShape& piece) {
  cad::Part part;
  part.name = piece.name;
  part.origin.place = piece.place;
  cad::Face& face = part.faces.emplace_back();
  face.name = piece.name;
  const Vec2 low = piece.box.min(), high = piece.box.max();
  face.surface.degree_u = face.surface.degree_v = 1;
  face.surface.count_u = face.surface.count_v = 2;
  face.surface.knots_u = {low.x(), low.x(), high.x(), high.x()};
  face.surface.knots_v = {low.y(), low.y(), high.y(), high.y()};
  for (const double y : {low.y(), high.y()})
    for (const double x : {low.x(), high.x()}) face.surface.points.emplace_back(x, y, 0);
  cad::Loop& loop = face.loops.emplace_back();
  for (const fabric::PieceEdge& edge : piece.edges)
    loop.edges.push_back({.curve = edge.curve, .flat = edge.curve});
  return part;
}

}  // namespace

std::optional<cad::Subject> subject_of(Job& job, const fabric::Fabric& fabric, const Onlooker& onlooker) {
  const std::optional<fabric::YarnBuilder> builder = job.builder(fabric);
  if (!builder) return std::nullopt;
  cad::Subject subject;
  subject.model.file = fabric.file;
  subject.model.title = fabric.title.value_or("");
  subject.model.units = fabric.units;
  job.for_each_yarn(*builder, "building yarn", [&](yarn::Body&& body) {
    if (onlooker.yarn) onlooker.yarn(body);
    cad::Part& part = subject.model.parts.emplace_back(cad::part_of(body));
    if (!body.is_named) part.name.clear();
    if (!body.is_colored) part.color.reset();
    for (cad::Face& face : part.faces) {
      face.name = part.name;
      face.color = part.color;
    }
    return true;
  });
  subject.yarns = subject.model.parts.size();
  for (const fabric::Piece* piece : fabric::pieces_of(fabric))
    if (const std::optional<fabric::PieceShape> shape = job.build_piece(fabric, *piece)) {
      if (onlooker.piece) onlooker.piece(*shape);
      subject.model.parts.push_back(part_of(*shape));
    }
  if (job.has_failed()) return std::nullopt;
  for (const cad::Part& part : fabric.parts)
    for (cad::Face& face : subject.model.parts.emplace_back(part).faces)
      face = cad::with_seam_in_gap(std::move(face));
  subject.model.curves.insert(subject.model.curves.end(), fabric.curves.begin(), fabric.curves.end());
  return subject;
}

void convert_lengths(cad::Subject& subject, Unit to) {
  const Unit from = subject.model.units;
  for (cad::Part& part : subject.model.parts) convert_lengths(part, from, to);
  for (cad::NamedCurve& curve : subject.model.curves) convert_lengths(curve, from, to);
  subject.model.units = to;
}

}  // namespace selvage::pipeline
