#include "structured/raster.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/units.h"
#include "fem/fibre.h"
#include "nurbs/divided.h"
#include "structured/voxel_grid.h"
#include "structured/yarn_triangles.h"
#include "yarn/in_axes.h"

namespace selvage::fem {
namespace {

constexpr double most_voxels = 2e8;
constexpr double least_share = 1e-7;  // of a voxel: below it a yarn is not there

// A convex polygon, a piece of a triangle: every plane that cuts it adds at most one corner, and six of them
// bound a voxel.
struct Piece {
  std::array<Vec3, 12> corners;
  std::size_t size = 0;

  void add(const Vec3& corner) { corners[size++] = corner; }
  [[nodiscard]] std::pair<double, double> range(int axis) const {
    double low = corners[0][axis], high = low;
    for (std::size_t i = 1; i < size; ++i) {
      low = std::min(low, corners[i][axis]);
      high = std::max(high, corners[i][axis]);
    }
    return {low, high};
  }
};

// What is below the plane axis = at, and what is above it, which takes the place of the whole.
Piece cut_off(Piece& whole, int axis, double at) {
  Piece below, above;
  for (std::size_t i = 0; i < whole.size; ++i) {
    const Vec3 &p = whole.corners[i], &q = whole.corners[i + 1 == whole.size ? 0 : i + 1];
    (p[axis] <= at ? below : above).add(p);
    if ((p[axis] <= at) == (q[axis] <= at)) continue;
    // The same point for the triangle on the edge's other side.
    const bool ordered = p[axis] < q[axis];
    const Vec3 &low = ordered ? p : q, &high = ordered ? q : p;
    Vec3 corner = low + (high - low) * ((at - low[axis]) / (high[axis] - low[axis]));
    corner[axis] = at;
    below.add(corner);
    above.add(corner);
  }
  whole = above;
  return below;
}

// Cuts a piece by the planes of whole numbers between `low` and `high`: take(piece, k) for what lies between
// k and k + 1; for all that is below `low` k = low - 1, for all above `high` k = high.
template <class Take>
void slice(Piece piece, int axis, std::ptrdiff_t low, std::ptrdiff_t high, const Take& take) {
  const auto [least, most] = piece.range(axis);
  auto k = std::max(low - 1, static_cast<std::ptrdiff_t>(std::floor(least)));
  for (; k < high && most > static_cast<double>(k + 1); ++k) {
    const Piece below = cut_off(piece, axis, static_cast<double>(k + 1));
    if (below.size > 2) take(below, k);
    if (piece.size < 3) return;
  }
  take(piece, std::min(k, high));
}

// How much of one yarn is in each voxel of a box round it. Lengths in voxels' sides.
class YarnShares {
 public:
  YarnShares(const std::array<std::ptrdiff_t, 3>& low, const std::array<std::ptrdiff_t, 3>& high)
      : low_(low), high_(high) {
    for (std::size_t a = 0; a < 3; ++a) sizes_[a] = static_cast<std::size_t>(high[a] - low[a]);
    cells_.resize(sizes_[0] * sizes_[1] * sizes_[2]);
  }

  void add(const Vec3& a, const Vec3& b, const Vec3& c, double v) {
    Piece triangle;
    triangle.add(a);
    triangle.add(b);
    triangle.add(c);
    slice(triangle, 0, low_[0], high_[0], [&](const Piece& strip, std::ptrdiff_t i) {
      if (i < low_[0] || i >= high_[0]) return;
      slice(strip, 1, low_[1], high_[1], [&](const Piece& part, std::ptrdiff_t j) {
        if (j < low_[1] || j >= high_[1]) return;
        slice(part, 2, low_[2], high_[2],
              [&](const Piece& piece, std::ptrdiff_t k) { account(piece, i, j, k, v); });
      });
    });
  }

  // take(voxel of the box as three numbers of the grid, share, v) for those with a share, column by column.
  template <class Take>
  void finish(bool is_ring, double range, const Take& take) {
    const std::size_t height = sizes_[2];
    double sum = 0;
    for (std::size_t column = 0; column < cells_.size() / height; ++column) {
      double above = 0;
      for (std::size_t k = height; k-- > 0;) {
        Cell& cell = cells_[column * height + k];
        const double area = cell.area;
        cell.share += above;
        above += area;
        sum += cell.share;
      }
    }
    const double sign = sum < 0 ? -1 : 1;
    for (std::size_t column = 0; column < cells_.size() / height; ++column) {
      const std::span<Cell> cells = std::span(cells_).subspan(column * height, height);
      for (Cell& cell : cells) cell.share = std::min(1.0, sign * cell.share);
      fill_inside(cells, is_ring, range);
      const auto i = low_[0] + static_cast<std::ptrdiff_t>(column / sizes_[1]);
      const auto j = low_[1] + static_cast<std::ptrdiff_t>(column % sizes_[1]);
      for (std::size_t k = 0; k < height; ++k)
        if (cells[k].share > least_share)
          take(std::array{i, j, low_[2] + static_cast<std::ptrdiff_t>(k)}, cells[k].share,
               static_cast<double>(cells[k].v));
    }
  }

 private:
  struct Cell {
    double share = 0;   // under the pieces in it; then in all
    double area = 0;    // of the pieces in it, seen along z, with their sign
    float v = 0;        // of the largest piece in it
    float largest = 0;  // its area; 0: the surface does not pass here
  };

  void account(const Piece& piece, std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k, double v) {
    if (k < low_[2]) return;
    double area = 0, volume = 0, size = 0;
    const double floor = static_cast<double>(k);
    const Vec3& a = piece.corners[0];
    for (std::size_t c = 1; c + 1 < piece.size; ++c) {
      const Vec3 &p = piece.corners[c], &q = piece.corners[c + 1];
      const Vec3 normal = (p - a).cross(q - a) / 2;
      area += normal.z();
      volume += normal.z() * ((a.z() + p.z() + q.z()) / 3 - floor);
      size += normal.norm();
    }
    const std::size_t column =
        static_cast<std::size_t>(i - low_[0]) * sizes_[1] + static_cast<std::size_t>(j - low_[1]);
    if (k >= high_[2]) {  // above all: it covers whole voxels
      Cell& top = cells_[column * sizes_[2] + sizes_[2] - 1];
      top.share += area;
      top.area += area;
      return;
    }
    Cell& cell = cells_[column * sizes_[2] + static_cast<std::size_t>(k - low_[2])];
    cell.share += volume;
    cell.area += area;
    if (size > cell.largest) {
      cell.largest = static_cast<float>(size);
      cell.v = static_cast<float>(v);
    }
  }

  // Inside a yarn v goes from what it is under a voxel to what it is over it; NaN where the surface is
  // nowhere in the column.
  static void fill_inside(std::span<Cell> cells, bool is_ring, double range) {
    std::size_t known = cells.size();  // the last one at which the surface passed
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (cells[k].share <= least_share) {
        known = cells.size();
      } else if (cells[k].largest > 0) {
        known = k;
      } else {
        std::size_t next = k;
        while (next < cells.size() && cells[next].share > least_share && cells[next].largest == 0) ++next;
        const bool has_next = next < cells.size() && cells[next].largest > 0;
        const std::size_t after = has_next ? next : known;
        const std::size_t before = known < cells.size() ? known : after;
        for (std::size_t m = k; m < next; ++m)
          cells[m].v = after < cells.size() ? between(cells, before, after, m, is_ring, range)
                                            : std::numeric_limits<float>::quiet_NaN();
        k = next - 1;
      }
    }
  }
  static float between(std::span<const Cell> cells, std::size_t before, std::size_t after, std::size_t at,
                       bool is_ring, double range) {
    const float a = cells[before].v, b = cells[after].v;
    if (before == after) return a;
    const float share = static_cast<float>(at - before) / static_cast<float>(after - before);
    if (is_ring && std::abs(b - a) > range / 2) return share < 0.5F ? a : b;
    return a + share * (b - a);
  }

  std::array<std::ptrdiff_t, 3> low_, high_;
  std::array<std::size_t, 3> sizes_{};
  std::vector<Cell> cells_;  // z fastest, then y
};

// Places along a yarn, close to each other: which way it runs, and the share of fibres in it.
class AxisTable {
 public:
  AxisTable(const yarn::Body& body, double step) : body_(body), is_ring_(body.closed_along) {
    const std::vector<double> breaks = nurbs::breakpoints(body.surface.knots_v, body.surface.degree_v);
    vs_ = nurbs::divided(breaks, [&](std::size_t k) {
      const double length =
          (nurbs::evaluate(body.axis, breaks[k + 1]) - nurbs::evaluate(body.axis, breaks[k])).norm();
      return nurbs::whole_parts(length / step, 8, 1000);
    });
    for (const double v : vs_) {
      const nurbs::CurveJet jet = nurbs::evaluate_jet(body.axis, v);
      points_.push_back(jet.position);
      tangents_.push_back(unit_or_zero(jet.d1));
    }
    for (std::size_t k = 0; k < vs_.size(); k += every)
      fractions_.push_back(body.fibre_area > 0 ? body.fibre_area / section_area(body, vs_[k])
                                               : std::numeric_limits<double>::quiet_NaN());
  }

  struct Place {
    Vec3 along;
    double fraction;
  };
  // Nearest to a point, from a good guess; NaN: none is known.
  [[nodiscard]] Place nearest(const Vec3& point, double guess) const {
    const auto by_distance = [&](const Vec3& p, const Vec3& q) {
      return (p - point).squaredNorm() < (q - point).squaredNorm();
    };
    auto k = static_cast<std::size_t>(
        std::isnan(guess) ? std::min_element(points_.begin(), points_.end(), by_distance) - points_.begin()
                          : std::lower_bound(vs_.begin(), vs_.end() - 1, guess) - vs_.begin());
    double here = distance(k, point);
    for (std::size_t steps = 0; steps < vs_.size(); ++steps) {
      const std::size_t next = after(k), last = before(k);
      if (const double there = distance(next, point); there < here) {
        k = next;
        here = there;
      } else if (const double back = distance(last, point); back < here) {
        k = last;
        here = back;
      } else {
        break;
      }
    }
    // Between this place and the one beside it on the point's side.
    const double ahead = (point - points_[k]).dot(tangents_[k]);
    const std::size_t other = ahead > 0 ? after(k) : before(k);
    const double length = (points_[other] - points_[k]).norm();
    const double share = length > 0 ? std::clamp(std::abs(ahead) / length, 0.0, 1.0) : 0;
    const Vec3 foot = (1 - share) * points_[k] + share * points_[other];
    return {fibre_direction(body_, unit_or_zero((1 - share) * tangents_[k] + share * tangents_[other]),
                            point - foot),
            fractions_[std::min(k / every, fractions_.size() - 1)]};
  }

 private:
  [[nodiscard]] double distance(std::size_t k, const Vec3& point) const {
    return (points_[k] - point).squaredNorm();
  }
  // The last place of a ring is its first one.
  [[nodiscard]] std::size_t after(std::size_t k) const {
    if (k + 1 < vs_.size()) return k + 1;
    return is_ring_ ? 1 : k;
  }
  [[nodiscard]] std::size_t before(std::size_t k) const {
    if (k > 0) return k - 1;
    return is_ring_ ? vs_.size() - 2 : k;
  }

  static constexpr std::size_t every = 8;  // the sections change slowly
  const yarn::Body& body_;
  bool is_ring_;
  std::vector<double> vs_;
  std::vector<Vec3> points_, tangents_;
  std::vector<double> fractions_;
};

struct VoxelShare {
  std::size_t voxel = 0;
  float share = 0, fibre = 0;
  std::array<float, 3> along{};
};

// The grid from its corner `low` on, and `own`, the same body, in the coordinates of the axes.
std::vector<VoxelShare> shares_of(const yarn::Body& body, const yarn::Body& own, const VoxelGrid& grid,
                                  const Vec3& low, const ObliqueAxes& axes) {
  const Vec3 sides = grid.sides();
  const Box3 box = yarn::bounds(own);
  std::array<std::ptrdiff_t, 3> first{}, last{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    const auto count = static_cast<double>(grid.count(a));
    first[a] = static_cast<std::ptrdiff_t>(
        std::clamp(std::floor((box.min()[axis] - low[axis]) / sides[axis]), 0.0, count));
    last[a] = static_cast<std::ptrdiff_t>(
        std::clamp(std::ceil((box.max()[axis] - low[axis]) / sides[axis]), 0.0, count));
    if (first[a] >= last[a]) return {};
  }
  YarnShares shares(first, last);
  constexpr double edges_round = 256, edges_along = 64;  // to a perimeter
  const double perimeter = section_perimeter(body, body.surface.first_v());
  const double half = sides.minCoeff() / 2;
  const auto scaled = [&](const Vec3& at) -> Vec3 { return (at - low).cwiseQuotient(sides); };
  triangulate_yarn(own, std::min(half, perimeter / edges_round), std::min(half, perimeter / edges_along),
                   [&](const YarnVertex& a, const YarnVertex& b, const YarnVertex& c) {
                     shares.add(scaled(a.at), scaled(b.at), scaled(c.at), b.v);
                   });
  const AxisTable table(body, half);
  std::vector<VoxelShare> result;
  shares.finish(
      body.closed_along, body.surface.last_v() - body.surface.first_v(),
      [&](const std::array<std::ptrdiff_t, 3>& at, double share, double v) {
        const Vec3 middle =
            axes.place(low + Vec3(static_cast<double>(at[0]) + 0.5, static_cast<double>(at[1]) + 0.5,
                                  static_cast<double>(at[2]) + 0.5)
                                 .cwiseProduct(sides));
        const AxisTable::Place place = table.nearest(middle, v);
        const Eigen::Vector3f along = place.along.cast<float>();
        const auto [i, j, k] = at;
        result.push_back(
            {(static_cast<std::size_t>(k) * grid.count(1) + static_cast<std::size_t>(j)) * grid.count(0) +
                 static_cast<std::size_t>(i),
             static_cast<float>(share),
             static_cast<float>(share * place.fraction),
             {along.x(), along.y(), along.z()}});
      });
  return result;
}

// Yarn by yarn, in their order.
class Merger {
 public:
  explicit Merger(Raster& raster) : raster_(raster), largest_(raster.voxels(), 0) {
    raster.phase.assign(raster.voxels(), 0);
    raster.yarn_fraction.assign(raster.voxels(), 0);
    raster.fibre_fraction.assign(raster.voxels(), 0);
    raster.orientation.assign(raster.voxels(), {});
    raster.phases.push_back({"matrix", "", 0});
  }

  void add(const yarn::Body& body, const std::vector<VoxelShare>& shares) {
    const auto number = static_cast<std::uint16_t>(raster_.phases.size());
    double sum = 0;
    for (const VoxelShare& one : shares) {
      sum += static_cast<double>(one.share);
      raster_.yarn_fraction[one.voxel] += one.share;
      raster_.fibre_fraction[one.voxel] += one.fibre;
      if (one.share <= largest_[one.voxel]) continue;
      largest_[one.voxel] = one.share;
      raster_.phase[one.voxel] = number;
      raster_.orientation[one.voxel] = one.along;
    }
    raster_.phases.push_back({body.name, body.material, sum / static_cast<double>(raster_.voxels())});
  }

  void finish() {
    double yarn = 0, fibre = 0, twice = 0;
    for (std::size_t i = 0; i < largest_.size(); ++i) {
      float& share = raster_.yarn_fraction[i];
      if (share > 1) {
        twice += static_cast<double>(share) - 1;
        raster_.fibre_fraction[i] /= share;
        share = 1;
      }
      yarn += static_cast<double>(share);
      fibre += static_cast<double>(raster_.fibre_fraction[i]);
      if (share < 0.5F) raster_.phase[i] = 0;
    }
    const auto all = static_cast<double>(largest_.size());
    raster_.yarn = yarn / all;
    raster_.fibre = fibre / all;
    raster_.overlap = twice / all;
    raster_.phases[0].fraction = 1 - raster_.yarn;
  }

 private:
  Raster& raster_;
  std::vector<float> largest_;
};

void say_what_is_rough(const Raster& raster, std::span<const yarn::Body> bodies, Diagnostics& diagnostics) {
  if (std::isnan(raster.fibre)) {
    const auto unknown =
        std::ranges::find_if(bodies, [](const yarn::Body& body) { return !(body.fibre_area > 0); });
    diagnostics.add(warning(
        Kind::geometry,
        fmt::format(
            "the fibres of yarn '{}' are not known: fibre_fraction is NaN where it and others "
            "like it are; its thread has to say `tex`, and it or its material the `density` of the fibres",
            unknown == bodies.end() ? "" : unknown->name)));
  }
  constexpr double told = 1e-6;
  if (raster.overlap > told)
    diagnostics.add(warning(
        Kind::geometry,
        fmt::format("yarns overlap in {:.2g} % of the cell, which is counted once; --relax moves them apart",
                    100 * raster.overlap)));
}

}  // namespace

Result<Raster> rasterize(const fabric::Fabric& fabric, std::span<const yarn::Body> bodies,
                         const RasterOptions& options, Diagnostics& diagnostics) {
  if (!fabric.cell) return error(Kind::geometry, "the file says no `cell` to fill with voxels");
  if (bodies.size() > std::numeric_limits<std::uint16_t>::max())
    return error(Kind::limit,
                 fmt::format("{} yarns are more than the 65535 that phases can tell apart", bodies.size()));
  const fabric::Cell& cell = *fabric.cell;
  const Box3 box(cell.low, cell.high);
  const Result<VoxelGrid> grid = make_grid(box, options.count, most_voxels, "voxels");
  if (!grid) return grid.error();
  const double unit = millimetres_per(fabric.units);
  Raster raster;
  raster.count = {grid->count(0), grid->count(1), grid->count(2)};
  const Parallelepiped whole(Box3(box.min() * unit, box.max() * unit), cell.axes);
  raster.origin = cell.axes.place(whole.box.min());
  for (int axis = 0; axis < 3; ++axis) raster.edges[static_cast<std::size_t>(axis)] = whole.edge(axis);
  raster.title = fabric.title.value_or("");
  Merger merger(raster);
  raster.phases[0].material = cell.matrix;
  const yarn::BodiesInAxes own(bodies, cell.axes);
  const auto slots = static_cast<std::size_t>(std::max(options.threads, 1));
  std::vector<std::vector<VoxelShare>> waiting(slots);
  for_each_in_order(
      bodies.size(), slots, options.threads,
      [&](std::size_t b, std::size_t slot) {
        waiting[slot] = shares_of(bodies[b], own.list()[b], *grid, box.min(), cell.axes);
      },
      [&](std::size_t b, std::size_t slot) {
        if (!waiting[slot].empty()) merger.add(bodies[b], waiting[slot]);
        waiting[slot] = {};
        if (options.progress) options.progress(b + 1, bodies.size());
      });
  if (raster.phases.size() == 1)
    return error(Kind::geometry, "no yarn enters the cell").placed(cell.place, fabric.file);
  merger.finish();
  say_what_is_rough(raster, bodies, diagnostics);
  return raster;
}

std::array<RasterField, 4> fields_of(const Raster& raster) {
  const auto field = [](std::string_view name, RasterField::Type type, std::size_t components,
                        const auto& data) {
    return RasterField{name, type, components, data.data(), data.size() * sizeof(data[0])};
  };
  using Type = RasterField::Type;
  return {field("phase", Type::uint16, 1, raster.phase),
          field("yarn_fraction", Type::float32, 1, raster.yarn_fraction),
          field("fibre_fraction", Type::float32, 1, raster.fibre_fraction),
          field("orientation", Type::float32, 3, raster.orientation)};
}

PhaseColumns columns_of(const std::vector<RasterPhase>& phases) {
  PhaseColumns columns;
  for (const RasterPhase& phase : phases) {
    columns.names.push_back(phase.name);
    columns.materials.push_back(phase.material);
    columns.fractions.push_back(phase.fraction);
  }
  return columns;
}

}  // namespace selvage::fem
