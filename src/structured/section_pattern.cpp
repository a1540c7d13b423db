#include "structured/section_pattern.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/plane.h"
#include "nurbs/divided.h"
#include "surface_mesh/size_field.h"

namespace selvage::fem {
namespace {

using Piece = std::array<std::size_t, 4>;

// The outline of a section in its plane, at parameters all round it.
struct Outline {
  std::vector<double> us;       // increasing; the last is the first again
  std::vector<Vec2> points;     // as many
  std::vector<double> lengths;  // from the first
  double area = 0;

  [[nodiscard]] std::size_t period() const { return points.size() - 1; }
  // From point k - 1 to point k, numbered all round and on.
  [[nodiscard]] Vec2 step(std::size_t k) const { return points[k % period()] - points[(k - 1) % period()]; }
  // By which it turns at point k > 0, radians, either way.
  [[nodiscard]] double turn(std::size_t k) const {
    return std::abs(std::atan2(cross(step(k), step(k + 1)), step(k).dot(step(k + 1))));
  }
};

// Axes across the centre line at v: the first toward the seam.
std::array<Vec3, 2> plane_at(const yarn::Body& body, const nurbs::CurveJet& centre, double v) {
  const Vec3 along = centre.d1.normalized();
  const Vec3 seam = nurbs::evaluate(body.surface, body.surface.first_u(), v) - centre.position;
  Vec3 across = seam - along * along.dot(seam);
  if (!(across.norm() > 1e-9 * seam.norm())) across = along.unitOrthogonal();
  across.normalize();
  return {across, along.cross(across)};
}

Outline outline_at(const yarn::Body& body, double v) {
  constexpr int least = 256;
  Outline outline;
  outline.us = nurbs::divided(body.surface.knots_u, body.surface.degree_u, 4, least);
  const nurbs::CurveJet centre = nurbs::evaluate_jet(body.axis, v);
  const std::array<Vec3, 2> plane = plane_at(body, centre, v);
  for (const Vec3& point : nurbs::evaluate_grid(body.surface, outline.us, {v})) {
    const Vec3 from = point - centre.position;
    outline.points.emplace_back(from.dot(plane[0]), from.dot(plane[1]));
  }
  const std::size_t count = outline.points.size();
  outline.lengths.assign(count, 0);
  for (std::size_t k = 1; k < count; ++k) {
    outline.area += cross(outline.points[k - 1], outline.points[k]) / 2;
    outline.lengths[k] = outline.lengths[k - 1] + outline.step(k).norm();
  }
  return outline;
}

// The two points of an outline farthest from each other.
std::array<std::size_t, 2> farthest_two(const Outline& outline) {
  std::array<std::size_t, 2> best{};
  double longest = -1;
  for (std::size_t a = 0; a + 1 < outline.points.size(); ++a)
    for (std::size_t b = a + 1; b + 1 < outline.points.size(); ++b)
      if (const double length = (outline.points[a] - outline.points[b]).squaredNorm();
          length > longest * (1 + 1e-9)) {
        longest = length;
        best = {a, b};
      }
  return best;
}

std::size_t nearest_index(const Outline& outline, double u) {
  const auto at = std::lower_bound(outline.us.begin(), outline.us.end() - 1, u);
  return static_cast<std::size_t>(at - outline.us.begin());
}

// How much of the way between two points of an outline (numbered on, to > from) has been passed at each: of
// length and, where it turns, of turn, which counts forty of a hundred at most. A corner at either end is no
// turn on the way.
std::vector<double> passed_shares(const Outline& outline, std::size_t from, std::size_t to) {
  std::vector<double> lengths = {0}, turns = {0};
  for (std::size_t k = from + 1; k <= to; ++k) {
    lengths.push_back(lengths.back() + outline.step(k).norm());
    turns.push_back(turns.back() + (k - 1 > from ? outline.turn(k - 1) : 0));
  }
  const double weight = 0.4 * std::min(turns.back(), 1.0);
  std::vector<double> shares;
  for (std::size_t k = 0; k < lengths.size(); ++k)
    shares.push_back((1 - weight) * lengths[k] / lengths.back() +
                     (weight > 0 ? weight * turns[k] / turns.back() : 0));
  return shares;
}

// Divides the outline between two of its points (the second may be behind the seam) into `count` parts, of
// even length and even turn, but for the first and last, which are `ends` of that; corners on the way get a
// node. Without the second point.
void divide(const Outline& outline, std::size_t from, std::size_t to, std::size_t count,
            const std::vector<std::size_t>& corners, std::vector<double>& ring, double ends = 1) {
  const std::size_t period = outline.period();
  if (to <= from) to += period;
  const std::vector<double> shares = passed_shares(outline, from, to);
  const auto share = [&](std::size_t k) { return shares[k - from]; };
  std::vector<std::size_t> at(count + 1, from);
  at[count] = to;
  std::size_t k = from;
  for (std::size_t i = 1; i < count; ++i) {
    const double wanted = (static_cast<double>(i) - 1 + ends) / (static_cast<double>(count) - 2 + 2 * ends);
    while (k < to && share(k) < wanted) ++k;
    if (k > from && wanted - share(k - 1) < share(k) - wanted) --k;
    at[i] = std::clamp(k, at[i - 1] + 1, to - 1);
  }
  for (std::size_t corner : corners) {
    if (corner <= from) corner += period;
    if (corner >= to) continue;
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < count; ++i)
      if (nearest == 0 ||
          std::abs(share(at[i]) - share(corner)) < std::abs(share(at[nearest]) - share(corner)))
        nearest = i;
    if (nearest > 0 && at[nearest - 1] < corner && at[nearest + 1] > corner) at[nearest] = corner;
  }
  for (std::size_t i = 0; i < count; ++i) ring.push_back(outline.us[at[i] % period]);
}

// Where nodes are asked for, in numbers of pieces.
struct Counts {
  std::size_t along = 2, through = 2;  // the width, the thickness
};

// `through` pieces over one another in each column, `along` columns.
SectionPattern columns_pattern(const Outline& outline, const std::array<std::size_t, 2>& tips,
                               const std::vector<std::size_t>& corners, const Counts& counts) {
  constexpr double tip = 0.3;  // of the others' width: long wedges are stiff, and little of them is best
  const std::size_t n = counts.along, m = counts.through;
  SectionPattern pattern;
  divide(outline, tips[0], tips[1], n, corners, pattern.ring, tip);
  divide(outline, tips[1], tips[0], n, corners, pattern.ring, tip);
  // The node of column line k (1 .. n - 1) at level l, from the part behind the second tip to that before it.
  const auto node = [&](std::size_t k, std::size_t l) {
    if (l == 0) return 2 * n - k;
    return l == m ? k : 2 * n + (k - 1) * (m - 1) + l - 1;
  };
  for (std::size_t k = 1; k < n; ++k)
    for (std::size_t l = 1; l < m; ++l) {
      const double share = static_cast<double>(l) / static_cast<double>(m);
      pattern.inside.push_back({{2 * n - k, 1 - share}, {k, share}});
    }
  for (std::size_t l = 0; l < m; ++l) {
    pattern.pieces.push_back({0, node(1, l + 1), node(1, l), node(1, l)});
    for (std::size_t k = 1; k + 1 < n; ++k)
      pattern.pieces.push_back({node(k, l), node(k, l + 1), node(k + 1, l + 1), node(k + 1, l)});
    pattern.pieces.push_back({n, node(n - 1, l), node(n - 1, l + 1), node(n - 1, l + 1)});
  }
  return pattern;
}

// Each inner node is the mean of its neighbours.
void average_inside(SectionPattern& pattern, std::size_t inside) {
  const std::size_t ring = pattern.ring.size();
  const auto count = static_cast<Eigen::Index>(inside);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
  Eigen::MatrixXd given = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(ring));
  // An edge inside belongs to two pieces, in which it runs both ways: each way is one neighbour.
  for (const Piece& piece : pattern.pieces)
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t a = piece[k], b = piece[(k + 1) % 4];
      if (a == b || a < ring) continue;
      const auto row = static_cast<Eigen::Index>(a - ring);
      matrix(row, row) += 1;
      if (b < ring)
        given(row, static_cast<Eigen::Index>(b)) += 1;
      else
        matrix(row, static_cast<Eigen::Index>(b - ring)) -= 1;
    }
  const Eigen::MatrixXd shares = matrix.partialPivLu().solve(given);
  for (Eigen::Index i = 0; i < count; ++i) {
    SectionPattern::Shares& own = pattern.inside.emplace_back();
    for (std::size_t k = 0; k < ring; ++k) own.emplace_back(k, shares(i, static_cast<Eigen::Index>(k)));
  }
}

// Round a block of a x b squares its border, from the corner (0, 0) counter-clockwise; and the squares.
struct Squares {
  std::size_t a, b;
  [[nodiscard]] std::size_t round() const { return 2 * (a + b); }
  [[nodiscard]] std::size_t inner() const { return (a - 1) * (b - 1); }
  // Below round(): on the border; from there on inside.
  [[nodiscard]] std::size_t node(std::size_t i, std::size_t j) const {
    if (j == 0) return i;
    if (i == a) return a + j;
    if (j == b) return a + b + (a - i);
    if (i == 0) return round() - j;
    return round() + (j - 1) * (a - 1) + i - 1;
  }
  void add_to(std::vector<Piece>& pieces, std::size_t first) const {
    for (std::size_t j = 0; j < b; ++j)
      for (std::size_t i = 0; i < a; ++i)
        pieces.push_back(
            {first + node(i, j), first + node(i + 1, j), first + node(i + 1, j + 1), first + node(i, j + 1)});
  }
};

// A block with one layer round it. The tips are in the middles of its short sides, as nearly as nodes can be.
SectionPattern ring_pattern(const Outline& outline, const std::array<std::size_t, 2>& tips,
                            const std::vector<std::size_t>& corners, const Counts& counts) {
  const Squares squares{counts.through, counts.along};
  SectionPattern pattern;
  divide(outline, tips[0], tips[1], counts.along + counts.through, corners, pattern.ring);
  divide(outline, tips[1], tips[0], counts.along + counts.through, corners, pattern.ring);
  std::rotate(pattern.ring.begin(), pattern.ring.end() - static_cast<std::ptrdiff_t>(counts.through / 2),
              pattern.ring.end());
  const std::size_t round = squares.round();
  for (std::size_t k = 0; k < round; ++k)
    pattern.pieces.push_back({k, (k + 1) % round, round + (k + 1) % round, round + k});
  squares.add_to(pattern.pieces, round);
  average_inside(pattern, round + squares.inner());
  return pattern;
}

// Squares alone between four corners.
SectionPattern block_pattern(const Outline& outline, const std::vector<std::size_t>& corners,
                             const Counts& counts) {
  const auto side = [&](std::size_t k) {
    const double from = outline.lengths[corners[k]], to = outline.lengths[corners[(k + 1) % 4]];
    return k == 3 ? to - from + outline.lengths.back() : to - from;
  };
  const bool is_wide = side(0) + side(2) >= side(1) + side(3);
  const Squares squares{is_wide ? counts.along : counts.through, is_wide ? counts.through : counts.along};
  SectionPattern pattern;
  for (std::size_t k = 0; k < 4; ++k)
    divide(outline, corners[k], corners[(k + 1) % 4], k % 2 == 0 ? squares.a : squares.b, {}, pattern.ring);
  squares.add_to(pattern.pieces, 0);
  average_inside(pattern, squares.inner());
  return pattern;
}

// The sine at the worst corner of a piece, of triangles as a share of the equilateral one's; < 0: one is
// turned.
double worst_corner(const SectionPattern& pattern, const std::vector<Vec2>& places) {
  double worst = 1;
  for (const Piece& piece : pattern.pieces) {
    const std::size_t count = piece[2] == piece[3] ? 3 : 4;
    for (std::size_t k = 0; k < count; ++k) {
      const Vec2 a = places[piece[(k + 1) % count]] - places[piece[k]],
                 b = places[piece[(k + count - 1) % count]] - places[piece[k]];
      const double sine = cross(a, b) / std::max(a.norm() * b.norm(), 1e-300);
      worst = std::min(worst, count == 3 ? sine / std::sqrt(0.75) : sine);
    }
  }
  return worst;
}

double worst_corner(const SectionPattern& pattern, const Outline& outline) {
  std::vector<Vec3> points;
  for (const double u : pattern.ring) {
    const Vec2& at = outline.points[nearest_index(outline, u)];
    points.emplace_back(at.x(), at.y(), 0);
  }
  const std::vector<Vec3> inner = pattern.fill(points);
  points.insert(points.end(), inner.begin(), inner.end());
  std::vector<Vec2> places;
  for (const Vec3& point : points) places.emplace_back(point.x(), outline.area < 0 ? -point.y() : point.y());
  return worst_corner(pattern, places);
}

// Sections all along the yarn that have an area to speak of, the largest first.
std::vector<Outline> some_outlines(const yarn::Body& body) {
  constexpr int count = 8;
  std::vector<Outline> outlines;
  const double first = body.surface.first_v(), last = body.surface.last_v();
  for (int k = 0; k <= count; ++k) outlines.push_back(outline_at(body, first + (last - first) * k / count));
  std::stable_sort(outlines.begin(), outlines.end(), [](const Outline& a, const Outline& b) {
    return std::abs(a.area) > std::abs(b.area) * (1 + 1e-6);
  });
  const double least = 0.1 * std::abs(outlines.front().area);
  std::erase_if(outlines, [&](const Outline& outline) { return !(std::abs(outline.area) >= least); });
  return outlines;
}

std::size_t whole(double wanted, std::size_t least) {
  constexpr double most = 1000;
  return std::max(least, static_cast<std::size_t>(std::clamp(std::ceil(wanted - 0.2), 1.0, most)));
}

// Thickness over the middle half of the way from tip to tip, on average.
double thickness_of(const Outline& outline, double width) {
  return std::abs(outline.area) / width * 4 / std::numbers::pi;  // exact for an ellipse
}

}  // namespace

std::vector<Vec3> SectionPattern::fill(std::span<const Vec3> outline) const {
  std::vector<Vec3> places;
  for (const Shares& shares : inside) {
    Vec3 place = Vec3::Zero();
    for (const auto& [node, share] : shares) place += share * outline[node];
    places.push_back(place);
  }
  return places;
}

SectionPattern section_pattern(const yarn::Body& body, double size) {
  constexpr double stretch = 2.5;   // of pieces along the width
  constexpr double wedges = 0.3;    // by which a pattern with triangles has to be better
  constexpr std::size_t least = 3;  // pieces along each half of a ring's outline are twice that
  const std::vector<Outline> outlines = some_outlines(body);
  const Outline& largest = outlines.front();
  std::vector<std::size_t> corners;
  for (const double u : crests_of(body.surface)) corners.push_back(nearest_index(largest, u));
  std::array<std::size_t, 2> tips = farthest_two(largest);
  const bool is_sharp = corners.size() == 2;
  if (is_sharp) tips = {corners[0], corners[1]};
  const double width = (largest.points[tips[0]] - largest.points[tips[1]]).norm();
  const double thickness = thickness_of(largest, width);

  std::vector<SectionPattern> candidates;
  const std::size_t through = whole(thickness / size, 2);
  const std::size_t along = whole(width / (stretch * size), through);
  if (corners.size() == 4) candidates.push_back(block_pattern(largest, corners, {along, through}));
  if (!is_sharp)
    candidates.push_back(
        ring_pattern(largest, tips, corners, {std::max(along, least), std::max(through, least)}));
  candidates.push_back(
      columns_pattern(largest, tips, corners, {std::max<std::size_t>(along, 6), is_sharp ? 2 : through}));
  SectionPattern* best = nullptr;
  double best_corner = -std::numeric_limits<double>::infinity();
  for (SectionPattern& candidate : candidates) {
    double worst = 1;
    for (const Outline& outline : outlines) worst = std::min(worst, worst_corner(candidate, outline));
    if (&candidate == &candidates.back()) worst -= wedges;
    if (worst > best_corner + 1e-6) {
      best_corner = worst;
      best = &candidate;
    }
  }
  return std::move(*best);
}

}  // namespace selvage::fem
