#include "pipeline/subject.h"

#include "cad/from_body.h"
#include "pipeline/scaling.h"

namespace selvage::pipeline {

namespace {

void add_piece(const fabric::PieceShape& piece, cad::Model& model) {
  for (const fabric::PieceEdge& edge : piece.edges) {
    cad::NamedCurve& curve = model.curves.emplace_back();
    curve.curve = edge.curve;
    curve.name = piece.name + "/" + edge.name;
    curve.origin.place = edge.place;
  }
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
      add_piece(*shape, subject.model);
    }
  if (job.has_failed()) return std::nullopt;
  subject.model.parts.insert(subject.model.parts.end(), fabric.parts.begin(), fabric.parts.end());
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
