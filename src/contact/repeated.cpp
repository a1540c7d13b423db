#include "contact/repeated.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace selvage::contact {

namespace {

constexpr double same_depth = 0.98, near = 0.5, same_way = 0.9;

// The two yarns, the power of two of a depth, and a cube as large as that.
using Place = std::array<long long, 6>;

Place place_of(const Contact& contact, int level, const Vec3& at) {
  Place place{static_cast<long long>(contact.a), static_cast<long long>(contact.b), level};
  for (std::size_t k = 0; k < 3; ++k)
    place[3 + k] = static_cast<long long>(std::floor(std::ldexp(at[static_cast<Eigen::Index>(k)], -level)));
  return place;
}

// Overlaps that stay, by their places: only those in cubes near another one are compared with it.
class Kept {
 public:
  [[nodiscard]] bool has_like(const Contact& contact) {
    const double depth = contact.depth();
    const Vec3 reach = Vec3::Constant(near * depth);
    for (int level = std::ilogb(depth); level <= std::ilogb(depth / same_depth); ++level) {
      const Place low = place_of(contact, level, contact.at - reach),
                  high = place_of(contact, level, contact.at + reach);
      for (long long x = low[3]; x <= high[3]; ++x)
        for (long long y = low[4]; y <= high[4]; ++y)
          for (long long z = low[5]; z <= high[5]; ++z)
            if (has_like(contact, {low[0], low[1], level, x, y, z})) return true;
    }
    return false;
  }
  void add(const Contact& contact) {
    there_[place_of(contact, std::ilogb(contact.depth()), contact.at)].push_back(
        {contact.depth(), contact.at, contact.direction});
  }
  [[nodiscard]] std::size_t compared() const { return compared_; }

 private:
  struct Overlap {
    double depth;
    Vec3 at, direction;
  };
  [[nodiscard]] bool has_like(const Contact& contact, const Place& place) {
    const auto there = there_.find(place);
    if (there == there_.end()) return false;
    return std::any_of(there->second.begin(), there->second.end(), [&](const Overlap& kept) {
      ++compared_;
      return contact.depth() > same_depth * kept.depth &&
             (kept.at - contact.at).norm() < near * contact.depth() &&
             kept.direction.dot(contact.direction) > same_way;
    });
  }

  std::map<Place, std::vector<Overlap>> there_;
  std::size_t compared_ = 0;
};

}  // namespace

std::size_t drop_repeated(std::vector<Contact>& list) {
  Kept kept;
  std::erase_if(list, [&](const Contact& contact) {
    if (!contact.is_overlap() || !(contact.depth() > 0.0)) return false;
    if (kept.has_like(contact)) return true;
    kept.add(contact);
    return false;
  });
  return kept.compared();
}

}  // namespace selvage::contact
