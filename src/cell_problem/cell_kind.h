// What a unit cell is, by the axes along which it is periodic.
#pragma once

#include <array>
#include <optional>

namespace selvage::fem {

enum class CellKind {
  piece,  // along none: cut out
  beam,   // along one: braid tubes, ropes, strips; all other faces are free
  plate,  // along x and y; the z faces are free
  block   // along all
};

// None: along two axes other than x and y, which has no load cases.
constexpr std::optional<CellKind> kind_of_cell(const std::array<bool, 3>& periodic) {
  const int count = (periodic[0] ? 1 : 0) + (periodic[1] ? 1 : 0) + (periodic[2] ? 1 : 0);
  if (count == 0) return CellKind::piece;
  if (count == 1) return CellKind::beam;
  if (count == 3) return CellKind::block;
  return periodic[2] ? std::nullopt : std::optional(CellKind::plate);
}

// The axis along which a beam is periodic: 0, 1, 2; none: it is no beam.
constexpr std::optional<int> beam_axis(const std::array<bool, 3>& periodic) {
  if (kind_of_cell(periodic) != CellKind::beam) return std::nullopt;
  return periodic[0] ? 0 : periodic[1] ? 1 : 2;
}

}  // namespace selvage::fem
