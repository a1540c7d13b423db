// One place where two surfaces may meet: what is there, measured on the B-splines.
#pragma once

#include <vector>

#include "contact/contact.h"
#include "contact/face.h"

namespace selvage::contact {

// Two cells whose hulls are not certainly farther apart than the reach.
struct NearPair {
  std::uint32_t a = 0, b = 0;
  double low = 0;  // bound of the distance from below
};

// Near pairs of one pair of yarns (or of one yarn with itself: `a` comes first along it) that hang together.
using Cluster = std::vector<NearPair>;

// Every contact in the cluster: overlaps, and gaps up to `reach`.
std::vector<Contact> measure(const CellModel& model, const Cluster& cluster, double reach);

}  // namespace selvage::contact
