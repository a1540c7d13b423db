// Overlaps that are too deep for two facing sheets of surface: one yarn runs through another or inside it, or
// two are nearly the same. On closed stretches of both yarns; the answer is then taken on the B-splines.
#pragma once

#include <vector>

#include "contact/contact.h"
#include "contact/tube_mesh.h"

namespace selvage::contact {

// Each connected piece of space that the two stretches share (and that reaches into `walls`), with the least
// translation that ends it. Stretches grow until their cut ends are outside the other yarn. Depths up to
// `touching` count as none. `a` and `b` may be equal: the stretches are different then.
std::vector<Contact> measure_deep(const CellModel& model, std::size_t a, const Stretch& stretch_a,
                                  std::size_t b, const Stretch& stretch_b, const Box3& walls,
                                  double touching);

}  // namespace selvage::contact
