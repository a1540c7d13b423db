// Closed surfaces: their turns, and where they are cut open.
#pragma once

#include <array>

#include "cad/model.h"

namespace selvage::cad {

// Do both ends of a direction of the surface lie on each other?
bool closes(const nurbs::Surface& surface, bool in_u);

// How wide the range of a closed direction is: one turn. 0: not closed. In u and in v.
std::array<double, 2> periods_of(const nurbs::Surface& surface);

// The whole turns that bring one place of the parameters nearest to another.
Vec2 turns_towards(const Vec2& place, const Vec2& other, const std::array<double, 2>& periods);

// A boundary that is wider, or farther away, is none that anybody meant.
inline constexpr double most_turns = 4;

// A face whose boundary in parameters leaves the range of its surface, in a direction in which that is closed
// and the boundary does not go round: the surface is cut open in the middle of the gap that the boundary
// leaves, at whose parameters it then lies. The same points, by as many joined pieces; where the cut was,
// knots of full multiplicity. Any other face stays as it is.
Face with_seam_in_gap(Face face);

}  // namespace selvage::cad
