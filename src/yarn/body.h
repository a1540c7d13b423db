// A yarn as geometry: one B-spline surface round its body, and what seals its two ends. This is what every
// surface format writes, what is checked, and what is meshed. All lengths in file units.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.h"
#include "core/vec.h"
#include "nurbs/spline.h"

namespace selvage::yarn {

enum class Role { warp, weft, wale, course, braider, axial, binder, other };
std::string_view name_of(Role role);
inline constexpr std::array<Role, 8> all_roles = {Role::warp,    Role::weft,  Role::wale,   Role::course,
                                                  Role::braider, Role::axial, Role::binder, Role::other};

struct Color {
  int red = 200, green = 200, blue = 200;  // 0-255
  bool operator==(const Color&) const = default;
};

// How a yarn's end is sealed; methods.md, 3.
enum class EndStyle { patch, fan, planar, none };
std::string_view name_of(EndStyle style);

// One end of a yarn. `surface` is filled for patch and fan, `origin` and `normal` always (but for none).
//   patch: a four-sided surface over [0,1]^2 whose boundary curves are the quarters of the body's end curve:
//          v=0 the first quarter (u forward), u=1 the second, v=1 the third (u backward), u=0 the fourth (v
//          backward). The quarters meet at Body::quarters.
//   fan:   count_u = the body's, 4 rows, degree 2 x 3: row 0 is the body's own end row (the same numbers),
//   row 3 is the
//          centre, a degenerate point.
//   planar: the plane through `origin` with `normal`, trimmed by the body's end curve.
struct EndFace {
  EndStyle style = EndStyle::none;
  nurbs::Surface surface;
  Vec3 origin = Vec3::Zero();  // the centre of the end
  Vec3 normal = Vec3::Zero();  // unit, out of the yarn
  bool inward = false;         // patch, fan: true where S_u x S_v points into the yarn
};

// A place where the path bends tighter than the section allows: the surface folds over itself there.
struct TightBend {
  double parameter = 0;    // of the path (the body's v)
  Vec3 at = Vec3::Zero();  // on the path
  double radius = 0;       // of the path's curvature there
  double needed = 0;       // how far the section reaches toward the centre of curvature
};

// What a yarn is called and made of.
struct BodyLabel {
  std::string name;
  std::string thread;    // name of the thread, may be empty
  std::string material;  // name of the material, may be empty
  std::string group;     // of a ply or a filament: the yarn that it is part of; else empty
  Role role = Role::other;
  Color color;
  // Of a CAD file: whether it says them, or they were given here.
  bool is_named = true, is_colored = true;
  bool has_own_color = true;  // false: nobody gave it one, `color` is that of its role
  double twist = 0;           // of the fibres, turns per file unit along the centre line; > 0: Z, < 0: S
  double fibre_area =
      0;               // of the fibres in a section: tex / (1000 density), file units squared; 0: not known
  double density = 0;  // of the solid, g/cm3: its mass by its volume, air and all; 0: not known
  bool section_turns = false;  // with the twist: the fibres follow the lines of constant u
  TextPlace place;             // in the file that it came from
  // Of a CAD file: the distance below which it calls two points one; 0: only rounding is none.
  double resolution = 0;
};

struct Body : BodyLabel {
  // u: round the section, closed and clamped: column 0 equals the last column, to the bit. v: along the path,
  // clamped.
  nurbs::Surface surface;
  bool closed_along = false;  // a ring: the first row equals the last, to the bit; no end faces
  bool inward = false;        // S_u x S_v points into the yarn (grids that run the other way round)
  // The values of u at which the patches' corners stand; quarters[0] is the first u. Knots of the surface.
  std::array<double, 4> quarters{0, 0.25, 0.5, 0.75};
  EndFace start, end;

  // The centre line over the same parameter v as the surface (the exact path, or for a grid the centres of
  // its sections).
  nurbs::Curve axis;

  // Of a finished body 0, until somebody knows better. Bodies of one shape (a number above 0) are the same
  // surface, moved by the difference of their places to the last digit of what was built.
  std::uint64_t shape = 0;
  Vec3 at = Vec3::Zero();

  double length = 0;      // of the centre line
  double volume = 0;      // enclosed, of the B-spline itself; with ends `none` as if the ends were planar
  double end_area = 0;    // of the first section (for grids: of the first section's B-spline)
  double tube_error = 0;  // bound on the distance to the exact swept section; 0 for a grid
  double tolerance = 0;   // what that distance may be
  double path_miss =
      0;  // the centre line's largest distance from the points that it was made after (loop paths)
  double min_bend_radius = 0;          // of the path; infinity for a straight one
  std::vector<TightBend> tight_bends;  // worst first
  std::vector<Message> messages;       // warnings made while building: a fold that made an end planar, ...
};

// For each body the first that is its shape, itself where none is before it.
std::vector<std::size_t> first_of_shape(std::span<const Body> bodies);

// What a message about it says of it.
inline About about(const BodyLabel& body, const std::optional<Vec3>& at = {}) {
  return {.place = body.place, .yarn = body.name, .at = at};
}

// The outline at the body's start or end: the boundary row as a curve over u.
nurbs::Curve end_curve(const Body& body, bool last);

// The same, as its four quarters between Body::quarters, each over its own part of u.
std::array<nurbs::Curve, 4> end_quarters(const Body& body, bool last);

// The largest distance between an end face's boundary and the body's end curve (0 for fan and planar ends
// that were built here): what a receiving system has to sew.
double end_gap(const Body& body, bool last);

// The largest diagonal of a box round one row of control points: no section is wider.
double widest_section(const Body& body);

// How thick the body is, whatever asks: the smallest width of its sections over all directions across the
// path. Sections smaller than a tenth of the largest one are passed over (a yarn that runs to a point); where
// no section has an area, widest_section(). File units.
double narrowest_section(const Body& body);
// Of the thinnest one; infinite where there is none.
double narrowest_section(std::span<const Body> bodies);

// The body's box (of its control points).
Box3 bounds(const Body& body);

}  // namespace selvage::yarn
