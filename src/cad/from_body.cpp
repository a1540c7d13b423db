#include "cad/from_body.h"

#include "yarn/end_plane.h"

namespace selvage::cad {

namespace {

Face end_face(const yarn::Body& body, bool last) {
  const yarn::EndFace& end = last ? body.end : body.start;
  Face face;
  if (end.style != yarn::EndStyle::planar) {
    face.surface = end.surface;
    face.reversed = end.inward;
    return face;
  }
  const nurbs::Curve outline = yarn::end_curve(body, last);
  const yarn::EndPlane plane = yarn::end_plane(body, outline, last);
  face.surface = plane.surface;
  face.reversed = plane.inward;
  face.loops = {{{{.curve = outline, .flat = plane.in_parameters(outline), .id = last ? 1 : 0}}}};
  return face;
}

}  // namespace

Part part_of(const yarn::Body& body) {
  Part part;
  part.name = body.name;
  part.group = body.group;
  part.color = body.color;
  part.level = static_cast<int>(body.role) + 1;
  part.origin.place = body.place;
  Face side;
  side.surface = body.surface;
  side.reversed = body.inward;
  part.faces.push_back(std::move(side));
  bool closed = true;
  if (!body.closed_along) {
    for (const bool last : {false, true}) {
      if ((last ? body.end : body.start).style == yarn::EndStyle::none)
        closed = false;
      else
        part.faces.push_back(end_face(body, last));
    }
  }
  part.kind = closed ? Part::Kind::solid : Part::Kind::surfaces;
  for (Face& face : part.faces) face.label() = part.label();
  return part;
}

}  // namespace selvage::cad
