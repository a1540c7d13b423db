// Is each yarn a closed, valid solid, and do yarns share space? Closedness by the module selvage_cgal (the
// only user of CGAL), overlaps by contact/contact.h.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "contact/contact.h"
#include "core/diagnostics.h"
#include "solid/planar.h"
#include "yarn/body.h"

namespace selvage::solid {

struct CheckOptions {
  // Tessellation, file units. 0: 1/200 of each yarn's narrowest section; of a swept yarn, whose folds and
  // contacts with itself are found without it, 1/50 where that shows a sound solid.
  double chord = 0;
  bool overlaps = true;
  double reach = 0;  // file units; near contacts with a gap up to this are listed too. 0: none
  int threads = 1;
  std::function<void(std::size_t done, std::size_t total)> progress;  // may be empty
};

struct YarnCheck {
  bool closed = false;             // CGAL is_closed on the tessellation
  bool self_intersecting = false;  // CGAL does_self_intersect
  bool bounds_volume = false;      // CGAL does_bound_a_volume
  // Without a gap, and running round a volume. One that crosses itself is closed all the same: that is
  // another defect.
  [[nodiscard]] bool is_shut() const { return closed && (bounds_volume || self_intersecting); }
  bool outward = false;  // CGAL is_outward_oriented
  double end_gap = 0;    // largest distance between an end face's edge and the body's
  double volume = 0;     // of the tessellation
  std::optional<Vec3> self_intersection_at;
  std::vector<Message> defects;  // errors, each with yarn, place and remedy; empty: a valid solid
};

struct SolidCheck {
  std::vector<YarnCheck> yarns;
  // As in contact::Contacts: overlaps, the deepest first; contacts within CheckOptions::reach, the smallest
  // gap first; the smallest gap, right to 1 %, 0: they touch (to rounding).
  std::vector<contact::Contact> overlaps, near_contacts;
  std::optional<double> min_gap;
};

// Errors: what find_contacts() and the module say.
Result<SolidCheck> check_solids(std::span<const yarn::Body> bodies, const CheckOptions& options);

// What the module exports: the check of each yarn by itself, and planar triangulations.
struct CgalModule {
  const char* version;
  Result<SolidCheck> (*check)(std::span<const yarn::Body> bodies, const CheckOptions& options);
  Result<PlanarTriangles> (*triangulate)(std::span<const Vec2> points,
                                         std::span<const PlanarSegment> segments);
};
Result<const CgalModule*> cgal_module();

}  // namespace selvage::solid
