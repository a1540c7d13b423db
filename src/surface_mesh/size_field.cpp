#include "surface_mesh/size_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/bounds.h"
#include "core/box_tree.h"
#include "core/parallel.h"
#include "nurbs/divided.h"
#include "surface_mesh/triangle_distance.h"

namespace selvage::fem {

namespace {

constexpr std::uint32_t leaf_size = 8;

}  // namespace

SizeField::SizeField(double largest, double growth, std::vector<Bound> bounds)
    : largest_(largest), growth_(growth), bounds_(std::move(bounds)) {
  std::erase_if(bounds_, [&](const Bound& bound) { return !(bound.size < largest_); });
  if (bounds_.empty()) return;
  nodes_.emplace_back();
  split(0, 0, static_cast<std::uint32_t>(bounds_.size()));
}

void SizeField::split(std::uint32_t node, std::uint32_t first, std::uint32_t last) {
  Box3 box;
  double least = largest_;
  for (std::uint32_t k = first; k < last; ++k) {
    box.extend(bounds_[k].at);
    least = std::min(least, bounds_[k].size);
  }
  nodes_[node].box = box;
  nodes_[node].least = least;
  if (last - first <= leaf_size) {
    nodes_[node].first = first;
    nodes_[node].count = last - first;
    return;
  }
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = first + (last - first) / 2;
  const auto begin = bounds_.begin();
  std::nth_element(begin + first, begin + middle, begin + last,
                   [&](const Bound& a, const Bound& b) { return a.at[axis] < b.at[axis]; });
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].first = left;
  nodes_.resize(nodes_.size() + 2);
  split(left, first, middle);
  split(left + 1, middle, last);
}

double SizeField::at(const Vec3& place) const {
  double best = largest_;
  if (nodes_.empty()) return best;
  struct Entry {
    double bound;
    std::uint32_t node;
  };
  const auto entry_of = [&](std::uint32_t node) {
    return Entry{nodes_[node].least + growth_ * nodes_[node].box.exteriorDistance(place), node};
  };
  std::array<Entry, 72> stack{};
  std::size_t depth = 0;
  stack[depth++] = entry_of(0);
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.bound >= best) continue;
    const Node& node = nodes_[entry.node];
    if (node.count == 0) {
      Entry near = entry_of(node.first), far = entry_of(node.first + 1);
      if (far.bound < near.bound) std::swap(near, far);
      stack[depth++] = far;
      stack[depth++] = near;
      continue;
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
      best = std::min(best, bounds_[k].size + growth_ * (bounds_[k].at - place).norm());
  }
  return best;
}

namespace {

constexpr double sharp_angle = 0.35;                           // radians: a crest
constexpr double alongside = 0.966, hardly_alongside = 0.906;  // cosines between a surface and a face

// One yarn's surface as a grid of points near the box.
struct Raster {
  std::uint32_t body = 0;
  std::vector<double> us, vs;         // us: first u <= u < last u
  std::vector<bool> is_crest;         // of each u
  std::vector<bool> joined;           // of each v: the next one follows it on the surface
  std::vector<Vec3> points, normals;  // u fastest; normals outward, unit

  [[nodiscard]] std::size_t index(std::size_t i, std::size_t j) const {
    return j * us.size() + i % us.size();
  }
};

struct Facet {
  std::array<Vec3, 3> corners;
  Vec3 normal;
  std::uint32_t body;
};

std::vector<double> divided(const std::vector<double>& breaks, double length, double step) {
  const double range = breaks.back() - breaks.front();
  return nurbs::divided(breaks, [&](std::size_t k) {
    return nurbs::whole_parts((breaks[k + 1] - breaks[k]) / range * length / step, 1, 100'000);
  });
}

double row_length(const nurbs::Surface& surface, double v) {
  std::vector<double> us;
  for (int i = 0; i <= 64; ++i)
    us.push_back(surface.first_u() + (surface.last_u() - surface.first_u()) * i / 64);
  return nurbs::length_of(nurbs::evaluate_grid(surface, us, {v}));
}

void find_normals(Raster& raster, bool inward) {
  raster.normals.assign(raster.points.size(), Vec3::Zero());
  const std::size_t n = raster.us.size();
  for (std::size_t j = 0; j < raster.vs.size(); ++j) {
    const bool up = raster.joined[j], down = j > 0 && raster.joined[j - 1];
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 round = raster.points[raster.index(i + 1, j)] - raster.points[raster.index(i + n - 1, j)];
      const Vec3 along =
          raster.points[raster.index(i, up ? j + 1 : j)] - raster.points[raster.index(i, down ? j - 1 : j)];
      const Vec3 normal = inward ? along.cross(round) : round.cross(along);
      if (normal.norm() > 0) raster.normals[raster.index(i, j)] = normal.normalized();
    }
  }
}

// Rows far from `near` are left out.
Raster raster_of(const yarn::Body& body, std::uint32_t number, const Box3& near, double step) {
  const nurbs::Surface& surface = body.surface;
  Raster raster;
  raster.body = number;
  const std::vector<double> crests = crests_of(surface);
  std::vector<double> breaks = crests;
  if (breaks.empty() || breaks.front() > surface.first_u()) breaks.insert(breaks.begin(), surface.first_u());
  breaks.push_back(surface.last_u());
  double round = 0;
  for (int j = 0; j <= 4; ++j)
    round = std::max(round,
                     row_length(surface, surface.first_v() + (surface.last_v() - surface.first_v()) * j / 4));
  raster.us = divided(breaks, round, std::min(step, round / 24));
  raster.us.pop_back();  // it is the first again
  for (const double u : raster.us)
    raster.is_crest.push_back(std::binary_search(crests.begin(), crests.end(), u));
  const std::vector<double> vs =
      divided(nurbs::breakpoints(surface.knots_v, surface.degree_v), body.length, step);
  const double reach = yarn::widest_section(body);
  const std::vector<Vec3> some = nurbs::evaluate_grid(surface, {surface.first_u()}, vs);
  bool last_kept = false;
  for (std::size_t j = 0; j < vs.size(); ++j) {
    const bool kept = near.exteriorDistance(some[j]) <= reach + step;
    if (!raster.joined.empty() && last_kept) raster.joined.back() = kept;
    if (kept) {
      raster.vs.push_back(vs[j]);
      raster.joined.push_back(false);
    }
    last_kept = kept;
  }
  if (raster.vs.empty()) return raster;
  raster.points = nurbs::evaluate_grid(surface, raster.us, raster.vs);
  find_normals(raster, body.inward);
  return raster;
}

void add_facets(const Raster& raster, const Box3& near, std::vector<Facet>& facets) {
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    const std::array<Vec3, 3> corners = {raster.points[a], raster.points[b], raster.points[c]};
    if (!near.intersects(bounds_of(corners))) return;
    Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (normal.norm() == 0) return;
    normal.normalize();
    const Vec3 outward = raster.normals[a] + raster.normals[b] + raster.normals[c];
    facets.push_back({corners, normal.dot(outward) < 0 ? Vec3(-normal) : normal, raster.body});
  };
  for (std::size_t j = 0; j + 1 < raster.vs.size(); ++j)
    for (std::size_t i = 0; raster.joined[j] && i < raster.us.size(); ++i) {
      const std::size_t a = raster.index(i, j), b = raster.index(i + 1, j), c = raster.index(i, j + 1),
                        d = raster.index(i + 1, j + 1);
      add(a, b, d);
      add(a, d, c);
    }
}

class Rule {
 public:
  Rule(const std::vector<Facet>& facets, const BoxTree& tree, const Parallelepiped& cell,
       const SizeRules& rules)
      : facets_(facets), tree_(tree), cell_(cell), rules_(rules) {}

  [[nodiscard]] double at(const Raster& raster, std::size_t i, std::size_t j) const {
    const std::size_t k = raster.index(i, j);
    double bound = from_curvature(raster, i, j);
    if (rules_.gap_factor > 0) bound = std::min({bound, from_gap(raster, k), from_faces(raster, k)});
    return std::max(std::min(bound, own(raster).largest), rules_.smallest);
  }

 private:
  [[nodiscard]] const SizeRules::Yarn& own(const Raster& raster) const { return rules_.yarns[raster.body]; }

  [[nodiscard]] double from_gap(const Raster& raster, std::size_t k) const {
    constexpr double opposed = -0.2, in_front = 0.5;
    const Vec3 &p = raster.points[k], &normal = raster.normals[k];
    double least = own(raster).largest / rules_.gap_factor;
    tree_.near_point(p, least, [&](std::uint32_t f) {
      const Facet& facet = facets_[f];
      const bool is_own = facet.body == raster.body;
      if (is_own && facet.normal.dot(normal) > opposed) return least;
      const Vec3 way = nearest_on(facet.corners, p) - p;
      const double distance = way.norm();
      if (distance >= least || (is_own && !(way.dot(normal) > in_front * distance))) return least;
      return least = distance;
    });
    return rules_.gap_factor * least;
  }

  [[nodiscard]] double from_faces(const Raster& raster, std::size_t k) const {
    constexpr double finest = 5;  // over the smallest: a yarn that crosses a face at a grazing angle
    double least = own(raster).largest;
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2;
      const double plane = face % 2 == 1 ? cell_.box.max()[axis] : cell_.box.min()[axis];
      const Vec3 normal = cell_.axes.normal(axis);
      const double aligned = std::abs(raster.normals[k].dot(normal));
      const double share =
          std::clamp((aligned - hardly_alongside) / (alongside - hardly_alongside), 0.0, 1.0);
      if (share == 0) continue;
      const double distance =
          cell_.axes.unit(axis).dot(normal) * std::abs(cell_.axes.own(raster.points[k])[axis] - plane);
      least = std::min(least, rules_.gap_factor * distance / share);
    }
    return std::max(least, finest * rules_.smallest);
  }

  [[nodiscard]] double from_curvature(const Raster& raster, std::size_t i, std::size_t j) const {
    const std::size_t n = raster.us.size(), here = raster.index(i, j);
    double least = own(raster).largest;
    const auto compare = [&](std::size_t other) {
      const double angle = std::acos(std::clamp(raster.normals[here].dot(raster.normals[other]), -1.0, 1.0));
      const double length = (raster.points[here] - raster.points[other]).norm();
      if (angle > 0) least = std::min(least, own(raster).turn * length / angle);
    };
    if (!raster.is_crest[i]) {
      if (!raster.is_crest[(i + 1) % n]) compare(raster.index(i + 1, j));
      if (!raster.is_crest[(i + n - 1) % n]) compare(raster.index(i + n - 1, j));
    }
    if (raster.joined[j]) compare(raster.index(i, j + 1));
    if (j > 0 && raster.joined[j - 1]) compare(raster.index(i, j - 1));
    return std::max(least, rules_.turn_finest * own(raster).largest);
  }

  const std::vector<Facet>& facets_;
  const BoxTree& tree_;
  const Parallelepiped& cell_;
  const SizeRules& rules_;
};

Box3 widened(const Box3& box, double by) {
  return {box.min() - Vec3::Constant(by), box.max() + Vec3::Constant(by)};
}

}  // namespace

SizeField size_field(std::span<const yarn::Body> bodies, const Parallelepiped& cell, const SizeRules& rules,
                     int threads, std::vector<SizeField::Bound> more) {
  const Box3 box = cell.bounds();
  const Box3 near = widened(box, 1.5 * rules.coarsest), nearest = widened(box, rules.coarsest);
  std::vector<Raster> rasters(bodies.size());
  for_each_index(bodies.size(), threads, [&](std::size_t b) {
    rasters[b] = raster_of(bodies[b], static_cast<std::uint32_t>(b), near,
                           std::max(rules.raster, 0.4 * rules.yarns[b].largest));
  });
  std::vector<Facet> facets;
  for (const Raster& raster : rasters) add_facets(raster, near, facets);
  std::vector<Box3> boxes;
  boxes.reserve(facets.size());
  for (const Facet& facet : facets) boxes.push_back(bounds_of(facet.corners));
  const BoxTree tree(std::move(boxes));
  const Rule rule(facets, tree, cell, rules);
  std::vector<std::vector<SizeField::Bound>> bounds(rasters.size());
  for_each_index(rasters.size(), threads, [&](std::size_t b) {
    const Raster& raster = rasters[b];
    for (std::size_t j = 0; j < raster.vs.size(); ++j)
      for (std::size_t i = 0; i < raster.us.size(); ++i) {
        const Vec3& at = raster.points[raster.index(i, j)];
        if (nearest.contains(at)) bounds[b].push_back({at, rule.at(raster, i, j)});
      }
  });
  std::vector<SizeField::Bound> all = std::move(more);
  for (const auto& some : bounds) all.insert(all.end(), some.begin(), some.end());
  return {rules.coarsest, rules.growth, std::move(all)};
}

std::vector<double> crests_of(const nurbs::Surface& surface) {
  std::vector<double> candidates;
  for (const double value : nurbs::breakpoints(surface.knots_u, surface.degree_u))
    if (value < surface.last_u() && nurbs::multiplicity(surface.knots_u, value) >= surface.degree_u)
      candidates.push_back(value);
  // A many-fold knot need not be sharp: the angle on a few sections tells.
  const double range = surface.last_u() - surface.first_u(), step = 1e-4 * range;
  std::vector<double> result;
  for (const double u : candidates) {
    const double before = u - step < surface.first_u() ? u - step + range : u - step;
    double sharpest = 0;
    for (int j = 0; j <= 8; ++j) {
      const double v = surface.first_v() + (surface.last_v() - surface.first_v()) * j / 8;
      const Vec3 a = nurbs::evaluate_jet(surface, before, v).du,
                 b = nurbs::evaluate_jet(surface, u + step, v).du;
      sharpest = std::max(sharpest, std::atan2(a.cross(b).norm(), a.dot(b)));
    }
    if (sharpest > sharp_angle) result.push_back(u);
  }
  return result;
}

}  // namespace selvage::fem
