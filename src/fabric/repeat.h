// How often a fabric repeats: what a periodic unit cell has to be a whole multiple of.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "core/vec.h"
#include "yarn/body.h"

namespace selvage::fabric {

// Along x, y and z: the smallest translation that maps the yarns onto themselves, file units; none: they do
// not repeat that way. 0: any translation does.
using Repeat = std::array<std::optional<double>, 3>;

// The smallest divisor of `count` by which a sequence of `count` things that begins anew after the last can
// be shifted without a change; are_same(i, k): of things of any two numbers from 0.
long long smallest_shift(long long count, const std::function<bool(long long, long long)>& are_same);

// The same of the lines of a pattern, each of so many places; at(line, place).
template <class At>
long long smallest_repeat(long long lines, long long places, const At& at) {
  return smallest_shift(lines, [&](long long i, long long k) {
    for (long long place = 0; place < places; ++place)
      if (at(i, place) != at(k, place)) return false;
    return true;
  });
}

// The smallest repeat of two fabrics in one: a multiple of both; none beyond a thousand repeats of either.
Repeat common_repeat(const Repeat& a, const Repeat& b);

// A yarn that runs through one of two opposite faces of a box and has no counterpart in the other.
struct LooseEnd {
  std::size_t body = 0;
  Vec3 at = Vec3::Zero();  // of its centre line, in the face
  bool high = false;       // which face
};

// Do the centre lines that cross the box's two faces across `axis` (0, 1, 2) cross them at equal places, to
// within the tolerance (file units)? None: they do. Runs along a face are not looked at.
std::optional<LooseEnd> find_loose_end(std::span<const yarn::Body> bodies, const Box3& box, int axis,
                                       double tolerance);

// Do the centre lines near the box come to centre lines when they are moved by `repeat` along `axis`,
// forwards and back, as far as that brings them into the box? None: they do. Else a yarn and where its copy
// is missing.
std::optional<LooseEnd> find_missing_copy(std::span<const yarn::Body> bodies, const Box3& box, int axis,
                                          double repeat, double tolerance);

// The same of the centre lines within `margin` of the box's two faces across `axis`, as far as that brings
// them to one of the faces: runs along a face cross it nowhere, so find_loose_end does not see them.
std::optional<LooseEnd> find_missing_in_faces(std::span<const yarn::Body> bodies, const Box3& box, int axis,
                                              double repeat, double margin, double tolerance);

// Does a centre line cross the low or the high face of the box across `axis`?
bool runs_through(std::span<const yarn::Body> bodies, const Box3& box, int axis, bool high);

// The smallest translation along `axis` that takes all centre lines to centre lines within the tolerance, as
// far as they go; 0: any does (straight yarns along it, or none). None: there is none of at most half of what
// they fill.
std::optional<double> repeat_of_lines(std::span<const yarn::Body> bodies, int axis, double tolerance);

// Two translations in the plane of the cloth that take the centre lines to centre lines within a region that
// is larger than a repeat, and of which all others that do are sums: the shortest ones, right-handed seen
// along z. Looked for among the sixteenths and larger parts of the repeats along x and y, and these
// themselves.
std::array<Vec3, 2> oblique_repeat(std::span<const yarn::Body> bodies, const Box3& region,
                                   const std::array<double, 2>& along_x_and_y, double tolerance);

}  // namespace selvage::fabric
