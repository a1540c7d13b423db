// The zoo: every fabric of samples/, asked for by property. Each is read by its format's own reader and can
// be built; the property tests run over all that have what they look at, so that a new sample is tested by
// being there.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "construction/build.h"
#include "fabric/model.h"

namespace selvage::zoo {

struct ZooFabric {
  std::string name;       // of the file: "jersey.txt"
  fabric::Fabric fabric;  // as read
};

// All of them, sorted by name; read once. A sample that cannot be read fails the calling test.
const std::vector<ZooFabric>& all();

// Those that have an item of this kind and use no others beside it: with<fabric::Weave>().
template <class Item>
std::vector<const ZooFabric*> with() {
  std::vector<const ZooFabric*> found;
  for (const ZooFabric& zoo : all()) {
    const auto& items = zoo.fabric.items;
    const auto is_one = [](const fabric::Item& item) { return std::holds_alternative<Item>(item); };
    const auto is_use = [](const fabric::Item& item) { return std::holds_alternative<fabric::Use>(item); };
    if (std::ranges::any_of(items, is_one) && std::ranges::none_of(items, is_use)) found.push_back(&zoo);
  }
  return found;
}

// The first item of this kind. Precondition: there is one.
template <class Item>
const Item& item_of(const ZooFabric& zoo) {
  for (const fabric::Item& item : zoo.fabric.items)
    if (const auto* found = std::get_if<Item>(&item)) return *found;
  std::abort();
}

// The plans of all its yarns (of parts where the text asks for plies or filaments). Failures fail the calling
// test.
std::vector<fabric::YarnPlan> plans_of(const ZooFabric& zoo);
std::vector<fabric::YarnPlan> plans_of(const fabric::Fabric& fabric);

// A fabric from text, for mutations. A text that cannot be read fails the calling test.
fabric::Fabric fabric_of(const std::string& text);

}  // namespace selvage::zoo
