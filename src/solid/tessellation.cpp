#include "solid/tessellation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/bounds.h"
#include "core/plane.h"
#include "nurbs/divided.h"
#include "nurbs/samples.h"
#include "solid/planar.h"

namespace selvage::solid {

namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

bool is_finite(const nurbs::Surface& surface) {
  return std::all_of(surface.points.begin(), surface.points.end(),
                     [](const Vec3& p) { return p.allFinite(); });
}

// Into how many equal parts each knot span is cut.
struct Cuts {
  std::vector<double> breaks;
  std::vector<double> parts;  // one a span, whole numbers >= 1
};

// The largest second derivative on a span from five points on it, a quarter of the span apart: exact for
// degree <= 3, whose second derivative is linear.
using Span = std::array<Vec3, 5>;
double largest_second_derivative(const Span& p, double step) {
  const std::array<Vec3, 3> d = {p[0] - 2.0 * p[1] + p[2], p[1] - 2.0 * p[2] + p[3],
                                 p[2] - 2.0 * p[3] + p[4]};
  const double ends = std::max((2.0 * d[0] - d[1]).squaredNorm(), (2.0 * d[2] - d[1]).squaredNorm());
  const double inside = std::max({d[0].squaredNorm(), d[1].squaredNorm(), d[2].squaredNorm()});
  return std::sqrt(std::max(ends, inside)) / (step * step);
}

// A surface as it is seen at four places a span.
class Look {
 public:
  explicit Look(const nurbs::Surface& surface)
      : breaks_{nurbs::breakpoints(surface.knots_u, surface.degree_u),
                nurbs::breakpoints(surface.knots_v, surface.degree_v)},
        samples_(surface, nurbs::divided(surface.knots_u, surface.degree_u, 4),
                 nurbs::divided(surface.knots_v, surface.degree_v, 4)) {}

  // du, dv so that the bound of tessellate() is met: 0.4 of `chord` for each direction, 0.2 for the twist.
  [[nodiscard]] std::array<Cuts, 2> cut(double chord) const {
    std::array<Cuts, 2> cuts;
    std::array<std::vector<double>, 2> more;
    for (const bool v : {false, true}) {
      cuts[v].breaks = breaks_[v];
      for (std::size_t k = 0; k + 1 < breaks_[v].size(); ++k) {
        const double step = breaks_[v][k + 1] - breaks_[v][k];
        cuts[v].parts.push_back(
            std::max(1.0, std::ceil(step * std::sqrt(bend(v, k) / (3.2 * chord)) - 1e-9)));
      }
      more[v].assign(cuts[v].parts.size(), 1.0);
    }
    for (std::size_t l = 0; l < more[1].size(); ++l)
      for (std::size_t k = 0; k < more[0].size(); ++k) {
        const double excess = std::sqrt(twist(k, l) / (0.8 * chord * cuts[0].parts[k] * cuts[1].parts[l]));
        more[0][k] = std::max(more[0][k], excess);
        more[1][l] = std::max(more[1][l], excess);
      }
    for (const bool v : {false, true})
      for (std::size_t k = 0; k < more[v].size(); ++k)
        cuts[v].parts[k] = std::ceil(cuts[v].parts[k] * more[v][k] - 1e-9);
    return cuts;
  }

  // No cell along v (or u) longer than this.
  void shorten(bool v, double longest, Cuts& cuts) const {
    for (std::size_t k = 0; k < cuts.parts.size(); ++k)
      cuts.parts[k] =
          std::max(cuts.parts[k], std::ceil(samples_.largest<5>(v, 4 * k, nurbs::length_of<Span>) / longest));
  }

  // The diagonal of the largest section's box.
  [[nodiscard]] double largest_section() const {
    double largest = 0.0;
    for (std::size_t j = 0; j < samples_.vs.size(); ++j)
      largest = std::max(largest, bounds_of(samples_.row(j)).diagonal().norm());
    return largest;
  }

 private:
  // Of the span k of u (or v).
  [[nodiscard]] double bend(bool v, std::size_t k) const {
    const double step = (breaks_[v][k + 1] - breaks_[v][k]) / 4.0;
    return samples_.largest<5>(v, 4 * k, [&](const Span& p) { return largest_second_derivative(p, step); });
  }
  // |S_uv| times both spans.
  [[nodiscard]] double twist(std::size_t k, std::size_t l) const {
    double largest = 0.0;
    for (std::size_t j = 4 * l; j < 4 * l + 4; ++j)
      for (std::size_t i = 4 * k; i < 4 * k + 4; ++i)
        largest = std::max(largest, (samples_.at(i + 1, j + 1) - samples_.at(i + 1, j) -
                                     samples_.at(i, j + 1) + samples_.at(i, j))
                                        .squaredNorm());
    return 16.0 * std::sqrt(largest);
  }

  std::array<std::vector<double>, 2> breaks_;  // of u and of v
  nurbs::Samples samples_;
};

// A quarter of the section over [0, 1]: knots, and how many vertices a unit of length asks for between them.
struct Quarter {
  std::vector<double> ends;
  std::vector<double> density;

  Quarter(const Cuts& cuts, double first, double last, bool backwards) {
    const double length = last - first;
    for (std::size_t k = 0; k + 1 < cuts.breaks.size(); ++k) {
      const double low = std::max(cuts.breaks[k], first), high = std::min(cuts.breaks[k + 1], last);
      if (high <= low) continue;
      ends.push_back((low - first) / length);
      density.push_back(cuts.parts[k] / (cuts.breaks[k + 1] - cuts.breaks[k]) * length);
    }
    ends.push_back(1.0);
    if (!backwards) return;
    std::reverse(ends.begin(), ends.end());
    std::reverse(density.begin(), density.end());
    for (double& t : ends) t = 1.0 - t;
  }

  [[nodiscard]] double density_at(double t) const {
    const auto above = std::upper_bound(ends.begin(), ends.end(), t) - ends.begin();
    return density[static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(above - 1, 0, std::ssize(density) - 1))];
  }
};

// One list of places for two opposite quarters (the second seen backwards), which is what a patch over them
// needs.
std::vector<double> unite(const Quarter& one, const Quarter& two) {
  std::vector<double> all = one.ends;
  all.insert(all.end(), two.ends.begin(), two.ends.end());
  std::sort(all.begin(), all.end());
  Cuts cuts{{0.0}, {}};
  for (double t : all)
    if (t > cuts.breaks.back() + 1e-9 && t < 1.0 - 1e-9) cuts.breaks.push_back(t);
  cuts.breaks.push_back(1.0);
  for (std::size_t k = 0; k + 1 < cuts.breaks.size(); ++k) {
    const double middle = 0.5 * (cuts.breaks[k] + cuts.breaks[k + 1]),
                 length = cuts.breaks[k + 1] - cuts.breaks[k];
    const double density = std::max(one.density_at(middle), two.density_at(middle));
    cuts.parts.push_back(std::max(1.0, std::ceil(length * density - 1e-6)));
  }
  if (cuts.parts.size() == 1)
    cuts.parts[0] = std::max(cuts.parts[0], 2.0);  // a patch's corner needs a cell of its own
  return nurbs::divided(cuts.breaks, cuts.parts);
}

// The places round the section at which the body has its vertices; the last one is the seam again.
struct Round {
  std::vector<double> us;
  std::array<std::vector<double>, 2> patch;  // places of the patches' u and v; empty without patches

  static Round make(const Cuts& cuts, const yarn::Body& body) {
    Round round;
    const bool has_patch =
        body.start.style == yarn::EndStyle::patch || body.end.style == yarn::EndStyle::patch;
    if (!has_patch) {
      round.us = nurbs::divided(cuts.breaks, cuts.parts);
      return round;
    }
    const auto& q = body.quarters;
    const std::array<double, 5> ends = {q[0], q[1], q[2], q[3], body.surface.last_u()};
    for (std::size_t k = 0; k < 2; ++k)
      round.patch[k] = unite({cuts, ends[k], ends[k + 1], false}, {cuts, ends[k + 2], ends[k + 3], true});
    for (std::size_t k = 0; k < 4; ++k) {
      const std::vector<double>& places = round.patch[k % 2];
      const std::size_t n = places.size() - 1;
      for (std::size_t i = 0; i < n; ++i) {
        const double t = k < 2 ? places[i] : 1.0 - places[n - i];
        round.us.push_back(ends[k] + t * (ends[k + 1] - ends[k]));
      }
    }
    round.us.push_back(ends[4]);
    return round;
  }
};

// Collects vertices and triangles.
class Skinner {
 public:
  explicit Skinner(double gap) : gap_(gap) {}

  using Ids = std::vector<std::uint32_t>;

  bool same(const Vec3& a, const Vec3& b) const { return (a - b).norm() <= gap_; }
  const Vec3& vertex(std::uint32_t id) const { return out_.vertices[id]; }

  std::uint32_t add(const Vec3& p) {
    out_.vertices.push_back(p);
    return static_cast<std::uint32_t>(out_.vertices.size() - 1);
  }

  // Vertices for the grid points that have none yet; a point takes its neighbour's where the two are one (a
  // pole). `round`: the last column is the first.
  void fill(const std::vector<Vec3>& points, std::size_t count_u, bool round, Ids& ids) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::size_t i = k % count_u;
      if (ids[k] != none) continue;
      if (i > 0 && same(vertex(ids[k - 1]), points[k])) {
        ids[k] = ids[k - 1];
      } else if (k >= count_u && ids[k - count_u] != none && same(vertex(ids[k - count_u]), points[k])) {
        ids[k] = ids[k - count_u];
      } else if (round && i + 1 == count_u) {
        ids[k] = ids[k - i];
      } else {
        ids[k] = add(points[k]);
      }
    }
  }

  // Two triangles a cell, their normals along S_u x S_v unless flipped; none where vertices coincide.
  void add_grid(const Ids& ids, std::size_t count_u, bool flip, Skin skin) {
    for (std::size_t k = 0; k + count_u < ids.size(); ++k) {
      if (k % count_u + 1 == count_u) continue;
      const std::uint32_t a = ids[k], b = ids[k + 1], c = ids[k + count_u + 1], d = ids[k + count_u];
      // The better shaped pair: at a patch's corner the other diagonal would leave a triangle without area.
      const double by_ac = std::min(shape(a, b, c), shape(a, c, d)),
                   by_bd = std::min(shape(a, b, d), shape(b, c, d));
      if (by_bd > by_ac * (1.0 + 1e-6)) {
        add_triangle(a, b, d, flip, skin);
        add_triangle(b, c, d, flip, skin);
      } else {
        add_triangle(a, b, c, flip, skin);
        add_triangle(a, c, d, flip, skin);
      }
    }
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool flip, Skin skin) {
    if (a == b || b == c || c == a) return;
    if (flip) std::swap(b, c);
    out_.triangles.push_back({a, b, c});
    out_.skin.push_back(skin);
  }

  Tessellation& result() { return out_; }

 private:
  // Area over the longest side squared; coinciding corners do not count against a cell at a pole.
  double shape(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    if (a == b || b == c || c == a) return std::numeric_limits<double>::infinity();
    const Vec3 ab = vertex(b) - vertex(a), ac = vertex(c) - vertex(a), bc = vertex(c) - vertex(b);
    return ab.cross(ac).norm() / std::max({ab.squaredNorm(), ac.squaredNorm(), bc.squaredNorm()});
  }

  double gap_;
  Tessellation out_;
};

using Ids = Skinner::Ids;

void add_patch(Skinner& skinner, const yarn::EndFace& face, const Round& round, const Ids& outline,
               Skin skin) {
  const std::vector<double>&us = round.patch[0], &vs = round.patch[1];
  const std::vector<Vec3> points = nurbs::evaluate_grid(face.surface, us, vs);
  const std::size_t nu = us.size(), nv = vs.size();
  Ids ids(points.size(), none);
  // The body's vertex k of the outline is this point of the patch's border.
  const auto border = [&](std::size_t k) -> std::size_t {
    if (k < nu - 1) return k;
    if (k < nu + nv - 2) return (k - (nu - 1)) * nu + nu - 1;
    if (k < 2 * nu + nv - 3) return (nv - 1) * nu + (nu - 1) - (k - (nu + nv - 2));
    return (nv - 1 - (k - (2 * nu + nv - 3))) * nu;
  };
  for (std::size_t k = 0; k + 1 < outline.size(); ++k)
    if (skinner.same(skinner.vertex(outline[k]), points[border(k)])) ids[border(k)] = outline[k];
  skinner.fill(points, nu, false, ids);
  skinner.add_grid(ids, nu, face.inward, skin);
}

void add_fan(Skinner& skinner, const yarn::EndFace& face, const Round& round, double chord,
             const Ids& outline, Skin skin) {
  const Cuts along = Look(face.surface).cut(chord)[1];
  const std::vector<Vec3> points =
      nurbs::evaluate_grid(face.surface, round.us, nurbs::divided(along.breaks, along.parts));
  Ids ids(points.size(), none);
  for (std::size_t k = 0; k < outline.size(); ++k)
    if (skinner.same(skinner.vertex(outline[k]), points[k])) ids[k] = outline[k];
  skinner.fill(points, outline.size(), true, ids);
  skinner.add_grid(ids, outline.size(), face.inward, skin);
}

// Errors: as solid::triangulate().
Status add_plane(Skinner& skinner, const yarn::EndFace& face, const Ids& outline, Skin skin) {
  Ids ring;
  for (std::uint32_t id : outline)
    if (ring.empty() || (id != ring.back() && id != ring.front())) ring.push_back(id);
  const Vec3 x = face.normal.unitOrthogonal(), y = face.normal.cross(x);
  std::vector<Vec2> flat;
  for (std::uint32_t id : ring) {
    const Vec3 p = skinner.vertex(id) - face.origin;
    flat.emplace_back(p.dot(x), p.dot(y));
  }
  const bool turns_left = twice_area(flat) > 0.0;
  std::vector<PlanarSegment> border;
  for (std::uint32_t k = 0; k < ring.size(); ++k)
    border.push_back(
        {k, (k + 1) % static_cast<std::uint32_t>(ring.size()), turns_left ? 0 : -1, turns_left ? -1 : 0});
  const Result<PlanarTriangles> made = triangulate(flat, border);
  if (!made) return made.error();
  for (const auto& t : made->triangles) skinner.add_triangle(ring[t[0]], ring[t[1]], ring[t[2]], false, skin);
  return {};
}

}  // namespace

double sewing_gap(const yarn::Body& body) {
  double largest = 0.0;
  for (const Vec3& p : body.surface.points) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  const double rounding = 16.0 * (std::nextafter(largest, std::numeric_limits<double>::infinity()) - largest);
  // Other systems write ten digits or recompute edges: what such a file resolves, if it is not worse than
  // that.
  constexpr double ten_digits = 1e-8;
  return std::max(rounding, std::min(body.resolution, ten_digits * largest));
}

Result<Tessellation> tessellate(const yarn::Body& body, double chord, double longest) {
  if (body.surface.is_empty())
    return error(Kind::geometry, fmt::format("yarn '{}' has no surface", body.name), about(body));
  if (!is_finite(body.surface) || !is_finite(body.start.surface) || !is_finite(body.end.surface))
    return error(Kind::geometry,
                 fmt::format("the surface of yarn '{}' has a coordinate that is not finite", body.name),
                 about(body));
  if (!(chord > 0.0)) return error(Kind::internal, "a tessellation needs a chord error above 0", about(body));

  const Look look(body.surface);
  auto [cuts_u, cuts_v] = look.cut(chord);
  // Rows no farther apart than the section is wide: slivers along a straight yarn would help nobody.
  if (const double widest = std::min(look.largest_section(), longest); widest > 0.0)
    look.shorten(true, widest, cuts_v);
  if (std::isfinite(longest)) look.shorten(false, longest, cuts_u);
  double cells_u = 0.0, cells_v = 0.0;
  for (double n : cuts_u.parts) cells_u += n;
  for (double n : cuts_v.parts) cells_v += n;
  while (cells_u < 8.0) {  // a closed section is no less
    for (double& n : cuts_u.parts) n *= 2.0;
    cells_u *= 2.0;
  }
  if (body.closed_along && cells_v < 4.0)
    for (double& n : cuts_v.parts) n = std::max(n, 4.0);
  if (2.0 * cells_u * cells_v > max_triangles)
    return error(
        Kind::limit,
        fmt::format(
            "a chord error of {} needs {:.3g} triangles on yarn '{}' (at most {:.0e}); allow a larger one",
            chord, 2.0 * cells_u * cells_v, body.name, max_triangles),
        about(body));

  const Round round = Round::make(cuts_u, body);
  const std::vector<double> vs = nurbs::divided(cuts_v.breaks, cuts_v.parts);
  const std::size_t nu = round.us.size();
  Skinner skinner(sewing_gap(body));
  std::vector<Vec3> points = nurbs::evaluate_grid(body.surface, round.us, vs);
  if (body.closed_along) points.resize(points.size() - nu);  // the last row is the first
  Ids ids(points.size(), none);
  skinner.fill(points, nu, true, ids);
  if (body.closed_along) ids.insert(ids.end(), ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(nu));
  skinner.add_grid(ids, nu, body.inward, Skin::side);
  for (bool last : {false, true}) {
    if (body.closed_along) break;
    const yarn::EndFace& face = last ? body.end : body.start;
    const Skin skin = last ? Skin::end : Skin::start;
    const Ids outline = last ? Ids(ids.end() - static_cast<std::ptrdiff_t>(nu), ids.end())
                             : Ids(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(nu));
    if (face.style == yarn::EndStyle::patch) add_patch(skinner, face, round, outline, skin);
    if (face.style == yarn::EndStyle::fan) add_fan(skinner, face, round, chord, outline, skin);
    if (face.style != yarn::EndStyle::planar) continue;
    if (const Status done = add_plane(skinner, face, outline, skin); !done)
      return error(
          done.error().kind,
          done.error().kind == Kind::geometry
              ? fmt::format("the outline at the {} of yarn '{}' crosses itself: no plane face can seal it",
                            last ? "end" : "start", body.name)
              : done.error().text,
          about(body));
  }
  Tessellation& out = skinner.result();
  out.sites.assign(out.vertices.size(), Vec2::Constant(std::numeric_limits<double>::quiet_NaN()));
  for (std::size_t k = points.size(); k-- > 0;)  // backwards, so that the seam's first place wins
    out.sites[ids[k]] = Vec2(round.us[k % nu], vs[k / nu]);
  return std::move(out);
}

double volume(const Tessellation& skin) {
  if (skin.vertices.empty()) return 0.0;
  const Vec3 origin = skin.vertices.front();
  double six = 0.0;
  for (const auto& t : skin.triangles)
    six += (skin.vertices[t[0]] - origin)
               .dot((skin.vertices[t[1]] - origin).cross(skin.vertices[t[2]] - origin));
  return six / 6.0;
}

double area(const Tessellation& skin) {
  double twice = 0.0;
  for (const auto& t : skin.triangles)
    twice +=
        (skin.vertices[t[1]] - skin.vertices[t[0]]).cross(skin.vertices[t[2]] - skin.vertices[t[0]]).norm();
  return twice / 2.0;
}

}  // namespace selvage::solid
