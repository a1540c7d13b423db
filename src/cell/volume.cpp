#include "cell/volume.h"

#include <algorithm>
#include <cmath>

#include "nurbs/basis.h"
#include "nurbs/measure.h"
#include "yarn/finish.h"

namespace selvage::cell {
namespace {

// The integral of f d(of) along an arc; both are functions of the parameters. Gauss's rule of two points
// between each two of the arc's, which never looks at a crest, where the surface has two normals; `of` is
// taken as quadratic there.
template <class Of, class F>
double along(const ArcCurve& curve, const Of& of, const F& f) {
  const std::vector<double>& lengths = curve.lengths();
  const double offset = std::sqrt(3.0) / 6;
  double sum = 0, start = of(curve.at(0));
  for (std::size_t k = 1; k < lengths.size(); ++k) {
    const auto at = [&](double share) {
      return curve.at(lengths[k - 1] + share * (lengths[k] - lengths[k - 1]));
    };
    const double middle = of(at(0.5)), end = of(at(1));
    for (const double share : {0.5 - offset, 0.5 + offset}) {
      const double slope = (4 * share - 3) * start + (4 - 8 * share) * middle + (4 * share - 1) * end;
      sum += f(at(share)) * slope / 2;
    }
    start = end;
  }
  return sum;
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
        const ArcCurve curve(body_, box_, arc);
        const auto u = [](const Vec2& q) { return q.x(); };
        flux -= along(curve, u, [this](const Vec2& q) { return up_to(q); });
        area -= along(curve, u, [](const Vec2& q) { return q.y(); });
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
      const Edge& edge = division.edges[side.edge];
      if (edge.arc == nullptr) {
        const Vec3 &p = division.corners[side.backward ? edge.to : edge.from].at,
                   &q = division.corners[side.backward ? edge.from : edge.to].at;
        area += (p[x] + q[x] - 2 * box.min()[x]) / 2 * (q[y] - p[y]);
        continue;
      }
      const ArcCurve curve(bodies[cut.pieces[edge.piece].body], box, *edge.arc);
      const auto coordinate = [&](int which) {
        return [&curve, &box, which](const Vec2& q) { return curve.position(q)[which] - box.min()[which]; };
      };
      const double along_arc = along(curve, coordinate(y), coordinate(x));
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
