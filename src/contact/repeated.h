// One overlap that was measured twice.
#pragma once

#include <cstddef>
#include <vector>

#include "contact/contact.h"

namespace selvage::contact {

// Two clusters of places can lie on the walls of one piece of space, which is then measured from both: of
// overlaps of the same two yarns that are about as deep, lie within half of that from each other and part
// them the same way, the first stays. The list is sorted by gap. Returns how many were compared with another
// one: what it cost, which grows with their number.
std::size_t drop_repeated(std::vector<Contact>& list);

}  // namespace selvage::contact
