// Which yarns of a cloth can be moved alike: those that are one shape and have the same neighbours in the
// same places, as the courses of a knit but for the first and the last ones. Moving a few of them then moves
// all.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "yarn/body.h"

namespace selvage::contact {

struct Alike {
  std::vector<std::size_t>
      first;  // for each yarn the first one that moves as it does, itself where none is before
  // Of all pairs of neighbours that are alike (a <= b) the first, and how many there are. A yarn that is the
  // first of its kind makes one with itself, as many as there are of its kind.
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> neighbours;
  // The yarns of these pairs, increasing: what is to be moved.
  std::vector<std::size_t> few;
};

// Neighbours are yarns that come nearer to each other than `reach` (file units, > 0). `marks`, one a yarn:
// what else tells yarns apart. Yarns without a shape (Body::shape) are alike to none.
Alike find_alike(std::span<const yarn::Body> bodies, double reach, std::span<const std::size_t> marks);

}  // namespace selvage::contact
