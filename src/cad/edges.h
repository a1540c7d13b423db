// The edges of faces, and the shells that they make by them.
#pragma once

#include <ranges>
#include <vector>

#include "cad/model.h"

namespace selvage::cad {

// All of them, loop by loop.
inline auto edges_of(const Face& face) {
  return face.loops | std::views::transform(&Loop::edges) | std::views::join;
}
inline auto edges_of(Face& face) {
  return face.loops | std::views::transform(&Loop::edges) | std::views::join;
}

// The numbers of the faces that hang together by edges of one id (poles aside), in the order of their first
// ones.
std::vector<std::vector<std::size_t>> shells_of(const std::vector<Face>& faces);

}  // namespace selvage::cad
