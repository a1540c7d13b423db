// A yarn as a manifold solid B-rep (186 with 514, 510, 508, 504, 502 and the edges' 126s).
#pragma once

#include "formats/iges/entities.h"

namespace selvage::formats::iges {

// How many entities write_solid writes for this body.
int entities_of_solid(const yarn::Body& body);

// Precondition: the body is closed (a ring, or both ends sealed). Returns the pointer of the 186.
int write_solid(Records& records, const Common& common, const yarn::Body& body);

}  // namespace selvage::formats::iges
