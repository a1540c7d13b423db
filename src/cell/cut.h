// Yarns cut by the faces of a box, exactly (of an oblique cell: in its own coordinates, yarn/in_axes.h):
// which parts of their surfaces lie inside, as regions of the surface's parameters bounded by curves that lie
// in the faces. CAD faces are trimmed by these curves, and meshes begin with points on them.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "core/parallelepiped.h"
#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::cell {

// Faces of the box: 0 x low, 1 x high, 2 y low, 3 y high, 4 z low, 5 z high.
inline constexpr int face_count = 6;
inline constexpr int axis_of(int face) {
  return face / 2;
}
inline constexpr bool is_high(int face) {
  return face % 2 == 1;
}
inline double plane_of(const Box3& box, int face) {
  return is_high(face) ? box.max()[axis_of(face)] : box.min()[axis_of(face)];
}
std::string name_of_face(int face);  // "x low" ...
// The axes in a face, of which the first cross the second points out of the box; a point's coordinates along
// them; and the point of the face that has these.
inline constexpr std::array<int, 2> axes_in(int face) {
  const int b = (axis_of(face) + 1) % 3, c = (axis_of(face) + 2) % 3;
  return is_high(face) ? std::array{b, c} : std::array{c, b};
}
inline Vec2 flat(const Vec3& point, int face) {
  return {point[axes_in(face)[0]], point[axes_in(face)[1]]};
}
Vec3 in_face(const Box3& box, int face, const Vec2& at);

// Edges of the box, which two faces share: number 4 a + k runs along axis a, where k has bit 0 set on the
// high side of the axis after a (x, y, z, x, ..), bit 1 on the high side of the one after that.
inline constexpr int edge_count = 12;
int edge_between(int face_a, int face_b);  // of faces of different axes
std::array<int, 2> faces_of_edge(int edge);
Vec3 edge_point(const Box3& box, int edge, double along);  // along: the coordinate of its own axis

// A stretch of the border of what lies inside: where the yarn's surface goes through a face of the box, or
// where it ends. An end that lies in a face of the box (within the tolerance) is that face's.
struct Arc {
  static constexpr int own_start = 6, own_end = 7;
  int face = 0;  // 0..5; own_start, own_end: an end inside the box
  enum class Along { through, start, end };
  Along along = Along::through;  // start, end: along the first or last v of the surface
  // Consecutive points of the curve, as parameters; the surface is inside on the left of the way (u to the
  // right, v up). u goes on past the ends of the domain where the curve crosses the seam, v likewise on a
  // ring. First and last: corners, where the next arc of the border goes on, or, of an arc that is a border
  // by itself, the same place (in u or v perhaps one period later).
  std::vector<Vec2> parameters;
};

// A closed chain of arcs: the last point is the first one, or the same place a period later.
struct Border {
  std::vector<Arc> arcs;
  int turns_u = 0, turns_v = 0;  // periods that it gains in one round: 0, 1 or -1
};

// A connected part of a yarn's surface inside the box.
struct Piece {
  std::size_t body = 0;
  std::vector<Border>
      borders;  // none: the whole surface, a ring inside the box (without end faces: closed along)
  Vec2 inside = Vec2::Zero();  // parameters of a point of it
};

struct Cut {
  std::vector<Piece> pieces;  // by body
  std::vector<Message> notes;
};

// A message whose place is in the cell's own coordinates, with that in space.
Message in_space(Message message, const Parallelepiped& cell);

// Where parameters lie on a surface that goes on periodically round u (and along v on a ring).
Vec3 position(const yarn::Body& body, const Vec2& parameters);
nurbs::SurfaceJet jet(const yarn::Body& body, const Vec2& parameters);
// The same place with parameters inside the surface's domain.
Vec2 in_domain(const yarn::Body& body, const Vec2& parameters);
// How far the parameters run in one round of the surface's domain.
Vec2 periods(const yarn::Body& body);
// The same place with parameters as they are beside `near`: by whole periods where they go round.
Vec2 beside(const yarn::Body& body, const Vec2& near, Vec2 parameters);

// `tolerance`, file units, > 0: an end face this near a face of the box lies in it; a part of a yarn that
// reaches less far into the box is left out, with a note.
// Errors (geometry), each with the yarn and the place: an end face that is partly inside the box (askew to
// the face that it ends near); a yarn that reaches through a face of the box by less than the tolerance; a
// box thinner than what the yarns are sampled by; no yarn that enters the box.
Result<Cut> cut(std::span<const yarn::Body> bodies, const Box3& box, double tolerance);

// An arc as a curve with a length: exact points between those that are kept.
class ArcCurve {
 public:
  // Body and arc outlive this; body and lengths in space.
  ArcCurve(const yarn::Body& body, const Parallelepiped& cell, const Arc& arc);

  // Of the polygon of its points, file units.
  [[nodiscard]] double length() const { return lengths_.back(); }
  // The point of the curve in the plane across the polygon at this length from its start (0..length()), on
  // the surface and in the face to rounding; the kept points at theirs.
  [[nodiscard]] Vec2 at(double along) const;
  [[nodiscard]] Vec3 position(const Vec2& parameters) const;  // in the face: of a box to the bit
  [[nodiscard]] const std::vector<double>& lengths() const { return lengths_; }  // one a kept point
  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }      // likewise

  struct Foot {
    double along = 0, distance = std::numeric_limits<double>::infinity();
  };
  // The place of the polygon nearest to a point.
  [[nodiscard]] Foot nearest(const Vec3& point) const;

 private:
  const yarn::Body* body_;
  const Arc* arc_;
  Parallelepiped cell_;
  int axis_ = -1;  // of the face; -1: an end inside the box
  double plane_ = 0;
  std::vector<Vec3> points_;
  std::vector<double> lengths_;
};

}  // namespace selvage::cell
