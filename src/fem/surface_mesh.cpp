#include "fem/surface_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fem/planar_mesh.h"

namespace selvage::fem {
namespace {

using nurbs::Surface;

constexpr double turn_per_edge = 0.7;  // radians, at the default size and above; less in proportion below it
constexpr double finest_share = 0.35;  // of the wanted size, where only curvature asks for less
constexpr double growth = 0.3;         // of the spacing, per length
constexpr double least_round = 8;      // vertices
constexpr double sharp_angle = 0.35;   // radians: a crest that gets vertices of its own
constexpr double most_triangles = 2e8;

// The parameters at which the surface may have a crest: knots as many-fold as the degree, and both ends.
std::vector<double> crest_candidates(const std::vector<double>& knots, int degree) {
  std::vector<double> result;
  for (const double value : nurbs::breakpoints(knots, degree))
    if (std::count(knots.begin(), knots.end(), value) >= degree) result.push_back(value);
  return result;
}

// `per_span` steps in each span of the breakpoints.
std::vector<double> fine_parameters(const std::vector<double>& breaks, int per_span) {
  std::vector<double> result;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i)
    for (int k = 0; k < per_span; ++k)
      result.push_back(breaks[i] + (breaks[i + 1] - breaks[i]) * k / per_span);
  result.push_back(breaks.back());
  return result;
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// A finely sampled line with the spacing of vertices that is wanted along it.
struct Gauge {
  std::vector<double> parameters;
  std::vector<double> lengths;     // of the steps, one less
  std::vector<double> spacing;     // wanted at each parameter
  std::vector<double> cumulative;  // steps of that spacing up to each parameter

  // No spacing grows faster along the line than `growth`; `around`: the line is closed.
  void finish(bool around) {
    const std::size_t n = lengths.size();
    for (int round = 0; round < (around ? 2 : 1); ++round) {
      for (std::size_t k = 0; k < n; ++k)
        spacing[k + 1] = std::min(spacing[k + 1], spacing[k] + growth * lengths[k]);
      if (around) spacing[0] = spacing[n] = std::min(spacing[0], spacing[n]);
      for (std::size_t k = n; k-- > 0;)
        spacing[k] = std::min(spacing[k], spacing[k + 1] + growth * lengths[k]);
      if (around) spacing[0] = spacing[n] = std::min(spacing[0], spacing[n]);
    }
    cumulative.assign(n + 1, 0.0);
    for (std::size_t k = 0; k < n; ++k)
      cumulative[k + 1] = cumulative[k] + 2 * lengths[k] / (spacing[k] + spacing[k + 1]);
  }

  [[nodiscard]] double steps_at(double parameter) const {
    const auto k = static_cast<std::size_t>(
        std::lower_bound(parameters.begin(), parameters.end(), parameter) - parameters.begin());
    if (k == 0) return cumulative.front();
    const double share = (parameter - parameters[k - 1]) / (parameters[k] - parameters[k - 1]);
    return cumulative[k - 1] + share * (cumulative[k] - cumulative[k - 1]);
  }

  [[nodiscard]] double parameter_at(double steps) const {
    const auto k = static_cast<std::size_t>(std::lower_bound(cumulative.begin(), cumulative.end(), steps) -
                                            cumulative.begin());
    if (k == 0) return parameters.front();
    if (k >= cumulative.size()) return parameters.back();
    const double share = (steps - cumulative[k - 1]) / (cumulative[k] - cumulative[k - 1]);
    return parameters[k - 1] + share * (parameters[k] - parameters[k - 1]);
  }
};

double curvature_spacing(double angle, double length, double turn, double size) {
  if (angle <= 0) return size;
  return std::clamp(turn * length / angle, finest_share * size, size);
}

// One row of vertices round the section. Segments lie between crests (the seam is one); a segment's vertices
// are its first up to the one before the next segment's first.
struct Row {
  double v = 0;
  std::vector<double> u;                   // increasing from the first u
  std::vector<std::size_t> segment_first;  // index into u, one a segment, and u.size() at the end
  std::uint32_t first_point = 0;

  [[nodiscard]] std::uint32_t point(std::size_t i) const {
    return first_point + static_cast<std::uint32_t>(i % u.size());
  }
};

class Builder {
 public:
  Builder(const yarn::Body& body, double size) : body_(body), surface_(body.surface), size_(size) {}

  Result<SurfaceMesh> build();

 private:
  void find_crests();
  [[nodiscard]] Gauge gauge_round(double v) const;
  [[nodiscard]] Gauge gauge_along() const;
  [[nodiscard]] std::vector<double> row_places(const Gauge& along) const;
  void make_rows(const std::vector<double>& places);
  void make_strips();
  void make_strip(const Row& a, const Row& b, std::size_t segment, std::size_t number);
  [[nodiscard]] Status make_cap(bool last);

  const yarn::Body& body_;
  const Surface& surface_;
  double size_;
  double turn_ = turn_per_edge;  // of the surface along one edge
  std::vector<double> fine_u_;
  std::vector<double> crests_;   // values of u, first and last included
  std::vector<double> creases_;  // values of v, likewise
  std::vector<Row> rows_;
  SurfaceMesh mesh_;
};

void Builder::find_crests() {
  const std::vector<double> spans = nurbs::breakpoints(surface_.knots_u, surface_.degree_u);
  fine_u_ = fine_parameters(spans, std::clamp(static_cast<int>(192 / spans.size()), 2, 16));
  const std::vector<double> candidates = crest_candidates(surface_.knots_u, surface_.degree_u);
  creases_ = crest_candidates(surface_.knots_v, surface_.degree_v);
  crests_ = {candidates.front()};
  // A many-fold knot need not be sharp: the angle on a few sections tells.
  std::vector<double> some_v;
  for (int j = 0; j <= 8; ++j)
    some_v.push_back(surface_.first_v() + (surface_.last_v() - surface_.first_v()) * j / 8);
  const std::vector<Vec3> points = nurbs::evaluate_grid(surface_, fine_u_, some_v);
  for (std::size_t c = 1; c + 1 < candidates.size(); ++c) {
    const auto i = static_cast<std::size_t>(std::lower_bound(fine_u_.begin(), fine_u_.end(), candidates[c]) -
                                            fine_u_.begin());
    double sharpest = 0;
    for (std::size_t j = 0; j < some_v.size(); ++j) {
      const Vec3* row = &points[j * fine_u_.size()];
      sharpest = std::max(sharpest, angle_between(row[i] - row[i - 1], row[i + 1] - row[i]));
    }
    if (sharpest > sharp_angle) crests_.push_back(candidates[c]);
  }
  crests_.push_back(candidates.back());
}

Gauge Builder::gauge_round(double v) const {
  Gauge gauge;
  gauge.parameters = fine_u_;
  const std::vector<Vec3> points = nurbs::evaluate_grid(surface_, fine_u_, {v});
  const std::size_t n = points.size() - 1;
  double perimeter = 0;
  for (std::size_t k = 0; k < n; ++k) {
    gauge.lengths.push_back((points[k + 1] - points[k]).norm());
    perimeter += gauge.lengths.back();
  }
  const double coarsest = std::min(size_, perimeter / least_round);
  gauge.spacing.assign(n + 1, coarsest);
  for (std::size_t k = 1; k < n; ++k) {
    if (std::binary_search(crests_.begin(), crests_.end(), fine_u_[k])) continue;
    const double angle = angle_between(points[k] - points[k - 1], points[k + 1] - points[k]);
    gauge.spacing[k] =
        curvature_spacing(angle, (gauge.lengths[k - 1] + gauge.lengths[k]) / 2, turn_, coarsest);
  }
  gauge.finish(true);
  return gauge;
}

// Along the yarn: mean length of the lines u = const, curvature of the line of section middles.
Gauge Builder::gauge_along() const {
  constexpr std::size_t round = 12;
  Gauge gauge;
  gauge.parameters = fine_parameters(nurbs::breakpoints(surface_.knots_v, surface_.degree_v), 8);
  std::vector<double> us;
  for (std::size_t i = 0; i < round; ++i)
    us.push_back(surface_.first_u() +
                 (surface_.last_u() - surface_.first_u()) * static_cast<double>(i) / round);
  const std::vector<Vec3> points = nurbs::evaluate_grid(surface_, us, gauge.parameters);
  const std::size_t n = gauge.parameters.size() - 1;
  std::vector<Vec3> middles(n + 1, Vec3::Zero());
  for (std::size_t k = 0; k <= n; ++k) {
    double perimeter = 0;
    for (std::size_t i = 0; i < round; ++i) {
      middles[k] += points[k * round + i] / static_cast<double>(round);
      perimeter += (points[k * round + (i + 1) % round] - points[k * round + i]).norm();
    }
    gauge.spacing.push_back(std::min(size_, perimeter / least_round));
    if (k == 0) continue;
    double length = 0;
    for (std::size_t i = 0; i < round; ++i)
      length += (points[k * round + i] - points[(k - 1) * round + i]).norm() / static_cast<double>(round);
    gauge.lengths.push_back(length);
  }
  for (std::size_t k = 1; k < n; ++k) {
    if (std::binary_search(creases_.begin(), creases_.end(), gauge.parameters[k])) continue;
    const Vec3 before = middles[k] - middles[k - 1], after = middles[k + 1] - middles[k];
    const double step = (before.norm() + after.norm()) / 2;
    gauge.spacing[k] = curvature_spacing(angle_between(before, after), step, turn_, gauge.spacing[k]);
  }
  gauge.finish(body_.closed_along);
  return gauge;
}

std::vector<double> Builder::row_places(const Gauge& along) const {
  std::vector<double> result;
  const double least = body_.closed_along && creases_.size() == 2 ? least_round : 1;
  for (std::size_t s = 0; s + 1 < creases_.size(); ++s) {
    const double from = along.steps_at(creases_[s]), to = along.steps_at(creases_[s + 1]);
    const auto count = static_cast<int>(std::max(std::round(to - from), least));
    for (int k = 0; k < count; ++k)
      result.push_back(k == 0 ? creases_[s] : along.parameter_at(from + (to - from) * k / count));
  }
  if (!body_.closed_along) result.push_back(creases_.back());
  return result;
}

void Builder::make_rows(const std::vector<double>& places) {
  const std::size_t segments = crests_.size() - 1;
  std::vector<int> counts(segments, 0);
  for (const double v : places) {
    const Gauge gauge = gauge_round(v);
    Row row;
    row.v = v;
    const double scale = std::max(1.0, least_round / gauge.cumulative.back());
    for (std::size_t s = 0; s < segments; ++s) {
      const double from = gauge.steps_at(crests_[s]), to = gauge.steps_at(crests_[s + 1]);
      // The count of the row before is kept until it is clearly wrong, so that equal sections look the same.
      const double wanted = scale * (to - from);
      if (counts[s] == 0 || std::abs(wanted - counts[s]) > 0.6 + 0.05 * counts[s])
        counts[s] = static_cast<int>(std::max(std::ceil(wanted - 0.25), 1.0));
      row.segment_first.push_back(row.u.size());
      for (int k = 0; k < counts[s]; ++k)
        row.u.push_back(k == 0 ? crests_[s] : gauge.parameter_at(from + (to - from) * k / counts[s]));
    }
    row.segment_first.push_back(row.u.size());
    row.first_point = static_cast<std::uint32_t>(mesh_.points.size());
    const std::vector<Vec3> points = nurbs::evaluate_grid(surface_, row.u, {v});
    mesh_.points.insert(mesh_.points.end(), points.begin(), points.end());
    for (const double u : row.u) mesh_.parameters.emplace_back(u, v);
    rows_.push_back(std::move(row));
  }
}

void Builder::make_strips() {
  const std::size_t count = rows_.size() - (body_.closed_along ? 0 : 1);
  for (std::size_t j = 0; j < count; ++j)
    for (std::size_t s = 0; s + 1 < crests_.size(); ++s)
      make_strip(rows_[j], rows_[(j + 1) % rows_.size()], s, j);
  mesh_.side_triangles = mesh_.triangles.size();
}

// Walks along both rows at the same pace. Where both next vertices are abreast the shorter diagonal decides;
// of equal ones every other, so that the pattern leans to no side.
void Builder::make_strip(const Row& a, const Row& b, std::size_t segment, std::size_t number) {
  const std::size_t first_a = a.segment_first[segment], count_a = a.segment_first[segment + 1] - first_a;
  const std::size_t first_b = b.segment_first[segment], count_b = b.segment_first[segment + 1] - first_b;
  std::size_t i = 0, j = 0;
  while (i < count_a || j < count_b) {
    const std::uint32_t pa = a.point(first_a + i), pb = b.point(first_b + j);
    const std::uint32_t next_a = a.point(first_a + i + 1), next_b = b.point(first_b + j + 1);
    bool advance_a = j == count_b;
    if (i < count_a && j < count_b) {
      const double share_a = static_cast<double>(i + 1) / static_cast<double>(count_a);
      const double share_b = static_cast<double>(j + 1) / static_cast<double>(count_b);
      advance_a = share_a < share_b;
      if (std::abs(share_a - share_b) * static_cast<double>(std::max(count_a, count_b)) < 0.3) {
        const double over_a = (mesh_.points[next_a] - mesh_.points[pb]).norm();
        const double over_b = (mesh_.points[next_b] - mesh_.points[pa]).norm();
        advance_a = std::abs(over_a - over_b) <= 1e-6 * over_a ? (i + number) % 2 == 0 : over_a < over_b;
      }
    }
    if (advance_a) {
      mesh_.triangles.push_back({pa, next_a, pb});
      ++i;
    } else {
      mesh_.triangles.push_back({pa, next_b, pb});
      ++j;
    }
  }
}

Status Builder::make_cap(bool last) {
  const Row& row = last ? rows_.back() : rows_.front();
  std::vector<std::uint32_t> ring;
  for (std::size_t i = 0; i < row.u.size(); ++i) ring.push_back(row.point(i));
  if (!last) std::reverse(ring.begin(), ring.end());
  // A body that is inside out is turned round as a whole afterwards; its caps look inward like its side.
  std::vector<Vec3> rim;
  double perimeter = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    rim.push_back(mesh_.points[ring[i]]);
    perimeter += (mesh_.points[ring[i]] - mesh_.points[ring[(i + 1) % ring.size()]]).norm();
  }
  EndCap cap(rim, last ? body_.end : body_.start);
  const auto planar = mesh_polygon(cap.rim(), std::min(size_, perimeter / least_round));
  if (!planar) {
    Message message =
        error(Kind::geometry, fmt::format("the outline of the yarn's {} crosses itself when it is "
                                          "seen along the yarn; make the end flatter",
                                          last ? "end" : "start"));
    message.at = rim.front();
    return message;
  }
  std::vector<std::uint32_t>& members = last ? mesh_.end_points : mesh_.start_points;
  members = ring;
  for (std::size_t i = ring.size(); i < planar->points.size(); ++i) {
    members.push_back(static_cast<std::uint32_t>(mesh_.points.size()));
    mesh_.points.push_back(cap.lift(planar->points[i]));
  }
  for (const auto& t : planar->triangles)
    mesh_.triangles.push_back({members[t[0]], members[t[1]], members[t[2]]});
  (last ? mesh_.end_triangles : mesh_.start_triangles) = planar->triangles.size();
  (last ? mesh_.end_cap : mesh_.start_cap) = std::move(cap);
  return {};
}

Result<SurfaceMesh> Builder::build() {
  if (surface_.is_empty()) return error(Kind::geometry, "the yarn has no surface");
  for (const Vec3& point : surface_.points)
    if (!point.allFinite())
      return error(Kind::geometry, "a control point of the yarn is not a finite number");
  if (!(size_ > 0) || !std::isfinite(size_))
    return error(Kind::usage, "the mesh size must be a positive number");
  turn_ *= std::min(1.0, size_ / (smallest_section_extent(body_) / 4));
  find_crests();
  const Gauge along = gauge_along();
  const Gauge round = gauge_round(surface_.first_v());
  if (!(2 * along.cumulative.back() * round.cumulative.back() < most_triangles))
    return error(Kind::limit,
                 fmt::format("the size {:.6g} would need more than {:.0e} triangles on the yarn's surface; "
                             "choose a larger --size",
                             size_, most_triangles));
  mesh_.coarsest = *std::max_element(along.spacing.begin(), along.spacing.end());
  make_rows(row_places(along));
  make_strips();
  if (!body_.closed_along)
    for (const bool last : {false, true})
      if (Status made = make_cap(last); !made) return made.error();
  if (enclosed_volume(mesh_.points, mesh_.triangles) < 0)
    for (Triangle& t : mesh_.triangles) std::swap(t[1], t[2]);
  return std::move(mesh_);
}

}  // namespace

double smallest_section_extent(const yarn::Body& body) {
  constexpr int sections = 17, directions = 36, round = 64;
  const Surface& surface = body.surface;
  std::vector<double> us, vs;
  for (int i = 0; i < round; ++i)
    us.push_back(surface.first_u() + (surface.last_u() - surface.first_u()) * i / round);
  for (int j = 0; j < sections; ++j)
    vs.push_back(surface.first_v() + (surface.last_v() - surface.first_v()) * j / (sections - 1));
  const std::vector<Vec3> points = nurbs::evaluate_grid(surface, us, vs);
  std::vector<double> extents;
  for (std::size_t j = 0; j < sections; ++j) {
    const std::span<const Vec3> row = std::span(points).subspan(j * round, round);
    // The section's own normal, from the area that it encloses.
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 0; i + 2 < row.size(); ++i)
      normal += (row[i + 1] - row[0]).cross(row[i + 2] - row[0]);
    const Vec3 x = normal.unitOrthogonal(), y = normal.normalized().cross(x);
    double extent = std::numeric_limits<double>::infinity();
    for (int k = 0; k < directions; ++k) {
      const double angle = std::numbers::pi * k / directions;
      const Vec3 direction = std::cos(angle) * x + std::sin(angle) * y;
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const Vec3& point : row) {
        low = std::min(low, direction.dot(point));
        high = std::max(high, direction.dot(point));
      }
      extent = std::min(extent, high - low);
    }
    extents.push_back(extent);
  }
  const double largest = *std::max_element(extents.begin(), extents.end());
  double result = largest;
  for (const double extent : extents)
    if (extent >= largest / 10) result = std::min(result, extent);
  return result;
}

Result<SurfaceMesh> mesh_surface(const yarn::Body& body, double size) {
  return Builder(body, size).build();
}

}  // namespace selvage::fem
