// Is each yarn a closed, valid solid, and do two yarns share space? Implemented in the module selvage_cgal
// (the only user of CGAL); call it through check_solids(), which opens the module.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "yarn/body.h"

namespace selvage::solid {

struct CheckOptions {
  double chord = 0;  // tessellation, file units; 0: 1/200 of each yarn's smallest section extent
  bool overlaps = true;
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

// One connected piece of space that two yarns share; a pair of yarns has one of these for each such piece.
struct Overlap {
  std::size_t a = 0, b = 0;  // indices of the yarns, a < b
  // The least distance by which one yarn has to be moved for this overlap to vanish, along the direction in
  // which it is least; on the B-spline surfaces (refined from the tessellation), right to 1 %.
  double depth = 0;
  Vec3 at = Vec3::Zero();  // in the middle of the shared space
  Vec3 direction =
      Vec3::Zero();  // unit: moving yarn b by depth * direction (or yarn a against it) ends this overlap
};

struct SolidCheck {
  std::vector<YarnCheck> yarns;
  std::vector<Overlap> overlaps;  // deepest first
  // Least distance between two yarns that do not overlap, on the B-spline surfaces, right to 1 %; 0: they
  // touch (to rounding). None when there are no two such yarns.
  std::optional<double> min_gap;
};

Result<SolidCheck> check_solids(std::span<const yarn::Body> bodies, const CheckOptions& options);

// What the module exports.
struct CgalModule {
  const char* version;
  Result<SolidCheck> (*check)(std::span<const yarn::Body> bodies, const CheckOptions& options);
};
Result<const CgalModule*> cgal_module();

}  // namespace selvage::solid
