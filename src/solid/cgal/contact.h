// Connected places where two skins share space or nearly touch.
#pragma once

#include <cstdint>
#include <vector>

#include "solid/cgal/triangle_tree.h"

namespace selvage::solid {

struct Contact {
  // Triangles of each skin that are near the other one, cross it, or lie inside it.
  std::vector<std::uint32_t> a, b;
  TriangleTree::Pair nearest;  // distance 0: the skins meet here
  bool shared = false;         // the skins meet here, or one lies inside the other
};

// One contact for each connected piece of shared space (its walls are the parts of A inside B and of B inside
// A), and one for each connected group of near pairs where nothing is shared. `pairs`: all that are nearer
// than some reach. Both skins closed and outward; O(triangles).
std::vector<Contact> find_contacts(const TriangleTree& a, const TriangleTree& b,
                                   const std::vector<TriangleTree::Pair>& pairs);

}  // namespace selvage::solid
