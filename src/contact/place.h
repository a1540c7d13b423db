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

struct Measured {
  std::vector<Contact> contacts;
  double unsettled = 0;  // an overlap up to this depth may have been missed
  bool is_deep = false;  // more of the yarns was looked at than is near: see measure_deep()
};

// Every contact in the cluster: overlaps, and gaps up to `reach`. Overlaps deeper than `resolution` are not
// missed, but where it says so.
Measured measure(const CellModel& model, const Cluster& cluster, double reach, double resolution);

}  // namespace selvage::contact
