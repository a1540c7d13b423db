#include "cell/volume.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "nurbs/basis.h"
#include "nurbs/measure.h"
#include "yarn/finish.h"

namespace selvage::cell {
namespace {

// The integral of f dg over an interval whose start, middle and end are given, both quadratic in the same
// parameter: Simpson's rule, exact for these.
double integral(const std::array<double, 3>& f, const std::array<double, 3>& g) {
  return (f[0] * (-3 * g[0] + 4 * g[1] - g[2]) + 4 * f[1] * (g[2] - g[0]) +
          f[2] * (g[0] - 4 * g[1] + 3 * g[2])) /
         6;
}

// Calls take(parameters of start, middle, end) for every interval between an arc's points.
template <class Take>
void along(const ArcCurve& curve, const Take& take) {
  const std::vector<double>& lengths = curve.lengths();
  Vec2 start = curve.at(0);
  for (std::size_t k = 1; k < lengths.size(); ++k) {
    const Vec2 middle = curve.at((lengths[k - 1] + lengths[k]) / 2), end = curve.at(lengths[k]);
    take(start, middle, end);
    start = end;
  }
}

// One third of the flux through a piece of a surface.
class PieceFlux {
 public:
  PieceFlux(const yarn::Body& body, const Box3& box, const Piece& piece)
      : body_(body), box_(box), piece_(piece) {
    const nurbs::Surface& s = body.surface;
    breaks_ = nurbs::breakpoints(s.knots_v, s.degree_v);
    if (!body.closed_along) return;
    // A ring goes on for a period on each side.
    const double period = s.last_v() - s.first_v();
    const std::vector<double> once = breaks_;
    breaks_.clear();
    for (const int turn : {-2, -1, 0, 1, 2})
      for (std::size_t i = turn == -2 ? 0 : 1; i < once.size(); ++i)
        breaks_.push_back(once[i] + turn * period);
  }

  [[nodiscard]] double value() {
    choose_base();
    double flux = 0, area = 0, around = 0;
    for (const Border& border : piece_.borders) {
      for (const Arc& arc : border.arcs) {
        along(ArcCurve(body_, box_, arc), [&](const Vec2& a, const Vec2& b, const Vec2& c) {
          const std::array<double, 3> us{a.x(), b.x(), c.x()};
          flux -= integral({up_to(a), up_to(b), up_to(c)}, us);
          area -= integral({a.y(), b.y(), c.y()}, us);
        });
      }
      around += std::abs(border.turns_u);
    }
    // The borders of a ring may be told on different turns of it: their area in the parameters shows it.
    if (body_.closed_along && around > 0) {
      const double whole = (body_.surface.last_u() - body_.surface.first_u()) *
                           (body_.surface.last_v() - body_.surface.first_v());
      flux -= std::floor(area / whole) * nurbs::volume_flux(body_.surface, box_.min());
    }
    return body_.inward ? -flux : flux;
  }

 private:
  void choose_base() {
    double least = breaks_.back();
    for (const Border& border : piece_.borders)
      for (const Arc& arc : border.arcs)
        for (const Vec2& q : arc.parameters) least = std::min(least, q.y());
    const auto after = std::upper_bound(breaks_.begin(), breaks_.end(), least);
    base_ = static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - breaks_.begin() - 1, 0));
  }

  [[nodiscard]] double density(double u, double v) const {
    const nurbs::SurfaceJet s = jet(body_, {u, v});
    return (s.position - box_.min()).dot(s.du.cross(s.dv)) / 3;
  }

  // The integral over v from the base to the point.
  [[nodiscard]] double up_to(const Vec2& q) const {
    const nurbs::GaussRule& rule = nurbs::gauss_rule(5);
    double sum = 0;
    for (std::size_t k = base_; k + 1 < breaks_.size() && breaks_[k] < q.y(); ++k) {
      const double to = std::min(breaks_[k + 1], q.y()), half = (to - breaks_[k]) / 2,
                   middle = (to + breaks_[k]) / 2;
      for (std::size_t g = 0; g < rule.nodes.size(); ++g)
        sum += half * rule.weights[g] * density(q.x(), middle + half * rule.nodes[g]);
    }
    return sum;
  }

  const yarn::Body& body_;
  const Box3& box_;
  const Piece& piece_;
  std::vector<double> breaks_;
  std::size_t base_ = 0;
};

double area_of(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut, const Division& division,
               const FaceRegion& region) {
  const int axis = axis_of(region.face), x = (axis + 1) % 3, y = (axis + 2) % 3;
  double area = 0;
  for (const Outline& outline : region.outlines)
    for (const Side& side : outline) {
      if (side.kind == Side::Kind::segment) {
        const Segment& segment = division.segments[side.segment];
        const Vec3 &p = division.corners[side.backward ? segment.to : segment.from].at,
                   &q = division.corners[side.backward ? segment.from : segment.to].at;
        area += (p[x] + q[x] - 2 * box.min()[x]) / 2 * (q[y] - p[y]);
        continue;
      }
      const Piece& piece = cut.pieces[side.arc.piece];
      const ArcCurve curve(bodies[piece.body], box, piece.borders[side.arc.border].arcs[side.arc.arc]);
      double along_arc = 0;
      along(curve, [&](const Vec2& a, const Vec2& b, const Vec2& c) {
        const Vec3 p = curve.position(a) - box.min(), q = curve.position(b) - box.min(),
                   r = curve.position(c) - box.min();
        along_arc += integral({p[x], q[x], r[x]}, {p[y], q[y], r[y]});
      });
      area += side.backward ? -along_arc : along_arc;
    }
  return is_high(region.face) ? area : -area;
}

}  // namespace

std::vector<double> volumes_inside(std::span<const yarn::Body> bodies, const Box3& box, const Cut& cut,
                                   const Division& division) {
  std::vector<double> volumes(bodies.size(), 0);
  for (const Piece& piece : cut.pieces) {
    const yarn::Body& body = bodies[piece.body];
    double& volume = volumes[piece.body];
    if (piece.borders.empty()) {
      const double flux = nurbs::volume_flux(body.surface, box.min());
      volume += body.inward ? -flux : flux;
      continue;
    }
    volume += PieceFlux(body, box, piece).value();
    for (const Border& border : piece.borders)
      for (const Arc& arc : border.arcs)
        if (arc.face >= face_count) volume += yarn::end_flux(body, arc.face == Arc::own_end, box.min());
  }
  for (const FaceRegion& region : division.regions)
    if (region.body != FaceRegion::matrix && is_high(region.face))
      volumes[region.body] +=
          area_of(bodies, box, cut, division, region) * box.sizes()[axis_of(region.face)] / 3;
  return volumes;
}

}  // namespace selvage::cell
