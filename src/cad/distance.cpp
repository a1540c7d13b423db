#include "cad/distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <queue>

#include "cad/bernstein.h"
#include "cad/region.h"
#include "core/box_tree.h"
#include "nurbs/basis.h"
#include "nurbs/sweep.h"

namespace selvage::cad {

namespace {

using nurbs::Surface;

constexpr double infinity = std::numeric_limits<double>::infinity();

// Values of a parameter at which a surface is sampled: three inside each knot span (its ends may be poles).
std::vector<double> sample_sites(const std::vector<double>& breaks) {
  std::vector<double> sites;
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k)
    for (const double share : {1.0 / 6, 0.5, 5.0 / 6})
      sites.push_back(breaks[k] + share * (breaks[k + 1] - breaks[k]));
  return sites;
}

// Where a surface was sampled.
struct Sample {
  std::uint32_t surface, u, v;
};

struct Target {
  const Surface* surface = nullptr;
  std::vector<double> breaks_u, breaks_v, sites_u, sites_v;
  Range range;
  bool closed_u = false, closed_v = false;
  bool is_curve = false;  // two equal rows
};

// Whether the two boundary curves of a direction are the same to `near`, point by point.
bool is_closed(const Target& target, bool in_u, double near) {
  const Range& r = target.range;
  for (const double t : in_u ? target.sites_v : target.sites_u) {
    const Vec3 a =
        in_u ? nurbs::evaluate(*target.surface, r.u0, t) : nurbs::evaluate(*target.surface, t, r.v0);
    const Vec3 b =
        in_u ? nurbs::evaluate(*target.surface, r.u1, t) : nurbs::evaluate(*target.surface, t, r.v1);
    if ((a - b).norm() > near) return false;
  }
  return true;
}

// A curve as a surface of no width: two equal rows.
bool is_curve(const Surface& surface) {
  const auto half = surface.points.begin() + static_cast<std::ptrdiff_t>(surface.count_u);
  return surface.degree_v == 1 && surface.count_v == 2 &&
         std::equal(surface.points.begin(), half, half, surface.points.end());
}

Target target_of(const Surface& surface, double near) {
  Target target;
  target.surface = &surface;
  target.breaks_u = nurbs::breakpoints(surface.knots_u, surface.degree_u);
  target.breaks_v = nurbs::breakpoints(surface.knots_v, surface.degree_v);
  target.sites_u = sample_sites(target.breaks_u);
  target.sites_v = sample_sites(target.breaks_v);
  target.range = domain(surface);
  target.is_curve = is_curve(surface);
  target.closed_u = is_closed(target, true, near);
  target.closed_v = !target.is_curve && is_closed(target, false, near);
  return target;
}

double brought_inside(double value, double low, double high, bool closed) {
  if (closed && (value < low || value > high)) value = low + std::fmod(value - low, high - low);
  if (closed && value < low) value += high - low;
  return std::clamp(value, low, high);
}

// Gauss and Newton's method, damped: the nearest point of the surface round (u, v).
SurfaceSet::Foot descend(const Target& target, std::size_t index, const Vec3& point, double u, double v) {
  nurbs::SurfaceJet jet = nurbs::evaluate_jet(*target.surface, u, v);
  double best = (jet.position - point).norm(), damping = 1e-12;
  for (int step = 0; step < 40 && best > 0; ++step) {
    const Vec3 miss = point - jet.position;
    const double a = jet.du.squaredNorm(), b = jet.du.dot(jet.dv), c = jet.dv.squaredNorm();
    const double more = damping * (a + c) + std::numeric_limits<double>::min();
    const double determinant = (a + more) * (c + more) - b * b;
    const double p = miss.dot(jet.du), q = miss.dot(jet.dv);
    const double next_u = brought_inside(u + ((c + more) * p - b * q) / determinant, target.range.u0,
                                         target.range.u1, target.closed_u);
    const double next_v = brought_inside(v + ((a + more) * q - b * p) / determinant, target.range.v0,
                                         target.range.v1, target.closed_v);
    const nurbs::SurfaceJet next = nurbs::evaluate_jet(*target.surface, next_u, next_v);
    const double distance = (next.position - point).norm();
    if (!(distance < best)) {
      if (damping > 1e3 || (next_u == u && next_v == v)) break;
      damping = std::max(damping * 100, 1e-6);
      continue;
    }
    const bool is_settled = best - distance <= 1e-15 * best;
    u = next_u;
    v = next_v;
    jet = next;
    best = distance;
    damping = std::max(damping / 10, 1e-12);
    if (is_settled) break;
  }
  return {index, u, v, best};
}

// `t` moved onto the nearest of the sorted `values` that is within `near`.
double snapped(double t, const std::vector<double>& values, double near) {
  const auto above = std::lower_bound(values.begin(), values.end(), t);
  if (above != values.end() && *above - t <= near) return *above;
  if (above != values.begin() && t - *(above - 1) <= near) return *(above - 1);
  return t;
}

enum class Split : std::uint8_t { both, u, v };

// The range divided at its middle in one direction or both; nothing where doubles have no number between.
std::vector<Range> parts_of(const Range& r, Split split) {
  const double u = 0.5 * (r.u0 + r.u1), v = 0.5 * (r.v0 + r.v1);
  const bool has_u = u > r.u0 && u<r.u1, has_v = v> r.v0 && v < r.v1;
  if (split == Split::u && has_u) return {{r.u0, u, r.v0, r.v1}, {u, r.u1, r.v0, r.v1}};
  if (split == Split::v && has_v) return {{r.u0, r.u1, r.v0, v}, {r.u0, r.u1, v, r.v1}};
  if (split == Split::both && has_u && has_v)
    return {{r.u0, u, r.v0, v}, {u, r.u1, r.v0, v}, {r.u0, u, v, r.v1}, {u, r.u1, v, r.v1}};
  return {};
}

// The range divided at its middle in both directions; nothing where doubles have no number between.
std::optional<std::array<Range, 4>> quarters(const Range& r) {
  const double u = 0.5 * (r.u0 + r.u1), v = 0.5 * (r.v0 + r.v1);
  if (!(u > r.u0 && u < r.u1 && v > r.v0 && v < r.v1)) return std::nullopt;
  return std::array<Range, 4>{
      {{r.u0, u, r.v0, v}, {u, r.u1, r.v0, v}, {r.u0, u, v, r.v1}, {u, r.u1, v, r.v1}}};
}

// The sorted breaks between two values, with these at the ends.
std::vector<double> cut_to(const std::vector<double>& breaks, double low, double high) {
  std::vector<double> values = {low};
  for (const double value : breaks)
    if (value > low && value < high) values.push_back(value);
  values.push_back(high);
  return values;
}

// Between neighbours of a grid, along both directions together.
double largest_step(const std::vector<Vec3>& points, std::size_t columns) {
  double along = 0, across = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (k % columns > 0) along = std::max(along, (points[k] - points[k - 1]).squaredNorm());
    if (k >= columns) across = std::max(across, (points[k] - points[k - columns]).squaredNorm());
  }
  return std::sqrt(along) + std::sqrt(across);
}

}  // namespace

struct SurfaceSet::Impl {
  std::vector<Target> targets;
  std::vector<Sample> samples;
  BoxTree tree{{}};  // of the samples' points
  double size = 0;   // largest coordinate
  double step = 0;   // no point of a surface is much farther than this from one of its samples
};

Range domain(const Surface& surface) {
  return {surface.first_u(), surface.last_u(), surface.first_v(), surface.last_v()};
}

nurbs::Surface as_surface(const nurbs::Curve& curve) {
  return nurbs::ruled(curve, curve.points);
}

SurfaceSet::SurfaceSet(const std::vector<const Surface*>& surfaces) {
  auto made = std::make_unique<Impl>();
  Box3 box;
  for (const Surface* surface : surfaces)
    for (const Vec3& p : surface->points) box.extend(p);
  if (!box.isEmpty()) made->size = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  std::vector<Box3> places;
  for (const Surface* surface : surfaces) {
    const Target& target = made->targets.emplace_back(target_of(*surface, 1e-9 * made->size));
    const std::vector<Vec3> points = nurbs::evaluate_grid(*surface, target.sites_u, target.sites_v);
    const auto index = static_cast<std::uint32_t>(made->targets.size() - 1);
    made->step = std::max(made->step, largest_step(points, target.sites_u.size()));
    for (std::size_t k = 0; k < points.size(); ++k) {
      made->samples.push_back({index, static_cast<std::uint32_t>(k % target.sites_u.size()),
                               static_cast<std::uint32_t>(k / target.sites_u.size())});
      places.emplace_back(points[k]);
    }
  }
  made->tree = BoxTree(std::move(places));
  impl_ = std::move(made);
}
SurfaceSet::~SurfaceSet() = default;
SurfaceSet::SurfaceSet(SurfaceSet&&) noexcept = default;
SurfaceSet& SurfaceSet::operator=(SurfaceSet&&) noexcept = default;

SurfaceSet::Foot SurfaceSet::near(const Vec3& point) const {
  Foot best{0, 0, 0, infinity};
  std::vector<std::uint32_t> tried;
  // Next to a border, or where surfaces meet, the nearest sample may be on another one.
  for (int trial = 0; trial < 3; ++trial) {
    const Sample* sample = nullptr;
    double reach = best.distance + impl_->step;
    impl_->tree.near_point(point, reach, [&](std::uint32_t k) {
      const double distance = (impl_->tree.box(k).min() - point).norm();
      if (distance < reach && std::ranges::find(tried, impl_->samples[k].surface) == tried.end()) {
        reach = distance;
        sample = &impl_->samples[k];
      }
      return reach;
    });
    if (sample == nullptr) break;
    const Target& target = impl_->targets[sample->surface];
    const Foot foot =
        descend(target, sample->surface, point, target.sites_u[sample->u], target.sites_v[sample->v]);
    if (foot.distance < best.distance) best = foot;
    if (impl_->targets.size() == 1 || best.distance <= 1e-12 * impl_->size) break;
    tried.push_back(sample->surface);
  }
  return best;
}

double SurfaceSet::least_distance(const Vec3& point, const Foot& foot) const {
  struct Piece {
    double distance;
    std::size_t target;
    Range range;
    bool operator<(const Piece& other) const { return distance > other.distance; }
  };
  std::priority_queue<Piece> queue;
  const auto push = [&](std::size_t target, const Range& range) {
    const Box3 box = piece_bounds(*impl_->targets[target].surface, range);
    const double distance = box.isEmpty() ? 0.0 : box.exteriorDistance(point);
    if (distance < foot.distance) queue.push({distance, target, range});
  };
  for (std::size_t t = 0; t < impl_->targets.size(); ++t) {
    const Target& target = impl_->targets[t];
    for (std::size_t j = 0; j + 1 < target.breaks_v.size(); ++j)
      for (std::size_t i = 0; i + 1 < target.breaks_u.size(); ++i)
        push(t, {target.breaks_u[i], target.breaks_u[i + 1], target.breaks_v[j], target.breaks_v[j + 1]});
  }
  const double near_enough = std::min(0.99 * foot.distance, foot.distance - 1e-14 * impl_->size);
  for (int boxes = 0; boxes < 10'000 && !queue.empty(); ++boxes) {
    const Piece piece = queue.top();
    if (piece.distance >= near_enough) return piece.distance;
    queue.pop();
    const auto parts = quarters(piece.range);
    if (!parts) return piece.distance;
    for (const Range& part : *parts) push(piece.target, part);
  }
  return queue.empty() ? foot.distance : queue.top().distance;
}

// One walk over a surface: the cells that are open, the worst one first.
class Surveyor {
 public:
  Surveyor(const Surface& surface, const SurfaceSet& others, double enough, const SurveyOptions& options)
      : surface_(surface),
        others_(others),
        targets_(others.impl_->targets),
        enough_(enough),
        near_(options.near),
        region_(options.region),
        left_(options.most_cells),
        is_curve_(is_curve(surface)) {}

  Reach survey(const Range& range);

 private:
  struct Cell {
    double bound = 0;
    Range range;
    int depth = 0;
    Split split = Split::both;
    bool operator<(const Cell& other) const { return bound < other.bound; }
  };
  // Where a cell lies in the parameters of one of the others.
  struct Image {
    std::size_t target = 0;
    BilinearMap map;
  };

  void look_at(const Range& range, int depth);
  using Feet = std::array<SurfaceSet::Foot, 4>;
  Feet feet_of(const Range& range);
  [[nodiscard]] std::optional<Image> image_of(Feet feet) const;
  void compare_rectangle(const Range& range, int depth, const Image& image);
  double box_bound(const Range& range);
  void keep(double bound, const Range& range, int depth, Split split = Split::both);
  // Where the difference says too little, the box may say more.
  void keep_difference(const PieceDifference& difference, const Range& range, int depth) {
    double bound = difference.bound;
    if (bound > enough_) bound = std::min(bound, box_bound(range));
    const Split split = difference.bend_s > 4 * difference.bend_t   ? Split::u
                        : difference.bend_t > 4 * difference.bend_s ? Split::v
                                                                    : Split::both;
    keep(bound, range, depth, split);
  }
  // Of the surface's point at (u, v).
  void take_foot(double u, double v, const Vec3& point, const SurfaceSet::Foot& foot);

  const Surface& surface_;
  const SurfaceSet& others_;
  const std::vector<Target>& targets_;
  double enough_, near_;
  const Region* region_;  // may be null
  std::size_t left_, looked_at_ = 0;
  bool is_curve_;
  std::priority_queue<Cell> cells_;
  double of_whole_ = infinity;  // the bound of the cell that is being divided
  double settled_ = 0;          // the largest bound of the cells that need no more
  Vec3 worst_ = Vec3::Zero();
  SurfaceSet::Foot worst_foot_;
  static constexpr int deepest = 40, deepest_search = 20;
  static constexpr double largest_skew = 0.2;  // of a rectangle's image, by its sides
};

void Surveyor::take_foot(double u, double v, const Vec3& point, const SurfaceSet::Foot& foot) {
  ++looked_at_;
  if (foot.distance <= worst_foot_.distance) return;
  if (region_ != nullptr && !region_->contains(u, v)) return;
  worst_foot_ = foot;
  worst_ = point;
}

void Surveyor::keep(double bound, const Range& range, int depth, Split split) {
  bound = std::min(bound, of_whole_);
  if (bound <= enough_)
    settled_ = std::max(settled_, bound);
  else
    cells_.push({bound, range, depth, is_curve_ ? Split::u : split});
}

// Any point of the cell's box is within its half diagonal of the middle one.
double Surveyor::box_bound(const Range& range) {
  const Box3 box = piece_bounds(surface_, range);
  if (box.isEmpty()) return infinity;
  const double u = 0.5 * (range.u0 + range.u1), v = 0.5 * (range.v0 + range.v1);
  const Vec3 middle = nurbs::evaluate(surface_, u, v);
  const SurfaceSet::Foot foot = others_.near(middle);
  take_foot(u, v, middle, foot);
  const Vec3 far = (box.max() - middle).cwiseMax(middle - box.min());
  return foot.distance + far.norm();
}

// Of four points inside the cell: its corners may stand on a seam or a pole.
Surveyor::Feet Surveyor::feet_of(const Range& range) {
  Feet feet;
  const double du = range.u1 - range.u0, dv = range.v1 - range.v0;
  for (std::size_t k = 0; k < 4; ++k) {
    const double u = range.u0 + du * (k % 2 == 0 ? 0.25 : 0.75), v = range.v0 + dv * (k < 2 ? 0.25 : 0.75);
    if (k > 1 && is_curve_) {
      feet[k] = feet[k - 2];
      continue;
    }
    const Vec3 point = nurbs::evaluate(surface_, u, v);
    feet[k] = others_.near(point);
    take_foot(u, v, point, feet[k]);
  }
  return feet;
}

// None when the feet are far from the corners of a rectangle.
std::optional<Surveyor::Image> Surveyor::image_of(Feet feet) const {
  const Target& target = targets_[feet[0].surface];
  const double period_u = target.range.u1 - target.range.u0, period_v = target.range.v1 - target.range.v0;
  for (SurfaceSet::Foot& foot : feet) {  // the same turn round a closed surface
    if (target.closed_u) foot.u -= period_u * std::round((foot.u - feet[0].u) / period_u);
    if (target.closed_v) foot.v -= period_v * std::round((foot.v - feet[0].v) / period_v);
  }
  Image image;
  image.target = feet[0].surface;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto value = [&](std::size_t corner) { return k == 0 ? feet[corner].u : feet[corner].v; };
    const double c00 = value(0), c10 = value(1), c01 = value(2), c11 = value(3);
    // The bilinear function over [0, 1]^2 with these values at 1/4 and 3/4.
    const double s = 2 * ((c10 - c00) + (c11 - c01)) / 2, t = 2 * ((c01 - c00) + (c11 - c10)) / 2;
    const double st = 4 * (c11 - c10 - c01 + c00);
    const double middle = (c00 + c10 + c01 + c11) / 4;
    image.map.of[k] = {middle - (s + t) / 2 + st / 4, s - st / 2, t - st / 2, st};
  }
  if (target.is_curve) image.map.of[1] = {0, 0, 1, 0};
  if (!image.map.make_rectangle(largest_skew)) return std::nullopt;
  return image;
}

// The cell's image is cut at the borders and knots of the target; what lies outside is looked at again.
void Surveyor::compare_rectangle(const Range& range, int depth, const Image& image) {
  const Target& target = targets_[image.target];
  const bool swaps = image.map.is_swapped();
  const auto cuts_of = [&](bool along_u) {  // fractions of the cell's side, with 0 and 1
    const bool other_u = along_u != swaps;
    const std::vector<double>& breaks = other_u ? target.breaks_u : target.breaks_v;
    const bool is_closed = other_u ? target.closed_u : target.closed_v;
    const auto [start, slope] = image.map.line(other_u);
    std::vector<double> cuts = {0.0, 1.0};
    if (slope == 0) return cuts;
    const double period = breaks.back() - breaks.front();
    for (const double turn : {-period, 0.0, period}) {
      if (turn != 0 && !is_closed) continue;
      // Those inside alone: a long yarn has thousands of knots, and as many cells.
      const auto [low, high] = std::minmax({start - turn, start + slope - turn});
      for (auto knot = std::ranges::lower_bound(breaks, low); knot != breaks.end() && *knot <= high; ++knot)
        cuts.push_back(std::clamp((*knot + turn - start) / slope, 0.0, 1.0));
    }
    std::sort(cuts.begin(), cuts.end());
    std::vector<double> kept;
    for (const double cut : cuts) {
      if (kept.empty() || cut - kept.back() > 1e-7) kept.push_back(cut);
    }
    if (1 - kept.back() < 1e-7) kept.pop_back();
    kept.push_back(1.0);
    return kept;
  };
  const std::vector<double> us = cuts_of(true), vs = cuts_of(false);
  const auto between = [](double low, double high, double share) {
    return share == 1.0 ? high : low + share * (high - low);
  };
  for (std::size_t j = 0; j + 1 < vs.size(); ++j)
    for (std::size_t i = 0; i + 1 < us.size(); ++i) {
      const Range part = {between(range.u0, range.u1, us[i]), between(range.u0, range.u1, us[i + 1]),
                          between(range.v0, range.v1, vs[j]), between(range.v0, range.v1, vs[j + 1])};
      Range there = image.map.rectangle(us[i], us[i + 1], vs[j], vs[j + 1]);
      const auto fit = [](double& a, double& b, const std::vector<double>& breaks, bool is_closed) {
        const double low = breaks.front(), high = breaks.back(), middle = 0.5 * (a + b);
        if (is_closed) {
          const double turn = (high - low) * std::floor((middle - low) / (high - low));
          a -= turn;
          b -= turn;
        }
        const double near = 1e-7 * (high - low);
        a = snapped(a, breaks, near * 0.1);
        b = snapped(b, breaks, near * 0.1);
        if (std::min(a, b) < low - near || std::max(a, b) > high + near) return false;
        a = std::clamp(a, low, high);
        b = std::clamp(b, low, high);
        return true;
      };
      const bool is_inside = fit(there.u0, there.u1, target.breaks_u, target.closed_u) &&
                             fit(there.v0, there.v1, target.breaks_v, target.closed_v);
      const bool is_whole = us.size() == 2 && vs.size() == 2;
      if (is_inside)
        keep_difference(piece_difference(surface_, part, *target.surface, there, swaps), part, depth);
      else if (is_whole || depth >= deepest)
        keep(box_bound(part), part, depth);
      else
        look_at(part, depth + 1);
    }
}

void Surveyor::look_at(const Range& range, int depth) {
  if (region_ != nullptr && !region_->may_meet(range)) return;
  if (left_ > 0) --left_;
  const Feet feet = feet_of(range);
  const bool same_low = feet[0].surface == feet[1].surface, same_high = feet[2].surface == feet[3].surface;
  const bool same_left = feet[0].surface == feet[2].surface, same_right = feet[1].surface == feet[3].surface;
  if (same_low && same_high && same_left && same_right) {
    if (const std::optional<Image> image = image_of(feet)) return compare_rectangle(range, depth, *image);
  } else if (depth < deepest_search) {
    // Over a border of two of the others: what is on one side of it alone tells where the border is.
    const double u = 0.5 * (range.u0 + range.u1), v = 0.5 * (range.v0 + range.v1);
    if (same_low && same_high) {
      look_at({range.u0, range.u1, range.v0, v}, depth + 1);
      look_at({range.u0, range.u1, v, range.v1}, depth + 1);
      return;
    }
    if (same_left && same_right) {
      look_at({range.u0, u, range.v0, range.v1}, depth + 1);
      look_at({u, range.u1, range.v0, range.v1}, depth + 1);
      return;
    }
  }
  keep(box_bound(range), range, depth);
}

Reach Surveyor::survey(const Range& range) {
  const std::vector<double> us =
      cut_to(nurbs::breakpoints(surface_.knots_u, surface_.degree_u), range.u0, range.u1);
  const std::vector<double> vs =
      cut_to(nurbs::breakpoints(surface_.knots_v, surface_.degree_v), range.v0, range.v1);
  left_ += (us.size() - 1) * (vs.size() - 1);  // each is looked at once in any case
  for (std::size_t j = 0; j + 1 < vs.size(); ++j)
    for (std::size_t i = 0; i + 1 < us.size(); ++i) look_at({us[i], us[i + 1], vs[j], vs[j + 1]}, 0);
  while (!cells_.empty() && left_ > 0) {
    const Cell cell = cells_.top();
    if (cell.bound <= near_ * worst_foot_.distance) break;
    cells_.pop();
    of_whole_ = cell.bound;
    const std::vector<Range> parts = parts_of(cell.range, cell.split);
    // Cuts at borders count as divisions, too, and leave a cell as wide as it was: they may begin anew.
    for (const Range& part : parts) look_at(part, std::min(cell.depth + 1, deepest / 2));
    if (parts.empty()) settled_ = std::max(settled_, cell.bound);
  }
  Reach reach;
  reach.at_most = cells_.empty() ? settled_ : std::max(settled_, cells_.top().bound);
  reach.at = worst_;
  reach.found = worst_foot_.distance;
  reach.looked_at = looked_at_;
  if (worst_foot_.distance > enough_) reach.at_least = others_.least_distance(worst_, worst_foot_);
  reach.at_most = std::max(reach.at_most, reach.at_least);
  return reach;
}

Reach distance_to(const Surface& surface, const Range& range, const SurfaceSet& others, double enough,
                  const SurveyOptions& options) {
  return Surveyor(surface, others, enough, options).survey(range);
}

Reach sampled_distance(const Surface& surface, const Range& range, const SurfaceSet& others, double enough,
                       int points, const Region* region) {
  Reach reach;
  reach.at_most = infinity;
  SurfaceSet::Foot worst;
  // Shares of the golden section: no grid, whose lines could keep step with what repeats itself.
  const double golden = 0.5 * (std::sqrt(5.0) - 1);
  for (int k = 0; k < points; ++k) {
    const double share = k * golden;
    const double u = std::lerp(range.u0, range.u1, share - std::floor(share)),
                 v = std::lerp(range.v0, range.v1, (k + 0.5) / points);
    if (region != nullptr && !region->contains(u, v)) continue;
    const Vec3 p = nurbs::evaluate(surface, u, v);
    const SurfaceSet::Foot foot = others.near(p);
    ++reach.looked_at;
    if (foot.distance <= worst.distance) continue;
    worst = foot;
    reach.at = p;
  }
  reach.found = worst.distance;
  if (reach.found > enough) reach.at_least = others.least_distance(reach.at, worst);
  return reach;
}

}  // namespace selvage::cad
