// Two surfaces where they are nearest or deepest in each other.
#pragma once

#include <optional>

#include "contact/face.h"

namespace selvage::contact {

struct SurfacePoint {
  nurbs::SurfaceJet jet;
  Vec3 normal = Vec3::Zero();  // outward; zero where there is none
};

// A point of the face; parameters beyond its range go round, or stop at its border.
SurfacePoint point_at(const Face& face, const Vec2& site);

// p on the first surface, q on the second, the outward normal at p opposite to that at q and both along p -
// q: a critical point of the distance. depth = (p - q) . normal: above 0 the yarns share space there, below 0
// it is minus their gap.
struct Critical {
  Vec2 site_a = Vec2::Zero(), site_b = Vec2::Zero();
  Vec3 p = Vec3::Zero(), q = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // the first's, unit, outward
  double depth = 0;
};

// By damped Newton steps from the sites (u, v); where solutions form a line (parallel yarns), some point of
// it. Nothing: it does not converge, as at sharp edges or past a face's border.
// `shift`: the second surface is moved by it first (q is the moved point).
std::optional<Critical> find_critical(const Face& a, const Vec2& site_a, const Face& b, const Vec2& site_b,
                                      const Vec3& shift = Vec3::Zero());

// Where a crease of the first surface, u = `crease`, is deepest in the second one: by Newton's method from v
// along it and from the second's site. site_a.x() is the crease, and `normal` is opposite to the second's
// outward one, along p - q. Nothing: as above.
std::optional<Critical> find_crease(const Face& a, double crease, double v, const Face& b,
                                    const Vec2& site_b);

// The crease along the face that is nearest to u, within a sixteenth of its range.
std::optional<double> crease_near(const Face& face, const Vec2& site);

// The two nearest points of two cells, by Newton's method within their parameters' bounds from given sites:
// also on edges and corners. A local solution.
struct NearestPoints {
  Vec2 site_a = Vec2::Zero(), site_b = Vec2::Zero();
  Vec3 p = Vec3::Zero(), q = Vec3::Zero();
};
NearestPoints find_nearest(const Face& a, const Cell& cell_a, const Vec2& site_a, const Face& b,
                           const Cell& cell_b, const Vec2& site_b);

}  // namespace selvage::contact
