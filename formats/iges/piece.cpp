#include "formats/iges/piece.h"

#include <vector>

#include "formats/iges/header.h"

namespace selvage::formats::iges {

namespace {

// The outline as one curve: a 102 of 126s. `status` says whether it lies in space or in the parameters.
int write_outline(Records& records, const Common& common, const fabric::PieceShape& piece,
                  std::string_view status) {
  const Vec3 up = Vec3::UnitZ();
  std::vector<int> parts;
  for (const fabric::PieceEdge& edge : piece.edges)
    parts.push_back(write_curve(records, common.entity(126, 0, status), edge.curve, &up));
  return write_composite(records, common, status, parts);
}

}  // namespace

nurbs::Surface plane_of(const fabric::PieceShape& piece) {
  const Vec2 margin = Vec2::Constant(0.1 * piece.box.sizes().maxCoeff());
  const Vec2 low = piece.box.min() - margin, high = piece.box.max() + margin;
  nurbs::Surface plane;
  plane.degree_u = plane.degree_v = 1;
  plane.count_u = plane.count_v = 2;
  plane.knots_u = {low.x(), low.x(), high.x(), high.x()};
  plane.knots_v = {low.y(), low.y(), high.y(), high.y()};
  plane.points = {
      {low.x(), low.y(), 0}, {high.x(), low.y(), 0}, {low.x(), high.y(), 0}, {high.x(), high.y(), 0}};
  return plane;
}

int entities_of_piece(const fabric::PieceShape& piece) {
  // 128, 142, 144, two 102s, the group; and for each edge three 126s and a name.
  return 6 + 4 * static_cast<int>(piece.edges.size());
}

int write_piece(Records& records, const Common& common, const fabric::PieceShape& piece) {
  const int plane = write_surface(records, common.entity(128, 0, dependent), plane_of(piece));
  const int flat = write_outline(records, common, piece, dependent_in_2d);
  const int spatial = write_outline(records, common, piece, dependent);
  const int boundary = write_boundary(records, common, plane, flat, spatial);
  std::vector<int> members = {write_trimmed(records, common, {&boundary, 1}, plane)};
  const Vec3 up = Vec3::UnitZ();
  for (const fabric::PieceEdge& edge : piece.edges) {
    const std::string name = ascii(edge.name);
    Common of_edge = common;
    of_edge.label = name;
    of_edge.name = write_name(records, of_edge);
    members.push_back(write_curve(records, of_edge.entity(126), edge.curve, &up, of_edge.name));
  }
  return write_group(records, common, members);
}

}  // namespace selvage::formats::iges
