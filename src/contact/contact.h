// Where yarns share space or nearly touch, with each other and with themselves, on their B-spline surfaces.
//
// Two stages. Broad: a tree of boxes over pieces of all surfaces, sections and end faces. Narrow: the places
// where two outward normals stand against each other and both points lie on their common line (critical
// points of the distance), found by Newton's method from every local minimum of the pieces; at creases and
// rims, where there are none, by refinement. What is left between two pieces is bounded from below (a
// B-spline lies in the hull of its control points), so that nothing deeper than Contacts::resolution is
// missed. Places in which the same two pieces of surface stand alike are measured once.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/diagnostics.h"
#include "yarn/body.h"

namespace selvage::contact {

// A local minimum of the gap between two surfaces.
struct Minimum {
  std::optional<Vec2> site_a, site_b;  // (u, v); none on an end face
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // a's, unit, outward
  double gap = 0;              // (on_b - on_a) . normal; negative: minus the depth
};

// One connected place where two surfaces overlap; or a local minimum of the gap, where they are near.
struct Contact {
  std::size_t a = 0, b = 0;  // indices of the yarns, a <= b; equal: a yarn meets itself
  // (u, v) of both points on the yarns' surfaces; none on an end face.
  std::optional<Vec2> site_a, site_b;
  Vec3 on_a = Vec3::Zero(), on_b = Vec3::Zero();
  Vec3 at = Vec3::Zero();  // in the middle of the shared space, or of the gap
  // Unit, out of a: moving b along it (or a against it) opens the contact.
  Vec3 direction = Vec3::Zero();
  // >= 0: the distance. < 0: minus the depth, the least distance by which one of the two has to be moved
  // (along `direction`, in which it is least) for this overlap to vanish. Right to 1 %.
  double gap = 0;
  double area = 0;             // of a's surface that lies in b; 0 where they are near only
  std::vector<Minimum> spots;  // every local minimum of the gap in this place, the deepest first

  [[nodiscard]] bool is_overlap() const { return gap < 0; }
  [[nodiscard]] double depth() const { return gap < 0 ? -gap : 0; }
};

struct ContactOptions {
  double reach = 0;  // file units; contacts with a gap up to this are listed too. 0: overlaps only
  // Two places of one yarn count as contact when they are farther apart along it than its section is wide
  // (times one and a half): nearer than that a surface meets itself only in a bend that is too tight
  // (Body::tight_bends).
  bool with_itself = true;
  int threads = 1;
  std::function<void(std::size_t done, std::size_t total)> progress;  // may be empty
};

struct Contacts {
  std::vector<Contact> list;  // deepest first, then by increasing gap; equal ones by yarns and place
  // The least distance between two yarns that do not overlap; none: no two such yarns. Two places of one yarn
  // count where their gap is within the reach, or within 2 % of the thinnest yarn.
  std::optional<double> min_gap;
  // File units: no overlap of surfaces that come near each other deeper than this was missed. A millionth of
  // the thinnest yarn; more where the work of proving it ran out. (Inside deep overlaps, beyond 0.3 of the
  // thickness, places are told apart on meshes.)
  double resolution = 0;
};

// Errors: geometry (a point that is not finite). Empty surfaces take no part. Same input, same result, for
// any number of threads.
Result<Contacts> find_contacts(std::span<const yarn::Body> bodies, const ContactOptions& options);

}  // namespace selvage::contact
