#include "contact/spot.h"

#include <utility>

#include "contact/least_shift.h"

namespace selvage::contact {

Minimum minimum_of(const Spot& spot) {
  Minimum minimum{{}, {}, spot.p, spot.q, spot.normal, -spot.depth};
  if (spot.face_a->is_side) minimum.site_a = spot.site_a;
  if (spot.face_b->is_side) minimum.site_b = spot.site_b;
  return minimum;
}

std::optional<Spot> crease_spot(const Face& a, const Vec2& site_a, const Face& b, const Vec2& site_b) {
  const std::optional<double> of_a = crease_near(a, site_a), of_b = crease_near(b, site_b);
  if (of_a.has_value() == of_b.has_value()) return std::nullopt;
  std::optional<Critical> found;
  if (of_a) {
    found = find_crease(a, *of_a, site_a.y(), b, site_b);
  } else {
    found = find_crease(b, *of_b, site_b.y(), a, site_a);
    if (found) {
      std::swap(found->site_a, found->site_b);
      std::swap(found->p, found->q);
      found->normal = -found->normal;
    }
  }
  return found ? std::optional(Spot{*found, &a, &b, false}) : std::nullopt;
}

std::optional<Vec3> parting_shift(const std::vector<Spot>& spots, double touching) {
  std::vector<ShiftDemand> demands;
  std::vector<const Spot*> of_demands;
  for (const Spot& spot : spots) {
    if (spot.depth <= touching) continue;
    demands.push_back({spot.normal, spot.depth});
    of_demands.push_back(&spot);
  }
  std::optional<Vec3> shift = least_shift(demands);
  for (int round = 0; round < 20 && shift; ++round) {
    for (std::size_t k = 0; k < demands.size(); ++k) {
      const Spot& spot = *of_demands[k];
      if (!spot.is_critical) continue;
      const std::optional<Critical> found =
          find_critical(*spot.face_a, spot.site_a, *spot.face_b, spot.site_b, *shift);
      if (found && found->normal.dot(spot.normal) > 0.7)
        demands[k] = {found->normal, found->depth + found->normal.dot(*shift)};
    }
    const std::optional<Vec3> next = least_shift(demands);
    const bool is_settled = next && (*next - *shift).norm() < 1e-10 * shift->norm();
    shift = next;
    if (is_settled) break;
  }
  return shift;
}

}  // namespace selvage::contact
