// Places where two surfaces are nearest or deepest in each other, and the least translation that parts all of
// them.
#pragma once

#include <optional>
#include <vector>

#include "contact/contact.h"
#include "contact/critical.h"

namespace selvage::contact {

// A local minimum of the gap.
struct Spot : Critical {
  const Face* face_a = nullptr;
  const Face* face_b = nullptr;
  bool is_critical = true;  // else on an edge or a border
};

Minimum minimum_of(const Spot& spot);

// Where a crease of one surface, near its site, is deepest in the other one, which is smooth there. Nothing:
// there is no such crease.
std::optional<Spot> crease_spot(const Face& a, const Vec2& site_a, const Face& b, const Vec2& site_b);

// The least translation of b that ends the overlap at all spots deeper than `touching`: each asks for its own
// depth along its own normal, and both are computed again with b where the translation puts it, until it
// changes by less than 1e-10 of itself. Spots on edges keep what they ask for. Nothing: their demands
// contradict each other.
std::optional<Vec3> parting_shift(const std::vector<Spot>& spots, double touching);

}  // namespace selvage::contact
