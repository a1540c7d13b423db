#include "contact/repeated.h"

#include <map>
#include <utility>

#include "core/box_tree.h"

namespace selvage::contact {

namespace {

constexpr double same_depth = 0.98, near = 0.5, same_way = 0.9;

}  // namespace

std::size_t drop_repeated(std::vector<Contact>& list) {
  std::map<std::pair<std::size_t, std::size_t>, std::vector<std::size_t>> by_yarns;  // the deepest first
  for (std::size_t k = 0; k < list.size(); ++k)
    if (list[k].depth() > 0.0) by_yarns[{list[k].a, list[k].b}].push_back(k);
  std::size_t compared = 0;
  std::vector<bool> gone(list.size(), false);
  for (const auto& entry : by_yarns) {
    const std::vector<std::size_t>& overlaps = entry.second;
    std::vector<Box3> places;
    places.reserve(overlaps.size());
    for (const std::size_t k : overlaps) places.emplace_back(list[k].at);
    const BoxTree tree(std::move(places));
    for (std::size_t k = 0; k < overlaps.size(); ++k) {
      const Contact& contact = list[overlaps[k]];
      const double reach = near * contact.depth();
      tree.near_point(contact.at, reach, [&](std::uint32_t other) {
        const Contact& kept = list[overlaps[other]];
        if (other >= k || gone[overlaps[other]]) return reach;
        ++compared;
        if (contact.depth() > same_depth * kept.depth() && (kept.at - contact.at).norm() < reach &&
            kept.direction.dot(contact.direction) > same_way)
          gone[overlaps[k]] = true;
        return reach;
      });
    }
  }
  std::size_t index = 0;
  std::erase_if(list, [&](const Contact&) { return gone[index++]; });
  return compared;
}

}  // namespace selvage::contact
