// Closed surfaces: their turns, and where they are cut open.
#pragma once

#include <array>
#include <optional>

#include "cad/model.h"

namespace selvage::cad {

// Do both ends of a direction of the surface lie on each other?
bool closes(const nurbs::Surface& surface, bool in_u);

// How wide the range of a closed direction is: one turn. 0: not closed. In u and in v.
std::array<double, 2> periods_of(const nurbs::Surface& surface);

// The whole turns that bring one place of the parameters nearest to another; none where they are half a turn
// apart.
Vec2 turns_towards(const Vec2& place, const Vec2& other, const std::array<double, 2>& periods);

// The loop begun at an edge that starts at a pole of the surface, where one does: who goes round it in the
// parameters then knows which turn he is in. Is there one?
bool begin_at_pole(Loop& loop, const nurbs::Surface& surface);

// A loop goes round the surface once, `turns` (1 or -1) in the direction other than `across` (0: u), and the
// face is what is on one side of it: on the one where it has more of `across`? That is where the surface ends
// in a pole; where it does on both sides, the face is to the left of the loop. Nothing where it has no pole.
std::optional<bool> is_high_side(const nurbs::Surface& surface, std::size_t across, int turns);

// A boundary that is wider, or farther away, is none that anybody meant.
inline constexpr double most_turns = 4;

// A face whose boundary in parameters leaves the range of its surface, in a direction in which that is closed
// and the boundary does not go round: the surface is cut open in the middle of the gap that the boundary
// leaves, at whose parameters it then lies. The same points, by as many joined pieces; where the cut was,
// knots of full multiplicity. Any other face stays as it is.
Face with_seam_in_gap(Face face);

}  // namespace selvage::cad
