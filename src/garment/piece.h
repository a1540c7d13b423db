// Pieces of a garment pattern as geometry: closed plane outlines of lines and cubic B-splines.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/diagnostics.h"
#include "fabric/model.h"
#include "nurbs/bezier.h"
#include "nurbs/bezier_fit.h"
#include "nurbs/spline.h"

namespace selvage::fabric {

// One fixed point of a curve and how far the curve passes from it.
struct FixedPoint {
  Vec2 at = Vec2::Zero();
  double parameter = 0;  // t_i
  double error = 0;      // distance to B(t_i)
  double distance = 0;   // distance to the nearest point of the curve
};

std::string_view name_of(nurbs::TurningShape shape);  // "straight", "C", "S"
std::string_view name_of(nurbs::PointParameters by);  // "uniform", "chord", "distance"

// How a curve was found from its fixed points, which keep their order in the file.
struct CurveFit {
  nurbs::BezierFit bezier;
  nurbs::PointParameters by = nurbs::PointParameters::uniform;
  nurbs::TurningShape shape = nurbs::TurningShape::straight;  // of the curve
  std::vector<FixedPoint> points;
  [[nodiscard]] double largest_error() const;
  [[nodiscard]] double largest_distance() const;
};

struct PieceEdge {
  std::string name;
  TextPlace place;
  nurbs::Curve curve;           // over [0, 1] in z = 0; degree 1: a line, 3: a cubic, clamped
  std::optional<CurveFit> fit;  // of a Bezier near fixed points
  [[nodiscard]] bool is_line() const { return curve.degree == 1; }
};

struct PieceShape {
  std::string name;
  TextPlace place;
  // Round the piece, counter-clockwise seen from +z, beginning with the first of the text; each one's last
  // point is the next one's first, to the bit.
  std::vector<PieceEdge> edges;
  double area = 0;  // > 0; from the outline by Green's theorem
  double perimeter = 0;
  nurbs::Box2 box;  // of the curves themselves
};

// The box of the curves themselves. It follows from their control points alone, so that a piece that was
// written and read again, or converted to another unit, has the same one to the bit.
nurbs::Box2 box_of(const std::vector<PieceEdge>& edges);

// The pieces of a fabric, in file order.
std::vector<const Piece*> pieces_of(const Fabric& fabric);

// `tolerance`, file units: a start this near to the end before it is moved onto it; 0: the file's
// `tolerance`, or 1e-6 of the piece's extent. Everything that is wrong goes to `diagnostics`, at its line,
// and then there is no shape: malformed (an end that does not meet the next start, an outline that is not
// closed), geometry (it crosses or touches itself, encloses no area, or is too large or small for the
// arithmetic; a curve whose points crowd so that no cubic is found), limit (over 50,000 lines and curves).
// Warnings: a curve that does not turn as its word (C or S) or its points do, or that runs back between two
// of them.
std::optional<PieceShape> build_piece(const Fabric& fabric, const Piece& piece, double tolerance,
                                      Diagnostics& diagnostics);

}  // namespace selvage::fabric
