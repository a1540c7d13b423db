// Yarns that are parts of one yarn of a periodic cloth, and yarns that repeat along themselves, have to move
// alike: they share the nodes of one lattice.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "contact/strand.h"

namespace selvage::contact {

// The nodes that strands share.
struct Lattices {
  std::vector<std::size_t> of;  // each strand; counted from 0 in the order of their first strands
  // Of each strand's energy. 0: it is its lattice's first one at another place, which counts for it. Empty:
  // all 1.
  std::vector<double> weights;
};

// For each strand the number of its lattice, counted from 0 in the order of their first strands. Strands of
// one lattice have the same one set (Strand::set_lattice), with the place that is theirs in it. Two places
// are the same where one of the `periods` takes the centre line of one strand to that of another (or to its
// own), within a hundredth of the thickness, as far as both go.
std::vector<std::size_t> tie_strands(std::span<Strand> strands, std::span<const Vec3> periods);

}  // namespace selvage::contact
